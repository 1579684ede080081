"""What can be simulated: how long a step may be, which arguments make sense, and in which words a run is stopped or doubted."""

import math

import numpy as np

from anisogran.dem.laws import NORMAL_LAWS, Friction
from anisogran.dem.stepping import CELL_TOO_SMALL, DEEP_OVERLAP, NOT_FINITE, OUTSIDE, TOO_FAST
from anisogran.outcome import InputError, checked

CAUSES = {
    NOT_FINITE: "its position is not a finite number; the time step is too long or a force has blown up",
    DEEP_OVERLAP: "it overlaps a neighbour by more than half a radius; the load is too high for the stiffness, or the time step too long",
    TOO_FAST: "it, or a wall, moves more than half the smallest radius in one step; faster than contacts can be found",
    CELL_TOO_SMALL: "the periodic cell is narrower than four of its radii and two skins; a contact would meet its own image",
    OUTSIDE: "its centre lies beyond a wall; the wall is too soft for the load, or the grain too fast for the time step",
}
STARTS = {
    NOT_FINITE: "is not at a finite place",
    DEEP_OVERLAP: "overlaps a neighbour by more than half a radius",
    OUTSIDE: "has its centre beyond a wall",
    CELL_TOO_SMALL: "is too large for the periodic cell, which must be wider and higher than four radii and two skins,",
}
HELD = 0.01  # the share by which the force on a pressed wall may be off
START_OVERLAP = 0.2  # of the smaller radius, a tenth of the diameter; more of it would fly apart


def collision_time(normal, mass):
    """Duration t_c = pi / sqrt(k/m12 - (g/(2 m12))^2) of a binary contact of the lightest pair on the stiffest branch, in s.

    An overdamped pair has no such time; there the undamped pi sqrt(m12/k) is returned.
    """
    reduced = 0.5 * float(np.min(mass))
    square = normal.stiffest / reduced
    damped = square - (normal.damping / (2.0 * reduced)) ** 2
    return math.pi / math.sqrt(damped if damped > 0 else square)


def longest_step(normal, friction, drag, mass):
    """The longest time step that is allowed, in s: a fifth of the shortest undamped contact time, less for strong dashpots or friction.

    The dashpots are explicit: a step beyond 2 m12/damping would turn damping into driving. A quarter of that leaves room for grains with
    many contacts. A tangential force also turns the grains, which makes it 1 + 1/0.4 = 3.5 times as effective on spheres; its
    oscillation may take 0.3 of its half period, so that k_t up to 0.6 of the normal stiffness leaves the step as it is.
    """
    lightest = float(np.min(mass))
    reduced = 0.5 * lightest
    limits = [math.pi / 5 * math.sqrt(reduced / normal.stiffest)]
    dashpots = [(normal.damping, reduced), (drag or 0.0, lightest)]
    if friction is not None:
        limits.append(0.3 * math.pi * math.sqrt(reduced / (3.5 * friction.stiffness)))
        dashpots.append((3.5 * friction.damping, reduced))
    return min(limits + [0.5 * inertia / damping for damping, inertia in dashpots if damping > 0])


def gravity_vector(gravity):
    """The acceleration as (g_x, g_y) in m/s2, or None. Raises InputError for anything else."""
    if gravity is None:
        return None
    if np.shape(gravity) != (2,):
        raise InputError(f"Simulation: gravity = {gravity!r} must be a vector (g_x, g_y) in m/s2, like (0, -9.81)")
    return tuple(checked("Simulation", f"gravity ({axis})", value, unit="m/s2") for axis, value in zip("xy", gravity, strict=True))


def check_effects(grains, normal, friction, rolling, wall_friction, boundary):
    """Raises InputError naming the first argument that is not what it has to be."""
    if type(normal) not in NORMAL_LAWS:
        laws = ", ".join(law.__name__ for law in NORMAL_LAWS)
        raise InputError(f"Simulation: normal = {normal!r} must be a contact law ({laws}) with its parameters")
    for name, effect in (("friction", friction), ("wall_friction", wall_friction)):
        if effect is not None and not isinstance(effect, Friction):
            raise InputError(f"Simulation: {name} = {effect!r} must be a Friction record or None")
    if rolling is not None:
        raise InputError(f"Simulation: rolling = {rolling!r}: there is no rolling resistance for discs; leave it None")
    if not hasattr(boundary, "walls") or isinstance(boundary, type):
        raise InputError(f"Simulation: boundary = {boundary!r} must be one of Open, Box, Ring, Periodic")
    if grains.driven and hasattr(boundary, "stretch_rate"):
        raise InputError(f"Simulation: driven = {grains.driven}: a periodic cell deforms, and driven grains have no place in it")
    glued = int(sum(getattr(boundary, "glued", ())))
    if glued and glued != grains.driven:
        raise InputError(f"Simulation: the box has glued = {glued} grains in all, but driven = {grains.driven} are given")
    if getattr(boundary, "inner", 0) > grains.driven:
        raise InputError(f"Simulation: the ring has inner = {boundary.inner} driven grains, but only {grains.driven} are given")


def doubts(simulation):
    """Sentences about what a reader of the results has to know: step, softness, overlaps, speed, stale lists."""
    reasons = []
    grains, effects, counters = simulation.grains, simulation.effects, simulation.counters
    duration = 5 * longest_step(effects["normal"], effects["friction"], effects["drag"], grains.mass)
    if simulation.dt > 1.001 * duration / 20:
        reasons.append(
            f"dt = {simulation.dt:.3g} s is {simulation.dt / duration:.2g} of the shortest contact time; above 1/20 it is coarse"
        )
    for pressure in simulation.boundary.pressures():
        if pressure > 1e-2 * effects["normal"].stiffest:
            reasons.append(f"the pressure {pressure:.3g} N/m is more than a hundredth of the stiffness: soft grains, large overlaps")
    if hasattr(simulation.boundary, "held"):
        for name, present, pressure in simulation.boundary.held(simulation.walls, simulation._state.body, simulation._state.movable):
            if abs(present / pressure - 1) > HELD:
                reasons.append(f"the {name} bears {present / pressure:.3g} of its pressure {pressure:.3g} N/m at present")
    if counters["deep_pairs"]:
        i, j = counters["deepest_pair"]
        reasons.append(
            f"{counters['deep_pairs']} pairs at once overlapped by more than 5% of the smaller radius, "
            f"grains {i} and {j} by {counters['deepest_overlap']:.1%}"
        )
    if counters["longest_way"] > 0.1 * grains.radius.min():
        reasons.append(f"a grain moved {counters['longest_way'] / grains.radius.min():.2g} of the smallest radius in one step")
    if counters["late_builds"]:
        reasons.append(f"{counters['late_builds']} neighbour lists were built late")
    if simulation.unbalanced_force is not None and simulation.unbalanced_force > 1e-2:
        reasons.append(f"the stage began out of equilibrium: mean net force {simulation.unbalanced_force:.2g} of the mean contact force")
    return reasons
