"""A fit brought before the gate: figures of merit, reasons against it, remarks."""

import numpy as np

from anisogran.fitting.contradiction import CONTRADICTED, contradiction
from anisogran.fitting.gate import ORDERED_SIGNS, RANDOM_SIGNS, Evidence, Source, judge
from anisogran.fitting.residuals import runs_test
from anisogran.fitting.spread import CONVERGED

_DOMINATES = 0.9  # share of what is known of a shared parameter
_LONG = 5  # points per parameter from which a data set tells its noise
_UNEQUAL = 3.0  # ratio of noises above which data sets should have been given errors


def figures(estimate, k, measured):
    """The figures of data set k, in the units of the data, see `FitResult.residuals`; `measured` if its errors were given."""
    about, points = estimate.spread, estimate.problem.sets[k]
    left, scale = estimate.problem.raw(k, estimate.theta), abs(estimate.scales[1])
    chi_square = float(left @ left) / points.importance
    return {
        "rms": float(about.noises[k]) * scale,
        "largest": float(np.max(np.abs(left / points.weight))) * scale,
        "chi_square": chi_square if measured else chi_square * scale**2,
        "correlation_time": float(about.taus[k]),
        "independent_points": float(left.size / about.taus[k]),
        "runs_p": runs_test(left[points.distinct]) if about.noises[k] > CONVERGED * about.signals[k] else float("nan"),
    }


def together(each, conditions):
    """The figures of all data sets at once: sums, the worst, and the scatter over all points."""
    numbers = np.array([one["correlation_time"] * one["independent_points"] for one in each])
    runs = [one["runs_p"] for one in each if np.isfinite(one["runs_p"])]
    return {
        "rms": float(np.sqrt(np.average([one["rms"] ** 2 for one in each], weights=numbers))),
        "largest": max(one["largest"] for one in each),
        "chi_square": sum(one["chi_square"] for one in each),
        "correlation_time": max(one["correlation_time"] for one in each),
        "independent_points": sum(one["independent_points"] for one in each),
        "runs_p": min(runs, default=float("nan")),
        "condition": max(conditions),
    }


def objections(estimate, found, labels, each):
    """(reasons, undetermined names) of the gate, of the signs of residuals and of contradicted sharing, over all components."""
    reasons, undetermined = [], set()
    for number, (one, group) in enumerate(zip(found, estimate.spread.components, strict=True)):
        names = [estimate.names[i] for i in one.variables]
        some, open_names = judge(_evidence(estimate, one, group, labels, number))
        reasons += some
        undetermined |= open_names
        if len(group) > 1 and len(one.variables) < one.apart.size:
            doubt = _doubt(estimate, one, group)
            reasons += doubt
            undetermined.update(names if doubt else ())
        if not estimate.problem.series:
            for k in (k for k in group if _wrong_law(estimate.problem, k, estimate.theta, each[k])):
                reasons.append(f"{_where(labels, k)}the law is wrong for independent points: long runs of one sign in the residuals")
                undetermined.update(estimate.names[i] for i in estimate.problem.index[k])
    return reasons, undetermined


def _evidence(estimate, one, group, labels, number):
    problem, about, scale = estimate.problem, estimate.spread, abs(estimate.scales[1])
    names = [estimate.names[i] for i in one.variables]
    values, errors, sizes = (estimate.named(scaled) for scaled in (estimate.theta, estimate.sigmas, about.sizes))
    sources = tuple(
        Source(
            labels[k],
            problem.sets[k].x.size,
            float(about.signals[k]) * scale,
            float(about.noises[k]) * scale,
            tuple(estimate.names[i] for i in problem.index[k]),
        )
        for k in group
    )
    return Evidence(
        sources=sources,
        free=float(np.sum([source.points / about.taus[k] for source, k in zip(sources, group, strict=True)])) - len(names),
        values={name: values[name] for name in names},
        errors={name: abs(errors[name]) for name in names},
        sizes={name: sizes[name] for name in names},
        correlations=estimate.correlations(one.variables),
        at_bound=tuple(estimate.names[i] for i in one.variables if problem.at_bound(estimate.theta)[i]),
        condition=about.conditions[number],
        chi_square=one.all_chi_squares[one.best],
        all_chi_squares=one.all_chi_squares,
    )


def _doubt(estimate, one, group):
    part, used = estimate.problem.part(group)
    test = contradiction(part, estimate.theta[used], one.apart, float(np.sum(estimate.spread.taken[group])))
    if not test.probability < CONTRADICTED:
        return []
    worst = "" if test.worst is None else f", {estimate.names[used[test.worst]]} differs most"
    return [
        f"the data sets do not share these values: chi^2 is {test.ratio:.3g} times that of separate fits "
        f"(F-test p = {test.probability:.1e}){worst}"
    ]


def _wrong_law(problem, k, theta, figures):
    """Whether signs change far less often than by chance; alternation is no sign of a wrong law."""
    left = problem.raw(k, theta)[problem.sets[k].distinct]
    signs = left[left != 0.0] > 0.0
    above = int(signs.sum())
    return figures["runs_p"] < ORDERED_SIGNS and np.count_nonzero(signs[1:] != signs[:-1]) < 2.0 * above * (signs.size - above) / signs.size


def _where(labels, k):
    return f"{labels[k]}: " if len(labels) > 1 else ""


def remarks(estimate, found, parts, each, given):
    """What to know in any case; `given` if the last start of all is the user's."""
    said = []
    for k, (part, one) in enumerate(zip(parts, each, strict=True)):
        where = _where([q.label for q in parts], k)
        copies = part.data.distinct.size / np.count_nonzero(part.data.distinct)
        tau = one["correlation_time"] / copies
        if part.data.dropped:
            said.append(f"{where}{part.data.dropped} points dropped")
        if copies > 1.0:
            said.append(f"{where}points occur {copies:.3g} times on average, copies do not shrink the errors")
        if one["runs_p"] < RANDOM_SIGNS:
            said.append(f"{where}structure left in residuals (runs test p = {one['runs_p']:.1e})")
        if tau > 1.5:
            said.append(f"{where}residuals correlated over {tau:.1f} points, errors enlarged by {np.sqrt(tau):.1f}")
    if given and any(one.all_chi_squares[-1] > 1.01 * min(one.all_chi_squares) for one in found):
        said.append("the given start leads to a worse minimum, another start was used")
    return [*said, *_balance(estimate, [part.label for part in parts])]


def _balance(estimate, labels):
    """Which data sets dominate what is shared, and whether they should have been given errors."""
    users = np.array([np.count_nonzero(np.any(estimate.problem.index == i, axis=1)) for i in range(len(estimate.names))])
    for k, label in enumerate(labels):
        names = [estimate.names[i] for i in np.flatnonzero((estimate.spread.say[k] > _DOMINATES) & (users > 1))]
        if names:
            yield f"{label} dominates {', '.join(names)} (over {_DOMINATES:.0%} of the information)"
    problem, about = estimate.problem, estimate.spread
    long = [points.x.size >= _LONG * problem.index.shape[1] for points in problem.sets]
    noises, together = about.noises[long], any(len(group) > 1 for group in about.components)
    if not together or noises.size < 2 or any(points.floor for points in problem.sets):
        return
    if noises.max() > _UNEQUAL * noises.min() > _UNEQUAL * CONVERGED * about.signals.max():
        yield f"the noise of the data sets differs by a factor of {noises.max() / noises.min():.3g}: give errors, or weights"
