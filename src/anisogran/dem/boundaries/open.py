"""No boundary at all: grains in free space."""

from dataclasses import dataclass
from typing import NamedTuple

from anisogran.dem.boundaries.driven import coast


class OpenState(NamedTuple):
    """A kernel needs a type."""

    unused: float


@dataclass(frozen=True)
class Open:
    """Grains in free space; driven ones move on with the velocity they are given."""

    walls = 0

    def state(self):
        return OpenState(0.0)

    def pressures(self):
        """The pressures that it holds, in N/m."""
        return ()

    def extent(self, state):
        """What a Snapshot says of it: nothing."""
        return {}


def advance(boundary, body, spin, movable, reach, time, dt):
    """Moves the driven grains; there is no wall to move."""
    coast(body, movable, body.x.size, dt)
    return 0.0
