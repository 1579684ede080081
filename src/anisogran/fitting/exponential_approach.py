"""The lecture's law for stress ratio and anisotropy: s = s_max - (s_max - s_0) exp(-beta eps_D)."""

from dataclasses import replace

import numpy as np

from anisogran.fitting.gate import CORRELATION, Verdict
from anisogran.fitting.least_squares import Parameter, Part, fit_together
from anisogran.fitting.observations import DataSet, labels, observations
from anisogran.outcome import InputError

_DROP = 0.05  # a fall after the peak below this part of the rise is no peak
_SMOOTHING = 0.05  # window of the running mean, as a part of the points


def approach(eps_D, s_0, s_max, beta):
    """s_max - (s_max - s_0) exp(-beta eps_D), shape of eps_D."""
    return s_max - (s_max - s_0) * np.exp(-beta * eps_D)


def relaxation(eps_D, s, errors=None, until="peak", start=None, loss="linear"):
    """Fit of s(eps_D), a stress ratio or an anisotropy, of a monotonic loading: `FitResult` with s_0, s_max, beta.

    eps_D (half/half, no unit) and s, shape (n,), in any order; s_0 is the value at eps_D = 0, which is left free.
    `until="peak"`: points after the peak are left out, since a softening tail would lower s_max and raise beta. The peak is
    the largest value of a running mean over 5 % of the points (at least 3); there is one only if the running mean afterwards
    falls by more than 5 % of its rise and by more than 3 standard deviations of the scatter about it. `x_range` and `cut` of the
    result say what was used. `until=None` uses all. `start` is an optional dict with the three values, tried beside 12 others.
    With loss="soft_l1" outliers have little say, and the errors are those of a bootstrap (0.3 s). Neighbouring points are taken as a
    correlated series. Raises InputError for data that cannot be fitted at all, or a bad
    `until`.
    """
    return _fit("relaxation", [DataSet(eps_D, s, errors)], [""], until, start, loss=loss)


def relaxations(sets, shared=None, until="peak", start=None, balance=False, loss="linear"):
    """Fit of s(eps_D) of several `DataSet`s at once: `FitResult` with s_0, s_max, beta, each own or shared.

    `shared={"s_max": ("mu",), "beta": "all"}`: data sets with equal mu have one s_max, all have one beta, and s_0 is own; then
    `values` has the names "s_0[LABEL]", "s_max[mu=0.5]", "beta". `result.table` says which is which, `result.of(LABEL)` has the three
    values of one data set. Every point counts by its error; `balance=True` lets each data set count the same, whatever its length.
    The rest is as in `relaxation`. Raises InputError for what it refuses, and for names of parameters or conditions that are unknown.
    """
    return _fit("relaxations", sets, labels("relaxations", sets), until, start, shared, balance, loss)


def _fit(where, sets, names, until, start, shared=None, balance=False, loss="linear"):
    if until not in ("peak", None):
        raise InputError(f"{where}: until = {until!r} must be 'peak' or None")
    if start is not None and not isinstance(start, dict):
        raise InputError(f"{where}: start = {start!r} must be a dict of s_0, s_max and beta")
    whole = [_checked(f"{where} {name}".strip(), one) for name, one in zip(names, sets, strict=True)]
    used = [_used(f"{where} {name}".strip(), data, until) for name, data in zip(names, whole, strict=True)]
    x_scale = max(float(np.max(np.abs(data.x))) for data in used)
    y_scale = max(float(np.max(np.abs(data.y))) for data in used) or 1.0
    fastest = max(x_scale * data.x.size / float(np.max(np.abs(data.x))) for data in used)
    parameters = (
        Parameter("s_0", y_scale, -10.0, 10.0, level=True),
        Parameter("s_max", y_scale, -10.0, 10.0),
        Parameter("beta", 1.0 / x_scale, 1e-3, 10.0 * fastest),
    )
    parts = []
    for name, one, data, all_data in zip(names, sets, used, whole, strict=True):
        x, y, reach = data.x / x_scale, data.y / y_scale, float(np.max(np.abs(data.x))) / x_scale
        starts = [_linear_start(x, y, beta) for beta in np.geomspace(0.03, 0.5 * data.x.size, 12) / reach]
        parts.append(Part(data, starts, name, one.conditions, one.weight, cut=all_data.x.size - data.x.size))
    law = "s = s_max - (s_max - s_0) exp(-beta eps_D)"
    settings = {"shared": shared, "balance": balance, "loss": loss, "start": start, "where": where}
    result = fit_together(law, approach, parameters, parts, scales=(x_scale, y_scale), series=True, **settings)
    hints = [hint for name in names for hint in _slope_only(result, name)]
    return replace(result, verdict=Verdict((*result.verdict.reasons, *hints), result.verdict.remarks)) if hints else result


def _checked(where, one):
    data = observations(where, one.x, one.y, one.errors, parameters=3)
    if data.x[0] < -1e-3 * abs(data.x[-1]):
        raise InputError(f"{where}: eps_D = {data.x[0]:g} is negative; the law holds for loading, compression positive")
    return data


def _used(where, data, until):
    used = data if until is None else data.part(slice(_end_of_rise(data.y)))
    if used.x.size < 3 or used.x[0] == used.x[-1]:
        raise InputError(f"{where}: only {used.x.size} points up to the peak, cannot determine 3 parameters")
    return used


def _slope_only(result, name):
    """What is known where s_max and beta are not separated."""
    variables = [result.table.variables[name, parameter] for parameter in ("s_max", "beta")]
    if abs(result.correlations[tuple(variables)]) >= CORRELATION:
        values = result.of(name)
        slope = values["beta"] * (values["s_max"] - values["s_0"])
        yield f"{name}: ".removeprefix(": ") + f"only the initial slope beta (s_max - s_0) = {slope:.4g} is determined"


def _linear_start(x, y, beta):
    """(s_0, s_max, beta) with the best levels for this beta: they enter linearly."""
    decay = np.exp(-beta * x)
    s_0, s_max = np.linalg.lstsq(np.column_stack([decay, 1.0 - decay]), y, rcond=1e-10)[0]
    return np.clip(s_0, -9.0, 9.0), np.clip(s_max, -9.0, 9.0), beta


def _end_of_rise(y):
    """The number of points up to the peak, or all; a law that falls towards its limit is turned over first."""
    window = max(3, 2 * round(0.5 * _SMOOTHING * y.size) + 1)
    if y.size < 3 * window:
        return y.size
    sums = np.cumsum(np.concatenate([[0.0], y]))
    smooth = (sums[window:] - sums[:-window]) / window  # entry i is centred on point i + window//2
    if smooth.max() - smooth[0] < smooth[0] - smooth.min():
        smooth, y = -smooth, -y
    peak = int(np.argmax(smooth))
    fall, rise = smooth[peak] - smooth[peak:].min(), smooth[peak] - smooth[0]
    scatter = np.std(y[window // 2 : window // 2 + smooth.size] - smooth)
    if fall <= _DROP * rise or fall <= 3.0 * scatter:
        return y.size
    return peak + window // 2 + 1
