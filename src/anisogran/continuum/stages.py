"""A flow from nothing, on one mesh, in stages: Picard rounds for a law with fluidity, then Newton while the rate floor is lowered."""

import numpy as np

from anisogran.continuum.newton import alternated, newton
from anisogran.continuum.walls import columns, equations, sticking, wall_velocity, with_setting


def staged(space, problem, history):
    """[(rate floor, unknowns), ...] with Coulomb walls that stick, the floor lowered in the steps of the law to the wanted one, and the
    System of this last one."""
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
    return known, system


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
