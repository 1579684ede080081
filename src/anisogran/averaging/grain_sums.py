"""What each grain carries: sums over its contacts (Q^p = sum_c Q^c of the lecture), from which every average is a weighted sum.

A contact belongs to both its grains, each with its own half of the branch, so summing over grains counts every contact as the lecture
does. Compression is made positive here and nowhere else: the per-grain sum of (force on the grain) x (centre to contact) is negative
under compression, the moment returned is its opposite. Grains of a rough wall are wall: they receive nothing.
"""

import math
from typing import NamedTuple

import numpy as np

from anisogran.compiled import kernel, subkernel


class ContactEnds(NamedTuple):
    """Every contact seen from each of its free grains; E ends, dimension d."""

    grain: np.ndarray  # (E,)
    partner: np.ndarray  # (E,) grain index, or negative for a wall
    force: np.ndarray  # (E, d) force on the grain
    arm: np.ndarray  # (E, d) from the centre to the contact
    normal: np.ndarray  # (E, d) unit vector from the centre to the contact
    overlap: np.ndarray  # (E,)
    contact: np.ndarray  # (E,) index of the contact in the snapshot


@subkernel
def to_nearest_image(vector, cell):
    """Makes the vector (d,) the shortest of its periodic images; nothing without a cell (0, d).

    Rows of the cell are lattice vectors, lower triangular, so the last axis is reduced first.
    """
    for axis in range(len(cell) - 1, -1, -1):
        times = math.floor(vector[axis] / cell[axis, axis] + 0.5)
        for k in range(axis + 1):
            vector[k] -= times * cell[axis, k]


@subkernel
def turn_about_axis(vector, angle):
    """Turns the vector (d,) counter-clockwise about the origin, or the z axis."""
    cosine, sine = math.cos(angle), math.sin(angle)
    x, y = vector[0], vector[1]
    vector[0], vector[1] = cosine * x - sine * y, sine * x + cosine * y


@kernel
def fill_ends(ends, position, radius, free, pairs, forces, points, overlaps, cell, sector, axes, plane):
    """Writes the ends of all contacts at free grains and returns their number.

    `plane` is a tuple as long as there are dimensions: the compiler knows its length, and unrolls what loops over it.
    """
    d = len(plane)
    force, arm, image = np.empty(d), np.empty(d), np.empty(d)
    used = 0
    for c in range(len(pairs)):
        for side in range(2):
            grain, partner = pairs[c, side], pairs[c, 1 - side]
            if grain < 0 or not free[grain]:
                continue
            for k in range(d):
                force[k] = forces[c, k] if side == 0 else -forces[c, k]
                arm[k] = points[c, k]
            # the contact as the second grain sees it: by the same turn of a sector, or lattice vector, that brought it to the first
            if side == 1 and sector > 0:
                first = math.atan2(position[partner, 1], position[partner, 0])
                apart = first - math.atan2(position[grain, 1], position[grain, 0])
                turn = -math.floor(apart / sector + 0.5) * sector
                turn_about_axis(force, turn)
                turn_about_axis(arm, turn)
            elif side == 1 and len(cell):
                # the image that lies beyond the contact point: in a narrow cell two grains, or one and itself, touch on both sides
                whole = 1 + radius[grain] / radius[partner]
                for k in range(d):
                    image[k] = position[grain, k] - position[partner, k] - whole * (points[c, k] - position[partner, k])
                    arm[k] += image[k]
                to_nearest_image(image, cell)
                for k in range(d):
                    arm[k] -= image[k]
            square = 0.0
            for k in range(d):
                arm[k] -= position[grain, k]
                square += arm[k] * arm[k]
            length = math.sqrt(square)
            for a in range(d):
                f, l = force[a], arm[a]
                if len(axes):
                    f, l = 0.0, 0.0
                    for k in range(d):
                        f += axes[grain, a, k] * force[k]
                        l += axes[grain, a, k] * arm[k]
                ends.force[used, a] = f
                ends.arm[used, a] = l
                ends.normal[used, a] = l / length
            ends.grain[used], ends.partner[used], ends.contact[used], ends.overlap[used] = grain, partner, c, overlaps[c]
            used += 1
    return used


def dyad_sums(grain, first, second, grains):
    """sum_c first_i second_j for each grain, shape (grains, n, d), from the values (E, n) and (E, d) at its ends."""
    return unrolled_dyad_sums(grain, first, second, grains, (0.0,) * first.shape[1], (0.0,) * second.shape[1])


@kernel
def unrolled_dyad_sums(grain, first, second, grains, rows, columns):
    """dyad_sums; the tuples `rows` and `columns` tell the compiler n and d, as `plane` in fill_ends."""
    sums = np.zeros((grains, len(rows), len(columns)))
    for e in range(len(grain)):
        g = grain[e]
        for i in range(len(rows)):
            for j in range(len(columns)):
                sums[g, i, j] += first[e, i] * second[e, j]
    return sums


@kernel
def without_rattlers(kept, grain, partner, wall, least_contacts):
    """Takes grains with fewer than `least_contacts` live contacts out of `kept` (N,), again and again until nothing changes.

    wall (E,) marks ends whose partner is a wall. The lost grains are worked off one by one, so that the cost is linear in the contacts.
    """
    n = len(kept)
    start = np.zeros(n + 1, np.int64)  # the ends of grain g stand in `order` from start[g] on
    for e in range(len(grain)):
        start[grain[e] + 1] += 1
    for g in range(n):
        start[g + 1] += start[g]
    count, lost, order = np.zeros(n, np.int64), np.empty(n, np.int64), np.empty(len(grain), np.int64)
    for e in range(len(grain)):
        g = grain[e]
        order[start[g] + count[g]] = e
        count[g] += 1
    size = 0
    for g in range(n):
        if kept[g] and count[g] < least_contacts:
            kept[g] = False
            lost[size] = g
            size += 1
    done = 0
    while done < size:
        g = lost[done]
        done += 1
        for k in range(start[g], start[g + 1]):
            e = order[k]
            if wall[e]:
                continue
            other = partner[e]
            count[other] -= 1
            if kept[other] and count[other] < least_contacts:
                kept[other] = False
                lost[size] = other
                size += 1


def lattice_of(snapshot):
    """The cell (d, d) as the kernels want it: (0, d) for none."""
    return np.empty((0, snapshot.dimension)) if snapshot.cell is None else snapshot.cell


def contact_ends(snapshot, axes=None):
    """All contact ends at free grains, as ContactEnds; vectors along the rows of `axes` (N, d, d) of each grain, default the laboratory."""
    n, d = 2 * len(snapshot.pairs), snapshot.dimension
    index, vector = np.int64, (n, d)
    ends = ContactEnds(
        np.empty(n, index), np.empty(n, index), np.empty(vector), np.empty(vector), np.empty(vector), np.empty(n), np.empty(n, index)
    )
    axes = np.empty((0, d, d)) if axes is None else axes
    used = fill_ends(
        ends, snapshot.position, snapshot.radius, snapshot.free, snapshot.pairs, snapshot.force, snapshot.point, snapshot.overlap,
        lattice_of(snapshot), snapshot.sector or 0.0, axes, (0.0,) * d,
    )  # fmt: skip
    return ContactEnds(*(array[:used] for array in ends))


def stress_moment(ends, grains):
    """-sum_c f_i l_j for each grain, shape (grains, d, d), N m; compression positive. The static stress is its sum over the area."""
    return -dyad_sums(ends.grain, ends.force, ends.arm, grains)


def torque(ends):
    """l x f at each end: (E, 1) in the plane, (E, 3) in space, N m."""
    l, f = ends.arm, ends.force
    return np.cross(l, f) if l.shape[1] == 3 else (l[:, 0] * f[:, 1] - l[:, 1] * f[:, 0])[:, None]


def has_friction(ends, share=1e-6):
    """Whether any contact bears a force along itself, larger than that share of the largest force of all."""
    normal = np.einsum("ed,ed->e", ends.force, ends.normal)
    square = np.einsum("ed,ed->e", ends.force, ends.force)
    return bool(np.any(square - normal**2 > share**2 * square.max(initial=0.0)))


def body_volume(snapshot):
    """V^p of each free grain (0 for a wall grain), (grains,): pi a^2 in m2 in the plane, 4/3 pi a^3 in m3 in space."""
    sphere = 4 / 3 * np.pi * snapshot.radius**3
    return (sphere if snapshot.dimension == 3 else np.pi * snapshot.radius**2) * snapshot.free


def backbone(snapshot, ends, least_contacts):
    """(grains,) bool: free grains that are no rattlers, and (E,) bool: ends between them or at a wall.

    A grain with fewer than `least_contacts` contacts carries nothing (without friction one more than the dimension, with it two). Taking
    it away may leave a neighbour with too few, so the removal is repeated until nothing changes.
    """
    kept = snapshot.free.copy()
    partner = np.where(ends.partner < 0, 0, ends.partner)  # any grain: where it stands for a wall it is not asked
    wall = (ends.partner < 0) | ~snapshot.free[partner]
    without_rattlers(kept, ends.grain, partner, wall, least_contacts)
    return kept, kept[ends.grain] & (wall | kept[partner])
