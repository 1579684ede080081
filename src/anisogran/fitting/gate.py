"""The gate: whether a fit can be trusted. A minimiser that reports success proves little; these limits separate good from bad."""

from dataclasses import dataclass
from math import isfinite
from typing import NamedTuple

from scipy.stats import norm
from scipy.stats import t as student

READABLE = 6  # sentences of a kind that a verdict prints; it may hold more
POINTS_PER_PARAMETER = 5
STARTS = 8  # fewest starts from which a minimum counts as the lowest
WORSE = 1.01  # a chi^2 above this multiple of the lowest is another minimum
RELATIVE_ERROR = 0.5
CORRELATION = 0.98
CONDITION = 1e3
SIGNAL_TO_NOISE = 3.0
# A runs test below the first limit finds structure in the residuals, which is remarked. In a series that may be noise with memory,
# and the errors are enlarged for it. Points declared independent have no memory: there structure means a wrong law, whose errors
# mean nothing, and below the second limit (seen in one good fit of a thousand) this is a reason.
RANDOM_SIGNS, ORDERED_SIGNS = 0.01, 1e-3


@dataclass(frozen=True)
class Verdict:
    """True only if the fit is trustworthy. `reasons` say why not; `remarks` what to know in any case. Prints as one line."""

    reasons: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()

    def __bool__(self):
        return not self.reasons

    def __str__(self):
        words = ["trustworthy"] if self else [f"not trustworthy: {self.reasons[0]}", *_first(self.reasons[1:])]
        return "; ".join([*words, *_first(self.remarks)])


def _first(sentences):
    """As many as can be read in one line."""
    more = len(sentences) - READABLE
    return sentences if more <= 0 else [*sentences[:READABLE], f"and {more} more"]


class Source(NamedTuple):
    """One data set as the gate sees it."""

    label: str
    points: int
    signal: float  # range of the fitted curve over the points
    noise: float  # rms residual
    names: tuple  # of the parameters that it helps to determine


class Evidence(NamedTuple):
    """What the gate judges; dicts have the parameter names as keys."""

    sources: tuple
    free: float  # degrees of freedom, in independent points
    values: dict
    errors: dict  # one standard error, correlations of the residuals included; nan if there is none
    sizes: dict  # what an error is compared with: the value itself, or the signal for a level that may be zero
    correlations: dict  # (name, name): correlation
    at_bound: tuple  # names
    condition: float  # of the Jacobian, each parameter in units of its size
    chi_square: float
    all_chi_squares: tuple  # one for each start


def judge(evidence):
    """(reasons, undetermined): sentences, empty if all is well, and the names that must not be given an error bar."""
    reasons, undetermined = [], set()
    names = list(evidence.values)

    def object_to(reason, *culprits):
        reasons.append(reason)
        undetermined.update(culprits or names)

    points, needed = sum(source.points for source in evidence.sources), POINTS_PER_PARAMETER * len(names)
    if points < needed:
        object_to(f"only {points} points, at least {needed} are needed for {len(names)} parameters")
    elif evidence.free <= 0.0:
        object_to("the residuals are so correlated that fewer independent points than parameters are left")
    for source, others in _with_others(evidence.sources):
        own = [name for name in source.names if not any(name in other.names for other in others)]
        if others and source.points < POINTS_PER_PARAMETER * len(own):
            object_to(f"only {source.points} points in {source.label} for its {len(own)} own parameters", *own)
    weak = [source for source in evidence.sources if not source.signal > SIGNAL_TO_NOISE * source.noise]
    for source in weak:
        where = f"in {source.label} " if len(evidence.sources) > 1 else ""
        elsewhere = {name for other in evidence.sources if other not in weak for name in other.names}
        if not elsewhere.issuperset(source.names):  # else the others determine all that this one uses
            culprits = [name for name in source.names if name not in elsewhere]
            object_to(
                f"{where}the signal {source.signal:.3g} is not above {SIGNAL_TO_NOISE:g} times the noise {source.noise:.3g}", *culprits
            )
    if len(evidence.all_chi_squares) < STARTS:
        object_to(f"only {len(evidence.all_chi_squares)} starts, at least {STARTS} are needed")
    elif evidence.chi_square > WORSE * min(evidence.all_chi_squares):
        ratio = evidence.chi_square / min(evidence.all_chi_squares)
        object_to(f"a local minimum: chi^2 is {ratio:.3g} times the lowest of {len(evidence.all_chi_squares)} starts")
    if not evidence.condition < CONDITION:
        object_to(f"the data do not tell the parameters apart (scaled condition {evidence.condition:.1e})")
    for pair, correlation in evidence.correlations.items():
        if not abs(correlation) < CORRELATION and isfinite(correlation):
            object_to(f"{pair[0]} and {pair[1]} are not separated (correlation {correlation:.4f})", *pair)
    for name in evidence.at_bound:
        object_to(f"{name} = {evidence.values[name]:.4g} lies at the bound of its range", name)
    # an error that is itself known from few points only stands for a wider interval
    few = float(student.ppf(0.975, evidence.free) / norm.ppf(0.975)) if evidence.free > 0.0 else 1.0
    words = f" with {evidence.free:.2g} degrees of freedom" if few > 1.2 else ""
    for name in names:
        error, size = evidence.errors[name], abs(evidence.sizes[name])
        if not isfinite(error):
            object_to(f"{name} has no error bar", name)
        elif not error * few < RELATIVE_ERROR * size:
            object_to(f"{name} = {evidence.values[name]:.4g} is uncertain by {error:.3g}{words}", name)
    return tuple(reasons), undetermined


def _with_others(sources):
    return [(source, [other for other in sources if other is not source]) for source in sources]
