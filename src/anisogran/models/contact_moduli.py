"""Moduli of a contact network in two dimensions that moves affinely, from its fabric.

Contact directions have the density f(theta) = (1 + a2 cos 2 theta + a4 cos 4 theta)/(2 pi), theta from the major axis of
the fabric; every contact has the stiffness k_n along its branch and k_t across. The angular averages are elementary; this is an
upper (Voigt) bound,
grains that rearrange are softer. Stresses and strains half/half as in `anisotropic`.
"""

from typing import NamedTuple

import numpy as np

from anisogran.outcome import InputError


class NetworkModuli(NamedTuple):
    """E, A, B, G, lam of the anisotropic law; unit of k_n times `scale`. E - B = 2 lam always; G = lam if k_t = 0."""

    E: np.ndarray
    A: np.ndarray
    B: np.ndarray
    G: np.ndarray
    lam: np.ndarray


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
    return NetworkModuli(scale * bulk, scale * a2 * k_n / 4, scale * (shear + shift), scale * (shear - shift) / 2, scale * lam)
