"""The elastic, Mohr-Coulomb plastic law in two dimensions, with a strength that falls from peak to residual.

    |t| <= sigma_V sin(phi) + c cos(phi)             the yield line, touched by the circle of stress
    d sigma_V = E (d eps_V + sin(psi) d kappa),      d t = 2G (d eps - d kappa t/|t|) + dw x t

kappa is the plastic deviatoric strain, psi the angle of dilatancy; sin(phi) and c cos(phi) fall exponentially from peak to residual with
kappa at the rate `beta`. The textbook baseline: no anisotropy, no memory but kappa. Compression positive, half/half; the stress axes are
those of the trial stress, which for an isotropic elasticity is exact.
"""

from math import cos, exp, hypot, pi, sin
from typing import NamedTuple

from anisogran.compiled import subkernel
from anisogran.models.first_order import exponential, inverse, size
from anisogran.models.point import APEX, BRITTLE, NOT_FINITE, OK, TENSION, Point, turned
from anisogran.outcome import InputError, checked

_ON_THE_LINE = 1e-10  # of the strength: rounding must not make a plastic state elastic again, and again


class PlasticParameters(NamedTuple):
    """E, two_G (half/half moduli); sines and c cos(phi) of peak and residual lines; sine of dilatancy; rate of the fall."""

    E: float
    two_G: float
    peak_sine: float
    peak_cohesion: float
    residual_sine: float
    residual_cohesion: float
    dilatancy_sine: float
    beta: float


Parameters = PlasticParameters
KEYS = {  # unit, meaning, example
    "E": ("N/m", "d sigma_V/d eps_V, above 0", 2e4),
    "G": ("N/m", "shear modulus, 2G is d sigma_D/d eps_D, above 0", 5e3),
    "phi": ("rad", "peak friction angle, 0 <= phi < pi/2", 0.45),
    "c": ("N/m", "peak cohesion, at least 0", 0.0),
    "phi_residual": ("rad", "residual friction angle, at most phi; default phi", 0.35),
    "c_residual": ("N/m", "residual cohesion, at most c; default c", 0.0),
    "psi": ("rad", "angle of dilatancy, at most phi_residual", 0.05),
    "beta": ("1", "rate of the fall of the strength with the plastic deviatoric strain, at least 0", 30.0),
}
STRESS_IS_STATE = True
INTERNAL = ("kappa", None)


def checked_parameters(E, G, phi, c=0.0, phi_residual=None, c_residual=None, psi=0.0, beta=0.0):
    """The `PlasticParameters`; angles in rad; residual values default to those of the peak.

    InputError unless E, G > 0, 0 <= residual <= peak, 0 <= phi < pi/2, psi in [0, phi_residual], beta >= 0.
    """
    where = "mohr_coulomb law"
    phi = checked(where, "phi", phi, at_least=0.0, below=0.5 * pi)
    c = checked(where, "c", c, at_least=0.0)
    phi_r = phi if phi_residual is None else checked(where, "phi_residual", phi_residual, at_least=0.0, at_most=phi)
    c_r = c if c_residual is None else checked(where, "c_residual", c_residual, at_least=0.0, at_most=c)
    psi = checked(where, "psi", psi, at_least=0.0, at_most=phi_r)
    return PlasticParameters(
        checked(where, "E", E, above=0.0),
        2.0 * checked(where, "G", G, above=0.0),
        sin(phi),
        c * cos(phi),
        sin(phi_r),
        c_r * cos(phi_r),
        sin(psi),
        checked(where, "beta", beta, at_least=0.0),
    )


@subkernel
def _strength(p, kappa):
    """sin(phi), c cos(phi) and their derivatives by kappa."""
    fall = exponential(-p.beta * kappa)
    sine, cohesion = (p.peak_sine - p.residual_sine) * fall, (p.peak_cohesion - p.residual_cohesion) * fall
    return p.residual_sine + sine, p.residual_cohesion + cohesion, -p.beta * sine, -p.beta * cohesion


def rate(p, point, increment):
    """The change of the state for an increment, evaluated at `point`: elastic inside the yield line, along it on or beyond."""
    w = 2.0 * increment.spin
    d_V, d_1, d_2 = p.E * increment.eps_V, p.two_G * increment.eps_1, p.two_G * increment.eps_2
    plastic = 0.0 * increment.eps_1
    sine, cohesion, sine_slope, cohesion_slope = _strength(p, point.x)
    shear = size(point.sigma_1, point.sigma_2)
    strength = point.sigma_V * sine + cohesion
    if shear.real > 0.0 and shear.real >= strength.real * (1.0 - _ON_THE_LINE):
        n_1, n_2 = point.sigma_1 * inverse(shear), point.sigma_2 * inverse(shear)
        hardening = p.two_G + p.E * p.dilatancy_sine * sine + point.sigma_V * sine_slope + cohesion_slope
        loading = (n_1 * d_1 + n_2 * d_2 - sine * d_V) * inverse(hardening)
        if loading.real > 0.0:
            plastic = loading
            d_V = d_V + p.E * p.dilatancy_sine * plastic
            d_1, d_2 = d_1 - p.two_G * plastic * n_1, d_2 - p.two_G * plastic * n_2
    return Point(d_V, d_1 - w * point.sigma_2, d_2 + w * point.sigma_1, plastic, 0.0 * plastic)


@subkernel
def _returned(p, point):
    """(state, outcome): a stress outside the yield line returns to it along the plastic strain; one inside stays."""
    shear = size(point.sigma_1, point.sigma_2)
    kappa = 0.0 * shear
    sine, cohesion, sine_slope, cohesion_slope = _strength(p, point.x)
    if not (shear - point.sigma_V * sine - cohesion).real > 0.0:
        return point, OK
    if not shear.real > 0.0:
        return point, APEX
    converged = False
    for _ in range(50):
        sine, cohesion, sine_slope, cohesion_slope = _strength(p, point.x + kappa)
        pressed = point.sigma_V + p.E * p.dilatancy_sine * kappa
        excess = shear - p.two_G * kappa - pressed * sine - cohesion
        stiffness = p.two_G + p.E * p.dilatancy_sine * sine + pressed * sine_slope + cohesion_slope
        if not stiffness.real > 0.0:
            return point, BRITTLE
        kappa = kappa + excess * inverse(stiffness)
        if converged:
            break
        converged = abs(excess.real) <= 1e-6 * shear.real  # quadratic: rounding after this change, and the derivative after the next
    if not converged:
        return point, NOT_FINITE
    left = 1.0 - p.two_G * kappa * inverse(shear)
    if left.real < -1e-12:  # rounding of a material that bears no shear
        return point, APEX
    pressed = point.sigma_V + p.E * p.dilatancy_sine * kappa
    return Point(pressed, left * point.sigma_1, left * point.sigma_2, point.x + kappa, point.y + 0.0 * kappa), OK


def midpoint(p, point, increment):
    """(state, outcome) after an increment: the elastic trial stress; `stressed` then returns it to the yield line.

    That return is backward Euler, the classical way: exact where the strength does not change and the stress axes do not turn against the
    strain; first order in the fall of the strength.
    """
    t_1, t_2 = turned(point.sigma_1, point.sigma_2, 0.5 * increment.spin)
    t_1, t_2 = turned(t_1 + p.two_G * increment.eps_1, t_2 + p.two_G * increment.eps_2, 0.5 * increment.spin)
    none = 0.0 * t_1
    return Point(point.sigma_V + p.E * increment.eps_V, t_1, t_2, point.x + none, point.y + none), OK


def trouble(p, point):
    """The outcome that a state stands for by itself."""
    sine, cohesion, _, _ = _strength(p, point.x.real)
    if (point.sigma_V.real * sine + cohesion).real < 0.0:
        return APEX
    return TENSION if cohesion.real == 0.0 and point.sigma_V.real < 0.0 else OK  # a fluid has no apex


def check_start(p, point):
    """Raises InputError if a path cannot start from this state."""
    fall = exp(-p.beta * point.x)
    sine = p.residual_sine + (p.peak_sine - p.residual_sine) * fall
    strength = point.sigma_V * sine + p.residual_cohesion + (p.peak_cohesion - p.residual_cohesion) * fall
    shear = hypot(point.sigma_1, point.sigma_2)
    if shear > strength * (1.0 + 1e-9):  # rounding of a state that was returned to the line
        raise InputError(f"mohr_coulomb law: start has the deviator {shear:g}, outside the yield line at {strength:g}")


def stressed(p, point, increment):
    """(the state with its stress, outcome): what went beyond the yield line, in any integrator, returns to it."""
    return _returned(p, point)
