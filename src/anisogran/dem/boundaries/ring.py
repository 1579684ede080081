"""A ring shear cell: an inner ring that turns, and an outer ring that may breathe as a radial piston; both may carry driven grains.

Driven grains are the last ones of the simulation. The first `inner` of them ride on the inner ring with its velocity and its spin, the
others on the outer ring, moving radially with it. Behind the latter the outer ring is a smooth wall.
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
    inner: int  # driven grains on the inner ring


@dataclass(frozen=True)
class Ring:
    """Outer ring of `radius` (m) about the origin, moving as told; of the driven grains, `inner` turn about the origin with omega (1/s)."""

    radius: float
    rim: Any = Fixed()
    omega: float = 0.0
    inner: int = 0
    walls = 1

    def __post_init__(self):
        checked("Ring", "radius", self.radius, above=0, unit="m")
        checked("Ring", "omega", self.omega, unit="1/s")
        if checked("Ring", "inner", self.inner, at_least=0) != int(self.inner):
            raise InputError(f"Ring: inner = {self.inner} must be a whole number of grains")
        if not hasattr(self.rim, "parameters"):
            raise InputError(f"Ring: rim = {self.rim!r} is no motion (Fixed, Cosine, Pressure)")

    def state(self):
        """What the kernel needs; the arrays change while it runs."""
        rest = (np.zeros(1) for _ in range(3))
        return RingState(np.array([self.radius]), *rest, self.rim.parameters(), float(self.omega), int(self.inner))

    def pressures(self):
        """The pressures that it holds, in N/m."""
        return (self.rim.pressure,) if hasattr(self.rim, "pressure") else ()

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
    """Turns the inner ring by omega dt about the axis and moves the outer ring by one step; returns the way of the outer ring.

    The grains press on the outer ring directly and through the driven grains on it.
    """
    cosine = math.cos(boundary.omega * dt)
    sine = math.sin(boundary.omega * dt)
    first_outer = movable + boundary.inner
    for i in range(movable, first_outer):
        x = body.x[i]
        y = body.y[i]
        body.x[i] = cosine * x - sine * y
        body.y[i] = sine * x + cosine * y
        body.vx[i] = -boundary.omega * body.y[i]
        body.vy[i] = boundary.omega * body.x[i]
        if spin is not None:
            spin[i] = boundary.omega
    force = boundary.force[0]
    for i in range(first_outer, body.x.size):
        force += (body.fx[i] * body.x[i] + body.fy[i] * body.y[i]) / math.sqrt(body.x[i] ** 2 + body.y[i] ** 2)
    radius = boundary.position[0]
    boundary.position[0], boundary.velocity[0] = move(
        boundary.rim, radius, boundary.velocity[0], force, 2.0 * math.pi * radius, 1.0, time, dt
    )
    way = boundary.position[0] - radius
    for i in range(first_outer, body.x.size):
        inverse = 1.0 / math.sqrt(body.x[i] ** 2 + body.y[i] ** 2)
        nx = body.x[i] * inverse
        ny = body.y[i] * inverse
        body.x[i] += way * nx
        body.y[i] += way * ny
        body.vx[i] = boundary.velocity[0] * nx
        body.vy[i] = boundary.velocity[0] * ny
    return abs(way)
