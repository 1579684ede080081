"""The lowest minimum of a least-squares problem, looked for from many starts."""

from typing import NamedTuple

import numpy as np

from anisogran.fitting.problem import EVALUATIONS, follow, minimum
from anisogran.fitting.spread import components

_ROUGH = 1e-6  # tolerance of the minimiser for all starts, far below the hundredth by which minima are told apart
_FEW = 15  # evaluations for each variable and one more: for curves that are dear
_MANY = 4000  # data sets with more points are thinned while the starts are tried; the best one is polished on all


class Found(NamedTuple):
    """The minimum of one component (data sets that share no variable with others); `variables` number those of the whole problem."""

    variables: np.ndarray
    theta: np.ndarray
    chi_square: float  # on all points; those of the starts are on the thinned ones
    all_chi_squares: tuple
    starts: list
    best: int
    apart: np.ndarray  # parameters of each data set fitted on its own, (K p,)


def search(problem, starts, together_first=False):
    """(theta, list of `Found`): `starts[k]` are guesses for data set k, shape (m, p), the same m for all.

    Data sets that share nothing are fitted one by one. Those that share something are first fitted alone too; the joint fit
    starts from there and from the m guesses together, with the median of a shared parameter. With `together_first` it starts from the
    guesses only, and each data set alone from the joint minimum: for data sets that cannot determine all parameters, at K times the speed.
    """
    theta, found = np.empty(problem.lower.size), []
    for group in components(problem.index):
        part, used = problem.part(group)
        guesses = [starts[k] for k in group]
        one, alone = (_joint_first if together_first else _alone_first)(part, guesses)
        theta[used] = one.theta
        found.append(one._replace(variables=used, apart=np.concatenate([each.theta for each in alone])))
    return theta, found


def _alone_first(part, guesses):
    """(joint `Found`, those of each data set alone), from guesses for each data set."""
    alone = _alone(part, guesses)
    if len(alone) == 1:
        return alone[0], alone
    return lowest(part, [_together(part.index, [each.theta for each in alone]), *_of_all(part, guesses)]), alone


def _joint_first(part, guesses):
    """As `_alone_first`, the other way round."""
    one = lowest(part, _of_all(part, guesses), _FEW)
    return one, [one] if len(guesses) == 1 else _alone(part, [[one.theta[variables]] for variables in part.index], _FEW)


def _alone(part, guesses, *evaluations):
    return [lowest(part.apart().part([k])[0], some, *evaluations) for k, some in enumerate(guesses)]


def _of_all(part, guesses):
    return [_together(part.index, some) for some in zip(*guesses, strict=True)]


def lowest(problem, starts, evaluations=EVALUATIONS):
    """The `Found` of a problem whose data sets all belong together, from guesses of shape (P,); `evaluations` as of `minimum`."""
    thin = problem.thinned(_MANY)
    tried = [minimum(thin, guess, tolerance=_ROUGH, evaluations=evaluations) for guess in starts]
    chi_squares = tuple(chi_square for _, chi_square in tried)
    best = int(np.argmin(chi_squares))
    theta, chi_square = follow(problem, tried[best][0])
    return Found(np.arange(theta.size), theta, chi_square, chi_squares, starts, best, theta)


def _together(index, parameters):
    """Variables from the parameters of each data set, (K, p): the median where several share one."""
    parameters = np.asarray(parameters)
    return np.array([np.median(parameters[index == variable]) for variable in range(index.max() + 1)])
