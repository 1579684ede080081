"""How a steady ring flow is found: from coarse to fine meshes, from a large rate floor to the wanted one, from sticking to slipping.

On the coarsest mesh a law with fluidity begins with Picard rounds; everything else is Newton's method.
"""

from typing import Any, NamedTuple

import numpy as np

from anisogran.continuum.grading import graded
from anisogran.continuum.newton import newton
from anisogran.continuum.slipping import let_go, weakest
from anisogran.continuum.space import Space
from anisogran.continuum.stages import carried, predicted, staged
from anisogran.continuum.walls import equations, slip_signs, sticking, with_setting
from anisogran.outcome import NotConverged

COARSEST = (16, 8)  # elements along the radius and around, below which a mesh is not coarsened
AT_REST = 1e-3  # of the speed of the rings: the rate floor may matter in grains that are slower everywhere
SWITCHES = 30  # rounds in which the places that slip are found


class Solution(NamedTuple):
    """A solved level: the space, its unknowns, the equations they fulfil, and where Coulomb walls slip."""

    space: Any
    x: np.ndarray
    system: Any
    signs: dict


def solved(problem, history):
    """The Solution on the finest mesh, and the relative change of v_phi with a tenth of the rate floor, None if it is not known.

    A mesh that a flow from the coarser one does not help, or that is too coarse for any flow, is started on, or left for the next,
    from nothing. `history` gets the size of every correction. Raises NotConverged.
    """
    known, change, spaces = None, None, levels(problem)
    for space in spaces:
        if known is not None:
            signs = {outer: np.repeat(before, 2) for outer, before in known.signs.items()}
            try:
                known = slipped(space, problem, refined(known, space, problem), signs, history)
                continue
            except NotConverged:
                known = None
        try:
            known, change = started(space, problem, history)
        except NotConverged:
            if space is spaces[-1]:
                raise
    return known, change


def levels(problem):
    """The spaces from the coarsest to the one asked for; each is nested in the next. One, if the flow is axisymmetric."""
    law = problem.law
    vertices = graded(problem.r_inner / problem.gap, problem.r_outer / problem.gap, problem.elements_along(), problem.layer())
    if problem.dimension == 1:
        return [Space(vertices, law.fields, inertia=problem.inertia)]
    angles, found = np.linspace(0.0, 2.0 * np.pi, int(problem.elements_around) + 1), []
    while True:
        found.append(Space(vertices, law.fields, angles, problem.eccentricity / problem.gap, problem.inertia))
        halved = [(line.size - 1) // 2 for line in (vertices, angles)]
        if any(line.size % 2 == 0 for line in (vertices, angles)) or any(np.less(halved, COARSEST)):
            return found[::-1]
        vertices, angles = vertices[::2], angles[::2]


def started(space, problem, history):
    """The Solution on the coarsest mesh, from nothing, and the influence of the rate floor (see `solved`)."""
    signs = sticking(space)
    known, system = staged(space, problem, history)
    x = known[-1][1]
    reaction = system.reaction(x)
    signs = weakest(space, problem, reaction, slip_signs(space, problem, x, reaction, signs))
    if any(sign.any() for sign in signs.values()):
        x = let_go(space, problem, signs, history)
        known, system = [], None
    solution = slipped(space, problem, x, signs, history, system)
    if np.abs(solution.x[space.part["u_phi"]]).max() < AT_REST:
        return solution, 0.0
    known = [*known[:-1], (problem.floor, solution.x)]
    finer = with_setting(solution.system, problem.law, problem.setting(0.1 * problem.floor))
    try:
        moved = newton(finer, predicted(space, known, 0.1 * problem.floor), [], problem.max_iterations, balanced=False) - solution.x
    except NotConverged:
        return solution, None
    return solution, norm(space, moved) / norm(space, solution.x)


def slipped(space, problem, x, signs, history, system=None):
    """The Solution from a start x, with the places of Coulomb walls that slip found in turn with the flow; `system` for these signs."""
    for _ in range(SWITCHES):
        system = system or equations(space, problem, problem.setting(), signs)
        x = newton(system, carried(space, problem, x, signs), history, problem.max_iterations)
        before, signs = signs, slip_signs(space, problem, x, system.reaction(x), signs)
        if all(np.array_equal(signs[outer], before[outer]) for outer in signs):
            return Solution(space, x, system, signs)
        system = None
    raise NotConverged(f"continuum: the places where the walls slip still change after {SWITCHES} rounds", history, x)


def refined(known, space, problem):
    """The unknowns of a coarse Solution in the space of a finer mesh, in which they are the same functions."""
    x = np.empty(space.size)
    for name, part in space.part.items():
        x[part] = getattr(known.space.evaluated(known.x, space.place[part], space.angle[part]), name)
    return carried(space, problem, x, {outer: np.repeat(before, 2) for outer, before in known.signs.items()})


def norm(space, x):
    """The L2 norm of u_phi over the area (as if the rings were concentric)."""
    s = space.nodes()
    square = np.mean(x[space.part["u_phi"]].reshape(s.size, -1) ** 2, axis=1)
    return float(np.sqrt(np.trapezoid(square * s, s)))
