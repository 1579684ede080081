"""A rectangular box of four smooth flat walls, each with its own motion."""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from anisogran.dem.boundaries.motion import Fixed, move
from anisogran.outcome import InputError, checked

NAMES = ("left", "right", "bottom", "top")


class BoxState(NamedTuple):
    """Walls left, right, bottom, top: coordinate, velocity, outward force of the grains, force along the wall; and the motions."""

    position: np.ndarray
    velocity: np.ndarray
    force: np.ndarray
    traction: np.ndarray
    left: Any
    right: Any
    bottom: Any
    top: Any


@dataclass(frozen=True)
class Box:
    """The box 0..width by 0..height (m), whose walls move as told (default: fixed). Raises InputError for a box of no size."""

    width: float
    height: float
    left: Any = Fixed()
    right: Any = Fixed()
    bottom: Any = Fixed()
    top: Any = Fixed()
    walls = 4

    def __post_init__(self):
        checked("Box", "width", self.width, above=0, unit="m")
        checked("Box", "height", self.height, above=0, unit="m")
        for name in ("left", "right", "bottom", "top"):
            if not hasattr(getattr(self, name), "parameters"):
                raise InputError(f"Box: {name} = {getattr(self, name)!r} is no motion (Fixed, Cosine, Path, Pressure)")

    def state(self):
        position = np.array([0.0, self.width, 0.0, self.height])
        motions = [wall.parameters() for wall in (self.left, self.right, self.bottom, self.top)]
        return BoxState(position, np.zeros(4), np.zeros(4), np.zeros(4), *motions)

    def pressures(self):
        """The pressures that it holds, in N/m."""
        return tuple(m.pressure for m in (self.left, self.right, self.bottom, self.top) if hasattr(m, "pressure"))

    def held(self, state, body, movable):
        """(name, present pressure, pressure it should have) of each wall under a pressure, N/m."""
        left, right, bottom, top = state.position
        length = (top - bottom, top - bottom, right - left, right - left)
        motions = enumerate((self.left, self.right, self.bottom, self.top))
        return [
            (f"{NAMES[wall]} wall", float(state.force[wall] / length[wall]), motion.pressure)
            for wall, motion in motions
            if hasattr(motion, "pressure")
        ]

    def extent(self, state):
        """Lattice vectors (none) and the present area of the box."""
        left, right, bottom, top = state.position
        return None, float((right - left) * (top - bottom))


def touch(boundary, wall, x, y, radius):
    """Overlap of a grain with a wall, normal from the grain to the wall, velocity of the wall at the contact."""
    sense = 1.0 if wall % 2 == 1 else -1.0
    across = wall < 2
    coordinate = x if across else y
    overlap = radius - sense * (boundary.position[wall] - coordinate)
    speed = boundary.velocity[wall]
    return overlap, sense if across else 0.0, 0.0 if across else sense, speed if across else 0.0, 0.0 if across else speed


def advance(boundary, body, spin, movable, reach, time, dt):
    """Moves the walls by one step, to `time`; the pressure of a wall acts on its present length. Returns the longest way of a wall."""
    p = boundary.position
    v = boundary.velocity
    f = boundary.force
    height = p[3] - p[2]
    width = p[1] - p[0]
    left, right, bottom, top = p[0], p[1], p[2], p[3]
    p[0], v[0] = move(boundary.left, left, v[0], f[0], height, -1.0, time, dt)
    p[1], v[1] = move(boundary.right, right, v[1], f[1], height, 1.0, time, dt)
    p[2], v[2] = move(boundary.bottom, bottom, v[2], f[2], width, -1.0, time, dt)
    p[3], v[3] = move(boundary.top, top, v[3], f[3], width, 1.0, time, dt)
    return max(abs(p[0] - left), abs(p[1] - right), abs(p[2] - bottom), abs(p[3] - top))
