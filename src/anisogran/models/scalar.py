"""The scalar anisotropic law in the eigen-system of the biaxial box, with evolving anisotropy A and softening S.

    d sigma_V = E d eps_V + S A d eps_D        S = 1 - sgn(d eps_D) s_D/s_max,   s_D = sigma_D/sigma_V
    d sigma_D = A d eps_V + S B d eps_D        dA = beta_F (A_max sgn(d eps_D) - A) |d eps_D|

Moduli as in Luding's lecture, "Constitutive model - scalar". S stands on the whole eps_D column, as in Magnanimo & Luding,
Granular Matter 13, 225 (2011) (equations recalled, not checked against the paper): the determinant is S (E B - A^2), so the
critical state S = 0 is isochoric for every E B > A^2. The sign in S makes unloading stiff, S up to 2. Above s_max (a start value, or
decompression at constant sigma_D) S is negative: the material softens, and s_D comes down to s_max. Half/half, compression positive.
The axes are those of the box, sigma_D = (sigma_zz - sigma_xx)/2 and so on; the law knows no shear strain and no rotation.
"""

from typing import NamedTuple

import numpy as np

from anisogran.models.first_order import exponential, inverse, root
from anisogran.models.point import INDEFINITE, MOST_SUBSTEPS, OK, RESOLUTION, TENSION, Point, substeps
from anisogran.outcome import InputError, checked


class ScalarParameters(NamedTuple):
    """Constant moduli E, B and limits; A_max has the unit of the moduli, the rest none."""

    E: float
    B: float
    s_max: float
    A_max: float
    beta_F: float


Parameters = ScalarParameters
KEYS = {  # unit, meaning, example
    "E": ("N/m", "d sigma_V/d eps_V, above 0", 2e4),
    "B": ("N/m", "d sigma_D/d eps_D of the isotropic sample, above 0", 1e4),
    "s_max": ("1", "largest stress ratio, sin(friction angle), 0 <= s_max < 1", 0.3),
    "A_max": ("N/m", "anisotropy modulus A in the end, below sqrt(E B)", 4e3),
    "beta_F": ("1", "rate of the anisotropy with eps_D (half/half), at least 0", 50.0),
}
STRESS_IS_STATE = True
INTERNAL = ("A", None)  # A > 0 is stiffer along z, the axis that a positive eps_D compresses


def checked_parameters(E, B, s_max, A_max, beta_F):
    """The `ScalarParameters`; InputError unless E, B > 0, 0 <= s_max < 1, beta_F >= 0."""
    where = "scalar law"
    return ScalarParameters(
        checked(where, "E", E, above=0.0),
        checked(where, "B", B, above=0.0),
        checked(where, "s_max", s_max, at_least=0.0, below=1.0),
        checked(where, "A_max", A_max),
        checked(where, "beta_F", beta_F, at_least=0.0),
    )


def softening(s_D, s_max, sense=1.0):
    """S = 1 - sense s_D/s_max, up to 2 after a reversal, negative above s_max; 0 for a material with s_max = 0, which bears no shear."""
    strong = np.asarray(s_max) != 0.0
    return np.where(strong, 1.0 - sense * s_D / np.where(strong, s_max, 1.0), 0.0)[()]


def rate(p, point, increment):
    """The change of the state for an increment, evaluated at `point`."""
    eps_D, sigma_D = -increment.eps_1, -point.sigma_1
    sense = -1.0 if eps_D.real < 0.0 else 1.0
    softened = 0.0 * eps_D if p.s_max == 0.0 else eps_D - sense * eps_D * sigma_D * inverse(point.sigma_V * p.s_max)
    return Point(
        p.E * increment.eps_V + point.x * softened,
        -(point.x * increment.eps_V + p.B * softened),
        0.0 * eps_D,
        p.beta_F * sense * eps_D * (p.A_max * sense - point.x),
        0.0 * eps_D,
    )


def midpoint(p, point, increment):
    """(state, outcome) after an increment: implicit midpoint for the stress, A exact; sub-steps where s_D would relax in one.

    With A at mid-step known, the ratio r at mid-step solves a quadratic equation, whose root is taken where nothing cancels.
    """
    eps_D = -increment.eps_1
    sense = -1.0 if eps_D.real < 0.0 else 1.0
    strong = p.s_max != 0.0
    length = sense * eps_D
    parts = substeps(length.real * p.B.real / (point.sigma_V.real * p.s_max.real) if strong else 0.0, 0.0)
    if parts > MOST_SUBSTEPS:
        return point, RESOLUTION
    h = 1.0 / parts
    eps_D, eps_V, length = h * eps_D, h * increment.eps_V, h * length
    sigma_V, sigma_D, A = point.sigma_V, -point.sigma_1, point.x
    half = exponential(-0.5 * p.beta_F * length)
    for _ in range(parts):
        A_mid = half * A + (1.0 - half) * sense * p.A_max
        fixed_V, fixed_D = p.E * eps_V, A_mid * eps_V
        soft = 0.0 * eps_D
        if strong:
            # r (sigma_V at mid-step) = sigma_D at mid-step, with eps_D - length r/s_max as the softened strain
            k = 0.5 * length / p.s_max
            P = sigma_V + 0.5 * (fixed_V + A_mid * eps_D)
            T = sigma_D + 0.5 * (fixed_D + p.B * eps_D)
            b = P + k * p.B
            square = b * b - 4.0 * k * A_mid * T
            if b.real <= 0.0 or square.real <= 0.0:
                return point, TENSION
            soft = eps_D - length / p.s_max * (2.0 * T * inverse(b + root(square)))
        sigma_V = sigma_V + fixed_V + A_mid * soft
        sigma_D = sigma_D + fixed_D + p.B * soft
        A = half * A_mid + (1.0 - half) * sense * p.A_max
        if not sigma_V.real > 0.0:
            return point, TENSION
    return Point(sigma_V, -sigma_D, point.sigma_2, A, point.y), OK


def trouble(p, point):
    """The outcome that a state stands for by itself."""
    if not point.sigma_V.real > 0.0:
        return TENSION
    return INDEFINITE if point.x.real**2 >= p.E.real * p.B.real else OK


def check_start(p, point):
    """Raises InputError if a path cannot start from this state."""
    checked("scalar law: start", "sigma_V", point.sigma_V, above=0.0)
    limit = (p.E * p.B) ** 0.5
    if abs(point.x) >= limit:
        raise InputError(f"scalar law: start |A| = {abs(point.x):g} must be below sqrt(E B) = {limit:g}: not positive definite")


def stressed(p, point, increment):
    """(the state with its stress, outcome); here the stress is part of the state."""
    return point, OK
