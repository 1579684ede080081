"""Forces between grains: one branch-free pass over blocks of the pair list, then a sum onto the grains in a fixed order.

A block goes through three stages that stay in the first-level cache: rows of grains become columns of pairs, the laws turn the columns
into forces in vector instructions, and the forces are added to the rows of the grains, always in the order of the list, so that a run
can be repeated bit for bit.

Pair (i, j): the normal n points from i to j, the tangent is t = (-n_y, n_x). Both grains share the contact point in the middle of the
overlap, so the lever arms are radius - overlap/2, the same in the slip velocity and in the torque; together they make the distance of
the centres, and angular momentum is conserved to rounding.
"""

import math
from typing import NamedTuple

import numpy as np

from anisogran.dem.kernel import block, kernel, unaliased
from anisogran.dem.laws import normal_force, tangential_force
from anisogran.dem.rows import DIFFERENCE_RADIUS, DIFFERENCE_SPIN, DU, DV, DX, DY, FX, FY, SUM_SPIN, add_to_rows, pair_columns

BLOCK = 256  # pairs; the columns of pairs and of forces take 25 kB


class Scratch(NamedTuple):
    """The columns of one block; what the scene does not need is None."""

    pairs: np.ndarray  # (8, BLOCK), see rows.py
    force: np.ndarray  # (4, BLOCK): on the second grain, F_x, F_y, torque taken from the first grain, torque given to the second
    virial_x: np.ndarray | None  # (BLOCK,) force times branch
    virial_y: np.ndarray | None
    whole: float | None  # None: only positions and velocities are fetched


def scratch(virial, whole):
    """Columns for one block: is the stress asked for, and does a law want more than positions and velocities?"""
    stresses = (np.zeros(BLOCK) if virial else None for _ in range(2))
    return Scratch(np.zeros((8, BLOCK)), np.zeros((4, BLOCK)), *stresses, 1.0 if whole else None)


@kernel
def separation(cell, dx, dy, du, dv):
    """Difference of position and velocity to the nearest image; unchanged where there is no periodic cell."""
    if cell is not None:
        rows = math.floor(dy * cell.inverse_height + 0.5)
        dy -= rows * cell.height
        dx -= rows * cell.offset
        columns = math.floor(dx * cell.inverse_width + 0.5)
        dx -= columns * cell.width
        du -= rows * cell.shear_speed + columns * cell.column_speed
        dv -= rows * cell.row_speed
    return dx, dy, du, dv


@kernel
def pair_forces(pairs, reach, normal, friction, cell, largest, spring, virial, out, dt):
    """Forces and torques of a block of pairs, one for each entry of `reach`, into `out`; contact memory is updated in place."""
    memory = unaliased(largest)
    springs = unaliased(spring)
    force_x = unaliased(out.force[FX])
    force_y = unaliased(out.force[FY])
    torque_first = unaliased(out.force[2])
    torque_second = unaliased(out.force[3])
    virial_x = unaliased(out.virial_x)
    virial_y = unaliased(out.virial_y)
    x = pairs[DX]
    y = pairs[DY]
    u = pairs[DU]
    v = pairs[DV]
    difference_radius = pairs[DIFFERENCE_RADIUS]
    difference_spin = pairs[DIFFERENCE_SPIN]
    sum_spin = pairs[SUM_SPIN]
    for k in range(reach.size):
        dx, dy, du, dv = separation(cell, x[k], y[k], u[k], v[k])
        distance = math.sqrt(dx * dx + dy * dy)
        inverse = 1.0 / distance
        nx = dx * inverse if distance > 0.0 else 1.0  # coincident centres: a fixed direction, never 0/0
        ny = dy * inverse if distance > 0.0 else 0.0
        overlap = reach[k] - distance
        touch = 1.0 if overlap > 0.0 else 0.0
        memo = 0.0
        if largest is not None:
            memo = memory[k]
        size_of_pair = 0.5 * (reach[k] - difference_radius[k] * difference_radius[k] / reach[k])  # 2 a_i a_j/(a_i + a_j)
        fn, bound, memo = normal_force(normal, overlap, du * nx + dv * ny, memo, size_of_pair)
        fn *= touch
        if largest is not None:
            memory[k] = memo * touch
        ft = 0.0
        if friction is not None:
            mean_arm = 0.5 * distance
            half = 0.5 * difference_radius[k]
            slip = dv * nx - du * ny - mean_arm * sum_spin[k] - half * difference_spin[k]
            ft, stretched = tangential_force(friction, springs[k], slip, bound * touch, dt)
            ft *= touch
            springs[k] = stretched * touch
            torque_first[k] = (mean_arm - half) * ft
            torque_second[k] = -(mean_arm + half) * ft
        fx = fn * nx - ft * ny
        fy = fn * ny + ft * nx
        force_x[k] = fx
        force_y[k] = fy
        if virial is not None:
            virial_x[k] = fx * dx
            virial_y[k] = fy * dy


@kernel
def add_pair_forces(body, pairs, normal, friction, cell, largest, spring, virial, out, dt):
    """Adds the forces of all pairs to the rows of body.forces, and leaves the sums of f_x branch_x and f_y branch_y in `virial`."""
    if virial is not None:
        virial[:] = 0.0
    used = pairs.start[-1]
    for begin in range(0, used, BLOCK):
        size = min(BLOCK, used - begin)
        pair_columns(body.rows, pairs.first, pairs.second, begin, size, out.pairs, out.whole)
        memory = block(largest, begin, begin + size)
        springs = block(spring, begin, begin + size)
        pair_forces(out.pairs, pairs.reach[begin : begin + size], normal, friction, cell, memory, springs, virial, out, dt)
        add_to_rows(body.forces, pairs.first, pairs.second, begin, size, out.force, friction)
        if virial is not None:
            for k in range(size):
                virial[0] += out.virial_x[k]
                virial[1] += out.virial_y[k]
