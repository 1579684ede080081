"""A rectangular box of four flat walls, each with its own motion and its own sliding speed; smooth, or rough with grains glued on.

Glued grains are the last ones of the simulation, in the order of the walls: left, right, bottom, top. They have the velocity of their
wall and do not turn, and what presses on them presses on the wall. A wall that slides stays where it is, but its glued grains go along
and leave the box at its end, so a run must be shorter than the reserve of glued grains on either side.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from anisogran.compiled import kernel, specialised
from anisogran.dem.boundaries.driven import coast
from anisogran.dem.boundaries.motion import Fixed, move
from anisogran.outcome import InputError, checked

NAMES = ("left", "right", "bottom", "top")


class BoxState(NamedTuple):
    """Walls left, right, bottom, top: coordinate, velocity, outward force of the grains, force along the wall; and the motions."""

    position: np.ndarray
    velocity: np.ndarray
    force: np.ndarray
    traction: np.ndarray
    sliding: np.ndarray  # speed along the wall
    glued: np.ndarray  # (5,) of the glued grains, the first one of each wall, and their number
    left: Any
    right: Any
    bottom: Any
    top: Any


@dataclass(frozen=True)
class Box:
    """The box 0..width by 0..height (m), whose walls move as told (default: fixed).

    `sliding`: speed of (left, right, bottom, top) along the wall in m/s, left and right along +y, bottom and top along +x, felt through
    `wall_friction` and by the glued grains. `glued`: how many of the last grains ride on each wall; the grains must then have
    driven = sum(glued). Without glued grains, driven ones keep their velocity. Raises InputError for values out of bounds.
    """

    width: float
    height: float
    left: Any = Fixed()
    right: Any = Fixed()
    bottom: Any = Fixed()
    top: Any = Fixed()
    sliding: tuple = (0.0, 0.0, 0.0, 0.0)
    glued: tuple = (0, 0, 0, 0)
    walls = 4

    def __post_init__(self):
        checked("Box", "width", self.width, above=0, unit="m")
        checked("Box", "height", self.height, above=0, unit="m")
        for name in NAMES:
            if not hasattr(getattr(self, name), "parameters"):
                raise InputError(f"Box: {name} = {getattr(self, name)!r} is no motion (Fixed, Cosine, Path, Pressure)")
        for name in ("sliding", "glued"):
            if np.shape(getattr(self, name)) != (4,):
                raise InputError(f"Box: {name} = {getattr(self, name)!r} must have four entries, for left, right, bottom, top")
        for wall, speed, count in zip(NAMES, self.sliding, self.glued, strict=True):
            checked("Box", f"sliding ({wall})", speed, unit="m/s")
            if checked("Box", f"glued ({wall})", count, at_least=0) != int(count):
                raise InputError(f"Box: glued ({wall}) = {count} must be a whole number of grains")

    def state(self):
        """What the kernel needs; the arrays change while it runs."""
        position = np.array([0.0, self.width, 0.0, self.height])
        motions = [wall.parameters() for wall in (self.left, self.right, self.bottom, self.top)]
        glued = np.append(0, np.cumsum(self.glued)).astype(np.int64)
        return BoxState(position, np.zeros(4), np.zeros(4), np.zeros(4), np.array(self.sliding, float), glued, *motions)

    def pressures(self):
        """The pressures that it holds, in N/m."""
        return tuple(m.pressure for m in (self.left, self.right, self.bottom, self.top) if hasattr(m, "pressure"))

    def held(self, state, body, movable):
        """(name, present pressure, pressure it should have) of each wall under a pressure, N/m."""
        left, right, bottom, top = state.position
        length = (top - bottom, top - bottom, right - left, right - left)
        motions = enumerate((self.left, self.right, self.bottom, self.top))
        return [
            (f"{NAMES[wall]} wall", float(thrust(state, body, wall) / length[wall]), motion.pressure)
            for wall, motion in motions
            if hasattr(motion, "pressure")
        ]

    def extent(self, state):
        """What a Snapshot says of it: the present area of the box."""
        left, right, bottom, top = state.position
        return {"volume": float((right - left) * (top - bottom))}


def touch(boundary, wall, x, y, radius):
    """Overlap of a grain with a wall, normal from the grain to the wall, velocity of the wall at the contact."""
    sense = 1.0 if wall % 2 == 1 else -1.0
    across = wall < 2
    coordinate = x if across else y
    overlap = radius - sense * (boundary.position[wall] - coordinate)
    speed = boundary.velocity[wall]
    along = boundary.sliding[wall]
    return overlap, sense if across else 0.0, 0.0 if across else sense, speed if across else along, along if across else speed


def _thrust(boundary, body, wall):
    first = body.x.size - boundary.glued[4]
    push = 0.0
    for i in range(first + boundary.glued[wall], first + boundary.glued[wall + 1]):
        push += body.fx[i] if wall < 2 else body.fy[i]
    return boundary.force[wall] + (push if wall % 2 == 1 else -push)


thrust = specialised({BoxState: _thrust})  # outward force of the grains on a wall: directly, and through the grains glued to it


@kernel
def ride(body, spin, begin, end, across, way, speed, along, dt):
    """Moves the grains begin .. end with their wall: by `way` with `speed` across it, with the speed `along` along it."""
    for i in range(begin, end):
        body.x[i] += way if across else dt * along
        body.y[i] += dt * along if across else way
        body.vx[i] = speed if across else along
        body.vy[i] = along if across else speed
        if spin is not None:
            spin[i] = 0.0


def advance(boundary, body, spin, movable, reach, time, dt):
    """Moves the walls by one step, to `time`; the pressure of a wall acts on its present length. Returns the longest way of a wall."""
    p = boundary.position
    v = boundary.velocity
    height = p[3] - p[2]
    width = p[1] - p[0]
    left, right, bottom, top = p[0], p[1], p[2], p[3]
    p[0], v[0] = move(boundary.left, left, v[0], thrust(boundary, body, 0), height, -1.0, time, dt)
    p[1], v[1] = move(boundary.right, right, v[1], thrust(boundary, body, 1), height, 1.0, time, dt)
    p[2], v[2] = move(boundary.bottom, bottom, v[2], thrust(boundary, body, 2), width, -1.0, time, dt)
    p[3], v[3] = move(boundary.top, top, v[3], thrust(boundary, body, 3), width, 1.0, time, dt)
    ways = (p[0] - left, p[1] - right, p[2] - bottom, p[3] - top)
    first = body.x.size - boundary.glued[4]
    coast(body, movable, first, dt)
    for wall in range(4):
        begin, end = first + boundary.glued[wall], first + boundary.glued[wall + 1]
        ride(body, spin, begin, end, wall < 2, ways[wall], v[wall], boundary.sliding[wall], dt)
    return max(abs(ways[0]), abs(ways[1]), abs(ways[2]), abs(ways[3]))
