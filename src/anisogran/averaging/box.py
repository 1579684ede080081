"""The contact network of a whole sample, as the affine moduli need it."""

from typing import NamedTuple

import numpy as np

from anisogran.averaging.grain_sums import contact_ends
from anisogran.averaging.sample import contact_lines


class ContactNetwork(NamedTuple):
    """The directions and the size of a contact network, as the affine moduli need them."""

    a2: float  # second Fourier coefficient of the contact directions, along the axis of the fabric
    a4: float  # fourth Fourier coefficient
    scale: float  # (1/V) sum over contacts of the squared branch length, each contact once


def contact_network(snapshot, angle=None):
    """The ContactNetwork of a whole 2D sample; `angle` of the axis in radians, default the major axis of the branches.

    f(theta) = (1 + a2 cos 2 theta + a4 cos 4 theta)/(2 pi) from that axis; contacts weighted by their squared branch length, as in the
    stiffness. A wall contact has the branch from the grain's centre to the wall.
    """
    branch = contact_lines(snapshot, contact_ends(snapshot)).branch
    square = np.einsum("cd,cd->c", branch, branch)
    theta = np.arctan2(branch[:, 1], branch[:, 0])
    if angle is None:
        angle = 0.5 * np.arctan2(np.sum(square * np.sin(2 * theta)), np.sum(square * np.cos(2 * theta)))
    weight = square / square.sum()
    a2, a4 = (2 * float(np.sum(weight * np.cos(order * (theta - angle)))) for order in (2, 4))
    return ContactNetwork(a2, a4, float(square.sum() / snapshot.volume))
