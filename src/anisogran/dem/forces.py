"""All forces on all grains and walls, from the contacts with their memory.

A block of pairs goes through three stages that stay in the first-level cache: rows of grains become columns of pairs, the laws turn the
columns into forces in vector instructions, and the forces are added to the rows of the grains, always in the order of the list, so that a
run can be repeated bit for bit.
"""

from typing import NamedTuple

import numpy as np

from anisogran.compiled import kernel, subkernel
from anisogran.dem.boundaries import lattice, stress_sums
from anisogran.dem.ledger import account_grains, account_images, account_pairs, account_walls, add_losses
from anisogran.dem.pairs import BLOCK, pair_forces
from anisogran.dem.rows import add_to_rows, pair_columns
from anisogran.dem.specialisation import block
from anisogran.dem.walls import add_wall_forces


class Memory(NamedTuple):
    """What contacts remember: (capacity of the list,) for pairs, (walls, N) for walls; None where no effect asks for it."""

    largest: np.ndarray | None  # largest overlap, m
    spring: np.ndarray | None  # stretch of the tangential spring, m
    overlap: np.ndarray | None  # for the energy ledger: overlap in the last step, 0 where open, m
    viscous: np.ndarray | None  # force of the normal dashpot then, N
    tangential: np.ndarray | None  # tangential force then, N


@subkernel
def add_pair_forces(body, pairs, memory, normal, friction, cell, virial, ledger, out, dt):
    """Adds the forces of all pairs to the rows of body.forces, and leaves the sums of f_x branch_x and f_y branch_y in `virial`."""
    if virial is not None:
        virial[:] = 0.0
    used = pairs.start[-1]
    for begin in range(0, used, BLOCK):
        size = min(BLOCK, used - begin)
        pair_columns(body.rows, pairs.first, pairs.second, begin, size, out.pairs, out.whole)
        reach = pairs.reach[begin : begin + size]
        largest = block(memory.largest, begin, begin + size)
        spring = block(memory.spring, begin, begin + size)
        if ledger is not None:
            overlap, viscous = memory.overlap[begin : begin + size], memory.viscous[begin : begin + size]
            tangential = block(memory.tangential, begin, begin + size)
            account_pairs(out.pairs, reach, normal, friction, cell, largest, spring, overlap, viscous, tangential, out.losses, dt)
            add_losses(out.losses, size, ledger, dt)
        pair_forces(out.pairs, reach, normal, friction, cell, largest, spring, virial, out, dt)
        if ledger is not None:
            account_images(out.pairs, size, cell, out.force, out.losses, ledger)
        add_to_rows(body.forces, pairs.first, pairs.second, begin, size, out.force, friction)
        if virial is not None:
            for k in range(size):
                virial[0] += out.virial_x[k]
                virial[1] += out.virial_y[k]


@kernel
def add_all_forces(
    body, spin, pairs, wall_list, memory, wall_memory, normal, friction, wall_friction, drag, boundary, movable, ledger, out, dt
):
    """Adds the forces and torques on all grains and walls to zero, contact memory advanced by dt.

    Those of the movable grains have been cleared by the drift; driven grains and walls press on their boundary until here.
    """
    body.forces[movable:] = 0.0
    largest = wall_memory.largest
    spring = wall_memory.spring
    if ledger is not None:
        account_walls(
            boundary, body, spin, wall_list, normal, wall_friction, largest, spring, wall_memory.overlap, wall_memory.viscous,
            wall_memory.tangential, ledger, dt,
        )  # fmt: skip
    add_wall_forces(boundary, body, spin, wall_list, normal, wall_friction, largest, spring, dt)
    add_pair_forces(body, pairs, memory, normal, friction, lattice(boundary), stress_sums(boundary), ledger, out, dt)
    if ledger is not None:
        account_grains(body.rows, body.forces, movable, drag, ledger, dt)
