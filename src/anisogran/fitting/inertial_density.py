"""The dilatancy law of dense flow: area fraction against inertial number."""

import numpy as np

from anisogran.fitting.least_squares import Parameter, fit_curve
from anisogran.fitting.observations import observations
from anisogran.outcome import InputError


def area_fraction(I, nu, errors=None):
    """Fit of nu = nu_max - a I: `FitResult` with nu_max and a, both without unit (a > 0: faster flow is looser).

    I >= 0 and nu, shape (n,); the points are taken as independent (one each from its own run or block). The straight line is the law of
    da Cruz et al., Phys. Rev. E 72, 021309 (2005), for discs up to I of about 0.2 (law recalled, not checked against the paper).
    Raises InputError for data that cannot be fitted at all, negative I, or nu outside (0, 1].
    """
    data = observations("area_fraction", I, nu, errors, parameters=2)
    if data.x[0] < 0.0:
        raise InputError(f"area_fraction: I = {data.x[0]:g} must be at least 0")
    wrong = data.y[(data.y <= 0.0) | (data.y > 1.0)]
    if wrong.size:
        raise InputError(f"area_fraction: nu = {wrong[0]:g} must be above 0 and at most 1")
    scales = float(data.x[-1]), float(np.max(data.y))
    parameters = (Parameter("nu_max", scales[1], 0.0, 10.0), Parameter("a", scales[1] / scales[0], -100.0, 100.0))
    starts = [(1.0, a) for a in np.geomspace(1e-4, 10.0, 12)]
    return fit_curve("nu = nu_max - a I", _line, parameters, data, starts, scales=scales, series=False)


def _line(x, nu_max, a):
    return nu_max - a * x
