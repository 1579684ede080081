"""How uncertain the variables of a fit are: the covariance, with residuals that are correlated and differ between data sets."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from anisogran.fitting.residuals import correlation_time

_ENOUGH = 10.0  # a data set with fewer degrees of freedom takes its variance from all of them
CONVERGED = 1e-7  # residuals below this part of the signal: data without noise


@dataclass(frozen=True)
class Spread:
    """In scaled variables; arrays over variables (P,) or data sets (K,).

    covariance  (P, P), nan where the data leave a direction open
    plain       (P,) its diagonal for residuals of variance 1: error^2/plain is the variance that belongs to a variable
    taken       (K,) the number of parameters that a data set determines, together the directions that the data see
    free        degrees of freedom in independent points, n/tau - P
    free_of     (P,) those of the variance of each variable
    taus        (K,) correlation times, copies of points included;  variances  (K,) variance of a sum of residuals over its number
    own         (K,) whether this is from the data set itself, or else from all
    signals, noises  (K,) range of the fitted curve, rms residual;  sizes  (P,) what an error is compared with
    say         (K, P) the share of a data set in what is known of a variable
    components  lists of data sets that share no variable with the others;  conditions  one for each, of the Jacobian
    """

    covariance: np.ndarray
    plain: np.ndarray
    taken: np.ndarray
    free: float
    free_of: np.ndarray
    taus: np.ndarray
    variances: np.ndarray
    own: np.ndarray
    signals: np.ndarray
    noises: np.ndarray
    sizes: np.ndarray
    say: np.ndarray
    components: tuple
    conditions: tuple


def components(index):
    """Lists of data sets, such that no variable is used in two of them."""
    sets, variables = np.repeat(np.arange(len(index)), index.shape[1]), index.ravel() + len(index)
    total = len(index) + int(index.max()) + 1
    _, group = connected_components(coo_array((np.ones(sets.size), (sets, variables)), shape=(total, total)), directed=False)
    return tuple(np.flatnonzero(group[: len(index)] == number).tolist() for number in np.unique(group[: len(index)]))


def spread(problem, theta):
    """The `Spread` of a `Problem` at its minimum theta."""
    count, P = len(problem.sets), theta.size
    signals, noises, taus = np.zeros(count), np.zeros(count), np.ones(count)
    reduced = np.zeros((count, problem.index.shape[1], P))
    sums = np.zeros(count)
    for k, points in enumerate(problem.sets):
        residual, jacobian = problem.linearised(k, theta)
        signals[k] = np.ptp(problem.raw(k, theta) / points.weight + points.y)
        noises[k] = np.sqrt(np.mean((residual / points.weight) ** 2))
        sums[k] = residual @ residual
        taus[k] = _memory(residual, jacobian, points.distinct, problem.series and noises[k] > CONVERGED * signals[k])
        rotated = np.linalg.qr(jacobian, mode="r") if np.all(np.isfinite(jacobian)) else np.full((1, jacobian.shape[1]), np.nan)
        reduced[k, : len(rotated), problem.index[k]] = rotated.T
    sizes = _sizes(problem, theta, signals)
    groups = components(problem.index)
    pieces = [_directions(reduced[group], np.unique(problem.index[group]), sizes) for group in groups]
    taken = np.full(count, np.nan)  # parameters that a data set pays for: the trace of its block of the projection on the curve
    for group, piece in zip(groups, pieces, strict=True):
        taken[group] = piece.taken
    numbers = np.array([points.x.size for points in problem.sets])
    floors, weights = (np.array([getattr(points, key) for points in problem.sets]) for key in ("floor", "importance"))
    variances, frees, own = _variances(sums, numbers, taken, taus, floors, weights)
    covariance, plain, free_of = np.full((P, P), np.nan), np.full(P, np.nan), np.full(P, np.nan)
    for group, piece in zip(groups, pieces, strict=True):
        v = np.unique(problem.index[group])
        covariance[np.ix_(v, v)] = np.einsum("iam,a,jam->ij", piece.response, variances[group], piece.response)
        plain[v] = np.einsum("iam,iam->i", piece.response, piece.response)
        free_of[v] = _satterthwaite(np.einsum("iam,a,iam->ia", piece.response, variances[group], piece.response), own[group], frees[group])
    information = np.sum(reduced**2, axis=1)
    total = np.sum(information, axis=0)
    say = np.divide(information, total, out=np.zeros_like(information), where=total > 0.0)
    free = float(np.sum(numbers / taus)) - P
    conditions = tuple(piece.condition for piece in pieces)
    return Spread(covariance, plain, taken, free, free_of, taus, variances, own, signals, noises, sizes, say, groups, conditions)


class _Directions(NamedTuple):
    response: np.ndarray  # (V, K, p): d variable/d (reduced residual)
    taken: np.ndarray  # (K,)
    condition: float  # of the Jacobian, each variable in units of its size


def _directions(reduced, variables, sizes):
    """What a singular-value decomposition says of one component of the problem; nan where the data leave a direction open."""
    rows, size = reduced[:, :, variables] * sizes[variables], sizes[variables]
    shape = size.size, *rows.shape[:2]
    if not np.all(np.isfinite(rows)):
        return _Directions(np.full(shape, np.nan), np.full(len(rows), np.nan), float("inf"))
    left, singular, axes = np.linalg.svd(rows.reshape(-1, size.size), full_matrices=False)
    if np.any(size == 0.0) or singular[-1] <= 1e-14 * singular[0]:  # rounding of the decomposition
        rank = np.linalg.matrix_rank(reduced[:, :, variables].reshape(-1, size.size))
        return _Directions(np.full(shape, np.nan), np.full(len(rows), rank / len(rows)), float("inf"))
    response = ((size[:, None] * axes.T / singular) @ left.T).reshape(shape)
    taken = np.sum(left.reshape(*rows.shape[:2], -1) ** 2, axis=(1, 2))
    return _Directions(response, taken, float(singular[0] / singular[-1]))


def _variances(sums, numbers, taken, taus, floors, weights):
    """(variances, degrees of freedom behind them, whether they are of one data set alone), each (K,); nan without any freedom.

    tau times the variance of a point, which is chi^2/n corrected for the independent points that the fit has used up. Data sets too
    short to tell their own noise take that of all together.
    """
    frees = numbers / taus - taken
    own = (frees >= _ENOUGH) | (len(sums) == 1)
    freedom = np.sum(frees)
    common = np.sum(sums / weights) / np.sum(numbers - taus * taken) if freedom > 0.0 else np.nan
    alone = np.divide(sums, frees, out=np.full(len(sums), np.nan), where=frees > 0.0)
    variances = np.where(own, alone, weights * taus * common)
    return np.maximum(variances, floors * taus), np.where(own, frees, freedom), own


def _satterthwaite(shares, own, frees):
    """Degrees of freedom of a sum of variances, shape (V,): its shares (V, K) are of data sets with `frees` each, or of all at once."""
    square = np.sum(shares[:, own] ** 2 / frees[own], axis=1)
    if not np.all(own):
        square = square + np.sum(shares[:, ~own], axis=1) ** 2 / frees[~own][0]
    return np.divide(np.sum(shares, axis=1) ** 2, square, out=np.full(len(shares), np.nan), where=square > 0.0)


def _sizes(problem, theta, signals):
    """The value itself, or for a level that may be zero the largest signal of the data sets that use it; shape (P,)."""
    sizes = theta.copy()
    for j in np.flatnonzero(problem.levels):
        sizes[problem.index[:, j]] = 0.0
        np.maximum.at(sizes, problem.index[:, j], signals)
    return sizes


def _memory(residual, jacobian, distinct, series):
    copies = distinct.size / np.count_nonzero(distinct)
    regular = np.all(np.isfinite(jacobian)) and np.all(np.any(jacobian != 0.0, axis=0))
    return copies * (correlation_time(residual[distinct], jacobian[distinct]) if series and regular else 1.0)
