"""A periodic cell: sheared by Lees-Edwards conditions (Lees & Edwards, J. Phys. C 5, 1921, 1972), stretched, or held at a pressure.

Velocities are those seen from the laboratory: an image has the velocity of its original plus that of the lattice vector between them.
`stretch_rate` = d(ln width)/dt, d(ln height)/dt prescribes the sides; opposite rates are pure shear. A side with a `pressure` follows its
normal stress, d(ln side)/dt = (sigma - pressure) / viscosity, which relaxes without ringing; there the grains are carried along affinely,
and dashpots do not feel it, so that no damping of the contacts can upset the control. sigma is the stress of the contacts and of the
agitation, sum m c^2 / area with the velocities c relative to the shear flow and to the mean.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from anisogran.compiled import kernel
from anisogran.dem.rows import INVERSE_MASS
from anisogran.outcome import InputError, checked

NONE = -1.0  # stands for "no pressure" in the kernel: a pressure is positive


class Cell(NamedTuple):
    """The lattice at one instant, and the affine motion since the last neighbour list."""

    width: float
    height: float
    offset: float  # of the image above, to the right
    column_speed: float  # of the image to the right, to the right
    row_speed: float  # of the image above, upwards
    shear_speed: float  # of the image above, to the right
    inverse_width: float  # a product is several times faster than a quotient, and this is needed for every pair
    inverse_height: float
    strain: float  # shear strain since the list was built
    stretch_x: float  # ratio of widths, of heights since then
    stretch_y: float
    growth_x: float  # strain of the last step by the pressures
    growth_y: float


class PeriodicState(NamedTuple):
    """lattice = [width, height, offset, strain, stretch_x, stretch_y, growth_x, growth_y]; see Cell.

    virial = sums over the contacts of f_x branch_x and f_y branch_y, left there by the force loop; None where no pressure is held.
    """

    lattice: np.ndarray
    virial: np.ndarray | None
    shear_rate: float
    stretch_rate_x: float
    stretch_rate_y: float
    pressure_x: float
    pressure_y: float
    viscosity: float


@dataclass(frozen=True)
class Periodic:
    """Periodic cell of width by height (m): `shear_rate` (1/s), `stretch_rate` of (width, height) (1/s), `pressure` on (x, y) (N/m).

    A side is free and relaxes with `viscosity` (N s/m) if it has a pressure, else its logarithm changes at its stretch rate; one
    number for `pressure` holds both sides, None none. A cell is sheared or stretched, not both. `offset` (m): how far the image above is
    to the right at the start, as a cell that has been sheared leaves it.
    A run stops where the cell gets narrower or lower than four of the largest radii and two skins: contacts would meet their own images.
    Raises InputError for values out of bounds.
    """

    width: float
    height: float
    shear_rate: float = 0.0
    pressure: float | tuple | None = None
    viscosity: float | None = None
    stretch_rate: tuple = (0.0, 0.0)
    offset: float = 0.0
    walls = 0

    def __post_init__(self):
        checked("Periodic", "width", self.width, above=0, unit="m")
        checked("Periodic", "height", self.height, above=0, unit="m")
        checked("Periodic", "shear_rate", self.shear_rate, unit="1/s")
        checked("Periodic", "offset", self.offset, unit="m")
        for side, rate, pressure in zip("xy", self._pair("stretch_rate"), self._pair("pressure"), strict=True):
            checked("Periodic", f"stretch_rate ({side})", rate, unit="1/s")
            if pressure is not None:
                checked("Periodic", f"pressure ({side})", pressure, above=0, unit="N/m")
                checked("Periodic", "viscosity", self.viscosity, above=0, unit="N s/m")
                if rate:
                    raise InputError(
                        f"Periodic: the side along {side} has both stretch_rate = {rate:g} 1/s and pressure = {pressure:g} N/m"
                    )
        if self.shear_rate and any(self._pair("stretch_rate")):
            raise InputError(f"Periodic: shear_rate = {self.shear_rate:g} and stretch_rate = {self.stretch_rate} exclude each other")

    def _pair(self, name):
        """The value for x and for y."""
        value = getattr(self, name)
        if isinstance(value, (list, tuple, np.ndarray)):
            if len(value) != 2:
                raise InputError(f"Periodic: {name} = {value} must have two entries, for x and for y")
            return tuple(value)
        return value, value

    def state(self):
        """What the kernel needs; the arrays change while it runs."""
        pressures = self._pair("pressure")
        controlled = any(pressure is not None for pressure in pressures)
        return PeriodicState(
            np.array([self.width, self.height, self.offset % self.width, 0.0, 1.0, 1.0, 0.0, 0.0]),
            np.zeros(2) if controlled else None,
            float(self.shear_rate),
            *(float(rate) for rate in self._pair("stretch_rate")),
            *(NONE if pressure is None else float(pressure) for pressure in pressures),
            float(self.viscosity) if controlled else 1.0,
        )

    def pressures(self):
        """The pressures that it holds, in N/m."""
        return tuple(pressure for pressure in self._pair("pressure") if pressure is not None)

    def extent(self, state):
        """What a Snapshot says of it: lattice vectors as rows, and how fast images move by them; a pressed side carries them affinely."""
        cell = lattice(state)
        vectors = np.array([[cell.width, 0.0], [cell.offset, cell.height]])
        return {"cell": vectors, "cell_velocity": np.array([[cell.column_speed, 0.0], [cell.shear_speed, cell.row_speed]])}


def lattice(boundary):
    """The cell as the pair kernel wants it."""
    box = boundary.lattice
    return Cell(
        box[0], box[1], box[2], boundary.stretch_rate_x * box[0], boundary.stretch_rate_y * box[1], boundary.shear_rate * box[1],
        1.0 / box[0], 1.0 / box[1], box[3], box[4], box[5], box[6], box[7],
    )  # fmt: skip


def stress_sums(boundary):
    """The array that takes the virial, or None where nobody asks for it."""
    return boundary.virial


def settle(boundary, body):
    """Puts every grain back into the cell, with the velocity that belongs there, and counts the affine motion from here."""
    box = boundary.lattice
    for i in range(body.x.size):
        rows = math.floor(body.y[i] / box[1])
        body.y[i] -= rows * box[1]
        body.x[i] -= rows * box[2]
        body.vx[i] -= rows * boundary.shear_rate * box[1]
        body.vy[i] -= rows * boundary.stretch_rate_y * box[1]
        columns = math.floor(body.x[i] / box[0])
        body.x[i] -= columns * box[0]
        body.vx[i] -= columns * boundary.stretch_rate_x * box[0]
    box[3] = 0.0
    box[4] = 1.0
    box[5] = 1.0


@kernel
def agitation(body, velocity, rate, place):
    """Sum of m c^2 in N m over all grains, c = velocity - rate * place less its mean by mass."""
    mass = 0.0
    momentum = 0.0
    twice_energy = 0.0
    for i in range(velocity.size):
        m = 1.0 / body.rows[i, INVERSE_MASS]
        c = velocity[i] - rate * place[i]
        mass += m
        momentum += m * c
        twice_energy += m * c * c
    return twice_energy - momentum * momentum / mass


@kernel
def pressed(virial, box, body, shear_rate, pressure_x, pressure_y, viscosity, dt):
    """Ratios of the sides after a step under pressure, 1 for a side without one; the grains are carried along."""
    stretch_x = 1.0
    stretch_y = 1.0
    if virial is not None:
        area = box[0] * box[1]
        if pressure_x > 0.0:
            stress = (virial[0] + agitation(body, body.vx, shear_rate, body.y)) / area
            stretch_x += dt * (stress - pressure_x) / viscosity
            for i in range(body.x.size):
                body.x[i] *= stretch_x
        if pressure_y > 0.0:
            stress = (virial[1] + agitation(body, body.vy, 0.0, body.x)) / area
            stretch_y += dt * (stress - pressure_y) / viscosity
            for i in range(body.y.size):
                body.y[i] *= stretch_y
    return stretch_x, stretch_y


def advance(boundary, body, spin, movable, reach, time, dt):
    """Slides the image above and changes the sides; two grains `reach` apart approach affinely by the result."""
    box = boundary.lattice
    stretch_x, stretch_y = pressed(
        boundary.virial, box, body, boundary.shear_rate, boundary.pressure_x, boundary.pressure_y, boundary.viscosity, dt
    )
    box[6] = stretch_x - 1.0
    box[7] = stretch_y - 1.0
    stretch_x *= math.exp(dt * boundary.stretch_rate_x)
    stretch_y *= math.exp(dt * boundary.stretch_rate_y)
    strain = dt * boundary.shear_rate
    box[2] *= stretch_x
    box[0] *= stretch_x
    box[1] *= stretch_y
    box[2] += strain * box[1]
    box[2] -= math.floor(box[2] / box[0]) * box[0]
    box[3] += strain
    box[4] *= stretch_x
    box[5] *= stretch_y
    return (abs(strain) + abs(stretch_x - 1.0) + abs(stretch_y - 1.0)) * reach
