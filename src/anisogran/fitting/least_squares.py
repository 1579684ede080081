"""The one place where curves are fitted: scaled variables, many starts, errors that know of correlated residuals, the gate."""

from dataclasses import replace
from typing import NamedTuple

import lmfit
import numpy as np

from anisogran.fitting.bootstrap import resampled
from anisogran.fitting.estimate import Estimate
from anisogran.fitting.examination import figures, objections, remarks, together
from anisogran.fitting.gate import Verdict
from anisogran.fitting.observations import Observations
from anisogran.fitting.problem import Points, Problem
from anisogran.fitting.result import FitResult
from anisogran.fitting.search import search
from anisogran.fitting.sharing import Sharing, variables
from anisogran.fitting.spread import spread
from anisogran.outcome import InputError, NotConverged

SAMPLES = 200  # of a bootstrap, unless told otherwise: errors are then known to 5 %
_ROBUST = {"linear": 0, "soft_l1": 2}  # how often the typical residual is found again
_EFFICIENT = 1.345  # bend of the loss in typical residuals: 95 % as good as least squares for Gaussian noise


class Parameter(NamedTuple):
    """A parameter of the scaled curve: `unit` times the scaled value is the value in the units of the data.

    `level` marks one that may well be zero: its error is judged against the signal, not against its value.
    """

    name: str
    unit: float
    lower: float
    upper: float
    level: bool = False


class Part(NamedTuple):
    """One data set of a fit. `starts` are guesses in scaled variables, shape (m, p), the same m for all data sets.

    `known` are further arguments of the curve that this data set fixes; they must be pure numbers, since nothing scales them.
    """

    data: Observations
    starts: object
    label: str = ""
    conditions: dict = {}  # noqa: RUF012, never changed
    weight: float = 1.0
    known: dict = {}  # noqa: RUF012
    cut: int = 0


def fit_curve(law, curve, parameters, data, starts, *, scales, series, cut=0, start=None, curve_of_data=None):
    """The `FitResult` of the least-squares fit of `curve(x, **values)` to `data` (an `Observations`): `fit_together` of one data set.

    `curve` must take complex parameters; it is the same in scaled and in unscaled variables. `scales` are those of x
    and y; `starts` an array (m, p) in scaled variables; `start` an optional dict of the user, in the units of the data, tried as
    well. `curve_of_data` is the curve in the user's variables if it is not `curve` (a fit to the logarithm).
    """
    part = Part(data, starts, cut=cut)
    return fit_together(law, curve, parameters, [part], scales=scales, series=series, start=start, curve_of_data=curve_of_data)


def fit_together(
    law,
    curve,
    parameters,
    parts,
    *,
    scales,
    series,
    shared=None,
    balance=False,
    loss="linear",
    start=None,
    curve_of_data=None,
    together_first=False,
    where="fit_together",
):
    """The `FitResult` of the least-squares fit of one curve to the `Part`s at once; for the arguments see `fit_curve`.

    `shared` says which parameters data sets have in common, see `sharing.variables`; data sets that share nothing are fitted one by one.
    Every point counts by its error, times the weight of its data set; with `balance` each data set counts the same, whatever its
    length. Weights move the values, they do not shrink the errors.
    Errors: without `data.errors` (of all data sets, or of none) the noise is the scatter about the curve, of each data set by itself if
    it is long enough; with them they are taken as given, and enlarged if the scatter is larger (chi^2/free > 1). If the points are a
    `series` (neighbours in x are neighbours in one run) the variance is multiplied by the correlation time tau of the residuals,
    since only n/tau points are independent; this holds for noise that is short-ranged against the curve.
    With loss="soft_l1" residuals count linearly, not squared, from about 1.3 typical ones on, so that outliers have little say; the
    errors are then those of a bootstrap, since a covariance would be wrong. For `together_first` see `search`.
    Raises InputError for a start or a sharing that names what there is not, NotConverged if no start gives a finite curve.
    """
    if loss not in _ROBUST:
        raise InputError(f"{where}: loss = {loss!r} must be 'linear' or 'soft_l1'")
    names = tuple(parameter.name for parameter in parameters)
    labels = [part.label for part in parts]
    index, owners = variables(where, names, labels, [part.conditions for part in parts], shared)
    of_variable = [parameters[int(np.argwhere(index == i)[0, 1])] for i in range(len(owners))]
    lower, upper, units = (np.array([getattr(q, key) for q in of_variable]) for key in ("lower", "upper", "unit"))
    sets = _sets(where, parts, scales, balance)
    problem = Problem(curve, names, tuple(q.level for q in parameters), series, sets, index, lower, upper)
    given = _given(law, start, parameters)
    starts = [[*np.asarray(part.starts, dtype=float), *given] for part in parts]
    theta, found = search(problem, starts, together_first)
    for _ in range(_ROBUST[loss]):
        problem = replace(problem, bend=_EFFICIENT * _typical_residual(problem, theta))
        theta, found = search(problem, starts, together_first)
    if not all(np.isfinite(one.chi_square) for one in found):
        raise NotConverged(f"{where}: the curve of {law} has no finite values from any of the starts")
    estimate = Estimate(problem, theta, spread(problem, theta), owners, units, scales)
    if problem.bend is not None:
        draws, _ = resampled(estimate, SAMPLES, seed=0)
        estimate = estimate._replace(spread=replace(estimate.spread, covariance=np.atleast_2d(np.cov(draws, rowvar=False))))
    each = [figures(estimate, k, part.data.errors is not None) for k, part in enumerate(parts)]
    reasons, undetermined = objections(estimate, found, labels, each)
    errors = estimate.named(estimate.sigmas)
    table = Sharing(
        names,
        tuple(labels),
        {(label, name): owners[i] for label, row in zip(labels, index, strict=True) for name, i in zip(names, row, strict=True)},
        {part.label: part.data.x.size for part in parts},
        {part.label: points.importance for part, points in zip(parts, sets, strict=True)},
    )
    tries = [_all_variables(estimate, found, number) for number in range(min(len(one.starts) for one in found))]
    return FitResult(
        law=law,
        values=estimate.named(theta),
        errors={name: float("nan") if name in undetermined else abs(errors[name]) for name in owners},
        errors_from="covariance" if problem.bend is None else "bootstrap",
        correlations=estimate.correlations(),
        verdict=Verdict(tuple(reasons), tuple(remarks(estimate, found, parts, each, bool(given)))),
        table=table,
        points=sum(points.x.size for points in sets),
        x_range=(min(float(part.data.x[0]) for part in parts), max(float(part.data.x[-1]) for part in parts)),
        dropped=sum(part.data.dropped for part in parts),
        cut=sum(part.cut for part in parts),
        free=estimate.spread.free,
        residuals=together(each, estimate.spread.conditions),
        data_sets=dict(zip(labels, each, strict=True)),
        starts=tuple(tries),
        start=_all_variables(estimate, found, None),
        lmfit_version=lmfit.__version__,
        _curve=curve_of_data or curve,
        _estimate=estimate,
        _known={part.label: part.known for part in parts},
    )


def _sets(where, parts, scales, balance):
    """The `Points` of each data set, with the weights that `balance` asks for."""
    given = [part.data.errors is not None for part in parts]
    if any(given) and not all(given):
        raise InputError(f"{where}: errors must be given for all data sets or for none, {parts[given.index(False)].label!r} has none")
    seen = {}
    for part in parts if len(parts) > 1 else ():
        first = seen.setdefault((part.data.x.tobytes(), part.data.y.tobytes()), part.label)
        if first != part.label:
            raise InputError(f"{where}: data sets {first!r} and {part.label!r} hold the same points")
    sizes = np.array([part.data.x.size for part in parts])
    factors = sizes.mean() / sizes if balance else np.ones(sizes.size)
    sets = []
    for part, factor in zip(parts, factors, strict=True):
        x, y, importance = part.data.x / scales[0], part.data.y / scales[1], float(part.weight * factor)
        weight = np.sqrt(importance) * (np.ones_like(y) if part.data.errors is None else scales[1] / part.data.errors)
        floor = 0.0 if part.data.errors is None else importance
        sets.append(Points(x, y, weight, part.data.distinct, part.known, floor, importance))
    return tuple(sets)


def _typical_residual(problem, theta):
    """The standard deviation of the residuals as their median tells it, outliers aside."""
    left = np.concatenate([problem.raw(k, theta) for k in range(len(problem.sets))])
    return 1.4826 * float(np.median(np.abs(left))) or 1.0


def _all_variables(estimate, found, number):
    """{name: start value} of the try of this number, or of the best one."""
    guess = np.empty(estimate.theta.size)
    for one in found:
        guess[one.variables] = one.starts[one.best if number is None else number]
    return estimate.named(guess)


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
