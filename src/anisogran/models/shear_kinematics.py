"""Simple shear is a rotation and a symmetric shear (Luding's lecture, "Anisotropy <-> Shear"), small and finite.

The flow is v_x = rate y, positive to the right above: grad u = [[0, gamma], [0, 0]], (grad u)_ij = d u_i/d x_j, with gamma = 2 eps_s
of the lecture. **Signs.** Strain is compression positive, the opposite of the lecture's: strain = -(grad u + grad u^T)/2. Rotation
is positive counter-clockwise, so that this flow turns the material by -gamma/2. For gamma > 0 the material is squeezed along the
axis at -45 degrees (and +135) and extended along +45 degrees; for gamma < 0 the other way round.
"""

from typing import NamedTuple

import numpy as np

from anisogran.tensors import rotate, rotation


class ShearIncrement(NamedTuple):
    """Parts of grad u = rotation - strain."""

    strain: np.ndarray  # compression positive, symmetric, (2, 2, ...)
    rotation: np.ndarray  # skew, turn [[0, -1], [1, 0]], (2, 2, ...)
    turn: np.ndarray  # angle of the rotation, counter-clockwise, -gamma/2 [rad], shape of gamma


class FiniteShear(NamedTuple):
    """Parts of the deformation gradient F = R(turn) stretch of [[1, gamma], [0, 1]]."""

    turn: np.ndarray  # angle of the rotation, counter-clockwise, -arctan(gamma/2) [rad], shape of gamma
    stretch: np.ndarray  # symmetric, of determinant 1, in the axes before the shear, (2, 2, ...)
    eps_D: np.ndarray  # true strain, half of the difference of the logarithms of the stretches, >= 0, shape of gamma
    axis: np.ndarray  # angle of the compression axis after the shear [rad], within (-pi/2, pi/2], shape of gamma


def displacement_gradient(gamma):
    """[[0, gamma], [0, 0]], shape (2, 2, ...)."""
    gamma = np.asarray(gamma)
    nothing = np.zeros_like(gamma)
    return np.array([[nothing, gamma], [nothing, nothing]])


def shear_increment(gamma):
    """The `ShearIncrement` of a small shear gamma, shape (...); of a rate, its parts are rate of deformation and spin.

    Half/half: eps_V = 0, eps_D = |gamma|/2, and |turn| = eps_D: half of simple shear is rotation.
    """
    gradient = displacement_gradient(gamma)
    turned = np.swapaxes(gradient, 0, 1)
    return ShearIncrement(-0.5 * (gradient + turned), 0.5 * (gradient - turned), -0.5 * np.asarray(gamma))


def finite_shear(gamma):
    """The `FiniteShear` of any gamma, shape (...): the polar decomposition.

    The stretches are exp(+-eps_D) with eps_D = arcsinh(|gamma|/2). The axes turn as shear goes on: compression is along
    -45 degrees + arctan(gamma/2)/2 before the shear and -45 degrees - arctan(gamma/2)/2 after it (gamma > 0), so that it ends along
    -90 degrees, across the flow. At gamma = 0 the axis is that of the shear that would begin, gamma -> 0+.
    """
    gamma = np.asarray(gamma)
    lean = np.arctan(0.5 * gamma)
    stretch = np.einsum("ki...,kj...->ij...", rotation(-lean), np.eye(2).reshape(2, 2, *(1,) * gamma.ndim) + displacement_gradient(gamma))
    axis = np.where(gamma < 0.0, 0.25, -0.25) * np.pi - 0.5 * lean
    return FiniteShear(-lean, stretch, np.arcsinh(0.5 * np.abs(gamma)), axis)


def in_axes_at_45_degrees(t):
    """Components of a tensor t[i, j, ...] in axes that are turned by +45 degrees: R t R^T with the passive R = [[c, s], [-s, c]].

    This is the lecture's R45: it makes biaxial shear of the symmetric one, [[0, e], [e, 0]] -> [[e, 0], [0, -e]]. The tensor itself
    is not turned; turning it by +45 degrees, `tensors.rotate(t, pi/4)`, gives [[-e, 0], [0, e]]. Of the strain of `shear_increment`
    (e = -gamma/2) the second of the new axes, at 135 degrees, is that of compression. Same shape as t.
    """
    return rotate(t, -0.25 * np.pi)
