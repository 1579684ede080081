"""Newton's method for B^T q(B x) = load: damped, kept inside the domain of the law, never quietly wrong.

The size of a step is measured by what it changes: velocities in wall speeds, pressure in outer pressures, fluidity in its own
maximum. A damped step is taken if it shrinks the next correction computed with the same matrix (the natural monotonicity test of
P. Deuflhard, Newton Methods for Nonlinear Problems, 2004; cited from memory), which no scaling of the equations can mislead.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.linalg import splu

from anisogran.continuum.balance import Point, complex_step
from anisogran.outcome import NotConverged

TOLERANCE = 1e-8  # of the last correction; it is still applied, and Newton squares it
IMBALANCE = 1e-10  # of a converged answer, in units of the largest reaction
SCALINGS = 3  # of rows and columns before a factorisation
SHORTEST = 2.0**-14  # damping below which the search is given up
BOUNDARY = 0.1  # share of its value that a positive quantity keeps in one step, at least
ROUNDS, NEAR = 30, 0.01  # of Picard, at most; the change at which Newton takes over (0.05 failed in 6 of 240 cases, 0.02 in none)


class Factors:
    """Sparse LU of a matrix whose rows and columns are first scaled to maxima near 1 (after Ruiz; cited from memory).

    Without it an inner radius of 1e-6 of the outer one, where element lengths and forces span many decades, is not solved.
    """

    def __init__(self, matrix):
        self.left, self.right = np.ones(matrix.shape[0]), np.ones(matrix.shape[1])
        size = np.abs(matrix.data)
        rows, columns = matrix.coords
        for _ in range(SCALINGS):
            scaled = self.left[rows] * size * self.right[columns]
            self.left /= np.sqrt(largest(scaled, rows, matrix.shape[0]))
            self.right /= np.sqrt(largest(scaled, columns, matrix.shape[1]))
        matrix.data = self.left[rows] * matrix.data * self.right[columns]
        self.lu = splu(matrix.tocsc())

    def solve(self, load):
        return self.right * self.lu.solve(self.left * load)


def largest(values, places, size):
    """The maximum of the values at each place; 1 where there is none but zero."""
    out = np.zeros(size)
    np.maximum.at(out, places, values)
    return np.where(out > 0.0, out, 1.0)


@dataclass
class System:
    """The discrete equations: `balance(point, r)` gives q, `positive(point)` arrays, linear in the point, that must be above 0.

    `load` is a fixed vector, `exchange` {place: factor} a linear wall term.
    """

    space: Any
    balance: Any
    positive: Any
    load: np.ndarray
    exchange: dict = field(default_factory=dict)

    def residual(self, x):
        """B^T q + wall term - load, all rows: in the rows of prescribed unknowns it is the reaction."""
        out = self.space.residual(self.balance(Point(*self.space.points(x)), self.space.r)) - self.load
        for place, factor in self.exchange.items():
            out[place] += factor * x[place]
        return out

    def factorised(self, x, free):
        """A sparse factorisation of the tangent in the unknowns `free`; RuntimeError if it is singular."""
        slope = complex_step(lambda point: self.balance(point, self.space.r), self.space.points(x))
        number = np.full(self.space.size, -1)
        number[free] = np.arange(free.size)
        local = number[self.space.dofs]
        rows, columns = np.broadcast_arrays(local[:, :, None], local[:, None, :])
        kept = (rows >= 0) & (columns >= 0)
        walls = [place for place in self.exchange if number[place] >= 0]
        values = np.concatenate([self.space.tangents(slope)[kept], [self.exchange[place] for place in walls]])
        rows = np.concatenate([rows[kept], number[walls]])
        columns = np.concatenate([columns[kept], number[walls]])
        return Factors(coo_array((values, (rows, columns)), shape=(free.size, free.size)))

    def size(self, step, x):
        """The largest change of an unknown, in units of its field."""
        changes = []
        for name, part in self.space.part.items():
            unit = np.abs(x[part]).max() if name == "g" else 1.0
            changes.append(np.abs(step[part]).max() / unit)
        return float(np.max(changes))  # NaN if there is one, unlike the built-in max

    def imbalance(self, x, free):
        """The largest force left over on a free velocity, in units of the largest reaction of the same component."""
        left, ratios = np.abs(self.residual(x)), []
        kept = np.zeros_like(left)
        kept[free] = left[free]
        for name in ("u_r", "u_phi"):
            part = self.space.part[name]
            ratios.append(kept[part].max() / left[part].max())
        return float(np.max(ratios))

    def longest(self, x, step):
        """The largest share (at most 1) of the step that leaves positive what must be, at every quadrature point."""
        now = self.positive(Point(*self.space.points(x)))
        then = self.positive(Point(*self.space.points(x + step)))
        share = 1.0
        for value, after in zip(now, then, strict=True):
            falls = after < value
            room = (1.0 - BOUNDARY) * value[falls] / (value - after)[falls]
            share = min(share, float(room.min(initial=1.0)))
        return share


def correction(system, x, free, history):
    """The Newton step in the unknowns `free`, and the factorisation it came from; NotConverged if the tangent is singular."""
    try:
        factors = system.factorised(x, free)
    except RuntimeError as trouble:
        raise NotConverged(f"continuum: the tangent cannot be factorised ({trouble})", history, x) from trouble
    step = np.zeros_like(x)
    step[free] = factors.solve(-system.residual(x)[free])
    if not np.isfinite(step).all():
        raise NotConverged("continuum: the Newton step is not finite", history, x)
    return step, factors


def alternated(system, x, groups, history, limit):
    """x after Picard rounds: a limited step in each group of unknowns with the others held, in turn, until it changes by NEAR.

    Each sub-problem of the fluidity model is linear and keeps g > 0, which a full Newton step from afar does not. That x is only
    a start for Newton; it is handed on after ROUNDS rounds at most. Raises NotConverged when the iterations are used up.
    """
    for _ in range(ROUNDS):
        before = x
        for free in groups:
            step, _ = correction(system, x, free, history)
            x = x + system.longest(x, step) * step
        history.append(system.size(x - before, x))
        if history[-1] <= NEAR:
            break
        if len(history) >= limit:
            raise NotConverged(f"continuum: no solution after {limit} iterations, in the Picard start", history, x)
    return x


def newton(system, x, free, history, limit):
    """The solution; `history` gets the size of every correction (see System.size).

    Raises NotConverged, with history and best iterate, when the iterations are used up or the line search stalls.
    """
    damping, last = 1.0, np.inf
    while len(history) < limit:
        step, factors = correction(system, x, free, history)
        size = system.size(step, x)
        history.append(size)
        share = system.longest(x, step)
        if size <= TOLERANCE and share == 1.0:
            x = x + step
            if system.imbalance(x, free) <= IMBALANCE or size > 0.5 * last:  # the latter: rounding, no step helps any more
                return x
            last = size
            continue
        share = min(share, 4.0 * damping)
        while True:
            trial = x + share * step
            after = np.zeros_like(x)
            # outside of its domain a law is not finite, and the trial is refused by the comparison below
            with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
                after[free] = factors.solve(-system.residual(trial)[free])
            if system.size(after, x) <= (1.0 - 0.25 * share) * size:
                break
            share *= 0.5
            if share < SHORTEST:
                raise NotConverged(f"continuum: the line search stalls at a correction of {size:.1e}; more elements may help", history, x)
        x, damping = trial, share
    raise NotConverged(f"continuum: no solution after {limit} iterations, last correction {history[-1]:.1e}", history, x)
