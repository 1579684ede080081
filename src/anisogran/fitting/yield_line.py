"""Mohr-Coulomb from peak stresses: friction angle and cohesion."""

import numpy as np

from anisogran.fitting.least_squares import Parameter, fit_curve
from anisogran.fitting.observations import observations
from anisogran.models import peak_stress


def mohr_coulomb(p, sigma_zz, errors=None):
    """Fit of sigma_zz = p K + 2 c sqrt(K), K = (1 + sin phi)/(1 - sin phi): `FitResult` with phi [rad] and c (unit of stress).

    p is the side pressure, sigma_zz the peak stress, shape (n,), compression positive; all error is taken to be in sigma_zz,
    and the points to be independent runs. phi belongs to the tangent line, not to a line through the origin. c may be zero, hence
    its error is judged against the range of the fitted stresses. Two points give the exact tangent, without errors and not
    trustworthy. Raises InputError for data that cannot be fitted at all.
    """
    data = observations("mohr_coulomb", p, sigma_zz, errors, parameters=2)
    scale = float(np.max(np.abs([data.x, data.y])))
    quarter = 0.5 * np.pi - 1e-3
    parameters = (Parameter("phi", 1.0, -quarter, quarter), Parameter("c", scale, -10.0, 10.0, level=True))
    starts = [(phi, c) for phi in (0.05, 0.2, 0.5, 1.0) for c in (-0.1, 0.01, 0.1)]
    law = "sigma_zz = p K + 2 c sqrt(K)"
    return fit_curve(law, peak_stress, parameters, data, starts, scales=(scale, scale), series=False)
