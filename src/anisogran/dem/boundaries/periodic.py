"""A periodic cell sheared by Lees-Edwards conditions (Lees & Edwards, J. Phys. C 5, 1921, 1972), of given volume or given pressure.

The image above the cell moves with shear_rate * height to the right. Under pressure control the height follows the vertical stress:
d(ln height)/dt = (sigma_yy - pressure) / viscosity, which relaxes without ringing; the grains are carried along affinely.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from anisogran.outcome import checked


class Cell(NamedTuple):
    """The lattice at one instant: width, height, offset of the image above and its relative velocity; affine motion since the last list."""

    width: float
    height: float
    offset: float
    shear_speed: float
    strain: float  # shear strain
    stretch: float  # ratio of heights
    virial: np.ndarray  # (1,) sum over the contacts of f_y branch_y, left here by the force loop


class PeriodicState(NamedTuple):
    """What changes: lattice = [width, height, offset, strain and stretch since the list was built], virial = sum of f_y branch_y.

    A negative pressure means fixed volume.
    """

    lattice: np.ndarray
    virial: np.ndarray
    shear_rate: float
    pressure: float
    viscosity: float


@dataclass(frozen=True)
class Periodic:
    """Periodic cell of width by height (m), sheared at shear_rate (1/s).

    With a `pressure` (N/m) the height is free and relaxes with `viscosity` (N s/m); without one the volume is fixed.
    A run stops where the cell gets narrower or lower than four of the largest radii and two skins: contacts would meet their own images.
    Raises InputError for values out of bounds.
    """

    width: float
    height: float
    shear_rate: float = 0.0
    pressure: float | None = None
    viscosity: float | None = None
    walls = 0

    def __post_init__(self):
        checked("Periodic", "width", self.width, above=0, unit="m")
        checked("Periodic", "height", self.height, above=0, unit="m")
        checked("Periodic", "shear_rate", self.shear_rate, unit="1/s")
        if self.pressure is not None:
            checked("Periodic", "pressure", self.pressure, above=0, unit="N/m")
            checked("Periodic", "viscosity", self.viscosity, above=0, unit="N s/m")

    def state(self):
        controlled = self.pressure is not None
        return PeriodicState(
            np.array([self.width, self.height, 0.0, 0.0, 1.0]),
            np.zeros(1),
            float(self.shear_rate),
            float(self.pressure) if controlled else -1.0,
            float(self.viscosity) if controlled else 1.0,
        )

    def extent(self, state):
        """Lattice vectors as rows, and the present area of the cell."""
        width, height, offset = state.lattice[:3]
        return np.array([[width, 0.0], [offset, height]]), float(width * height)


def lattice(boundary):
    """The cell as the pair kernel wants it."""
    box = boundary.lattice
    return Cell(box[0], box[1], box[2], boundary.shear_rate * box[1], box[3], box[4], boundary.virial)


def settle(boundary, body):
    """Puts every grain back into the cell, with the velocity that belongs there, and counts the affine motion from here."""
    box = boundary.lattice
    for i in range(body.x.size):
        rows = math.floor(body.y[i] / box[1])
        body.y[i] -= rows * box[1]
        body.x[i] -= rows * box[2]
        body.vx[i] -= rows * boundary.shear_rate * box[1]
        body.x[i] -= math.floor(body.x[i] / box[0]) * box[0]
    box[3] = 0.0
    box[4] = 1.0


def advance(boundary, body, spin, movable, reach, time, dt):
    """Slides the image above, and lets the height follow the vertical stress; two grains `reach` apart approach affinely by the result."""
    box = boundary.lattice
    strain = dt * boundary.shear_rate
    stretch = 1.0
    if boundary.pressure > 0.0:
        excess = boundary.virial[0] / (box[0] * box[1]) - boundary.pressure
        stretch += dt * excess / boundary.viscosity
        box[1] *= stretch
        for i in range(body.y.size):
            body.y[i] *= stretch
    box[2] += strain * box[1]
    box[2] -= math.floor(box[2] / box[0]) * box[0]
    box[3] += strain
    box[4] *= stretch
    return (abs(strain) + abs(stretch - 1.0)) * reach
