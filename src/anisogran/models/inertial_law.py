"""The mu(I) law at a point whose volume is given: pressure and friction follow from area fraction and rate (Bagnold's scaling).

    I = (phi_max - phi)/slope          the dilatancy phi(I) = phi_max - slope I, turned round
    sigma_V = m (rate/I)^2,  t = mu(I) sigma_V d eps/|d eps|,   mu(I) = mu_s + (mu_d - mu_s)/(1 + I0/I) + b I

with rate = 2 |d eps|/dt and I = rate sqrt(m/sigma_V) (da Cruz et al., Phys. Rev. E 72, 021309 (2005), recalled; mu(I) after Jop,
Forterre & Pouliquen, Nature 441, 727 (2006), recalled; `b` is the linear law of discs). A law without memory but for the area fraction:
at rest it has no stress, and above phi_max it is jammed and has none either, which is an outcome. Compression positive, half/half.
"""

from typing import NamedTuple

import numpy as np

from anisogran.compiled import subkernel
from anisogran.models.first_order import inverse, size
from anisogran.models.mu_of_i import saturating
from anisogran.models.point import EMPTY, JAMMED, OK, Point
from anisogran.outcome import checked

_saturating = subkernel(saturating)  # the one formula of a point, a curve and all quadrature points


class InertialParameters(NamedTuple):
    """mu_s, mu_d, I0, b of the friction, phi_max and slope of the area fraction (no units), mean grain mass in kg."""

    mu_s: float
    mu_d: float
    I0: float
    b: float
    phi_max: float
    slope: float
    grain_mass: float


Parameters = InertialParameters
KEYS = {  # unit, meaning, example
    "mu_s": ("1", "friction at rest, 0 <= mu_s < 1", 0.28),
    "phi_max": ("1", "area fraction at rest, between 0 and 1", 0.82),
    "slope": ("1", "phi = phi_max - slope I, above 0", 0.3),
    "grain_mass": ("kg", "mean mass of a grain, above 0", 1e-5),
    "b": ("1", "mu grows by b I, at least 0", 1.1),
    "mu_d": ("1", "friction of fast flow, from mu_s to 1; default mu_s", 0.28),
    "I0": ("1", "inertial number of the change from mu_s to mu_d, above 0", 1.0),
}
STRESS_IS_STATE = False  # it follows from area fraction and rate
INTERNAL = ("area_fraction", None)


def checked_parameters(mu_s, phi_max, slope, grain_mass, b=0.0, mu_d=None, I0=1.0):
    """The `InertialParameters`; mu_d = None is the linear law mu_s + b I. InputError for values out of bounds."""
    where = "mu_of_I law"
    mu_s = checked(where, "mu_s", mu_s, at_least=0.0, below=1.0)
    return InertialParameters(
        mu_s,
        mu_s if mu_d is None else checked(where, "mu_d", mu_d, at_least=mu_s, below=1.0),
        checked(where, "I0", I0, above=0.0),
        checked(where, "b", b, at_least=0.0),
        checked(where, "phi_max", phi_max, above=0.0, below=1.0),
        checked(where, "slope", slope, above=0.0),
        checked(where, "grain_mass", grain_mass, above=0.0, unit="kg"),
    )


def rate(p, point, increment):
    """The change of the state for an increment: the area fraction, since mass is conserved."""
    none = 0.0 * point.sigma_V
    return Point(none, none, none, 2.0 * point.x * increment.eps_V, none)


def midpoint(p, point, increment):
    """(state, outcome) after an increment: the area fraction, exact."""
    after = point.x * np.exp(2.0 * increment.eps_V)
    return Point(point.sigma_V, point.sigma_1, point.sigma_2, after, point.y), OK


@subkernel
def _outcome(p, area_fraction):
    if not area_fraction > 0.0:
        return EMPTY
    return JAMMED if area_fraction >= p.phi_max.real else OK


def trouble(p, point):
    """The outcome that a state stands for by itself."""
    return _outcome(p, point.x.real)


def check_start(p, point):
    """Raises InputError if a path cannot start from this state."""
    checked("mu_of_I law: start", "area_fraction", point.x, above=0.0, below=p.phi_max)


def stressed(p, point, increment):
    """(the state with its stress, outcome): that of the mean rate of the increment at the area fraction of the state."""
    code = _outcome(p, point.x.real)
    if code != OK:
        return point, code
    I = (p.phi_max - point.x) / p.slope
    mu = _saturating(I, p.mu_s, p.mu_d, p.I0) + p.b * I
    length = size(increment.eps_1, increment.eps_2)
    over_rate = p.grain_mass * (2.0 * inverse(I * increment.time)) ** 2  # sigma_V / |d eps|^2
    shear = mu * over_rate * length
    return Point(over_rate * length * length, shear * increment.eps_1, shear * increment.eps_2, point.x, point.y), OK
