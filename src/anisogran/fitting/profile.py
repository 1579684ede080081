"""Profile likelihood: how far a parameter can be moved while the others follow, before the data object."""

from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq
from scipy.stats import t as student

from anisogran.fitting.problem import follow
from anisogran.fitting.spread import CONVERGED

_DOUBLINGS = 40  # of the step away from the minimum, before the search for a limit is given up
_PRECISION = 1e-4  # of a limit, in steps
_LOWER = -1e-3  # an excess of chi^2 below this part of the threshold is another, lower minimum


class Profile(NamedTuple):
    """Limits that hold the true value with the probability `level`, not symmetric in general; `outcome` is "" if both were found.

    A limit that was not found is -inf, inf or nan, and the outcome says why, in one sentence.
    """

    low: float
    high: float
    level: float
    outcome: str = ""


def limits(estimate, name, level):
    """The `Profile` of one parameter: chi^2 rises by t^2 times the variance that belongs to the parameter.

    t is Student's for this level; the variance has the correlation time in it, as in the covariance, so that both agree where the curve
    is linear in its parameters over the interval.
    """
    i = estimate.names.index(name)
    group = next(one for one in estimate.spread.components if np.any(estimate.problem.index[one] == i))
    problem, used = estimate.problem.part(group)
    mine, theta = int(np.flatnonzero(used == i)[0]), estimate.theta[used]
    variance, free, sigma = _variance(estimate, i, group)
    if not free > 0.0 or not variance > 0.0:
        return Profile(float("nan"), float("nan"), level, "no degrees of freedom are left to tell the noise")
    if np.all(estimate.spread.noises[group] <= CONVERGED * estimate.spread.signals[group]):
        return Profile(float("nan"), float("nan"), level, "the data have no noise")
    threshold = variance * float(student.ppf(0.5 + 0.5 * level, free)) ** 2
    if np.any(problem.at_bound(theta)):
        return Profile(float("nan"), float("nan"), level, "the minimum itself lies at the bound of a range")
    walk = _Walk(problem, theta, mine, threshold)
    step = sigma * np.sqrt(threshold / variance)
    ends = [walk.limit(side, step) for side in (-1.0, 1.0)][:: 1 if estimate.units[i] > 0.0 else -1]
    outcomes = [f"no {side} limit: {why}" for side, (_, why) in zip(("lower", "upper"), ends, strict=True) if why]
    low, high = (float(value * estimate.units[i]) for value, _ in ends)
    return Profile(low, high, level, "; ".join(outcomes))


def _variance(estimate, i, group):
    """(variance of a residual, degrees of freedom, first step) for variable i; those of its data sets where it has no error."""
    about = estimate.spread
    error = np.sqrt(about.covariance[i, i])
    if np.isfinite(error):
        return error**2 / about.plain[i], about.free_of[i], error
    return float(np.mean(about.variances[group])), about.free, 0.1 * abs(estimate.theta[i]) or 0.1


class _Walk:
    """The way from the minimum along one variable, the others following."""

    def __init__(self, problem, theta, mine, threshold):
        self.problem, self.theta, self.mine, self.threshold = problem, theta, mine, threshold
        self.lowest = float(np.sum(problem.chi_squares(theta)))

    def limit(self, side, step):
        """(value, why not) where chi^2 has risen by the threshold."""
        start = float(self.theta[self.mine])
        bound = float(self.problem.upper[self.mine] if side > 0.0 else self.problem.lower[self.mine])
        near, found = start, {start: (self.theta, -1.0)}
        followers = [self.theta]

        def height(value):
            if value not in found:
                found[value] = min((self._follow(value, guess) for guess in followers), key=lambda one: one[1])
                if found[value][1] <= 0.0:
                    followers[1:] = [found[value][0]]
            return found[value][1]

        for doubling in range(_DOUBLINGS):
            value = start + side * step * 2.0**doubling
            value = min(value, bound) if side > 0.0 else max(value, bound)
            if height(value) < _LOWER - 1.0:
                return float("nan"), f"there is a lower minimum (found at {value:.4g} in scaled units)"
            if height(value) >= 0.0:
                # brentq sees the heights already found, so that the two signs differ whatever the inner minimisation does
                end = float(brentq(height, near, value, xtol=_PRECISION * step, rtol=1e-12))
                height(end)
                if np.any(np.delete(self.problem.at_bound(found[end][0]), self.mine)):
                    return side * float("inf"), "chi^2 rises only because another parameter is at the bound of its range"
                return end, ""
            if value == bound:
                break
            near = value
        return side * float("inf"), "chi^2 stays low up to the bound of the range"

    def _follow(self, value, guess):
        """(theta, height) with this variable at `value` and the others at their best, from a guess; 0 is the limit, -1 the minimum."""
        guess = guess.copy()
        guess[self.mine] = value
        theta, chi_square = follow(self.problem, guess, held=[self.mine])
        return theta, min((chi_square - self.lowest) / self.threshold, 1e6) - 1.0
