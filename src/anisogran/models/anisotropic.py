"""The tensorial anisotropic law in two dimensions: one axis phi_C of the structure, moduli E, A, B and a shear modulus G.

    d sigma_V = E eps_V + A eps_D c,                        c = cos(2 phi_eps - 2 phi_C)
    d SIGMA_D = [A eps_V + (B - 2G) eps_D c] D(phi_C) + 2G eps_D D(phi_eps)

Half/half measures, compression positive: eps_V = (e1 + e2)/2, eps_D = (e1 - e2)/2 along phi_eps, D(a) = [[cos 2a, sin 2a],
[sin 2a, -cos 2a]]. With stiffness C_s along phi_C, C_w across, lam between them: E = (C_s + C_w + 2 lam)/2, A = (C_s - C_w)/2,
B = (C_s + C_w - 2 lam)/2. The law of Luding's lecture, "Constitutive model - tensorial", is the case 2G = E - B, that is G = lam.
Angles are in radians; the moduli share one unit (N/m in two dimensions).
"""

import numpy as np

from anisogran.outcome import InputError
from anisogran.tensors import direction

_SAME = 1e-12  # two moduli that agree to this relative accuracy are the same: rounding of E - B, not physics


def shear_modulus(E, B, G=None):
    """G, or (E - B)/2, the lecture's special case, if G is None."""
    return 0.5 * (np.asarray(E) - B) if G is None else G


def _excess(E, A, B, G):
    """B - 2G, the modulus that singles out the axis of the structure; exactly 0 where A is 0; InputError as in `stiffness`."""
    excess = np.asarray(B - 2.0 * G)
    isotropic = np.broadcast_to(np.asarray(A) == 0.0, np.broadcast_shapes(np.shape(A), excess.shape))
    undefined = isotropic & (np.abs(excess) > _SAME * (np.abs(B) + 2.0 * np.abs(G)))
    if np.any(undefined):
        raise InputError(
            "anisotropic law: A = 0 needs B = 2G (in the lecture's form, G = None, that is E = 2B): "
            "without anisotropy the axis phi_C has no meaning, and the response must not depend on it"
        )
    return np.where(isotropic, 0.0, excess)


def stiffness(E, A, B, phi_C=0.0, G=None):
    """C[i, j, k, l, ...] with d sigma_ij = C_ijkl d eps_kl, shape (2, 2, 2, 2, ...), unit of the moduli, fully symmetric.

    The batch shape is that of the arguments broadcast. E B > A^2 and G > 0 make it positive definite; this is not required here,
    see `critical_flow`. Raises InputError if somewhere A = 0 but B != 2G.
    """
    G = shear_modulus(E, B, G)
    excess = _excess(E, A, B, G)
    E, A, G, excess, phi_C = np.broadcast_arrays(E, A, G, excess, phi_C)
    identity, axis = np.eye(2), direction(phi_C)
    unit = np.einsum("ij,kl->ijkl", identity, identity)
    symmetric_unit = 0.5 * (np.einsum("ik,jl->ijkl", identity, identity) + np.einsum("il,jk->ijkl", identity, identity))
    coupling = np.einsum("ij,kl...->ijkl...", identity, axis)
    # eps_V = I:eps/2 and eps_D c = D(phi_C):eps/2, which is where the halves come from
    return (
        np.multiply.outer(0.5 * unit, E)
        + 0.5 * A * (coupling + np.einsum("ijkl...->klij...", coupling))
        + 0.5 * excess * np.einsum("ij...,kl...->ijkl...", axis, axis)
        + np.multiply.outer(2.0 * symmetric_unit - unit, G)
    )


def stress_increment(d_eps, E, A, B, phi_C=0.0, G=None):
    """d sigma[i, j, ...] for a strain increment d_eps[i, j, ...], compression positive in both, symmetric, unit of the moduli.

    Only the symmetric part of d_eps matters. No angle of the strain is taken, so a vanishing deviator is no special case.
    Raises InputError if d_eps is not (2, 2, ...), or as `stiffness`.
    """
    d_eps = np.asarray(d_eps)
    if d_eps.shape[:2] != (2, 2):
        raise InputError(f"stress_increment: d_eps has shape {d_eps.shape}, must be (2, 2, ...)")
    return np.einsum("ijkl...,kl...->ij...", stiffness(E, A, B, phi_C, G), d_eps)


def directional_stiffness(theta, E, A, B, phi_C=0.0, G=None):
    """n n : C : n n along the angle theta, unit of the moduli: the curve of the polar picture, C_s at phi_C and C_w across.

    Shape of the arguments broadcast. Raises InputError as `stiffness`.
    """
    G = shear_modulus(E, B, G)
    c = np.cos(2.0 * (np.asarray(theta) - phi_C))
    return 0.5 * np.asarray(E) + A * c + 0.5 * _excess(E, A, B, G) * c**2 + G
