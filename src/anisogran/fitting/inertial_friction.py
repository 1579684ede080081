"""The friction law mu(I) from pairs of inertial number and stress ratio."""

import numpy as np

from anisogran import models
from anisogran.fitting.least_squares import Parameter, fit_curve
from anisogran.fitting.observations import observations
from anisogran.outcome import InputError


def mu_of_I(I, mu, errors=None, law="linear"):
    """Fit of mu(I): `FitResult` with mu_s, b (law="linear") or mu_s, mu_d, I0 (law="saturating", that of Jop et al. 2006).

    I > 0 and mu, shape (n,), without units; the points are taken as independent (one each from its own run or block).
    The linear law holds for discs below I of about 0.2: leave larger I out. Raises InputError for data that cannot be fitted at
    all, negative I, or another law.
    """
    if law not in ("linear", "saturating"):
        raise InputError(f"mu_of_I: law = {law!r} must be 'linear' or 'saturating'")
    data = observations("mu_of_I", I, mu, errors, parameters=2 if law == "linear" else 3)
    if data.x[0] < 0.0:
        raise InputError(f"mu_of_I: I = {data.x[0]:g} must be at least 0")
    x_scale, y_scale = float(data.x[-1]), float(np.max(np.abs(data.y))) or 1.0
    scales = x_scale, y_scale
    slopes = np.geomspace(1e-3, 10.0, 12)
    if law == "linear":
        parameters = (Parameter("mu_s", y_scale, -10.0, 10.0), Parameter("b", y_scale / x_scale, -100.0, 100.0))
        return fit_curve("mu = mu_s + b I", _linear, parameters, data, [(0.5, b) for b in slopes], scales=scales, series=False)
    parameters = (
        Parameter("mu_s", y_scale, -10.0, 10.0),
        Parameter("mu_d", y_scale, -10.0, 10.0),
        Parameter("I0", x_scale, 1e-6, 1e3),
    )
    starts = [(0.5, 1.0, I0) for I0 in slopes]
    return fit_curve("mu = mu_s + (mu_d - mu_s)/(1 + I0/I)", _saturating, parameters, data, starts, scales=scales, series=False)


def _linear(x, mu_s, b):
    return models.mu_linear(x, mu_s, b)


def _saturating(x, mu_s, mu_d, I0):
    return models.mu_of_I(x, mu_s, mu_d, I0)
