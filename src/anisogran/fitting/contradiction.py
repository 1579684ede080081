"""A parameter shared by mistake: whether data sets that share parameters contradict each other."""

from typing import NamedTuple

import numpy as np
from scipy.stats import f as fisher

from anisogran.fitting.problem import follow
from anisogran.fitting.spread import CONVERGED, spread

CONTRADICTED = 1e-3  # an F-test below this says that the data sets do not share what they are said to share


class Contradiction(NamedTuple):
    """`probability` that chance makes the joint fit so much worse than separate fits, nan if too few points are left to tell."""

    probability: float
    ratio: float  # chi^2 of the joint fit over that of separate fits, each data set in units of its own noise
    worst: int | None  # the shared variable whose separate values differ most


def contradiction(problem, theta, apart, rank):
    """The `Contradiction` of a fit of data sets that belong together, an F-test of shared against own parameters.

    theta is the joint minimum, which sees `rank` directions, `apart` the parameters of separate fits, shape (K p,). The variance of
    each data set is that of its separate fit, correlation time included, and the joint fit is repeated with these, so that a noisy
    data set does not pull the others away.
    """
    alone = problem.apart()
    about = spread(alone, apart)
    saved = float(np.sum(about.taken)) - rank
    freedom = about.free + apart.size - float(np.sum(about.taken))
    if not (freedom >= 1.0 and saved > 0.5):
        return Contradiction(float("nan"), float("nan"), None)
    rounding = CONVERGED * about.signals * np.array([points.weight.max() for points in problem.sets])
    scale = 1.0 / np.sqrt(np.maximum(about.variances, rounding**2))
    separate = float(np.sum(alone.weighted(scale).chi_squares(apart)))
    _, joint = follow(problem.weighted(scale), theta)
    ratio = max(joint - separate, 0.0) / saved
    return Contradiction(float(fisher.sf(ratio, saved, freedom)), joint / separate, _worst(problem, apart, about))


def _worst(problem, apart, about):
    """The shared variable whose separate values scatter most, in units of their errors, or None."""
    values, squares = (quantity.reshape(problem.index.shape) for quantity in (apart, np.diag(about.covariance)))
    scatter = np.zeros(problem.lower.size)
    for variable in range(scatter.size):
        chosen = (problem.index == variable) & (squares > 0.0)
        weight = 1.0 / squares[chosen]
        if weight.size > 1:
            scatter[variable] = np.sum(weight * (values[chosen] - np.sum(weight * values[chosen]) / np.sum(weight)) ** 2) / (
                weight.size - 1
            )
    return int(np.argmax(scatter)) if np.any(scatter > 0.0) else None
