"""Forces between grains: one branch-free pass over blocks of the pair list, then a sum onto the grains in a fixed order.

The pass writes into scratch arrays that stay in the first-level cache, so that the compiler turns it into vector instructions; the
sum is scalar and always in the order of the list, so that a run can be repeated bit for bit.

Pair (i, j): the normal n points from i to j, the tangent is t = (-n_y, n_x). Both grains share the contact point in the middle of the
overlap, so the lever arms are radius - overlap/2, the same in the slip velocity and in the torque; together they make the distance of
the centres, and angular momentum is conserved to rounding.
"""

import math
from typing import NamedTuple

import numpy as np

from anisogran.dem.kernel import block, kernel, unaliased
from anisogran.dem.laws import normal_force, tangential_force

BLOCK = 512  # pairs; five scratch arrays of this length take 20 kB


class Scratch(NamedTuple):
    """What the pass over a block leaves for the sum: force on j, and the torques on i and j; each (BLOCK,)."""

    force_x: np.ndarray
    force_y: np.ndarray
    torque_first: np.ndarray
    torque_second: np.ndarray
    overlap: np.ndarray


def scratch(size=BLOCK):
    """Scratch arrays for blocks of `size` pairs."""
    return Scratch(*(np.zeros(size) for _ in Scratch._fields))


@kernel
def separation(cell, dx, dy, du, dv):
    """Difference of position and velocity to the nearest image; unchanged where there is no periodic cell."""
    if cell is not None:
        rows = math.floor(dy / cell.height + 0.5)
        dy -= rows * cell.height
        dx -= rows * cell.offset
        du -= rows * cell.shear_speed
        dx -= math.floor(dx / cell.width + 0.5) * cell.width
    return dx, dy, du, dv


@kernel
def pair_forces(x, y, vx, vy, spin, radius, first, second, normal, friction, cell, largest, spring, out, dt):
    """One block of pairs: forces and torques into `out`, contact memory updated in place (largest overlap, tangential spring)."""
    memory = unaliased(largest)
    springs = unaliased(spring)
    force_x = unaliased(out.force_x)
    force_y = unaliased(out.force_y)
    torque_first = unaliased(out.torque_first)
    torque_second = unaliased(out.torque_second)
    overlaps = unaliased(out.overlap)
    for k in range(first.size):
        i = first[k]
        j = second[k]
        dx, dy, du, dv = separation(cell, x[j] - x[i], y[j] - y[i], vx[j] - vx[i], vy[j] - vy[i])
        distance = math.sqrt(dx * dx + dy * dy)
        inverse = 1.0 / distance
        nx = dx * inverse if distance > 0.0 else 1.0  # coincident centres: a fixed direction, never 0/0
        ny = dy * inverse if distance > 0.0 else 0.0
        overlap = radius[i] + radius[j] - distance
        touch = 1.0 if overlap > 0.0 else 0.0
        memo = 0.0
        if largest is not None:
            memo = memory[k]
        fn, bound, memo = normal_force(normal, overlap, du * nx + dv * ny, memo)
        fn *= touch
        if largest is not None:
            memory[k] = memo * touch
        ft = 0.0
        if friction is not None:
            arm_first = radius[i] - 0.5 * overlap
            arm_second = radius[j] - 0.5 * overlap
            slip = dv * nx - du * ny - arm_first * spin[i] - arm_second * spin[j]
            ft, stretched = tangential_force(friction, springs[k], slip, bound * touch, dt)
            ft *= touch
            springs[k] = stretched * touch
            torque_first[k] = arm_first * ft
            torque_second[k] = arm_second * ft
        force_x[k] = fn * nx - ft * ny
        force_y[k] = fn * ny + ft * nx
        overlaps[k] = overlap


@kernel
def add_pair_forces(body, spin, torque, first, second, normal, friction, cell, largest, spring, out, dt):
    """Adds the forces of all pairs to body.fx, body.fy and torque; in a periodic cell also leaves the sum of f_y branch_y there."""
    fx = body.fx
    fy = body.fy
    virial = 0.0
    for begin in range(0, first.size, BLOCK):
        end = min(begin + BLOCK, first.size)
        i_block = first[begin:end]
        j_block = second[begin:end]
        pair_forces(
            body.x, body.y, body.vx, body.vy, spin, body.radius, i_block, j_block, normal, friction, cell,
            block(largest, begin, end), block(spring, begin, end), out, dt,
        )  # fmt: skip
        for k in range(i_block.size):
            i = i_block[k]
            j = j_block[k]
            fx[i] -= out.force_x[k]
            fy[i] -= out.force_y[k]
            fx[j] += out.force_x[k]
            fy[j] += out.force_y[k]
            if friction is not None:
                torque[i] -= out.torque_first[k]
                torque[j] -= out.torque_second[k]
            if cell is not None:
                dy = body.y[j] - body.y[i]
                virial += out.force_y[k] * (dy - math.floor(dy / cell.height + 0.5) * cell.height)
    if cell is not None:
        cell.virial[0] = virial
