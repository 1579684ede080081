"""Moduli of a contact network in two dimensions that moves affinely, from its fabric; and the fabric and contacts from moduli.

Contact directions have the density f(theta) = (1 + a2 cos 2 theta + a4 cos 4 theta)/(2 pi), theta from the major axis of the fabric;
every contact has the stiffness k_n along its branch and k_t across. The angular averages are elementary:

    E = k_n/2              B = (k_n + k_t)/4 + a4 (k_n - k_t)/8
    A = a2 k_n/4          2G = (k_n + k_t)/4 - a4 (k_n - k_t)/8        each times (1/V) sum_c l^2

This is an upper (Voigt) bound, grains that rearrange are softer. Stresses and strains half/half as in `anisotropic`.
"""

from typing import NamedTuple

import numpy as np

from anisogran.models.anisotropic import shear_modulus
from anisogran.outcome import InputError
from anisogran.tensors import deviator_size, direction, principal_angle, trace

_SAME = 1e-12  # relative: what rounding leaves of a difference that is zero


class NetworkModuli(NamedTuple):
    """E, A, B, G, lam of the anisotropic law; unit of k_n times `scale`. E - B = 2 lam always; G = lam if k_t = 0."""

    E: np.ndarray
    A: np.ndarray
    B: np.ndarray
    G: np.ndarray
    lam: np.ndarray


class Network(NamedTuple):
    """Coefficients a2, a4 of the contact directions, and k_n, k_t times `scale`: only these products show in the moduli."""

    a2: np.ndarray
    a4: np.ndarray
    k_n: np.ndarray
    k_t: np.ndarray


def network_moduli(a2, a4, k_n, k_t, scale=1.0):
    """The `NetworkModuli` of a fabric, shape of the arguments broadcast.

    `a2` is the `anisotropy` of the glossary, 2 (F_1 - F_2)/tr F; `a4` the fourth Fourier coefficient (0 if not known); `scale`
    the number (1/V) sum_c l^2, each contact once with its full branch l (no unit in two dimensions). A does not depend on k_t.
    Raises InputError for negative k_n, k_t or scale.
    """
    a2, a4 = np.asarray(a2), np.asarray(a4)
    for key, value in (("k_n", k_n), ("k_t", k_t), ("scale", scale)):
        if np.any(np.real(value) < 0.0):
            raise InputError(f"network_moduli: {key} = {np.min(np.real(value)):g} must be at least 0")
    # isotropic parts and the part that a4 shifts between the two kinds of shear
    bulk, shear, shift = k_n / 2, (k_n + k_t) / 4, a4 * (k_n - k_t) / 8
    lam = (k_n - k_t) / 8 - shift / 2
    moduli = scale * bulk, scale * a2 * k_n / 4, scale * (shear + shift), scale * (shear - shift) / 2, scale * lam
    return NetworkModuli(*(value[()] for value in np.broadcast_arrays(*moduli)))


def network_of_moduli(E, A, B, G=None):
    """The `Network` that has these moduli, the inverse of `network_moduli`; shape of the arguments broadcast, k_n and k_t in their unit.

    a2 = 2 A/E, k_n = 2 E, k_t = 2 (B + 2 G - E), a4 = 4 (B - 2 G)/(k_n - k_t); NaN for a4 where k_n = k_t, since such contacts do
    not show it. G = None is the lecture's 2G = E - B, that of contacts with k_t = 0. Raises InputError for E <= 0, or where
    k_t < 0: no such network is that soft in shear, grains must have rearranged.
    """
    E, A, B = np.asarray(E, dtype=float), np.asarray(A, dtype=float), np.asarray(B, dtype=float)
    two_G = 2.0 * np.asarray(shear_modulus(E, B, G), dtype=float)
    if np.any(E <= 0.0):
        raise InputError(f"network_of_moduli: E = {np.nanmin(E):g} must be above 0")
    E, A, B, two_G = np.broadcast_arrays(E, A, B, two_G)
    k_n, k_t = 2.0 * E, 2.0 * (B + two_G - E)
    k_t = np.where(np.abs(k_t) <= _SAME * k_n, 0.0, k_t)
    if np.any(k_t < 0.0):
        raise InputError(f"network_of_moduli: B + 2G - E = {np.nanmin(k_t) / 2:g} must be at least 0: it is k_t/2 of the contacts")
    difference = np.where(np.abs(k_n - k_t) <= _SAME * k_n, np.nan, k_n - k_t)
    return Network(2.0 * A / E, 4.0 * (B - two_G) / difference, k_n, k_t)


def fabric_moduli(fabric, k_n, k_t, a4=0.0, scale=None):
    """(`NetworkModuli`, phi_C) of a fabric tensor F[i, j, ...] of the glossary: a2 = 2 (F_1 - F_2)/tr F, phi_C its major axis.

    `stiffness(E, A, B, phi_C, G)` is then the stiffness. `scale` is (1/V) sum_c l^2, or, if None, that of equal discs, 2 tr F/pi;
    `a4` along the same axis. An isotropic fabric gets phi_C = 0. Raises InputError if F is not (2, 2, ...), or tr F <= 0 somewhere
    (no contacts, no fabric), or as `network_moduli`.
    """
    fabric = np.asarray(fabric)
    if fabric.shape[:2] != (2, 2):
        raise InputError(f"fabric_moduli: fabric has shape {fabric.shape}, must be (2, 2, ...)")
    size = trace(fabric)
    if np.any(size <= 0.0):
        raise InputError(f"fabric_moduli: tr F = {np.nanmin(size):g} must be above 0")
    if scale is None:
        scale = 2.0 * size / np.pi
    return network_moduli(4.0 * deviator_size(fabric) / size, a4, k_n, k_t, scale), principal_angle(fabric)


def fabric_of_moduli(E, A, phi_C=0.0, size=1.0):
    """The fabric tensor F[i, j, ...] with the trace `size` whose network has these moduli: size/2 (I + (A/E) D(phi_C)).

    Moduli do not tell the number of contacts apart from their stiffness, so that the trace has to be known. Shape (2, 2, ...) of the
    arguments broadcast. Raises InputError for E <= 0 or size <= 0.
    """
    E, A, phi_C, size = np.broadcast_arrays(E, A, phi_C, size)
    for key, value in (("E", E), ("size", size)):
        if np.any(value <= 0.0):
            raise InputError(f"fabric_of_moduli: {key} = {np.nanmin(value):g} must be above 0")
    identity = np.eye(2).reshape(2, 2, *(1,) * E.ndim)
    return 0.5 * size * (identity + A / E * direction(phi_C))
