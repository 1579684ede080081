"""No boundary at all: grains in free space."""

from dataclasses import dataclass
from typing import NamedTuple


class OpenState(NamedTuple):
    """A kernel needs a type."""

    unused: float


@dataclass(frozen=True)
class Open:
    """Grains in free space."""

    walls = 0

    def state(self):
        return OpenState(0.0)

    def pressures(self):
        """The pressures that it holds, in N/m."""
        return ()

    def extent(self, state):
        """Lattice vectors and volume as the averages want them: neither."""
        return None, None


def advance(boundary, body, spin, movable, reach, time, dt):
    """Nothing moves."""
    return 0.0
