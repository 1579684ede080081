"""The contacts at one instant, written out for the averages. Nothing of the run is changed: contact memory is copied first."""

import numpy as np

from anisogran.dem.boundaries import lattice
from anisogran.dem.kernel import kernel
from anisogran.dem.pairs import pair_forces, scratch, separation
from anisogran.dem.walls import wall_contact


@kernel
def pair_table(body, spin, pairs, normal, friction, boundary, largest, spring, out):
    """Fills `out` for all pairs of the list, and returns the branch vectors, shape (pairs, 2)."""
    used = pairs.start[-1]
    first = pairs.first[:used]
    second = pairs.second[:used]
    cell = lattice(boundary)
    pair_forces(body.x, body.y, body.vx, body.vy, spin, body.radius, first, second, normal, friction, cell, largest, spring, out, 0.0)
    branch = np.empty((used, 2))
    for k in range(used):
        i = first[k]
        j = second[k]
        branch[k, 0], branch[k, 1], _, _ = separation(cell, body.x[j] - body.x[i], body.y[j] - body.y[i], 0.0, 0.0)
    return branch


@kernel
def wall_table(boundary, body, spin, wall_list, normal, friction, largest, spring):
    """Of all wall candidates: overlap (n,), force on the grain (n, 2), contact point (n, 2)."""
    size = wall_list.size[0]
    overlaps = np.empty(size)
    force = np.empty((size, 2))
    point = np.empty((size, 2))
    for k in range(size):
        i, _, overlap, nx, ny, fn, ft = wall_contact(boundary, body, spin, k, wall_list, normal, friction, largest, spring, 0.0)
        overlaps[k] = overlap
        force[k, 0] = ft * ny - fn * nx
        force[k, 1] = -ft * nx - fn * ny
        # the wall does not yield: the contact point is its surface
        point[k, 0] = body.x[i] + (body.radius[i] - overlap) * nx
        point[k, 1] = body.y[i] + (body.radius[i] - overlap) * ny
    return overlaps, force, point


def contact_table(state):
    """Closed contacts of a simulation's state: pairs (C, 2), force on the first grain (C, 2), point (C, 2), overlap (C,)."""
    used = int(state.pairs.start[-1])
    out = scratch(used)
    largest = None if state.largest is None else state.largest[:used].copy()
    spring = None if state.spring is None else state.spring[:used].copy()
    branch = pair_table(state.body, state.spin, state.pairs, state.normal, state.friction, state.boundary, largest, spring, out)
    closed = out.overlap > 0
    pairs = np.stack([state.pairs.first[:used][closed], state.pairs.second[:used][closed]], axis=1).astype(np.int64)
    force = -np.stack([out.force_x[closed], out.force_y[closed]], axis=1)
    branch = branch[closed]
    overlap = out.overlap[closed]
    arm = state.body.radius[pairs[:, 0]] - 0.5 * overlap
    centre = np.stack([state.body.x, state.body.y], axis=1)[pairs[:, 0]]
    point = centre + branch * (arm / np.hypot(branch[:, 0], branch[:, 1]))[:, None]

    if state.wall_list is None:
        return pairs, force, point, overlap
    memories = (None if memory is None else memory.copy() for memory in (state.wall_largest, state.wall_spring))
    wall_overlap, wall_force, wall_point = wall_table(
        state.boundary, state.body, state.spin, state.wall_list, state.normal, state.wall_friction, *memories
    )
    closed = np.flatnonzero(wall_overlap > 0)
    wall_pairs = np.stack([state.wall_list.grain[closed], -1 - state.wall_list.wall[closed]], axis=1)
    return (
        np.concatenate([pairs, wall_pairs]),
        np.concatenate([force, wall_force[closed]]),
        np.concatenate([point, wall_point[closed]]),
        np.concatenate([overlap, wall_overlap[closed]]),
    )
