"""The scalar anisotropic law in the eigen-system of the biaxial box, with evolving anisotropy A and softening S.

    d sigma_V = E d eps_V + S A d eps_D        S = 1 - sgn(d eps_D) s_D/s_max,   s_D = sigma_D/sigma_V
    d sigma_D = A d eps_V + S B d eps_D        dA = beta_F (A_max sgn(d eps_D) - A) |d eps_D|

Moduli as in Luding's lecture, "Constitutive model - scalar". S stands on the whole eps_D column, as in Magnanimo & Luding,
Granular Matter 13, 225 (2011) (equations recalled, not checked against the paper): the determinant is S (E B - A^2), so the
critical state S = 0 is isochoric for every E B > A^2. The sign in S makes unloading stiff. Half/half, compression positive.
"""

from typing import NamedTuple

import numpy as np

from anisogran.models.evolution import loading_sense, relax
from anisogran.outcome import InputError

_COMPLEX_STEP = 1e-30  # far below rounding, so that the derivative is exact


class ScalarState(NamedTuple):
    """Stress and structure of a point; stresses and A share the unit of the moduli, any one shape."""

    sigma_V: np.ndarray
    sigma_D: np.ndarray
    A: np.ndarray


class ScalarParameters(NamedTuple):
    """Constant moduli E, B and limits; A_max has the unit of the moduli, the rest none."""

    E: float
    B: float
    s_max: float
    A_max: float
    beta_F: float


def softening(s_D, s_max, sense=1.0):
    """S = 1 - sense s_D/s_max, not below 0; up to 2 after a reversal. A material with s_max = 0 bears no shear: S = 0."""
    strong = np.asarray(s_max) != 0.0
    S = np.where(strong, 1.0 - sense * s_D / np.where(strong, s_max, 1.0), 0.0)
    return np.where(np.real(S) < 0.0, 0.0, S)


def _phi_2(z):
    """(exp(z) - 1 - z)/z^2, by its series where the closed form would cancel."""
    small = np.abs(z) < 0.1
    series = 1.0
    for n in range(11, 2, -1):  # 1/2 (1 + z/3 (1 + z/4 (...))); the first term left out is 0.1^10/12!
        series = 1.0 + np.where(small, z, 0.0) * series / n
    large = np.where(small, 1.0, z)
    return np.where(small, 0.5 * series, (np.expm1(large) - large) / large**2)


def _advance(state, d_eps_V, d_eps_D, p):
    """The state after one exponential Rosenbrock-Euler step with A at mid-step.

    Second order, and stable for large steps: only S depends on the stress, so the Jacobian has rank one and its exponential is
    that of the number `rate`.
    """
    sigma_V, sigma_D, A_old = state
    sense = loading_sense(d_eps_D)
    A = relax(A_old, p.A_max, p.beta_F, 0.5 * d_eps_D)
    s = sigma_D / sigma_V
    S = softening(s, p.s_max, sense)
    # at S = 0 the material flows, and S does not change with the stress
    steepness = np.where(np.real(S) > 0.0, sense / np.where(np.real(S) > 0.0, p.s_max, 1.0), 0.0) / sigma_V
    f_V = p.E * d_eps_V + S * A * d_eps_D
    f_D = A * d_eps_V + S * p.B * d_eps_D
    rate = steepness * d_eps_D * (A * s - p.B)
    correction = d_eps_D * steepness * (s * f_V - f_D) * _phi_2(rate)
    return ScalarState(sigma_V + f_V + A * correction, sigma_D + f_D + p.B * correction, relax(A_old, p.A_max, p.beta_F, d_eps_D))


def scalar_step(state, increment, parameters):
    """(new state, stress, tangent) for a strain increment (d_eps_V, d_eps_D), each a number or an array of one shape (...).

    stress has shape (2, ...): sigma_V, sigma_D. tangent has shape (2, 2, ...): d stress_i/d increment_j, exact for this
    integrator (complex step); where d_eps_D = 0 it is that of loading. Second order in the increment. Overshoot of s_max that
    the integrator may leave is of its order; S is then 0 for further loading.
    Raises InputError where sigma_V <= 0 (the law holds under compression only), or for s_max < 0 or beta_F < 0.
    """
    if np.any(np.real(state.sigma_V) <= 0.0):
        raise InputError(f"scalar law: sigma_V = {np.min(np.real(state.sigma_V)):g} must be above 0 (no tension)")
    if np.any(np.real(parameters.s_max) < 0.0):
        raise InputError(f"scalar law: s_max = {np.min(np.real(parameters.s_max)):g} must be at least 0")
    d_eps_V, d_eps_D = np.broadcast_arrays(*increment)
    step = 1j * _COMPLEX_STEP
    trial = _advance(state, np.array([d_eps_V + step, d_eps_V]), np.array([d_eps_D, d_eps_D + step]), parameters)
    new = ScalarState(*(np.real(value[0]) for value in trial))
    tangent = np.array([np.imag(trial.sigma_V), np.imag(trial.sigma_D)]) / _COMPLEX_STEP
    return new, np.array([new.sigma_V, new.sigma_D]), tangent
