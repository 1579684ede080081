"""Critical-state flow of the anisotropic law: the strains that change no stress (Luding's lecture, "Critical state flow").

In the frame of the structure, with (x, y) = eps_D (cos, sin)(2 phi_eps - 2 phi_C) and the softening S on the whole eps_D part,

    d sigma_V     [ E  S A    0  ] [eps_V]
    coaxial     = [ A  S B    0  ] [  x  ]        determinant 2G S^2 (E B - A^2)
    non-coaxial   [ 0   0   2G S ] [  y  ]

The scalar case of the lecture, S = 1 and E B = A^2, dilates: eps_V/eps_D = -A/E. Isochoric flow needs S = 0 (or A = B = 0).
"""

from dataclasses import dataclass
from math import hypot, inf, nan, pi

import numpy as np

from anisogran.models.anisotropic import shear_modulus
from anisogran.outcome import InputError, checked

_SINGULAR = 1e-12  # a determinant below this part of its own terms is zero: their rounding is some 1e-16


@dataclass(frozen=True)
class CriticalFlow:
    """Whether the material flows at constant stress, and how.

    flows        whether a strain exists that changes no stress
    case         "stiff" (no flow), "unstable" (no flow, but not positive definite), "dilating", "isochoric", "volumetric",
                 "non-coaxial", "dilating and non-coaxial", "free" (the whole deviatoric part is free), "no stiffness"
    directions   unit null vectors (eps_V, eps_D), compression positive, one for each entry of `angles`
    angles       angle of the major strain axis against the stiff axis of the structure [rad]: 0 coaxial, pi/4 non-coaxial;
                 a negative eps_D is one turned by pi/2
    dilatancy    eps_V/eps_D of the first direction: negative dilates; inf if eps_D = 0 there, nan if nothing or everything flows
    determinant  S (E B - A^2), of the scalar law [moduli^2]
    distance     of the moduli from flow, see `distance_from_flow`; nan unless E > 0 and B > 0
    tensor_determinant  2G S^2 (E B - A^2), of the 3x3 operator [moduli^3]
    """

    flows: bool
    case: str
    directions: list
    angles: list
    dilatancy: float
    determinant: float
    distance: float
    tensor_determinant: float


def distance_from_flow(E, A, B, G=None, softening=1.0):
    """S min(1 - A^2/(E B), 2G/B), no unit, shape of the arguments broadcast: 1 for the fresh isotropic material, 0 where it flows.

    The first is the part of B that is left where the mean stress stays constant, the second the modulus against non-coaxial shear,
    over B; negative where the stiffness is not positive definite. G = None is the lecture's 2G = E - B. Raises InputError for E <= 0
    or B <= 0.
    """
    E, A, B = np.asarray(E), np.asarray(A), np.asarray(B)
    for key, value in (("E", E), ("B", B)):
        if np.any(value <= 0.0):
            raise InputError(f"distance_from_flow: {key} = {np.nanmin(value):g} must be above 0")
    return softening * np.minimum(1.0 - (A / E) * (A / B), 2.0 * shear_modulus(E, B, G) / B)


def critical_flow(E, A, B, G=None, softening=1.0):
    """The `CriticalFlow` of moduli E, A, B, G (numbers of one unit); G = None is the lecture's 2G = E - B.

    `softening` is S = 1 - s_D/s_max, 0 at the critical state. Zero is meant to rounding. Raises InputError unless all are finite
    and softening >= 0.
    """
    where = "critical_flow"
    E, A, B = checked(where, "E", E), checked(where, "A", A), checked(where, "B", B)
    S = checked(where, "softening", softening, at_least=0.0)
    S = 0.0 if S <= _SINGULAR else S  # 1 - s_D/s_max is rounded as well
    two_G = E - B if G is None else 2.0 * checked(where, "G", G)
    determinant = S * (E * B - A * A)
    distance = float(distance_from_flow(E, A, B, 0.5 * two_G, S)) if E > 0.0 and B > 0.0 else nan
    measures = determinant, distance, S * two_G * determinant
    coaxial = _null_directions(E, A, B, S)
    non_coaxial = S == 0.0 or abs(two_G) <= _SINGULAR * (abs(E) + abs(B))
    directions = [*coaxial, *([(0.0, 1.0)] if non_coaxial else [])]
    angles = [0.0] * len(coaxial) + [pi / 4] * non_coaxial
    if not directions:
        stable = E > 0.0 and determinant > 0.0 and S * two_G > 0.0
        return CriticalFlow(False, "stiff" if stable else "unstable", [], [], nan, *measures)
    eps_V, eps_D = directions[0]
    dilatancy = nan if len(coaxial) == 2 else eps_V / eps_D if eps_D else inf
    return CriticalFlow(True, _case(coaxial, non_coaxial), directions, angles, dilatancy, *measures)


def _null_directions(E, A, B, S):
    """Unit null vectors of [[E, S A], [A, S B]], eps_D >= 0."""
    if E == A == 0.0 and S * B == 0.0:
        return [(1.0, 0.0), (0.0, 1.0)]
    if S == 0.0 or A == B == 0.0:
        return [(0.0, 1.0)]
    if E == A == 0.0:
        return [(1.0, 0.0)]
    if abs(E * B - A * A) > _SINGULAR * (abs(E * B) + A * A):
        return []
    length = hypot(S * A, E)
    return [(-S * A * (1 if E > 0 else -1) / length, abs(E) / length)]


def _case(coaxial, non_coaxial):
    if len(coaxial) == 2:
        return "no stiffness"
    if not coaxial:
        return "non-coaxial"
    eps_V, eps_D = coaxial[0]
    if eps_D == 0.0:
        return "volumetric"
    if eps_V == 0.0:
        return "free" if non_coaxial else "isochoric"
    kind = "dilating" if eps_V < 0.0 else "contracting"
    return f"{kind} and non-coaxial" if non_coaxial else kind
