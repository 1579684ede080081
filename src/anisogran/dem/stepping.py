"""The time loop: velocity Verlet in half kicks, neighbour list rebuilt when needed, all inside one compiled call.

Forces are taken at the new positions with the half-step velocities. A step is kick, drift, force, kick; the two half kicks of
neighbouring steps stay two additions, so that a run split anywhere gives the same bits as the straight run.
"""

import math
from typing import NamedTuple

import numpy as np

from anisogran.dem.boundaries import advance, lattice, settle
from anisogran.dem.kernel import kernel, unaliased
from anisogran.dem.neighbours import PairList, carry_over, find_pairs
from anisogran.dem.pairs import add_pair_forces, separation
from anisogran.dem.walls import add_wall_forces, find_wall_contacts

CHECK_EVERY = 10  # steps between two looks at how far the grains have moved since the list was built

DEEP_EVERY = 100  # steps between two looks for overlaps that no contact law is meant for

DONE, LIST_FULL, NOT_FINITE, DEEP_OVERLAP, OUTSIDE, TOO_FAST, CELL_TOO_SMALL = range(7)


class Body(NamedTuple):
    """The grains, structure of arrays, each (N,) float64; the driven ones come last."""

    x: np.ndarray
    y: np.ndarray
    vx: np.ndarray
    vy: np.ndarray
    fx: np.ndarray
    fy: np.ndarray
    radius: np.ndarray
    inverse_mass: np.ndarray
    built_x: np.ndarray  # positions when the neighbour list was built
    built_y: np.ndarray


class Counters(NamedTuple):
    """What happened, each (1,): steps, lists built, lists built late, pairs needed, the grain that a failure names, way of the walls."""

    step: np.ndarray
    builds: np.ndarray
    late: np.ndarray
    pairs: np.ndarray
    grain: np.ndarray
    travel: np.ndarray  # (2,) m: since the list was built, and in the last step


@kernel
def kick_and_drift(x, y, vx, vy, fx, fy, inverse_mass, drag, movable, before, after, dt):
    """Two kicks in a row, of lengths `before` and `after`, then a drift of dt; any of the three may be zero."""
    u = unaliased(vx)
    v = unaliased(vy)
    px = unaliased(x)
    py = unaliased(y)
    for i in range(movable):
        ax = fx[i] * inverse_mass[i]
        ay = fy[i] * inverse_mass[i]
        if drag is not None:
            u[i] += before * (ax - drag * inverse_mass[i] * u[i])
            v[i] += before * (ay - drag * inverse_mass[i] * v[i])
            u[i] += after * (ax - drag * inverse_mass[i] * u[i])
            v[i] += after * (ay - drag * inverse_mass[i] * v[i])
        else:
            u[i] += before * ax
            v[i] += before * ay
            u[i] += after * ax
            v[i] += after * ay
        px[i] += dt * u[i]
        py[i] += dt * v[i]


@kernel
def turn(spin, torque, inverse_inertia, movable, before, after):
    """The same two kicks for the spins."""
    if spin is not None:
        w = unaliased(spin)
        for i in range(movable):
            acceleration = torque[i] * inverse_inertia[i]
            w[i] += before * acceleration
            w[i] += after * acceleration


@kernel
def farthest_move(body, cell):
    """Longest way of a grain since the list was built, and the fastest grain's speed; which one is fastest, or nowhere (NaN or inf).

    In a periodic cell these are the non-affine motions.
    """
    farthest = 0.0
    fastest = 0.0
    who = 0
    for i in range(body.x.size):
        dx = body.x[i] - body.built_x[i]
        dy = body.y[i] - body.built_y[i]
        du = body.vx[i]
        if cell is not None:
            dx -= cell.strain * body.built_y[i]
            dy -= (cell.stretch - 1.0) * body.built_y[i]
            du -= cell.shear_speed * body.y[i] / cell.height
        way = dx * dx + dy * dy
        speed = du * du + body.vy[i] ** 2
        if not way + speed < math.inf:
            return math.inf, math.inf, i
        farthest = max(farthest, way)
        if speed > fastest:
            fastest = speed
            who = i
    return math.sqrt(farthest), math.sqrt(fastest), who


@kernel
def deepest_pair(body, pairs, cell):
    """A grain of a pair that overlaps by more than half the smaller radius, or -1."""
    for k in range(pairs.start[-1]):
        i = pairs.first[k]
        j = pairs.second[k]
        dx, dy, _, _ = separation(cell, body.x[j] - body.x[i], body.y[j] - body.y[i], 0.0, 0.0)
        reach = body.radius[i] + body.radius[j] - 0.5 * min(body.radius[i], body.radius[j])
        if dx * dx + dy * dy < reach * reach:
            return np.int64(i)
    return -1


@kernel
def rebuild(body, pairs, wall_list, largest, spring, boundary, movable, skin, counters):
    """A new neighbour list with the old contact memory; returns DONE or what is wrong."""
    settle(boundary, body)
    cell = lattice(boundary)
    old = PairList(pairs.first.copy(), pairs.second.copy(), pairs.start.copy())
    counters.pairs[0] = find_pairs(body.x, body.y, body.radius, movable, cell, skin, pairs)
    if counters.pairs[0] < 0:
        counters.grain[0] = body.radius.argmax()
        return CELL_TOO_SMALL
    if counters.pairs[0] > pairs.first.size:
        pairs.first[:] = old.first
        pairs.second[:] = old.second
        pairs.start[:] = old.start
        # the list stays due, but the grains may have been wrapped: from here no way would be known
        body.built_x[:] = body.x
        body.built_y[:] = body.y
        counters.travel[0] = skin
        return LIST_FULL
    carry_over(old, pairs, largest)
    carry_over(old, pairs, spring)
    counters.builds[0] += 1
    body.built_x[:] = body.x
    body.built_y[:] = body.y
    counters.travel[0] = 0.0
    counters.grain[0] = find_wall_contacts(boundary, body, movable, skin, wall_list)
    if counters.grain[0] >= 0:
        return OUTSIDE
    counters.grain[0] = deepest_pair(body, pairs, cell)
    return DEEP_OVERLAP if counters.grain[0] >= 0 else DONE


@kernel
def add_all_forces(
    body, spin, torque, pairs, wall_list, largest, spring, wall_largest, wall_spring,
    normal, friction, wall_friction, boundary, out, dt,
):  # fmt: skip
    """Forces and torques on all grains and walls, contact memory advanced by dt."""
    body.fx[:] = 0.0
    body.fy[:] = 0.0
    if torque is not None:
        torque[:] = 0.0
    cell = lattice(boundary)
    add_wall_forces(boundary, body, spin, torque, wall_list, normal, wall_friction, wall_largest, wall_spring, dt)
    used = pairs.start[-1]
    add_pair_forces(body, spin, torque, pairs.first[:used], pairs.second[:used], normal, friction, cell, largest, spring, out, dt)


@kernel
def run_steps(
    body, spin, torque, inverse_inertia, pairs, wall_list, largest, spring, wall_largest, wall_spring,
    normal, friction, wall_friction, drag, boundary, movable, skin, reach, step_limit, out, counters, dt, steps,
):  # fmt: skip
    """Up to `steps` steps; returns DONE, or why it stopped early at counters.step (LIST_FULL: make room and call again).

    `reach` is the distance at which grains may touch, `step_limit` the longest way of a grain in one step.
    """
    half = 0.5 * dt
    owed = 0.0  # the second half kick of the step before; it is done together with the first one of the next step
    code = DONE
    for _ in range(steps):
        if counters.step[0] % CHECK_EVERY == 0:
            way, speed, counters.grain[0] = farthest_move(body, lattice(boundary))
            approach = 2.0 * way + counters.travel[0]
            if way == math.inf:
                code = NOT_FINITE
            elif speed * dt > step_limit:
                code = TOO_FAST
            elif approach + CHECK_EVERY * (2.0 * speed * dt + counters.travel[1]) > 0.95 * skin:
                # in a periodic cell the grains are wrapped now: no kick may be owed, or a split run would round differently
                kick_and_drift(body.x, body.y, body.vx, body.vy, body.fx, body.fy, body.inverse_mass, drag, movable, owed, 0.0, 0.0)
                turn(spin, torque, inverse_inertia, movable, owed, 0.0)
                owed = 0.0
                code = rebuild(body, pairs, wall_list, largest, spring, boundary, movable, skin, counters)
                counters.late[0] += code in (DONE, LIST_FULL) and approach > skin
            elif counters.step[0] % DEEP_EVERY == 0:
                deep = deepest_pair(body, pairs, lattice(boundary))
                if deep >= 0:
                    counters.grain[0] = deep
                    code = DEEP_OVERLAP
            if code != DONE:
                break
        kick_and_drift(body.x, body.y, body.vx, body.vy, body.fx, body.fy, body.inverse_mass, drag, movable, owed, half, dt)
        turn(spin, torque, inverse_inertia, movable, owed, half)
        counters.step[0] += 1
        counters.travel[1] = advance(boundary, body, spin, movable, reach, counters.step[0] * dt, dt)
        counters.travel[0] += counters.travel[1]
        add_all_forces(
            body, spin, torque, pairs, wall_list, largest, spring, wall_largest, wall_spring,
            normal, friction, wall_friction, boundary, out, dt,
        )  # fmt: skip
        owed = half
    kick_and_drift(body.x, body.y, body.vx, body.vy, body.fx, body.fy, body.inverse_mass, drag, movable, owed, 0.0, 0.0)
    turn(spin, torque, inverse_inertia, movable, owed, 0.0)
    return code
