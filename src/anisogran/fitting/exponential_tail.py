"""The two-parameter baseline of a shear band: v = amplitude exp(-x/length)."""

import numpy as np

from anisogran.fitting.least_squares import Parameter, fit_curve
from anisogran.fitting.observations import observations
from anisogran.outcome import InputError


def decay(x, amplitude, length):
    """amplitude exp(-x/length), shape of x."""
    return amplitude * np.exp(-x / length)


def _log_decay(x, amplitude, length):
    return np.log(amplitude) - x / length


def exponential_decay(x, v, errors=None):
    """Fit of v(x) = amplitude exp(-x/length): `FitResult` with amplitude (unit of v) and length (unit of x, > 0).

    With `errors` the fit is to v itself, weighted by them. Without, it is to ln|v|, so that every point has the same relative
    error; points whose sign is not that of most are then left out and counted in `dropped`, residual figures are those of ln|v|.
    Where a noise floor bends the tail, cut it off or give errors. Points are a series (profile bins share grains).
    Raises InputError for data that cannot be fitted at all.
    """
    data = observations("exponential_decay", x, v, errors, parameters=2)
    sign = -1.0 if np.median(data.y) < 0.0 else 1.0
    if errors is None:
        usable = sign * data.y > 0.0
        if np.count_nonzero(usable) < 2:
            raise InputError("exponential_decay: fewer than 2 points of one sign, no logarithm can be fitted")
        data = data.part(usable)._replace(dropped=data.dropped + int(np.count_nonzero(~usable)))
        if data.x[0] == data.x[-1]:
            raise InputError("exponential_decay: all points of one sign have the same abscissa")
    x_scale = float(np.max(np.abs(data.x)))
    y_scale = float(sign * np.max(np.abs(data.y)))
    if y_scale == 0.0:
        raise InputError("exponential_decay: all values are 0")
    parameters = (Parameter("amplitude", y_scale, 1e-12, 1e12), Parameter("length", x_scale, 1e-4, 1e4))
    starts = [(1.0, length) for length in np.geomspace(0.02, 50.0, 12)]
    settings = {"series": True, "curve_of_data": decay}
    if errors is not None:
        return fit_curve("v = amplitude exp(-x/length)", decay, parameters, data, starts, scales=(x_scale, y_scale), **settings)
    logs = data._replace(y=np.log(data.y / y_scale))
    return fit_curve("ln v = ln amplitude - x/length", _log_decay, parameters, logs, starts, scales=(x_scale, 1.0), **settings)
