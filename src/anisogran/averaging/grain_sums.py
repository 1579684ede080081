"""What each grain carries: sums over its contacts (Q^p = sum_c Q^c of the lecture), from which every average is a weighted sum.

A contact belongs to both its grains, each with its own half of the branch, so summing over grains counts every contact as the lecture
does. Compression is made positive here and nowhere else: the per-grain sum of (force on the grain) x (centre to contact) is negative
under compression, the moment returned is its opposite. Grains of a rough wall are wall: they receive nothing.
"""

from typing import NamedTuple

import numpy as np


class ContactEnds(NamedTuple):
    """Every contact seen from each of its free grains; E ends, dimension d."""

    grain: np.ndarray  # (E,)
    partner: np.ndarray  # (E,) grain index, or negative for a wall
    force: np.ndarray  # (E, d) force on the grain
    arm: np.ndarray  # (E, d) from the centre to the contact
    normal: np.ndarray  # (E, d) unit vector from the centre to the contact


def nearest_image(snapshot, vectors):
    """The vectors (C, d) to the nearest periodic image; unchanged without a cell."""
    if snapshot.cell is None:
        return vectors
    # rows of the cell matrix are lattice vectors; those of a Lees-Edwards cell are triangular, so reduce the last one first
    reduced = np.array(vectors, dtype=float)
    for axis in reversed(range(len(snapshot.cell))):
        lattice = snapshot.cell[axis]
        reduced -= np.rint(reduced[:, axis] / lattice[axis])[:, None] * lattice
    return reduced


def contact_ends(snapshot):
    """All contact ends at free grains, as ContactEnds."""
    first, second = snapshot.pairs.T
    arm = snapshot.point - snapshot.position[first]
    with_grain = second >= 0
    i, j = first[with_grain], second[with_grain]
    other_arm = arm[with_grain] - nearest_image(snapshot, snapshot.position[j] - snapshot.position[i])
    grain = np.concatenate([first, j])
    partner = np.concatenate([second, i])
    force = np.concatenate([snapshot.force, -snapshot.force[with_grain]])
    arms = np.concatenate([arm, other_arm])
    keep = snapshot.free[grain]
    arms = arms[keep]
    length = np.sqrt(np.einsum("cd,cd->c", arms, arms))
    return ContactEnds(grain[keep], partner[keep], force[keep], arms, arms / length[:, None])


def per_grain(ends, values, grains):
    """Sum of `values` (E, ...) over the contacts of each grain, shape (grains, ...)."""
    shape = values.shape[1:]
    columns = np.moveaxis(values, 0, -1).reshape(int(np.prod(shape)), len(values))
    sums = [np.bincount(ends.grain, weights=column, minlength=grains) for column in columns]
    return np.stack(sums, axis=-1).reshape((grains, *shape))


def stress_moment(ends, grains):
    """-sum_c f_i l_j for each grain, shape (grains, d, d), N m; compression positive. The static stress is its sum over the area."""
    return per_grain(ends, -ends.force[:, :, None] * ends.arm[:, None, :], grains)


def contact_fabric(ends, grains):
    """sum_c n_i n_j for each grain, shape (grains, d, d); its trace is the number of contacts."""
    return per_grain(ends, ends.normal[:, :, None] * ends.normal[:, None, :], grains)


def body_area(snapshot):
    """V^p = pi a^2 of each free grain (0 for a wall grain), shape (grains,), m2."""
    return np.pi * snapshot.radius**2 * snapshot.free


def backbone(snapshot, ends, least_contacts):
    """(grains,) bool: free grains that are no rattlers, and (E,) bool: ends between them or at a wall.

    A grain with fewer than `least_contacts` contacts carries nothing (3 without friction, 2 with it, in the plane). Taking it away
    may leave a neighbour with too few, so the removal is repeated until nothing changes.
    """
    kept = snapshot.free.copy()
    partner = np.where(ends.partner < 0, 0, ends.partner)  # any grain: where it stands for a wall it is not asked
    wall = (ends.partner < 0) | ~snapshot.free[partner]
    while True:
        live = kept[ends.grain] & (wall | kept[partner])
        count = np.bincount(ends.grain[live], minlength=len(kept))
        lost = kept & (count < least_contacts)
        if not lost.any():
            return kept, live
        kept &= ~lost
