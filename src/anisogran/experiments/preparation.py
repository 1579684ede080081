"""What all preparations share: start density, time step, damping."""

import math

import numpy as np

from anisogran.dem import longest_step

LOOSE = 0.4  # area fraction of the random start
ATTEMPTS = 200  # looks for equilibrium, after which a preparation is given up


def quasi_static_step(contact, friction, mass, contact_steps=20.0):
    """The time step of the experiments in s: that part of the shortest contact time, less for strong dashpots.

    A twentieth gives the restitution to 1.6 %.
    """
    return 5.0 / contact_steps * longest_step(contact, friction, None, mass)


def background_drag(contact, mass):
    """Damping of the preparation in kg/s: a mean grain loses its velocity within fifty of the shortest contact times."""
    return float(mass.mean()) / (50 * math.pi * math.sqrt(0.5 * float(mass.min()) / contact.stiffest))


def sphere_mass(radius, density):
    """Masses in kg of spheres of these radii."""
    return 4.0 / 3.0 * np.pi * density * radius**3
