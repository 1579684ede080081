"""A ring shear cell: an inner ring that turns, and an outer ring that may turn too and breathe as a radial piston.

Each ring may be smooth, a wall that wall friction drags along, or rough, carrying driven grains; or both. Driven grains are the last ones
of the simulation. The first `inner` of them ride on the inner ring with its velocity and its spin, the others on the outer ring, moving
radially with it. Behind the latter the outer ring is a smooth wall.
"""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from anisogran.compiled import kernel, specialised
from anisogran.dem.boundaries.motion import Fixed, move
from anisogran.outcome import InputError, checked


class RingState(NamedTuple):
    """The outer ring and, if it is a wall, the inner one: radius, its velocity, outward force of the grains, force along the ring."""

    position: np.ndarray  # (1,) or (2,)
    velocity: np.ndarray
    force: np.ndarray
    traction: np.ndarray
    rim: Any  # motion of the outer radius
    omega: float  # angular velocity of the inner ring, 1/s
    outer_omega: float  # of the outer ring
    inner: int  # driven grains on the inner ring


@dataclass(frozen=True)
class Ring:
    """Outer ring of `radius` (m) about the origin, moving as told; of the driven grains, `inner` turn about the origin with omega (1/s).

    `inner_radius` (m) makes the inner ring a smooth wall (wall 1; the outer ring is wall 0), which turns with omega too; without it there
    is no such wall. The outer ring and the driven grains on it turn with `outer_omega` (1/s). Counter-clockwise is positive. A smooth
    ring drags grains along by the simulation's `wall_friction`, at the speed of the ring at the contact.
    Raises InputError for values out of bounds.
    """

    radius: float
    rim: Any = Fixed()
    omega: float = 0.0
    inner: int = 0
    inner_radius: float | None = None
    outer_omega: float = 0.0

    def __post_init__(self):
        checked("Ring", "radius", self.radius, above=0, unit="m")
        checked("Ring", "omega", self.omega, unit="1/s")
        checked("Ring", "outer_omega", self.outer_omega, unit="1/s")
        if checked("Ring", "inner", self.inner, at_least=0) != int(self.inner):
            raise InputError(f"Ring: inner = {self.inner} must be a whole number of grains")
        if self.inner_radius is not None:
            checked("Ring", "inner_radius", self.inner_radius, above=0, below=self.radius, unit="m")
        if not hasattr(self.rim, "parameters"):
            raise InputError(f"Ring: rim = {self.rim!r} is no motion (Fixed, Cosine, Path, Pressure)")

    @property
    def walls(self):
        """Number of smooth walls: the outer ring, and the inner one if it has a radius."""
        return 1 if self.inner_radius is None else 2

    def state(self):
        """What the kernel needs; the arrays change while it runs."""
        radii = np.array([self.radius, self.inner_radius][: self.walls], dtype=float)
        rest = (np.zeros(self.walls) for _ in range(3))
        return RingState(radii, *rest, self.rim.parameters(), float(self.omega), float(self.outer_omega), int(self.inner))

    def pressures(self):
        """The pressures that it holds, in N/m."""
        return (self.rim.pressure,) if hasattr(self.rim, "pressure") else ()

    def held(self, state, body, movable):
        """(name, present pressure, pressure it should have) of each wall under a pressure, N/m."""
        length = 2 * math.pi * state.position[0]
        return [("outer ring", float(thrust(state, body, movable) / length), pressure) for pressure in self.pressures()]

    def extent(self, state):
        """What a Snapshot says of it: the present area within the outer ring, less that of an inner wall."""
        return {"volume": float(np.pi * (state.position[0] ** 2 - np.sum(state.position[1:] ** 2)))}


def touch(boundary, wall, x, y, radius):
    """Overlap of a grain with a ring, normal from the grain to the ring, velocity of the ring at the contact.

    The ring turns as a rigid body, and the contact is in the middle of the overlap: a grain that turns with the ring does not slip.
    """
    sense = 1.0 if wall == 0 else -1.0
    turning = boundary.outer_omega if wall == 0 else boundary.omega
    distance = math.sqrt(x * x + y * y)
    inverse = 1.0 / distance if distance > 0.0 else 0.0
    outward_x = x * inverse
    outward_y = y * inverse
    overlap = radius - sense * (boundary.position[wall] - distance)
    speed = boundary.velocity[wall]
    along = turning * (distance + sense * (radius - 0.5 * overlap))
    return overlap, sense * outward_x, sense * outward_y, speed * outward_x - along * outward_y, speed * outward_y + along * outward_x


@kernel
def turn(body, spin, begin, end, omega, dt):
    """Turns the grains begin .. end by omega dt about the origin."""
    cosine = math.cos(omega * dt)
    sine = math.sin(omega * dt)
    for i in range(begin, end):
        x = body.x[i]
        y = body.y[i]
        body.x[i] = cosine * x - sine * y
        body.y[i] = sine * x + cosine * y
        body.vx[i] = -omega * body.y[i]
        body.vy[i] = omega * body.x[i]
        if spin is not None:
            spin[i] = omega


def _thrust(boundary, body, movable):
    force = boundary.force[0]
    for i in range(movable + boundary.inner, body.x.size):
        force += (body.fx[i] * body.x[i] + body.fy[i] * body.y[i]) / math.sqrt(body.x[i] ** 2 + body.y[i] ** 2)
    return force


thrust = specialised({RingState: _thrust})  # outward force on the outer ring: directly, and through the driven grains on it


def advance(boundary, body, spin, movable, reach, time, dt):
    """Turns both rings about the axis and moves the outer one by one step; returns the way of the outer ring."""
    radius = boundary.position[0]
    force = thrust(boundary, body, movable)
    boundary.position[0], boundary.velocity[0] = move(
        boundary.rim, radius, boundary.velocity[0], force, 2.0 * math.pi * radius, 1.0, time, dt
    )
    way = boundary.position[0] - radius
    first_outer = movable + boundary.inner
    turn(body, spin, movable, first_outer, boundary.omega, dt)
    turn(body, spin, first_outer, body.x.size, boundary.outer_omega, dt)
    for i in range(first_outer, body.x.size):
        inverse = 1.0 / math.sqrt(body.x[i] ** 2 + body.y[i] ** 2)
        nx = body.x[i] * inverse
        ny = body.y[i] * inverse
        body.x[i] += way * nx
        body.y[i] += way * ny
        body.vx[i] = boundary.velocity[0] * nx - boundary.outer_omega * body.y[i]
        body.vy[i] = boundary.velocity[0] * ny + boundary.outer_omega * body.x[i]
    return abs(way)
