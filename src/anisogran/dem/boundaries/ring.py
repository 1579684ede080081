"""A ring shear cell: a rough inner ring of driven grains that turns, and a smooth outer ring that may breathe as a radial piston.

The driven grains are the last ones of the simulation. They ride on the inner ring with its velocity and its spin.
"""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from anisogran.dem.boundaries.motion import Fixed, move
from anisogran.outcome import InputError, checked


class RingState(NamedTuple):
    """The outer ring (one entry each): radius, its velocity, outward force of the grains, force along the ring; and the inner ring."""

    position: np.ndarray
    velocity: np.ndarray
    force: np.ndarray
    traction: np.ndarray
    rim: Any  # motion of the outer radius
    omega: float  # angular velocity of the inner ring, 1/s


@dataclass(frozen=True)
class Ring:
    """Outer ring of `radius` (m) about the origin, moving as told; driven grains turn about the origin with `omega` (1/s)."""

    radius: float
    rim: Any = Fixed()
    omega: float = 0.0
    walls = 1

    def __post_init__(self):
        checked("Ring", "radius", self.radius, above=0, unit="m")
        checked("Ring", "omega", self.omega, unit="1/s")
        if not hasattr(self.rim, "parameters"):
            raise InputError(f"Ring: rim = {self.rim!r} is no motion (Fixed, Cosine, Pressure)")

    def state(self):
        return RingState(np.array([self.radius]), np.zeros(1), np.zeros(1), np.zeros(1), self.rim.parameters(), float(self.omega))

    def extent(self, state):
        """Lattice vectors (none) and the present area within the outer ring."""
        return None, float(np.pi * state.position[0] ** 2)


def touch(boundary, wall, x, y, radius):
    """Overlap of a grain with the outer ring, normal from the grain to the ring, velocity of the ring at the contact."""
    distance = math.sqrt(x * x + y * y)
    inverse = 1.0 / distance if distance > 0.0 else 0.0
    nx = x * inverse
    ny = y * inverse
    speed = boundary.velocity[0]
    return radius - (boundary.position[0] - distance), nx, ny, speed * nx, speed * ny


def advance(boundary, body, spin, movable, reach, time, dt):
    """Turns the driven grains by omega dt about the axis and moves the outer ring by one step; returns the way of the outer ring."""
    cosine = math.cos(boundary.omega * dt)
    sine = math.sin(boundary.omega * dt)
    for i in range(movable, body.x.size):
        x = body.x[i]
        y = body.y[i]
        body.x[i] = cosine * x - sine * y
        body.y[i] = sine * x + cosine * y
        body.vx[i] = -boundary.omega * body.y[i]
        body.vy[i] = boundary.omega * body.x[i]
        if spin is not None:
            spin[i] = boundary.omega
    radius = boundary.position[0]
    boundary.position[0], boundary.velocity[0] = move(
        boundary.rim, radius, boundary.velocity[0], boundary.force[0], 2.0 * math.pi * radius, 1.0, time, dt
    )
    return abs(boundary.position[0] - radius)
