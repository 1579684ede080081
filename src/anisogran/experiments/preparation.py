"""What all preparations share: start density, random start in a cell, time step, damping."""

import math

import numpy as np

from anisogran.dem import longest_step
from anisogran.dem.packing import random_positions
from anisogran.outcome import InputError

LOOSE = 0.4  # area fraction of the random start
ATTEMPTS = 200  # looks for equilibrium, after which a preparation is given up
MOST_STEPS = 1e14  # of a time; a single grain would take months


def quasi_static_step(contact, friction, mass, contact_steps, drag=None):
    """The time step of the experiments in s: that part of the shortest contact time, less for strong dashpots and for drag.

    A twentieth gives the restitution to 1.6 %.
    """
    return 5.0 / contact_steps * longest_step(contact, friction, drag, mass)


def time_steps(time, dt, told):
    """How many steps of dt take this time, both in s. Raises InputError, beginning with what is `told`, for more than MOST_STEPS."""
    steps = time / dt
    if not steps <= MOST_STEPS:
        raise InputError(f"{told} makes {steps:.2g} time steps of {dt:.2g} s; at most {MOST_STEPS:g} are taken")
    return math.ceil(steps)


def background_drag(contact, mass):
    """Damping of the preparation in kg/s: a mean grain loses its velocity within fifty of the shortest contact times.

    More, if the lightest grain would lose its own within half of one: no time step of a contact would be short enough for that.
    """
    lightest = float(mass.min())
    return min(float(mass.mean()), 100 * lightest) / (50 * math.pi * math.sqrt(0.5 * lightest / contact.stiffest))


def positions_in_cell(radius, period, rng):
    """Random positions (N, 2) in m of discs of these radii that do not overlap, in a periodic cell with the sides `period` (2,)."""

    def anywhere(points, r):
        return np.ones(len(points), bool)

    return random_positions(radius, lambda rng, count: rng.uniform(0, period, (count, 2)), anywhere, rng, period=period)


def sphere_mass(radius, density):
    """Masses in kg of spheres of these radii."""
    return 4.0 / 3.0 * np.pi * density * radius**3
