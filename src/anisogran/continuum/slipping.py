"""How the flow between Coulomb walls that slip is reached from nothing: viscous films in their place come near their friction."""

from dataclasses import replace

import numpy as np

from anisogran.continuum.newton import newton
from anisogran.continuum.stages import staged
from anisogran.continuum.walls import NavierSlip, equations, sticking, wall_of
from anisogran.outcome import NotConverged

FILMS, CLOSE, LEAP = 30, 0.01, 2.0  # rounds in which a film is made to act like friction; how closely; its largest logarithmic step


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
        known, system = staged(space, problem, history)
        x = known[-1][1]
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
