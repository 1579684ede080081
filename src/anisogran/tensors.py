"""Second-order tensors with the indices first: t[i, j, ...], so that one function serves a point, a series and a whole mesh.

Angles are in radians, counter-clockwise from the first axis. The eigenvalue split of a symmetric 2D tensor is the "half/half" one:
t = mean * I + size * direction(angle), with size = half the difference of the eigenvalues.
"""

import numpy as np


def trace(t):
    """t[i, i, ...], shape (...)."""
    return np.einsum("ii...->...", t)


def symmetric(t):
    """The symmetric part (t + t^T) / 2, same shape."""
    t = np.asarray(t)
    return 0.5 * (t + np.swapaxes(t, 0, 1))


def mean(t):
    """The isotropic part tr t / dimension, shape (...)."""
    return trace(t) / np.shape(t)[0]


def deviator(t):
    """t - mean(t) I, same shape, in any dimension."""
    t = np.asarray(t)
    identity = np.eye(t.shape[0]).reshape(t.shape[:2] + (1,) * (t.ndim - 2))
    return t - mean(t) * identity


def plane_parts(t):
    """Half/half: mean, (t_11 - t_22)/2 and the symmetric t_12 of a 2D tensor, shape (3, ...); the deviator is the last two."""
    (xx, xy), (yx, yy) = np.asarray(t)
    return np.array([0.5 * (xx + yy), 0.5 * (xx - yy), 0.5 * (xy + yx)])


def plane_tensor(parts):
    """The symmetric 2D tensor of its `plane_parts`, shape (2, 2, ...)."""
    middle, first, second = parts
    return np.array([[middle + first, second], [second, middle - first]])


def deviator_size(t):
    """|dev| = sqrt(dev : dev / 2) of the symmetric part, >= 0, shape (...); in 2D half the difference of the eigenvalues."""
    t = symmetric(t)
    if t.shape[0] == 2:
        return np.hypot(0.5 * (t[0, 0] - t[1, 1]), t[0, 1])
    dev = deviator(t)
    return np.sqrt(0.5 * np.einsum("ij...,ij...->...", dev, dev))


def principal_angle(t):
    """Angle of the axis of the larger eigenvalue of a 2D tensor, in (-pi/2, pi/2], shape (...); 0 where the tensor is isotropic."""
    t = symmetric(t)
    return 0.5 * np.arctan2(2.0 * t[0, 1] + 0.0, t[0, 0] - t[1, 1])  # 0.0: there is no -0, and no -pi/2


def direction(angle):
    """The unit deviator D = [[cos 2a, sin 2a], [sin 2a, -cos 2a]] whose major axis has the angle a; shape (2, 2, ...)."""
    cosine, sine = np.cos(2.0 * np.asarray(angle)), np.sin(2.0 * np.asarray(angle))
    return np.array([[cosine, sine], [sine, -cosine]])


def rotation(angle, dimension=2):
    """The active rotation matrix [[c, -s], [s, c]], shape (2, 2, ...); in 3D that about the z axis, (3, 3, ...)."""
    cosine, sine = np.cos(angle), np.sin(angle)
    plane = np.array([[cosine, -sine], [sine, cosine]])
    if dimension == 2:
        return plane
    turn = np.zeros((3, 3, *plane.shape[2:]))
    turn[:2, :2], turn[2, 2] = plane, 1.0
    return turn


def rotate(t, angle):
    """R t R^T: the tensor turned counter-clockwise by the angle (active, in 3D about z), same shape as t broadcast with the angle."""
    turn = rotation(angle, np.shape(t)[0])
    return np.einsum("ik...,kl...,jl...->ij...", turn, t, turn)


def in_polar_frame(t, azimuth):
    """Components of a 2D tensor along (e_r, e_phi) at the azimuth: [[rr, rphi], [phir, phiphi]], shape (2, 2, ...)."""
    return rotate(t, -np.asarray(azimuth))
