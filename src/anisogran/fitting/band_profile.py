"""The error-function profile of a wide shear band, as in split-bottom cells."""

import numpy as np
from scipy.special import erf

from anisogran.fitting.least_squares import Parameter, fit_curve
from anisogran.fitting.observations import observations


def band(r, inner, outer, centre, width):
    """inner + (outer - inner) (1 + erf((r - centre)/width))/2, shape of r."""
    return inner + 0.5 * (outer - inner) * (1.0 + erf((r - centre) / width))


def shear_band(r, omega, errors=None):
    """Fit of the angular velocity omega(r) by an error function: `FitResult` with inner, outer (unit of omega), centre, width
    (of r).

    `inner` and `outer` are the limits at small and large r and may be zero. Shapes (n,); points are taken as a series
    (profile bins share grains). Raises InputError for data that cannot be fitted at all.
    """
    data = observations("shear_band", r, omega, errors, parameters=4)
    x_scale, y_scale = float(np.max(np.abs(data.x))), float(np.max(np.abs(data.y))) or 1.0
    low, span = data.x[0] / x_scale, (data.x[-1] - data.x[0]) / x_scale
    parameters = (
        Parameter("inner", y_scale, -10.0, 10.0, level=True),
        Parameter("outer", y_scale, -10.0, 10.0, level=True),
        Parameter("centre", x_scale, low - span, low + 2.0 * span),
        Parameter("width", x_scale, 1e-3 * span, 10.0 * span),
    )
    edges = data.y[[0, -1]] / y_scale
    starts = [(*edges, low + at * span, width * span) for at in (0.25, 0.5, 0.75) for width in (0.01, 0.03, 0.1, 0.3)]
    return fit_curve("omega = erf band", band, parameters, data, starts, scales=(x_scale, y_scale), series=True)
