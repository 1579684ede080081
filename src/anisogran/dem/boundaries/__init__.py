"""The boundaries, one file each, and the functions that the kernels specialise by the type of the boundary's state.

A boundary gives: `advance` (one step of its own motion); if it has walls, `touch` (geometry of one wall contact); and, if it is
periodic, `lattice`, `settle` (what is done before a new neighbour list) and `stress_sums` (where a pressure is held).
A new boundary is one new file and one line in each table.
"""

from anisogran.compiled import specialised
from anisogran.dem.boundaries import box, open, periodic, ring
from anisogran.dem.boundaries.box import Box
from anisogran.dem.boundaries.motion import Cosine, Fixed, Path, Pressure
from anisogran.dem.boundaries.open import Open
from anisogran.dem.boundaries.periodic import Periodic
from anisogran.dem.boundaries.ring import Ring

_ROOMS = {open.OpenState: open, box.BoxState: box, ring.RingState: ring, periodic.PeriodicState: periodic}


def _no_lattice(boundary):
    return None


def _no_stress_sums(boundary):
    return None


def _nothing_to_settle(boundary, body):
    return None


touch = specialised({state: room.touch for state, room in _ROOMS.items() if hasattr(room, "touch")})
advance = specialised({state: room.advance for state, room in _ROOMS.items()})
lattice = specialised({state: getattr(room, "lattice", _no_lattice) for state, room in _ROOMS.items()})
stress_sums = specialised({state: getattr(room, "stress_sums", _no_stress_sums) for state, room in _ROOMS.items()})
settle = specialised({state: getattr(room, "settle", _nothing_to_settle) for state, room in _ROOMS.items()})

__all__ = [
    "Box", "Cosine", "Fixed", "Open", "Path", "Periodic", "Pressure", "Ring", "advance", "lattice", "settle", "stress_sums", "touch",
]  # fmt: skip
