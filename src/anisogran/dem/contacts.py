"""The contacts at one instant, written out for the averages. Nothing of the run is changed: contact memory is copied first."""

import math

import numpy as np

from anisogran.compiled import kernel
from anisogran.dem.boundaries import lattice
from anisogran.dem.pairs import BLOCK, pair_forces, scratch, separation
from anisogran.dem.rows import DX, DY, FX, FY, pair_columns
from anisogran.dem.specialisation import block
from anisogran.dem.walls import wall_contact


@kernel
def pair_table(body, pairs, order, normal, friction, boundary, largest, spring, out):
    """Of the closed pairs in the list: grains (C, 2) as `order` numbers them, force on the first (C, 2), contact point (C, 2), overlap."""
    used = pairs.start[-1]
    cell = lattice(boundary)
    grains = np.empty((used, 2), np.int64)
    force = np.empty((used, 2))
    point = np.empty((used, 2))
    overlap = np.empty(used)
    closed = 0
    for begin in range(0, used, BLOCK):
        size = min(BLOCK, used - begin)
        pair_columns(body.rows, pairs.first, pairs.second, begin, size, out.pairs, out.whole)
        memory = block(largest, begin, begin + size)
        springs = block(spring, begin, begin + size)
        pair_forces(out.pairs, pairs.reach[begin : begin + size], normal, friction, cell, memory, springs, None, out, 0.0)
        for k in range(size):
            dx, dy, _, _ = separation(cell, out.pairs[DX, k], out.pairs[DY, k], 0.0, 0.0)
            distance = math.sqrt(dx * dx + dy * dy)
            depth = pairs.reach[begin + k] - distance
            if depth <= 0:
                continue
            i = pairs.first[begin + k]
            arm = (body.radius[i] - 0.5 * depth) / distance
            grains[closed, 0] = order[i]
            grains[closed, 1] = order[pairs.second[begin + k]]
            force[closed, 0] = -out.force[FX, k]
            force[closed, 1] = -out.force[FY, k]
            point[closed, 0] = body.x[i] + arm * dx
            point[closed, 1] = body.y[i] + arm * dy
            overlap[closed] = depth
            closed += 1
    return grains[:closed], force[:closed], point[:closed], overlap[:closed]


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
    """Closed contacts of a simulation's state: pairs (C, 2), force on the first grain (C, 2), point (C, 2), overlap (C,).

    Grains have the numbers that the user gave them.
    """
    memories = (None if memory is None else memory.copy() for memory in state.memory[:2])
    room = scratch(virial=False, whole=state.out.whole)
    pairs, force, point, overlap = pair_table(
        state.body, state.pairs, state.order, state.normal, state.friction, state.boundary, *memories, room
    )
    if state.wall_list is None:
        return pairs, force, point, overlap
    memories = (None if memory is None else memory.copy() for memory in state.wall_memory[:2])
    wall_overlap, wall_force, wall_point = wall_table(
        state.boundary, state.body, state.spin, state.wall_list, state.normal, state.wall_friction, *memories
    )
    closed = np.flatnonzero(wall_overlap > 0)
    wall_pairs = np.stack([state.order[state.wall_list.grain[closed]], -1 - state.wall_list.wall[closed]], axis=1)
    return (
        np.concatenate([pairs, wall_pairs]),
        np.concatenate([force, wall_force[closed]]),
        np.concatenate([point, wall_point[closed]]),
        np.concatenate([overlap, wall_overlap[closed]]),
    )
