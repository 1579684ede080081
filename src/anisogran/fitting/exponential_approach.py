"""The lecture's law for stress ratio and anisotropy: s = s_max - (s_max - s_0) exp(-beta eps_D)."""

from dataclasses import replace

import numpy as np

from anisogran.fitting.gate import CORRELATION, Verdict
from anisogran.fitting.least_squares import Parameter, fit_curve
from anisogran.fitting.observations import observations
from anisogran.outcome import InputError

_DROP = 0.05  # a fall after the peak below this part of the rise is no peak
_SMOOTHING = 0.05  # window of the running mean, as a part of the points


def approach(eps_D, s_0, s_max, beta):
    """s_max - (s_max - s_0) exp(-beta eps_D), shape of eps_D."""
    return s_max - (s_max - s_0) * np.exp(-beta * eps_D)


def relaxation(eps_D, s, errors=None, until="peak", start=None):
    """Fit of s(eps_D), a stress ratio or an anisotropy, of a monotonic loading: `FitResult` with s_0, s_max, beta.

    eps_D (half/half, no unit) and s, shape (n,), in any order; s_0 is the value at eps_D = 0, which is left free.
    `until="peak"`: points after the peak are left out, since a softening tail would lower s_max and raise beta. The peak is
    the largest value of a running mean over 5 % of the points (at least 3); there is one only if the running mean afterwards
    falls by more than 5 % of its rise and by more than 3 standard deviations of the scatter about it. `x_range` and `cut` of the
    result say what was used. `until=None` uses all. `start` is an optional dict with the three values, tried beside 12 others.
    Neighbouring points are taken as a correlated series. Raises InputError for data that cannot be fitted at all, or a bad
    `until`.
    """
    if until not in ("peak", None):
        raise InputError(f"relaxation: until = {until!r} must be 'peak' or None")
    if start is not None and not isinstance(start, dict):
        raise InputError(f"relaxation: start = {start!r} must be a dict of s_0, s_max and beta")
    data = observations("relaxation", eps_D, s, errors, parameters=3)
    if data.x[0] < -1e-3 * abs(data.x[-1]):
        raise InputError(f"relaxation: eps_D = {data.x[0]:g} is negative; the law holds for loading, compression positive")
    used = data if until is None else data.part(slice(_end_of_rise(data.y)))
    if used.x.size < 3 or used.x[0] == used.x[-1]:
        raise InputError(f"relaxation: only {used.x.size} points up to the peak, cannot determine 3 parameters")
    x_scale, y_scale = float(np.max(np.abs(used.x))), float(np.max(np.abs(used.y))) or 1.0
    spacing = x_scale / used.x.size
    parameters = (
        Parameter("s_0", y_scale, -10.0, 10.0, level=True),
        Parameter("s_max", y_scale, -10.0, 10.0),
        Parameter("beta", 1.0 / x_scale, 1e-3, 10.0 * x_scale / spacing),
    )
    x, y = used.x / x_scale, used.y / y_scale
    betas = np.geomspace(0.03, 0.5 * x_scale / spacing, 12)
    starts = [_linear_start(x, y, beta) for beta in betas]
    result = fit_curve(
        "s = s_max - (s_max - s_0) exp(-beta eps_D)",
        approach,
        parameters,
        used,
        starts,
        scales=(x_scale, y_scale),
        series=True,
        cut=data.x.size - used.x.size,
        start=start,
    )
    if abs(result.correlations["s_max", "beta"]) >= CORRELATION:
        slope = result.values["beta"] * (result.values["s_max"] - result.values["s_0"])
        hint = f"only the initial slope beta (s_max - s_0) = {slope:.4g} is determined"
        return replace(result, verdict=Verdict((*result.verdict.reasons, hint), result.verdict.remarks))
    return result


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
