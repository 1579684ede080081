"""A law written from scratch, for exact flows: what a new law needs is all in this class."""

from dataclasses import dataclass

import numpy as np

from anisogran.continuum.laws.coaxial import shear_rate, viscous


@dataclass(frozen=True)
class Newtonian:
    """A Newtonian fluid; the viscosity is reduced, in P gap/(speed of the faster ring)."""

    viscosity: float
    fields = ("u_r", "u_phi", "p")
    first_floor, floor_factor, floor = 1e-4, 0.1, 1e-4
    valid_to = np.inf

    def layer(self, setting):
        return 1.0

    def elements(self, layers, setting):
        return 32

    def positive(self, point, setting):
        return (point.p,)

    def stress(self, point, setting):
        return viscous(point, self.viscosity)

    def rate(self, point, setting, deviator):
        return shear_rate(point)
