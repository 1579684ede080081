"""The tensorial anisotropic law in two dimensions: any axes of stress, strain and structure, with rotation of the material.

    d sigma_V = E d eps_V + a . d eps*                       d eps* = d eps - |d eps| t/(s_max sigma_V)
    d t       = a d eps_V + 2G d eps* + X (a . d eps*) a     + dw x t
    d a       = beta_F (A_max d eps - a |d eps|)             + dw x a

Deviators are vectors: d eps the strain, t the stress, a = A (cos, sin)(2 phi_C) the anisotropy, a . b their coaxial part; dw x t turns t
with the material (Jaumann). X = (B - 2G)/A_max^2. For a fixed a of size A_max this is the law of `anisotropic` with moduli E, A, B, G
(Luding's lecture, "Constitutive model - tensorial", is its special case 2G = E - B) and the softening on every deviatoric term; for
coaxial loading and B = 2G it is the scalar law. d eps* vanishes, and the stress stays, once t is s_max sigma_V along d eps: the critical
state, isochoric, whatever the moduli are (in simple shear the material turns while it is sheared, t and a lag behind the strain by
different angles of order 1/beta, and a volume rate of that order squared is left). Without anisotropy the response is isotropic, 2G in
every direction: a network of contacts has B - 2G from the fourth Fourier coefficient of its directions, which here dies with the square
of the second, so B is reached only at |a| = A_max, and the axis of a vanishing anisotropy has no say. Written here after the lecture and
Luding & Perdahcioglu, CIT 83, 672 (2011) (its softening recalled, not checked against the paper). Compression positive, half/half.
"""

from typing import NamedTuple

from anisogran.compiled import subkernel
from anisogran.models.evolution import relaxation, relaxed
from anisogran.models.first_order import inverse, size
from anisogran.models.point import INDEFINITE, MOST_SUBSTEPS, OK, RESOLUTION, TENSION, Point, substeps, turned
from anisogran.outcome import InputError, checked


class TensorialParameters(NamedTuple):
    """E, two_G (half/half moduli), limits; `excess` is X = (B - 2G)/A_max^2 [1/modulus]. Made by `law_parameters`."""

    E: float
    two_G: float
    excess: float
    s_max: float
    A_max: float
    beta_F: float


Parameters = TensorialParameters
KEYS = {  # unit, meaning, example
    "E": ("N/m", "d sigma_V/d eps_V, above 0", 2e4),
    "B": ("N/m", "coaxial shear modulus d sigma_D/d eps_D at |A| = A_max, above 0", 1.2e4),
    "G": ("N/m", "shear modulus, 2G is d sigma_D/d eps_D across the axes; leave it out for the lecture's 2G = E - B", 5e3),
    "s_max": ("1", "largest stress ratio, sin(friction angle), 0 <= s_max < 1", 0.3),
    "A_max": ("N/m", "anisotropy modulus A in the end, below sqrt(E B)", 4e3),
    "beta_F": ("1", "rate of the anisotropy with eps_D (half/half), at least 0", 50.0),
}
STRESS_IS_STATE = True
INTERNAL = ("A_1", "A_2")  # A (cos, sin)(2 phi_C)


def checked_parameters(E, B, s_max, A_max, beta_F, G=None):
    """The `TensorialParameters`; G = None is the lecture's 2G = E - B.

    InputError unless E, B, G > 0, 0 <= s_max < 1, A_max >= 0, beta_F >= 0, and B = 2G where A_max = 0 (no structure, no axis).
    """
    where = "tensorial law"
    E, B = checked(where, "E", E, above=0.0), checked(where, "B", B, above=0.0)
    A_max = checked(where, "A_max", A_max, at_least=0.0)
    if G is None:
        two_G = checked(where, "E - B (which is 2G, since no G is given)", E - B, above=0.0)
    else:
        two_G = 2.0 * checked(where, "G", G, above=0.0)
    if A_max == 0.0 and abs(B - two_G) > 1e-12 * B:  # rounding of E - B
        raise InputError(
            f"{where}: A_max = 0 needs B = 2G (B = {B:g}, 2G = {two_G:g}): without anisotropy there is no axis to tell them apart"
        )
    excess = (B - two_G) / A_max**2 if A_max > 0.0 else 0.0
    s_max = checked(where, "s_max", s_max, at_least=0.0, below=1.0)
    return TensorialParameters(E, two_G, excess, s_max, A_max, checked(where, "beta_F", beta_F, at_least=0.0))


@subkernel
def _softened(p, point, e_1, e_2, length):
    """d eps*, its components."""
    if p.s_max == 0.0:  # bears no shear
        return 0.0 * e_1, 0.0 * e_2
    share = length * inverse(p.s_max * point.sigma_V)
    return e_1 - share * point.sigma_1, e_2 - share * point.sigma_2


@subkernel
def _answer(p, a_1, a_2, f_1, f_2):
    """2G f + X (a . f) a, the deviator of stress for a deviator of strain f."""
    along = p.excess * (a_1 * f_1 + a_2 * f_2)
    return p.two_G * f_1 + along * a_1, p.two_G * f_2 + along * a_2


def rate(p, point, increment):
    """The change of the state for an increment, evaluated at `point`."""
    e_1, e_2, w = increment.eps_1, increment.eps_2, 2.0 * increment.spin
    length = size(e_1, e_2)
    f_1, f_2 = _softened(p, point, e_1, e_2, length)
    g_1, g_2 = _answer(p, point.x, point.y, f_1, f_2)
    return Point(
        p.E * increment.eps_V + point.x * f_1 + point.y * f_2,
        point.x * increment.eps_V + g_1 - w * point.sigma_2,
        point.y * increment.eps_V + g_2 + w * point.sigma_1,
        p.beta_F * (p.A_max * e_1 - point.x * length) - w * point.y,
        p.beta_F * (p.A_max * e_2 - point.y * length) + w * point.x,
    )


@subkernel
def _change_of_ratio(P, T_1, T_2, k, a_1, a_2, m_11, m_12, m_22, r_1, r_2):
    """Newton's change of r for T - k M r = (P - k a.r) r."""
    loss = P - k * (a_1 * r_1 + a_2 * r_2)
    F_1 = T_1 - k * (m_11 * r_1 + m_12 * r_2) - loss * r_1
    F_2 = T_2 - k * (m_12 * r_1 + m_22 * r_2) - loss * r_2
    J_11, J_12 = k * (a_1 * r_1 - m_11) - loss, k * (a_2 * r_1 - m_12)
    J_21, J_22 = k * (a_1 * r_2 - m_12), k * (a_2 * r_2 - m_22) - loss
    over = inverse(J_11 * J_22 - J_12 * J_21)
    return (J_12 * F_2 - J_22 * F_1) * over, (J_21 * F_1 - J_11 * F_2) * over


@subkernel
def _middle_ratio(P, T_1, T_2, k, a_1, a_2, m_11, m_12, m_22, r_1, r_2):
    """t/sigma_V at mid-step with a starting value (real); (r_1, r_2, whether it converged)."""
    for _ in range(20):
        d_1, d_2 = _change_of_ratio(P.real, T_1.real, T_2.real, k.real, a_1.real, a_2.real, m_11.real, m_12.real, m_22.real, r_1, r_2)
        r_1, r_2 = r_1 + d_1, r_2 + d_2
        if abs(d_1) + abs(d_2) <= 1e-6:  # the error left is about the square, and its square after the round that is the derivative's
            d_1, d_2 = _change_of_ratio(P, T_1, T_2, k, a_1, a_2, m_11, m_12, m_22, r_1, r_2)
            return r_1 + d_1, r_2 + d_2, True
    return r_1 + 0.0 * P, r_2 + 0.0 * P, False


def midpoint(p, point, increment):
    """(state, outcome) after an increment: implicit midpoint for the stress, a exact, rotation exact.

    The stress is turned by half of the rotation before and after, so that a rigid rotation is one; sub-steps where the stress ratio
    would relax, or the material turn, too far in one.
    """
    strong = p.s_max != 0.0
    length = size(increment.eps_1, increment.eps_2)
    stiffest = p.two_G.real + max(p.excess.real, 0.0) * (point.x.real**2 + point.y.real**2)
    relaxing = length.real * stiffest / (point.sigma_V.real * p.s_max.real) if strong else 0.0
    parts = substeps(relaxing, increment.spin.real)
    if parts > MOST_SUBSTEPS:
        return point, RESOLUTION
    h = 1.0 / parts
    e_1, e_2, eps_V, spin, length = h * increment.eps_1, h * increment.eps_2, h * increment.eps_V, h * increment.spin, h * length
    k = 0.5 * length / p.s_max if strong else 0.0 * length
    to_middle = relaxation(p.A_max, p.beta_F, 0.5 * e_1, 0.5 * e_2, 0.5 * spin)
    sigma_V, t_1, t_2, a_1, a_2 = point
    for _ in range(parts):
        m_1, m_2 = relaxed(a_1, a_2, to_middle)
        t_1, t_2 = turned(t_1, t_2, 0.5 * spin)
        f_1, f_2 = 0.0 * e_1, 0.0 * e_2
        if strong:
            g_1, g_2 = _answer(p, m_1, m_2, e_1, e_2)
            P = sigma_V + 0.5 * (p.E * eps_V + m_1 * e_1 + m_2 * e_2)
            T_1, T_2 = t_1 + 0.5 * (m_1 * eps_V + g_1), t_2 + 0.5 * (m_2 * eps_V + g_2)
            m_11, m_12, m_22 = p.two_G + p.excess * m_1 * m_1, p.excess * m_1 * m_2, p.two_G + p.excess * m_2 * m_2
            guess = 1.0 / sigma_V.real
            r_1, r_2, converged = _middle_ratio(P, T_1, T_2, k, m_1, m_2, m_11, m_12, m_22, t_1.real * guess, t_2.real * guess)
            if not (converged and (P - k * (m_1 * r_1 + m_2 * r_2)).real > 0.0):
                return point, TENSION  # at a positive pressure and this step a solution is near
            f_1, f_2 = e_1 - 2.0 * k * r_1, e_2 - 2.0 * k * r_2
        g_1, g_2 = _answer(p, m_1, m_2, f_1, f_2)
        sigma_V = sigma_V + p.E * eps_V + m_1 * f_1 + m_2 * f_2
        t_1, t_2 = turned(t_1 + m_1 * eps_V + g_1, t_2 + m_2 * eps_V + g_2, 0.5 * spin)
        a_1, a_2 = relaxed(m_1, m_2, to_middle)
        if not sigma_V.real > 0.0:
            return point, TENSION
    return Point(sigma_V, t_1, t_2, a_1, a_2), OK


def trouble(p, point):
    """The outcome that a state stands for by itself."""
    if not point.sigma_V.real > 0.0:
        return TENSION
    square = point.x.real**2 + point.y.real**2
    return INDEFINITE if p.E.real * (p.two_G.real + p.excess.real * square) <= square else OK


def check_start(p, point):
    """Raises InputError if a path cannot start from this state."""
    checked("tensorial law: start", "sigma_V", point.sigma_V, above=0.0)
    square = point.x**2 + point.y**2
    if p.E * (p.two_G + p.excess * square) <= square:
        raise InputError(f"tensorial law: start A = {square**0.5:g} is too large for E B > A^2: not positive definite")


def stressed(p, point, increment):
    """(the state with its stress, outcome); here the stress is part of the state."""
    return point, OK
