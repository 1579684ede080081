"""The nonlocal law: a field of fluidity that flow lends to its surroundings."""

from dataclasses import dataclass
from math import sqrt, tanh

import numpy as np

from anisogran.continuum.grading import elements_for
from anisogran.continuum.laws.coaxial import shear_rate, viscous
from anisogran.keys import check_keys, key
from anisogran.models import LINEAR_LIMIT, mu_linear
from anisogran.outcome import checked


@dataclass(frozen=True)
class Nonlocal:
    """Nonlocal granular fluidity, steady, with the linear friction law (Kamrin and Koval 2012, Phys. Rev. Lett. 108, 178301).

    In their form xi^2 lap g = g - g_loc with xi = A d / sqrt|mu - mu_s|. With mu = shear_rate/g the singular length is gone:

        mu(I) g - A^2 d^2 lap g = shear_rate,      stress = p 1 - (2 p / g) D_dev,      mu(I) = mu_s + b I

    (derived here; linear in g, since I is that of the shear rate). `amplitude` is A, in grain diameters. The value of g at the walls is not
    settled in the literature: `wall=None` puts dg/dr = 0 at both rings; a number kappa puts dg/dr = -(kappa/d) g at the inner
    ring (kappa > 0: the wall makes the grains beside it more fluid; kappa < 0: it calms them) and dg/dr = 0 at the outer one.

    Raises InputError if mu_s or amplitude is not above 0, b is below 0, or kappa is sqrt(mu_s)/amplitude or more, at which a wall
    at rest would fluidise the grains. Grains at rest keep the fluidity rate_floor |V|/gap in the stress (not in the equation
    above): far from the ring g falls below any rounding, and its inverse, the viscosity, would have no limit.
    """

    mu_s: float = key("1", "friction of slow flow", above=0.0, example=0.26)
    b: float = key("1", "mu grows by b I", at_least=0.0, example=1.0)
    amplitude: float = key("grain diameters", "how far the flow acts on its surroundings", above=0.0, example=0.9)
    wall: float | None = key("1", "-d/g dg/dr at the inner ring; left out: 0, and 0 always at the outer ring", None, example=0.2)

    kind = "nonlocal"
    valid_to = LINEAR_LIMIT
    fields = ("u_r", "u_phi", "p", "g")
    first_floor, floor_factor, floor = 1e-5, 1e-3, 1e-8

    def __post_init__(self):
        check_keys(self)
        if self.wall is not None:
            checked("Nonlocal", "wall", self.wall, below=sqrt(self.mu_s) / self.amplitude)

    def friction(self, I):
        """mu(I) of homogeneous flow, shape of I, real or complex."""
        return mu_linear(I, self.mu_s, self.b)

    def length(self, setting):
        """Decay length A d / sqrt(mu_s) of the fluidity in grains at rest, reduced."""
        return self.amplitude * setting.diameter / sqrt(self.mu_s)

    def layer(self, setting):
        """Two decay lengths: the width of a slow flow, reduced."""
        return 2.0 * self.length(setting)

    def elements(self, layers, setting):
        """The default number: 64 (error 4e-6 of v_phi for A = 0.9), more if an element would exceed two decay lengths."""
        return max(64, elements_for(2.0 * self.length(setting), layers))

    def positive(self, point, setting):
        """What must stay above 0 at every point: pressure and fluidity."""
        return point.p, point.g + setting.rate_floor

    def stress(self, point, setting):
        return viscous(point, point.p / (point.g + setting.rate_floor))

    def rate(self, point, setting, deviator):
        """The shear rate where the stress deviator is known, from the fluidity: more exact than the slope of the velocity."""
        return (point.g + setting.rate_floor) * deviator / point.p

    def fluidity(self, point, setting):
        """What is paired with a variation of g and of its slopes along r and phi in the weak form of the equation above."""
        rate = shear_rate(point)
        inertial_number = setting.inertial * rate / np.sqrt(point.p)
        diffusivity = (self.amplitude * setting.diameter) ** 2
        return self.friction(inertial_number) * point.g - rate, diffusivity * point.g_r, diffusivity * point.g_f

    def wall_exchange(self, setting):
        """The factor of g(R_i) in the residual at the inner ring: A^2 d^2 dg/dr = -A^2 d kappa g enters as -R_i A^2 d kappa.

        Raises InputError if kappa d is tanh(gap/length)/length or more: the ring would fluidise a gap this thin even at rest.
        """
        if self.wall is None:
            return 0.0
        limit = tanh(1.0 / self.length(setting)) * setting.diameter / self.length(setting)
        checked("RingFlow", "law.wall", self.wall, below=limit)
        return -setting.inner * self.amplitude**2 * setting.diameter * self.wall
