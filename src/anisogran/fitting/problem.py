"""The least-squares problem of one curve and one or more data sets, in scaled variables; the only file that calls lmfit."""

import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import lmfit
import numpy as np
from scipy.optimize import leastsq

_COMPLEX_STEP = 1e-30
_TOLERANCE = 1e-12  # of the minimiser, relative; its noise of rounding lies some decades lower
EVALUATIONS = 100  # for each variable and one more, before a valley without a floor is left
_WARM = 15  # the same for a start that is close
_ENDED = 1, 2, 3, 4  # what MINPACK says when it has found a minimum
_FEW = 500  # points up to which one data set is left as it is
_AT_BOUND = 1e-6  # this close to a bound, in units of the range of the variable, is at the bound
_INSIDE = 1e-9  # distance of a start from the bounds of its range, in units of the range
_NOWHERE = 1e100  # residual where the curve has no finite value: worse than any other place, so that the minimiser steps back


class Points(NamedTuple):
    """One data set in scaled variables, rows of shape (n,).

    `known` are further arguments of the curve, the same for all points; `distinct` is False for points that repeat an earlier one;
    `floor` is the smallest variance of a weighted residual, that of errors which were given, or 0; `importance` the weight of the set.
    """

    x: np.ndarray
    y: np.ndarray
    weight: np.ndarray
    distinct: np.ndarray
    known: dict
    floor: float
    importance: float

    def thinned(self, most):
        """Every so manieth point, such that at most so many are left."""
        step = -(-self.x.size // most)
        return self._replace(x=self.x[::step], y=self.y[::step], weight=self.weight[::step], distinct=self.distinct[::step])


@dataclass(frozen=True)
class Problem:
    """Parameter j of data set k is the variable `index[k, j]`; variables theta have shape (P,) and lie between lower and upper.

    `levels` (p,) marks parameters whose errors are judged against the signal; `series` says that neighbours may be correlated.
    With `bend` residuals r above this size count less (soft L1): r/sqrt((1 + sqrt(1 + (r/bend)^2))/2) stands in their place.
    """

    curve: Callable
    names: tuple
    levels: tuple
    series: bool
    sets: tuple
    index: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    bend: float | None = None

    def raw(self, k, theta):
        """(curve - y) weight of data set k, shape (n_k,)."""
        points = self.sets[k]
        arguments = dict(zip(self.names, theta[self.index[k]], strict=True))
        return (self.curve(points.x, **arguments, **points.known) - points.y) * points.weight

    def residual(self, k, theta):
        """What is squared and summed: `raw`, bent if asked for."""
        left = self.raw(k, theta)
        return left if self.bend is None else left / np.sqrt(0.5 + 0.5 * np.sqrt(1.0 + (left / self.bend) ** 2))

    def linearised(self, k, theta):
        """(residual, its derivatives by the parameters of data set k, shape (n_k, p)), exact (complex step)."""
        steps = 1j * _COMPLEX_STEP * np.eye(theta.size)[self.index[k]]
        columns = np.array([self.residual(k, theta + step) for step in steps])
        return columns[0].real, columns.imag.T / _COMPLEX_STEP

    def compressed(self, theta):
        """(f, J), shapes (m,) and (m, P), m = K (p + 1): the same sum of squares, gradient and normal matrix as all points.

        A rotation of the points of each data set (QR) leaves p of them that change with the parameters and one that does not, so
        that what the minimiser sees does not grow with the number of points.
        """
        if len(self.sets) == 1 and theta.size <= self.sets[0].x.size <= _FEW:  # nothing to gain
            residual, derivatives = self.linearised(0, theta)
            if not (np.all(np.isfinite(residual)) and np.all(np.isfinite(derivatives))):
                return np.full(residual.shape, _NOWHERE), np.zeros(derivatives.shape)
            return residual, derivatives[:, np.argsort(self.index[0])]
        p = self.index.shape[1]
        f, jacobian = np.zeros((len(self.sets), p + 1)), np.zeros((len(self.sets), p + 1, theta.size))
        for k, variables in enumerate(self.index):
            residual, derivatives = self.linearised(k, theta)
            if not (np.all(np.isfinite(residual)) and np.all(np.isfinite(derivatives))):
                f[k] = _NOWHERE
                continue
            q, r = np.linalg.qr(derivatives)
            along = q.T @ residual
            f[k, : along.size], f[k, p] = along, np.linalg.norm(residual - q @ along)
            jacobian[k, : along.size, variables] = r.T
        return f.ravel(), jacobian.reshape(f.size, theta.size)

    def chi_squares(self, theta):
        """The sum of squares of each data set, shape (K,)."""
        return np.array([np.sum(self.residual(k, theta) ** 2) for k in range(len(self.sets))])

    def at_bound(self, theta):
        """Which variables lie at a bound of their range, shape (P,)."""
        margin = _AT_BOUND * (self.upper - self.lower)
        # of a rate, with a range over decades, the low end is near in ratio, not in difference
        low = np.where(self.lower > 0.0, theta < self.lower * (1.0 + 1e-3), theta <= self.lower + margin)
        return low | (theta >= self.upper - margin)

    def part(self, chosen):
        """(the problem of these data sets alone, the numbers of its variables in this one)."""
        used, index = np.unique(self.index[chosen], return_inverse=True)
        index = index.reshape(len(chosen), -1)
        sets = tuple(self.sets[k] for k in chosen)
        return replace(self, sets=sets, index=index, lower=self.lower[used], upper=self.upper[used]), used

    def apart(self):
        """The problem in which no parameter is shared; variables in the order of the parameters, data set by data set."""
        index = np.arange(self.index.size).reshape(self.index.shape)
        return replace(self, index=index, lower=self.lower[self.index].ravel(), upper=self.upper[self.index].ravel())

    def weighted(self, factors):
        """The problem with the residuals of each data set times its factor."""
        sets = [points._replace(weight=points.weight * factor) for points, factor in zip(self.sets, factors, strict=True)]
        return replace(self, sets=tuple(sets))

    def thinned(self, most):
        """This problem with at most so many points in each data set."""
        return replace(self, sets=tuple(points.thinned(most) for points in self.sets))


class _Minimiser(lmfit.Minimizer):
    """lmfit's minimiser without its own error bars, which are not used here and with 100 variables cost more than the fit."""

    def _calculate_uncertainties_correlations(self):
        pass


def minimum(problem, guess, held=(), tolerance=_TOLERANCE, evaluations=EVALUATIONS):
    """(theta, chi^2) of Levenberg-Marquardt from one start, inside the bounds; the variables numbered in `held` keep their values.

    chi^2 is inf where no place with a finite curve was found.
    """
    fixed = np.array(guess, dtype=float)
    inside = _INSIDE * (problem.upper - problem.lower)  # at a bound itself lmfit's substitution has no slope
    theta = np.clip(fixed, problem.lower + inside, problem.upper - inside)
    theta[list(held)] = fixed[list(held)]
    free = np.setdiff1d(np.arange(theta.size), held)
    at = _remembered(problem, theta, free)
    table = lmfit.Parameters()
    for i in free:
        table.add(f"v{i}", value=theta[i], min=problem.lower[i], max=problem.upper[i])

    def numbers(table):
        return np.array([parameter.value for parameter in table.values()])

    with warnings.catch_warnings(), np.errstate(all="ignore"):
        # lmfit warns when it cannot have a covariance; errstate restores the floating-point settings, which it loses if a curve raises
        warnings.simplefilter("ignore")
        if free.size:
            minimiser = _Minimiser(lambda table: at(numbers(table))[0], table, max_nfev=evaluations * (free.size + 1))
            slope = {"Dfun": lambda table: at(numbers(table))[1].copy()}  # lmfit scales it in place
            theta[free] = numbers(minimiser.leastsq(ftol=tolerance, xtol=tolerance, **slope).params)
        chi_square = float(np.sum(problem.chi_squares(theta)))
    return theta, chi_square if np.isfinite(chi_square) else float("inf")


def follow(problem, guess, held=(), tolerance=_TOLERANCE):
    """`minimum` from a start that is close: the same method at a quarter of the cost, without bounds unless it comes to them."""
    theta = np.array(guess, dtype=float)
    free = np.setdiff1d(np.arange(theta.size), held)
    at = _remembered(problem, theta, free)
    with np.errstate(all="ignore"):
        if free.size:
            settings = {"Dfun": lambda some: at(some)[1], "ftol": tolerance, "xtol": tolerance, "maxfev": _WARM * (free.size + 1)}
            found, _, _, _, outcome = leastsq(lambda some: at(some)[0], theta[free], full_output=True, **settings)
            theta[free] = found
            inside = np.all((theta > problem.lower) & (theta < problem.upper) | np.isin(np.arange(theta.size), held))
            if not inside or outcome not in _ENDED or np.any(problem.at_bound(theta)[free]):
                return minimum(problem, guess, held, tolerance, _WARM)
        chi_square = float(np.sum(problem.chi_squares(theta)))
    return theta, chi_square if np.isfinite(chi_square) else float("inf")


def _remembered(problem, theta, free):
    """The function of the free variables that gives (f, J) of `compressed`, evaluated once for each place."""
    last, place = [None, None], theta.copy()

    def at(some):
        if last[0] is None or not np.array_equal(some, last[0]):
            place[free] = some
            f, jacobian = problem.compressed(place)
            last[:] = np.array(some), (f, jacobian[:, free])
        return last[1]

    return at
