"""Moving discs apart: the energy of their overlaps, sum k overlap^2/2, is minimised by FIRE, in one compiled loop.

FIRE (Bitzek et al., Phys. Rev. Lett. 97, 170201, 2006) is molecular dynamics of a marble that runs downhill: velocities are steered towards
the force, the step grows while the power is positive, and everything stops when it is not. Here k = 1, so forces are overlaps in m, and
the inertia of a disc grows with the number of neighbours that fit around it, so that one step suits discs of all sizes.

A periodic cell may breathe: its size is one more coordinate, driven by the difference of pressures, and what is minimised is the enthalpy.
"""

import math
from typing import NamedTuple

import numpy as np

from anisogran.compiled import kernel, subkernel
from anisogran.dem.boundaries import lattice, touch
from anisogran.dem.forces import Memory, add_pair_forces
from anisogran.dem.laws.linear import LinearParameters
from anisogran.dem.neighbours import find_pairs
from anisogran.dem.pairs import separation
from anisogran.dem.rows import FX, FY, INVERSE_MASS, VX, VY, X, Y
from anisogran.dem.stepping import CELL_TOO_SMALL, DONE, LIST_FULL, NOT_FINITE, remember_places

SPRING = LinearParameters(1.0, 0.0)
LONGEST_STEP, SHORTEST_STEP, FIRST_STEP = 0.5, 0.01, 0.1  # in sqrt(mass/k) of a disc of mean size; its neighbours limit it to 0.56
FIRST_MIX, PATIENCE = 0.1, 5  # as published; patience: steps downhill before the step grows
LOOK_EVERY = 20  # steps between two looks at what has been reached
BREATH = 1e-3  # largest strain of the cell in one step

SEPARATE, BALANCED = 101, 102  # ends of a minimisation, besides the codes of stepping.py


class Progress(NamedTuple):
    """Where the minimisation is. It lives in arrays, so that it can be interrupted anywhere without changing a bit."""

    fire: np.ndarray  # [step, mix, velocity of ln(size of the cell), its inertia, size of the cell now by that of the list]
    count: np.ndarray  # [steps done, steps downhill in a row, whether the list is due, pairs needed, lists built]
    worst: np.ndarray  # (2,) the pair that overlaps most; the second is -1 - wall at a wall
    reached: np.ndarray  # [deepest overlap / smaller radius, mean overlap, contacts, mean net force / mean overlap, pressure]
    virial: np.ndarray  # (2,)


STEP, MIX, BREATHING, INERTIA, SIZE = range(5)
STEPS, DOWNHILL, DUE, PAIRS, BUILDS = range(5)
DEEPEST, MEAN_OVERLAP, CONTACTS, UNBALANCED, PRESSURE = range(5)


@kernel
def new_list(body, cell, movable, skin, pairs):
    """Fills the list from positions wrapped into the cell; the grains themselves are not wrapped. Returns what `find_pairs` returns."""
    x = body.x.copy()
    y = body.y.copy()
    if cell is not None:
        for i in range(x.size):
            rows = math.floor(y[i] / cell.height)
            y[i] -= rows * cell.height
            x[i] -= rows * cell.offset
            x[i] -= math.floor(x[i] / cell.width) * cell.width
    return find_pairs(x, y, body.radius, movable, cell, skin, pairs)


@subkernel
def push_from_walls(boundary, walls, body, movable):
    """Adds the overlap with each wall to the forces."""
    if walls is not None:
        for wall in range(walls):
            for i in range(movable):
                overlap, nx, ny, _, _ = touch(boundary, wall, body.x[i], body.y[i], body.radius[i])
                if overlap > 0.0:
                    body.fx[i] -= overlap * nx
                    body.fy[i] -= overlap * ny


@kernel
def look(body, radius, boundary, cell, walls, pairs, movable, progress):
    """Fills `reached`, which it returns, and `worst`: overlaps of the discs as they are, forces of the inflated ones."""
    deepest = -1.0
    total = 0.0
    contacts = 0
    for k in range(pairs.start[-1]):
        i = pairs.first[k]
        j = pairs.second[k]
        dx, dy, _, _ = separation(cell, body.x[j] - body.x[i], body.y[j] - body.y[i], 0.0, 0.0)
        distance = math.sqrt(dx * dx + dy * dy)
        overlap = body.radius[i] + body.radius[j] - distance
        if overlap > 0.0:
            contacts += 1
            total += overlap
            share = (radius[i] + radius[j] - distance) / min(radius[i], radius[j])
            if share > deepest:
                deepest = share
                progress.worst[0] = i
                progress.worst[1] = j
    if walls is not None:
        for wall in range(walls):
            for i in range(movable):
                overlap = touch(boundary, wall, body.x[i], body.y[i], body.radius[i])[0]
                if overlap > 0.0:
                    contacts += 1
                    total += overlap
                    share = (overlap + radius[i] - body.radius[i]) / radius[i]
                    if share > deepest:
                        deepest = share
                        progress.worst[0] = i
                        progress.worst[1] = -1 - wall
    net = 0.0
    for i in range(movable):
        net += math.sqrt(body.fx[i] ** 2 + body.fy[i] ** 2)
    progress.reached[DEEPEST] = deepest
    progress.reached[CONTACTS] = contacts
    progress.reached[MEAN_OVERLAP] = total / contacts if contacts > 0 else 0.0
    progress.reached[UNBALANCED] = net / movable / (total / contacts) if contacts > 0 else 0.0
    progress.reached[PRESSURE] = 0.0
    if cell is not None:
        progress.reached[PRESSURE] = (progress.virial[0] + progress.virial[1]) / (2.0 * cell.width * cell.height)
    return progress.reached


@subkernel
def sums(rows, forces, movable):
    """Power, squared force over mass and squared velocity times mass, summed over the movable grains."""
    power = 0.0
    square_force = 0.0
    square_velocity = 0.0
    for i in range(movable):
        u = rows[i, VX]
        v = rows[i, VY]
        fx = forces[i, FX]
        fy = forces[i, FY]
        power += u * fx + v * fy
        square_force += (fx * fx + fy * fy) * rows[i, INVERSE_MASS]
        square_velocity += (u * u + v * v) / rows[i, INVERSE_MASS]
    return power, square_force, square_velocity


@subkernel
def move(rows, forces, built, movable, keep, gain, step, cap, scale, scale_built):
    """v <- keep v + gain f/m, at most cap/step; x <- scale x + step v. Returns the longest way, beyond the affine one, squared."""
    fastest = cap / step
    farthest = 0.0
    for i in range(movable):
        u = keep * rows[i, VX] + gain * rows[i, INVERSE_MASS] * forces[i, FX]
        v = keep * rows[i, VY] + gain * rows[i, INVERSE_MASS] * forces[i, FY]
        square = u * u + v * v
        if square > fastest * fastest:
            shorter = fastest / math.sqrt(square)
            u *= shorter
            v *= shorter
        rows[i, VX] = u
        rows[i, VY] = v
        rows[i, X] = scale * rows[i, X] + step * u
        rows[i, Y] = scale * rows[i, Y] + step * v
        dx = rows[i, X] - scale_built * built[i, 0]
        dy = rows[i, Y] - scale_built * built[i, 1]
        farthest = max(farthest, dx * dx + dy * dy)
    return farthest


@subkernel
def breath_push(box, pressure, virial):
    """Force on the logarithm of the size of the cell: what its contacts press more than `pressure`; 0 for a cell that does not breathe."""
    if box is not None:  # noqa: SIM102 (only a condition of its own is pruned by the compiler)
        if pressure > 0.0:
            return virial[0] + virial[1] - 2.0 * pressure * box[0] * box[1]
    return 0.0


@subkernel
def breathe(box, fire, keep, gain, push):
    """Kicks and moves the size of the cell; returns the ratio of the new to the old one."""
    scale = 1.0
    if box is not None:
        step = fire[STEP]
        fire[BREATHING] = min(max(keep * fire[BREATHING] + gain * push / fire[INERTIA], -BREATH / step), BREATH / step)
        scale += step * fire[BREATHING]
        box[0] *= scale
        box[1] *= scale
    fire[SIZE] *= scale
    return scale


@subkernel
def steer(progress, power, square_force, square_velocity):
    """Sets step and mix by the sign of the power; returns the share of the velocity that is kept and the gain of velocity by f/m."""
    fire = progress.fire
    if power <= 0.0:
        progress.count[DOWNHILL] = 0
        fire[STEP] = max(0.5 * fire[STEP], SHORTEST_STEP)
        fire[MIX] = FIRST_MIX
        return 0.0, fire[STEP]
    progress.count[DOWNHILL] += 1
    if progress.count[DOWNHILL] > PATIENCE:
        fire[STEP] = min(1.1 * fire[STEP], LONGEST_STEP)
        fire[MIX] *= 0.99
    return 1.0 - fire[MIX], fire[MIX] * math.sqrt(square_velocity / square_force) + fire[STEP]


@kernel
def minimise(body, radius, boundary, box, walls, pairs, movable, skin, cap, pressure, enough, balance, out, progress, steps):
    """Up to `steps` steps; returns SEPARATE (no overlap beyond `enough` of the smaller radius), BALANCED, LIST_FULL, ... or DONE: go on.

    box: the array (width, height, ...) of a periodic cell, or None; it breathes until it bears `pressure` (by k), unless that is 0.
    """
    fire = progress.fire
    count = progress.count
    virial = progress.virial
    reach = 2.0 * body.radius.max()
    for _ in range(steps):
        if count[DUE]:
            count[PAIRS] = new_list(body, lattice(boundary), movable, skin, pairs)
            if count[PAIRS] < 0:
                return CELL_TOO_SMALL
            if count[PAIRS] > pairs.first.size:
                return LIST_FULL
            count[DUE] = 0
            count[BUILDS] += 1
            remember_places(body)
            fire[SIZE] = 1.0
        body.forces[:] = 0.0
        push_from_walls(boundary, walls, body, movable)
        add_pair_forces(body, pairs, Memory(None, None, None, None, None), SPRING, None, lattice(boundary), virial, None, out, 0.0)
        push = breath_push(box, pressure, virial)
        power, square_force, square_velocity = sums(body.rows, body.forces, movable)
        power += push * fire[BREATHING]
        square_force += push * push / fire[INERTIA]
        square_velocity += fire[BREATHING] ** 2 * fire[INERTIA]
        if not square_force + square_velocity < math.inf:
            return NOT_FINITE
        if count[STEPS] % LOOK_EVERY == 0:
            reached = look(body, radius, boundary, lattice(boundary), walls, pairs, movable, progress)
            if pressure == 0.0 and reached[DEEPEST] <= enough:
                return SEPARATE
            if reached[CONTACTS] > 0 and reached[UNBALANCED] < balance and abs(push) <= balance * (virial[0] + virial[1]):
                return BALANCED
        keep, gain = steer(progress, power, square_force, square_velocity)
        scale = breathe(box, fire, keep, gain, push)
        farthest = move(body.rows, body.forces, body.built, movable, keep, gain, fire[STEP], cap, scale, fire[SIZE])
        # grains not in the list were farther apart than radii + skin, now they are farther than SIZE of that, less their two ways
        count[DUE] = 2.0 * math.sqrt(farthest) > min(fire[SIZE], 1.0) * (reach + skin) - reach
        count[STEPS] += 1
    return DONE
