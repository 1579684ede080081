"""The gate: whether a fit can be trusted. A minimiser that reports success proves little; these limits separate good from bad."""

from dataclasses import dataclass
from math import isfinite
from typing import NamedTuple

POINTS_PER_PARAMETER = 5
STARTS = 8  # fewest starts from which a minimum counts as the lowest
WORSE = 1.01  # a chi^2 above this multiple of the lowest is another minimum
RELATIVE_ERROR = 0.5
CORRELATION = 0.98
CONDITION = 1e3
SIGNAL_TO_NOISE = 3.0
RANDOM_SIGNS = 0.01  # a runs test below this finds structure in the residuals


@dataclass(frozen=True)
class Verdict:
    """True only if the fit is trustworthy. `reasons` say why not; `remarks` what to know in any case. Prints as one line."""

    reasons: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()

    def __bool__(self):
        return not self.reasons

    def __str__(self):
        word = "trustworthy" if self else "not trustworthy"
        return "; ".join([f"{word}: {self.reasons[0]}" if self.reasons else word, *self.reasons[1:], *self.remarks])


class Evidence(NamedTuple):
    """What the gate judges; dicts have the parameter names as keys."""

    points: int
    free: float  # degrees of freedom, in independent points
    values: dict
    errors: dict  # one standard error, correlations of the residuals included; nan if there is none
    sizes: dict  # what an error is compared with: the value itself, or the signal for a level that may be zero
    correlations: dict  # (name, name): correlation
    at_bound: tuple  # names
    condition: float  # of the Jacobian, each parameter in units of its size
    signal: float  # range of the fitted curve over the points
    noise: float  # rms residual
    chi_square: float
    all_chi_squares: tuple  # one for each start


def judge(evidence):
    """(reasons, undetermined): sentences, empty if all is well, and the names that must not be given an error bar."""
    reasons, undetermined = [], set()
    names = list(evidence.values)

    def object_to(reason, *culprits):
        reasons.append(reason)
        undetermined.update(culprits or names)

    needed = POINTS_PER_PARAMETER * len(names)
    if evidence.points < needed:
        object_to(f"only {evidence.points} points, at least {needed} are needed for {len(names)} parameters")
    elif evidence.free <= 0.0:
        object_to("the residuals are so correlated that fewer independent points than parameters are left")
    if not evidence.signal > SIGNAL_TO_NOISE * evidence.noise:
        object_to(f"the signal {evidence.signal:.3g} is not above {SIGNAL_TO_NOISE:g} times the noise {evidence.noise:.3g}")
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
    for name in names:
        error, size = evidence.errors[name], abs(evidence.sizes[name])
        if not isfinite(error):
            object_to(f"{name} has no error bar", name)
        elif not error < RELATIVE_ERROR * size:
            object_to(f"{name} = {evidence.values[name]:.4g} is uncertain by {error:.3g}", name)
    return tuple(reasons), undetermined
