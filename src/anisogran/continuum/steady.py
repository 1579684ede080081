"""How a steady ring flow is found: from coarse to fine meshes, from a large rate floor to the wanted one, from sticking to slipping.

On the coarsest mesh a law with fluidity begins with Picard rounds; everything else is Newton's method.
"""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from anisogran.continuum.grading import graded
from anisogran.continuum.newton import alternated, newton
from anisogran.continuum.space import Space
from anisogran.continuum.walls import NavierSlip, columns, equations, slip_signs, sticking, wall_of, wall_velocity, with_setting
from anisogran.outcome import NotConverged

COARSEST = (16, 8)  # elements along the radius and around, below which a mesh is not coarsened
AT_REST = 1e-3  # of the speed of the rings: the rate floor may matter in grains that are slower everywhere
FILMS, CLOSE, LEAP = 30, 0.01, 2.0  # rounds in which a film is made to act like friction; how closely; its largest logarithmic step
SWITCHES = 30  # rounds in which the places that slip are found


class Solution(NamedTuple):
    """A solved level: the space, its unknowns, the equations they fulfil, and where Coulomb walls slip."""

    space: Any
    x: np.ndarray
    system: Any
    signs: dict


def solved(problem, history):
    """The Solution on the finest mesh, and the relative change of v_phi with a tenth of the rate floor, None if it is not known.

    `history` gets the size of every correction. Raises NotConverged.
    """
    spaces = levels(problem)
    known, change = started(spaces[0], problem, history)
    for space in spaces[1:]:
        signs = {outer: np.repeat(before, 2) for outer, before in known.signs.items()}
        known = slipped(space, problem, refined(known, space, problem), signs, history)
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
    known = staged(space, problem, history)
    x = known[-1][1]
    reaction = equations(space, problem, problem.setting(), signs).reaction(x)
    signs = weakest(space, problem, reaction, slip_signs(space, problem, x, reaction, signs))
    if any(sign.any() for sign in signs.values()):
        x = let_go(space, problem, signs, history)
        known = []
    solution = slipped(space, problem, x, signs, history)
    if np.abs(solution.x[space.part["u_phi"]]).max() < AT_REST:
        return solution, 0.0
    known = [*known[:-1], (problem.floor, solution.x)]
    finer = with_setting(solution.system, problem.law, problem.setting(0.1 * problem.floor))
    try:
        moved = newton(finer, predicted(space, known, 0.1 * problem.floor), [], problem.max_iterations, balanced=False) - solution.x
    except NotConverged:
        return solution, None
    return solution, norm(space, moved) / norm(space, solution.x)


def staged(space, problem, history):
    """[(rate floor, unknowns), ...] with Coulomb walls that stick, the floor lowered in the steps of the law to the wanted one."""
    x, known = first_guess(space, problem), []
    system = equations(space, problem, problem.setting(), sticking(space))
    for floor in floors(problem.law, problem.floor):
        system = with_setting(system, problem.law, problem.setting(floor))
        if known:
            x = predicted(space, known, floor)
        elif "g" in space.part:
            x = alternated(system, x, history, problem.max_iterations)
        x = newton(system, x, history, problem.max_iterations, balanced=False)
        known.append((floor, x))
    return known


def let_go(space, problem, signs, history):
    """A start for Coulomb walls that slip: the flow with viscous films in their place whose stresses come near their friction.

    A flow driven by a stress is found only from nearby, one with a film from nothing, whether the grains flow or stay at rest.
    The stress rises with the viscosity of its film, often hardly; the secant in logarithms tells how far to go.
    """
    walls = {outer: wall_of(problem, outer) for outer in signs if signs[outer].any()}
    full_slip = {outer: wall.friction * problem.outer_pressure / problem.speed for outer, wall in walls.items()}
    film, tried, x = full_slip, [], None
    for _ in range(FILMS):
        x, reaction = filmed(space, problem, film, x, history)
        lacking = {outer: lacking_stress(space, reaction, outer, wall.friction) for outer, wall in walls.items()}
        if all(abs(lack) <= CLOSE for lack in lacking.values()):
            break
        tried.append((film, lacking))
        film = {outer: film[outer] * np.exp(next_step([(np.log(f[outer]), lack[outer]) for f, lack in tried])) for outer in walls}
    return x


def weakest(space, problem, reaction, signs):
    """The signs of the ring alone whose friction is exceeded most in proportion: its slip unloads the other, for the torque is one."""
    if not all(sign.any() for sign in signs.values()):
        return signs
    inner, outer = (wall_of(problem, ring).friction / stress_ratio(space, reaction, ring) for ring in (False, True))
    kept = outer < inner
    return {ring: sign if ring == kept else 0 * sign for ring, sign in signs.items()}


def filmed(space, problem, film, x, history):
    """Unknowns, and the forces of the walls, with films of the viscosities {outer: N s/m^2}; x is tried as a start if there is one."""
    keys = {True: "outer_wall", False: "inner_wall"}
    problem = replace(problem, **{keys[outer]: NavierSlip(viscosity) for outer, viscosity in film.items()})
    system = equations(space, problem, problem.setting(), sticking(space))
    if x is not None:
        try:
            x = newton(system, x, history, problem.max_iterations, balanced=False)
        except NotConverged:
            x = None
    if x is None:
        x = staged(space, problem, history)[-1][1]
    return x, system.reaction(x)


def stress_ratio(space, reaction, outer):
    """Ratio of the sums of shear and normal forces on a ring."""
    return np.abs(reaction[space.ring("u_phi", outer)]).sum() / np.abs(reaction[space.ring("u_r", outer)]).sum()


def lacking_stress(space, reaction, outer, friction):
    """Logarithm of friction over stress ratio on a ring; 0 on a perfectly smooth one."""
    return float(np.log(friction / stress_ratio(space, reaction, outer))) if friction > 0.0 else 0.0


def next_step(points):
    """The step of a secant to lacking = 0 from the last of the points (place, lacking), in its direction and at most LEAP."""
    place, lack = points[-1]
    step = lack
    if len(points) > 1:
        slope = (points[-2][1] - lack) / (place - points[-2][0]) if place != points[-2][0] else 0.0
        step = lack / slope if slope > 0.0 else lack
    return float(np.clip(step, -LEAP, LEAP))


def slipped(space, problem, x, signs, history):
    """The Solution from a start x, with the places of Coulomb walls that slip found in turn with the flow."""
    for _ in range(SWITCHES):
        system = equations(space, problem, problem.setting(), signs)
        x = newton(system, carried(space, problem, x, signs), history, problem.max_iterations)
        before, signs = signs, slip_signs(space, problem, x, system.reaction(x), signs)
        if all(np.array_equal(signs[outer], before[outer]) for outer in signs):
            return Solution(space, x, system, signs)
    raise NotConverged(f"continuum: the places where the walls slip still change after {SWITCHES} rounds", history, x)


def floors(law, last):
    """Rate floors from the law's first one down to `last`, each the law's factor below the one before."""
    floor = law.first_floor
    while floor > last * 1.000001:
        yield floor
        floor *= law.floor_factor
    yield last


def predicted(space, known, floor):
    """A start for a lower floor from the solutions [(floor, x), ...] known.

    With fluidity: the last one, the fluidity raised as much as the floor falls, which keeps its stress and its positivity. Else
    the line through the last two: where grains are all but at rest, the velocity is proportional to the floor.
    """
    last, x = known[-1]
    out = x.copy()
    if "g" in space.part:
        out[space.part["g"]] += last - floor
    elif len(known) > 1:
        before, older = known[-2]
        out += (floor - last) / (last - before) * (x - older)
    return out


def first_guess(space, problem):
    """Reduced unknowns: velocity linear from ring to ring, pressure 1, fluidity decaying as in grains at rest."""
    x = np.zeros(space.size)
    share = (space.place - space.vertices[0]) / (space.vertices[-1] - space.vertices[0])
    inside, outside = wall_velocity(space, problem, outer=False), wall_velocity(space, problem, outer=True)
    for name, a, b in zip(("u_r", "u_phi"), inside, outside, strict=True):
        part = space.part[name]
        rounds = share[part].reshape(-1, a.size)
        x[part] = (a * (1.0 - rounds) + b * rounds).ravel()
    x[space.part["p"]] = 1.0
    if "g" in space.part:
        part = space.part["g"]
        x[part] = np.exp(-(space.place[part] - space.vertices[0]) / problem.law.length(problem.setting()))
    return carried(space, problem, x, sticking(space))


def carried(space, problem, x, signs):
    """x with the velocities that the walls prescribe."""
    out, held = x.copy(), columns(space, problem, signs) < 0
    for outer in (False, True):
        for name, values in zip(("u_r", "u_phi"), wall_velocity(space, problem, outer), strict=True):
            places = space.ring(name, outer)
            out[places] = np.where(held[places], values, x[places])
    return out


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
