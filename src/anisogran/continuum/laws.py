"""Laws of dense granular flow at a point: from rate of deformation, pressure and fluidity to stress.

A law is a small record with the members of LocalMuI: `fields` (its unknowns), its floors, `layer`, `elements`,
`positive`, `stress` and `rate`; with a fluidity, also those of Nonlocal. They work on whole arrays in the reduced units of
`Setting`; stress and fluidity must be analytic (no abs, no comparisons), since the tangent of the solver is their derivative by a
complex step, exact to rounding for every law.

Stress is compression positive, sigma = p 1 - 2 eta D with D the deviator of the rate of deformation, so that sigma_rphi > 0
where the angular velocity falls outward. The inertial number is I = shear_rate sqrt(grain mass / p) (da Cruz et al. 2005,
Phys. Rev. E 72, 021309; cited from memory) and the friction law linear, mu(I) = mu_s + b I.
"""

from dataclasses import dataclass
from math import sqrt, tanh

import numpy as np

from anisogran.continuum.grading import elements_for
from anisogran.outcome import InputError, checked


def shear_rate(point, floor=0.0):
    """2 |D_dev|, the difference of the eigenvalues of D; in simple shear the engineering rate |gamma|."""
    return np.sqrt((point.d_rr - point.d_ff) ** 2 + point.gamma**2 + floor**2)


def viscous(point, eta):
    """sigma_rr, sigma_phiphi, sigma_rphi of p 1 - 2 eta D_dev."""
    difference = eta * (point.d_rr - point.d_ff)
    return point.p - difference, point.p + difference, -eta * point.gamma


@dataclass(frozen=True)
class LocalMuI:
    """Local friction law mu(I) = mu_s + b I, stress coaxial with the rate of deformation.

    It flows only where the stress ratio exceeds mu_s: the layer at the inner ring shrinks like the square root of the wall speed,
    there is no creep, so it cannot describe a slow ring cell; it is here as base line and to verify the solver. The shear rate is
    regularised as sqrt(rate^2 + floor^2). A steady axisymmetric flow is a well-posed problem at every I; a time-dependent
    incompressible flow in two dimensions is well-posed only if 4n^2 - 4n + mu^2 (1 - n/2)^2 <= 0 with n = I mu'/mu (Barker
    et al. 2015, J. Fluid Mech. 779; formula cited at second hand), which a slow cell (I < about 0.004) violates.

    Raises InputError if mu_s or b is not above 0.
    """

    mu_s: float
    b: float

    fields = ("u_r", "u_phi", "p")
    first_floor, floor_factor, floor = 1.0, 0.1, 1e-4

    def __post_init__(self):
        checked("LocalMuI", "mu_s", self.mu_s, above=0.0)
        checked("LocalMuI", "b", self.b, above=0.0)

    def layer(self, setting):
        """Thickness of the flowing layer in the limit of slow flow, reduced: sqrt(b I R_i / mu_s)."""
        return sqrt(self.b * setting.inertial * setting.inner / self.mu_s)

    def elements(self, layers, setting):
        """The default number: from 32 on, the error at the default rate floor (4e-4 to 8e-4 of v_phi) hardly falls."""
        return 32

    def positive(self, point, setting):
        """What must stay above 0 at every point: the pressure."""
        return (point.p,)

    def stress(self, point, setting):
        rate = shear_rate(point, setting.rate_floor)
        return viscous(point, self.mu_s * point.p / rate + self.b * setting.inertial * np.sqrt(point.p))

    def rate(self, point, setting, deviator):
        """The shear rate, where the stress deviator (half the difference of the principal stresses) is known: 2 |D_dev|."""
        return shear_rate(point)


@dataclass(frozen=True)
class Nonlocal:
    """Nonlocal granular fluidity, steady, with the linear friction law (Kamrin and Koval 2012, Phys. Rev. Lett. 108, 178301).

    In their form xi^2 lap g = g - g_loc with xi = A d / sqrt|mu - mu_s|. With mu = shear_rate/g the singular length is gone:

        mu_s g - A^2 d^2 lap g = shear_rate (1 - b sqrt(m/p) g),      stress = p 1 - (2 p / g) D_dev,

    (derived here; without lap g it is mu = mu_s + b I). `amplitude` is A, in grain diameters. The value of g at the walls is not
    settled in the literature: `wall=None` puts dg/dr = 0 at both rings; a number kappa puts dg/dr = -(kappa/d) g at the inner
    ring (kappa > 0: the wall makes the grains beside it more fluid; kappa < 0: it calms them) and dg/dr = 0 at the outer one.

    Raises InputError if mu_s or amplitude is not above 0, b is below 0, or kappa is sqrt(mu_s)/amplitude or more, at which a wall
    at rest would fluidise the grains. Grains at rest keep the fluidity rate_floor |V|/gap in the stress (not in the equation
    above): far from the ring g falls below any rounding, and its inverse, the viscosity, would have no limit.
    """

    mu_s: float
    b: float
    amplitude: float
    wall: float | None = None

    fields = ("u_r", "u_phi", "p", "g")
    first_floor, floor_factor, floor = 1e-5, 1e-3, 1e-8

    def __post_init__(self):
        mu_s = checked("Nonlocal", "mu_s", self.mu_s, above=0.0)
        checked("Nonlocal", "b", self.b, at_least=0.0)
        amplitude = checked("Nonlocal", "amplitude", self.amplitude, above=0.0, unit="grain diameters")
        if self.wall is not None:
            checked("Nonlocal", "wall", self.wall, below=sqrt(mu_s) / amplitude)

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
        source = shear_rate(point) * (1.0 - self.b * setting.inertial * point.g / np.sqrt(point.p))
        diffusivity = (self.amplitude * setting.diameter) ** 2
        return self.mu_s * point.g - source, diffusivity * point.g_r, diffusivity * point.g_f

    def wall_exchange(self, setting):
        """The factor of g(R_i) in the residual at the inner ring: A^2 d^2 dg/dr = -A^2 d kappa g enters as -R_i A^2 d kappa.

        Raises InputError if kappa d is tanh(gap/length)/length or more: the ring would fluidise a gap this thin even at rest.
        """
        if self.wall is None:
            return 0.0
        limit = tanh(1.0 / self.length(setting)) * setting.diameter / self.length(setting)
        checked("RingFlow", "law.wall", self.wall, below=limit)
        return -setting.inner * self.amplitude**2 * setting.diameter * self.wall


def check_law(law):
    """The law itself; InputError if it has not what the solver needs."""
    if isinstance(law, type) or not all(hasattr(law, name) for name in ("fields", "stress", "layer", "floor")):
        raise InputError(f"RingFlow: law = {law!r} is no law; give LocalMuI(mu_s, b) or Nonlocal(mu_s, b, amplitude)")
    return law
