"""Forces between grains: one branch-free pass over a block of pairs, which the compiler turns into vector instructions.

Pair (i, j): the normal n points from i to j, the tangent is t = (-n_y, n_x). Both grains share the contact point in the middle of the
overlap, so the lever arms are radius - overlap/2, the same in the slip velocity and in the torque; together they make the distance of
the centres, and angular momentum is conserved to rounding.
"""

import math
from typing import NamedTuple

import numpy as np

from anisogran.compiled import kernel, subkernel
from anisogran.dem.laws import normal_force, tangential_force
from anisogran.dem.rows import DIFFERENCE_RADIUS, DIFFERENCE_SPIN, DU, DV, DX, DY, FX, FY, SUM_SPIN, aligned_zeros
from anisogran.dem.specialisation import unaliased

BLOCK = 256  # pairs; the columns of pairs and of forces take 25 kB


class Scratch(NamedTuple):
    """The columns of one block; what the scene does not need is None."""

    pairs: np.ndarray  # (8, BLOCK), see rows.py
    force: np.ndarray  # (4, BLOCK): on the second grain, F_x, F_y, torque taken from the first grain, torque given to the second
    virial_x: np.ndarray | None  # (BLOCK,) force times branch
    virial_y: np.ndarray | None
    whole: float | None  # None: only positions and velocities are fetched
    losses: np.ndarray | None  # (5, BLOCK) J, see ledger.py


def scratch(virial, whole, ledger=False):
    """Columns for one block: is the stress asked for, does a law want more than positions and velocities, is a book of energies kept?"""
    stresses = (aligned_zeros(BLOCK) if virial else None for _ in range(2))
    return Scratch(
        aligned_zeros((8, BLOCK)),
        aligned_zeros((4, BLOCK)),
        *stresses,
        1.0 if whole else None,
        aligned_zeros((5, BLOCK)) if ledger else None,
    )


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
def direction(dx, dy, distance):
    """Unit vector from the first grain to the second; for coincident centres a fixed one, never 0/0."""
    inverse = 1.0 / distance
    return (dx * inverse, dy * inverse) if distance > 0.0 else (1.0, 0.0)


@kernel
def slip_velocity(nx, ny, du, dv, distance, difference_radius, difference_spin, sum_spin):
    """Velocity of the second grain's surface against the first one's along the tangent, at the middle of the overlap."""
    return dv * nx - du * ny - 0.5 * distance * sum_spin - 0.5 * difference_radius * difference_spin


@kernel
def pair_size(reach, difference_radius):
    """The length 2 a_i a_j/(a_i + a_j) of a pair, from sum and difference of its radii."""
    return 0.5 * (reach - difference_radius * difference_radius / reach)


@subkernel
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
        nx, ny = direction(dx, dy, distance)
        overlap = reach[k] - distance
        touch = 1.0 if overlap > 0.0 else 0.0
        memo = 0.0
        if largest is not None:
            memo = memory[k]
        fn, bound, memo = normal_force(normal, overlap, du * nx + dv * ny, memo, pair_size(reach[k], difference_radius[k]))
        fn *= touch
        if largest is not None:
            memory[k] = memo * touch
        ft = 0.0
        if friction is not None:
            mean_arm = 0.5 * distance
            half = 0.5 * difference_radius[k]
            slip = slip_velocity(nx, ny, du, dv, distance, difference_radius[k], difference_spin[k], sum_spin[k])
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
