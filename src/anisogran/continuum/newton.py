"""Newton's method for the equations of a ring: damped, kept inside the domain of the law, never quietly wrong.

The size of a step is measured by what it changes: velocities in wall speeds, pressure in outer pressures, fluidity in its own
maximum. A damped step is taken if it shrinks the next correction computed with the same matrix (the natural monotonicity test of
P. Deuflhard, Newton Methods for Nonlinear Problems, 2004; cited from memory), which no scaling of the equations can mislead.
"""

import numpy as np

from anisogran.outcome import NotConverged

TOLERANCE = 1e-7  # of the last correction; it is still applied, and Newton squares it
IMBALANCE = 1e-10  # of a converged answer, in units of the largest reaction
SHORTEST = 2.0**-14  # damping below which the search is given up
CHORD = 0.1  # contraction that is worth another step with an old factorisation
BOUNDARY = 0.1  # share of its value that a positive quantity keeps in one step, at least
ROUNDS, NEAR = 30, 0.01  # of Picard, at most; the change at which Newton takes over (0.05 failed in 6 of 240 cases, 0.02 in none)
SLOW, WINDOW = 0.99, 25  # stagnation: the best correction falls by less than 1 % in so many iterations
VANISHED = 1e-3  # of the outer pressure: below, it is what ends the search


def longest(system, x, step):
    """The largest share (at most 1) of the step that leaves positive what must be, at every quadrature point."""
    share = 1.0
    for value, after in zip(system.positive_values(x), system.positive_values(x + step), strict=True):
        falls = after < value
        room = (1.0 - BOUNDARY) * value[falls] / (value - after)[falls]
        share = min(share, float(room.min(initial=1.0)))
    return share


def correction(system, x, history):
    """The Newton step and the factorisation it came from; NotConverged at the edge of the domain of the law, or if it is singular."""
    if not all(np.all(value > 0.0) for value in system.positive_values(x)):
        raise NotConverged("continuum: pressure or fluidity falls to 0 somewhere, where a law has no answer", history, x)
    load = -system.residual(x)
    try:
        factors = system.factorised(x)
        step = system.trial @ factors.solve(load)
    except RuntimeError as trouble:
        raise NotConverged(f"continuum: the tangent cannot be factorised ({trouble})", history, x) from trouble
    if not np.isfinite(step).all():
        raise NotConverged("continuum: the Newton step is not finite", history, x)
    return step, factors


def alternated(system, x, history, limit):
    """x after Picard rounds: a limited step in the flow and one in the fluidity, in turn, until a round changes it by NEAR.

    Each sub-problem of the fluidity model is linear and keeps g > 0, which a full Newton step from afar does not. That x is only
    a start for Newton; it is handed on after ROUNDS rounds at most. Raises NotConverged when the iterations are used up.
    """
    halves = [system.of_fields(names) for names in (("u_r", "u_phi", "p"), ("g",))]
    for _ in range(ROUNDS):
        before = x
        for half in halves:
            step, _ = correction(half, x, history)
            whole = all(values.min() > 0.0 for values in half.positive_values(x + step))
            x = x + (1.0 if whole else longest(half, x, step)) * step
        history.append(system.size(x - before, x))
        if history[-1] <= NEAR:
            break
        if len(history) >= limit:
            raise NotConverged(f"continuum: no solution after {limit} iterations, in the Picard start", history, x)
    return x


def newton(system, x, history, limit, balanced=True):
    """The solution; `history` gets the size of every correction. One that need not be `balanced` will do to start another stage.

    A factorisation serves on as long as its corrections shrink by CHORD each. Raises NotConverged, with history and best iterate,
    when the iterations are used up, the line search stalls, or the corrections stagnate.
    """
    damping, first = 1.0, len(history)
    while len(history) < limit:
        step, factors = correction(system, x, history)
        size = system.size(step, x)
        history.append(size)
        if size > TOLERANCE:
            refuse_stagnation(system, history[first:], history, x)
        share = min(longest(system, x, step), 4.0 * damping)
        while True:
            if share >= 1.0 and finished(system, x + step, size, balanced):
                return x + step
            trial = x + share * step
            after = chord(system, factors, trial)
            shrunk = system.size(after, x)
            if shrunk <= (1.0 - 0.25 * share) * size:
                break
            if size <= TOLERANCE:
                return min((x, x + step), key=system.imbalance)  # rounding, no step helps any more
            share *= 0.5
            if share < SHORTEST:
                why = f"the line search stalls at a correction of {size:.1e}"
                raise NotConverged(f"continuum: {blamed(why, system, x, '; more elements may help')}", history, x)
        x, damping = trial, share
        while shrunk <= CHORD * size and longest(system, x, after) == 1.0 and len(history) < limit:
            x, size = x + after, shrunk
            history.append(size)
            if finished(system, x, size, balanced):
                return x
            after = chord(system, factors, x)
            shrunk = system.size(after, x)
    why = f"no solution after {limit} iterations, last correction {history[-1]:.1e}"
    raise NotConverged(f"continuum: {blamed(why, system, x)}", history, x)


def chord(system, factors, x):
    """The correction at x with the tangent of another place; not finite outside of the domain of a law, which no comparison passes."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        return system.trial @ factors.solve(-system.residual(x))


def finished(system, x, size, balanced):
    """Whether x, reached by a correction of this size, will do."""
    return size <= TOLERANCE and (not balanced or system.imbalance(x) <= IMBALANCE)


def blamed(why, system, x, hint=""):
    """The words of a failure with its reason: a flow of constant density does not exist where grains would have to be pulled."""
    lowest = system.space.point(x).p.min()
    if lowest < VANISHED:
        return f"the pressure falls to {lowest:.1e} of the outer one, and no grains can be pulled: {why}"
    return f"{why}; the lowest pressure is {lowest:.1e} of the outer one{hint}"


def refuse_stagnation(system, sizes, history, x):
    """Raises NotConverged if the last WINDOW corrections of a stage have brought no progress."""
    if len(sizes) > WINDOW and min(sizes[-WINDOW:]) > SLOW * min(sizes[:-WINDOW]):
        why = f"stagnation, the corrections stay above {min(sizes):.1e} over {WINDOW} iterations"
        raise NotConverged(f"continuum: {blamed(why, system, x)}", history, x)
