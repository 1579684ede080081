"""The one place where a curve is fitted: scaled variables, many starts, errors that know of correlated residuals, the gate."""

import warnings
from typing import NamedTuple

import lmfit
import numpy as np

from anisogran.fitting.gate import RANDOM_SIGNS, Evidence, Verdict, judge
from anisogran.fitting.residuals import correlation_time, runs_test
from anisogran.fitting.result import FitResult
from anisogran.outcome import InputError

_COMPLEX_STEP = 1e-30
_TOLERANCE = 1e-12  # of the minimiser, relative; its noise of rounding lies some decades lower
_CONVERGED = 1e-7  # residuals below this part of the signal: data without noise
_AT_BOUND = 1e-6  # this close to a bound, in units of the range of the parameter, is at the bound
_MANY = 4000  # above this number of points the starts are tried on a thinned set, and the best one is polished on all


class Parameter(NamedTuple):
    """A parameter of the scaled curve: `unit` times the scaled value is the value in the units of the data.

    `level` marks one that may well be zero: its error is judged against the signal, not against its value.
    """

    name: str
    unit: float
    lower: float
    upper: float
    level: bool = False


def fit_curve(law, curve, parameters, data, starts, *, scales, series, cut=0, start=None, curve_of_data=None):
    """The `FitResult` of the least-squares fit of `curve(x, **values)` to `data` (an `Observations`).

    `curve` must take complex parameters; it is the same in scaled and in unscaled variables. `scales` are those of x
    and y; `starts` an array (m, p) in scaled variables; `start` an optional dict of the user, in the units of the data, tried as
    well. `curve_of_data` is the curve in the user's variables if it is not `curve` (a fit to the logarithm).
    Errors: without `data.errors` the noise is the scatter about the curve; with them they are taken as given, and enlarged if the
    scatter is larger (chi^2/free > 1). If the points are a `series` (neighbours in x are neighbours in one run) the covariance is
    multiplied by the correlation time tau of the residuals, since only n/tau points are independent; this holds for noise that is
    short-ranged against the curve.
    """
    x, y = data.x / scales[0], data.y / scales[1]
    weight = np.ones_like(y) if data.errors is None else scales[1] / data.errors
    names = [parameter.name for parameter in parameters]
    units = np.array([parameter.unit for parameter in parameters])

    def residual(theta, x=x, y=y, weight=weight):
        return (curve(x, **dict(zip(names, theta, strict=True))) - y) * weight

    starts = [*np.asarray(starts, dtype=float), *_given(law, start, parameters)]
    coarse = slice(None, None, -(-x.size // _MANY))
    tried = [_minimum(residual, parameters, guess, (x[coarse], y[coarse], weight[coarse])) for guess in starts]
    chi_squares = tuple(chi_square for _, chi_square in tried)
    best = int(np.argmin(chi_squares))
    theta = tried[best][0]
    if x.size > _MANY:
        theta, _ = _minimum(residual, parameters, theta, (x, y, weight))

    left = residual(theta)
    chi_square, n, p = float(left @ left), x.size, len(names)
    signal, noise = float(np.ptp(left / weight + y)), float(np.sqrt(np.mean((left / weight) ** 2)))
    jacobian = _jacobian(residual, theta)
    regular = bool(np.all(np.isfinite(jacobian)) and np.all(np.any(jacobian != 0.0, axis=0)))
    # residuals as small as the minimiser's own tolerance are no noise, and their order tells nothing
    tau = correlation_time(left, jacobian) if series and regular and noise > _CONVERGED * signal else 1.0
    free = n / tau - p
    size = np.array([signal if parameter.level else value for parameter, value in zip(parameters, theta, strict=True)])
    # tau times the variance of a point, which is chi^2/n corrected for the p independent points that the fit has used up
    variance = chi_square / free if free > 0.0 else np.nan
    if data.errors is not None and free > 0.0:
        variance = max(tau, variance)
    covariance, condition = _covariance(jacobian, size, variance)
    covariance = covariance * np.outer(units, units)
    sigma = np.sqrt(np.diag(covariance))
    correlations = {
        (names[i], names[j]): float(covariance[i, j] / (sigma[i] * sigma[j])) if sigma[i] * sigma[j] > 0.0 else float("nan")
        for i in range(p)
        for j in range(i + 1, p)
    }
    values = dict(zip(names, (theta * units).tolist(), strict=True))
    errors = dict(zip(names, sigma.tolist(), strict=True))
    evidence = Evidence(
        points=n,
        free=free,
        values=values,
        errors=errors,
        sizes=dict(zip(names, (size * np.abs(units)).tolist(), strict=True)),
        correlations=correlations,
        at_bound=tuple(q.name for q, v in zip(parameters, theta, strict=True) if _at_bound(q, v)),
        condition=condition,
        signal=signal * scales[1],
        noise=noise * scales[1],
        chi_square=chi_squares[best],
        all_chi_squares=chi_squares,
    )
    reasons, undetermined = judge(evidence)
    runs_p = runs_test(left)
    return FitResult(
        law=law,
        values=values,
        errors={name: float("nan") if name in undetermined else errors[name] for name in names},
        correlations=correlations,
        verdict=Verdict(reasons, _remarks(data.dropped, runs_p, tau, chi_squares, start)),
        points=n,
        x_range=(float(data.x[0]), float(data.x[-1])),
        dropped=data.dropped,
        cut=cut,
        free=free,
        residuals={
            "rms": noise * scales[1],
            "largest": float(np.max(np.abs(left / weight))) * scales[1],
            "chi_square": chi_square if data.errors is not None else chi_square * scales[1] ** 2,
            "correlation_time": tau,
            "independent_points": n / tau,
            "runs_p": runs_p,
            "condition": condition,
        },
        starts=tuple(dict(zip(names, (guess * units).tolist(), strict=True)) for guess in starts),
        start=dict(zip(names, (starts[best] * units).tolist(), strict=True)),
        lmfit_version=lmfit.__version__,
        _curve=curve_of_data or curve,
    )


def _minimum(residual, parameters, guess, points):
    """(theta, chi^2) of Levenberg-Marquardt from one start, inside the bounds."""
    table = lmfit.Parameters()
    for parameter, value in zip(parameters, guess, strict=True):
        table.add(parameter.name, value=value, min=parameter.lower, max=parameter.upper)
    names = [parameter.name for parameter in parameters]
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        # lmfit also makes error bars, which are not used here, and warns when they vanish or cannot be had; errstate restores the
        # floating-point settings, which lmfit itself loses if a curve raises
        warnings.simplefilter("ignore")
        answer = lmfit.minimize(
            lambda table: residual([table[name].value for name in names], *points),
            table,
            method="leastsq",
            ftol=_TOLERANCE,
            xtol=_TOLERANCE,
        )
    return np.array([answer.params[name].value for name in names]), float(np.sum(answer.residual**2))


def _given(law, start, parameters):
    """The user's start in scaled variables, as a list of none or one."""
    if start is None:
        return []
    names = {parameter.name for parameter in parameters}
    if set(start) != names:
        raise InputError(f"{law}: start must give {', '.join(sorted(names))}, has {', '.join(sorted(start))}")
    guess = np.array([start[parameter.name] / parameter.unit for parameter in parameters], dtype=float)
    inside = [parameter.lower < value < parameter.upper for parameter, value in zip(parameters, guess, strict=True)]
    if not all(inside):
        raise InputError(f"{law}: start {start} lies outside the range of the parameters")
    return [guess]


def _jacobian(residual, theta):
    """d residual/d theta, shape (n, p), exact (complex step)."""
    return np.array([np.imag(residual(theta + 1j * _COMPLEX_STEP * unit)) / _COMPLEX_STEP for unit in np.eye(theta.size)]).T


def _covariance(jacobian, size, variance):
    """(covariance, condition); the condition has each parameter in units of its size."""
    scaled = jacobian * size
    if not np.all(np.isfinite(scaled)) or np.any(size == 0.0):
        return np.full((size.size, size.size), np.nan), float("inf")
    _, singular, axes = np.linalg.svd(scaled, full_matrices=False)
    if singular[-1] <= 1e-14 * singular[0]:  # rounding of the decomposition
        return np.full((size.size, size.size), np.nan), float("inf")
    half = (axes.T / singular) * size[:, None]
    return half @ half.T * variance, float(singular[0] / singular[-1])


def _at_bound(parameter, value):
    margin = _AT_BOUND * (parameter.upper - parameter.lower)
    if parameter.lower > 0.0:  # a rate: the low end of a range over decades is near in ratio, not in difference
        return value < parameter.lower * (1.0 + 1e-3) or value > parameter.upper - margin
    return not parameter.lower + margin < value < parameter.upper - margin


def _remarks(dropped, runs_p, tau, chi_squares, start):
    remarks = []
    if dropped:
        remarks.append(f"{dropped} points dropped")
    if runs_p < RANDOM_SIGNS:
        remarks.append(f"structure left in residuals (runs test p = {runs_p:.1e})")
    if tau > 1.5:
        remarks.append(f"residuals correlated over {tau:.1f} points, errors enlarged by {np.sqrt(tau):.1f}")
    if start is not None and chi_squares[-1] > 1.01 * min(chi_squares):
        remarks.append("the given start leads to a worse minimum, another start was used")
    return tuple(remarks)
