"""The time loop: velocity Verlet in half kicks, neighbour list rebuilt when needed, all inside one compiled call.

Forces are taken at the new positions with the half-step velocities. A step is kick, drift, force, kick; the two half kicks of
neighbouring steps stay two additions, so that a run split anywhere gives the same bits as the straight run.
"""

import math
from typing import NamedTuple

import numpy as np

from anisogran.compiled import kernel, subkernel
from anisogran.dem.boundaries import advance, lattice, settle
from anisogran.dem.forces import add_all_forces
from anisogran.dem.ledger import BOUNDARY
from anisogran.dem.neighbours import PairList, carry_over, find_pairs, overwrite
from anisogran.dem.pairs import separation
from anisogran.dem.rows import FX, FY, INVERSE_INERTIA, INVERSE_MASS, RADIUS, SPIN, TORQUE, VX, VY, X, Y, aligned_zeros
from anisogran.dem.walls import find_wall_contacts

CHECK_EVERY = 10  # steps between two looks at how far the grains have moved since the list was built

DEEP_EVERY = 30  # steps between two looks for overlaps that no contact law is meant for; a contact lasts fifty by default
DEEP, TOO_DEEP = 0.05, 0.5  # shares of the smaller radius

DONE, LIST_FULL, NOT_FINITE, DEEP_OVERLAP, OUTSIDE, TOO_FAST, CELL_TOO_SMALL = range(7)


class Body(NamedTuple):
    """The grains: a row each (see rows.py), and the columns of these rows by name; the driven grains come last."""

    rows: np.ndarray  # (N, 8)
    forces: np.ndarray  # (N, 4)
    x: np.ndarray  # from here: views of the above, (N,) each
    y: np.ndarray
    vx: np.ndarray
    vy: np.ndarray
    fx: np.ndarray
    fy: np.ndarray
    radius: np.ndarray
    built: np.ndarray  # (N, 2) positions when the neighbour list was built


def body_of(rows):
    """A Body of these rows of grains, without forces."""
    forces = aligned_zeros((len(rows), 4))
    columns = [rows[:, X], rows[:, Y], rows[:, VX], rows[:, VY], forces[:, FX], forces[:, FY], rows[:, RADIUS]]
    return Body(rows, forces, *columns, rows[:, :2].copy())


class Counters(NamedTuple):
    """What happened."""

    step: np.ndarray  # (1,) steps done
    builds: np.ndarray  # (1,) lists built
    late: np.ndarray  # (1,) lists built late
    pairs: np.ndarray  # (1,) pairs needed
    grain: np.ndarray  # (1,) the grain that a failure names
    travel: np.ndarray  # (3,) m: way of the walls since the list was built, in the last step; longest way of a grain in a step
    deep: np.ndarray  # (3,) the deepest pair, and most pairs at one time that are deeper than DEEP
    deepest: np.ndarray  # (1,) the largest overlap seen, as a share of the smaller radius

    @classmethod
    def zero(cls):
        """At the start."""
        sizes = {"travel": (3, float), "deep": (3, np.int64), "deepest": (1, float)}
        return cls(*(np.zeros(*sizes.get(name, (1, np.int64))) for name in cls._fields))


@subkernel
def kick_and_drift(rows, forces, spin, gravity, drag, movable, before, after, dt):
    """Two kicks in a row, of lengths `before` and `after`, then a drift of dt; any of the three may be zero. Spins are kicked alike.

    After a drift the forces are of no use any more: they are cleared here, where they are at hand, for the next sum.
    """
    for i in range(movable):
        inverse = rows[i, INVERSE_MASS]
        ax = forces[i, FX] * inverse
        ay = forces[i, FY] * inverse
        if gravity is not None:
            ax += gravity[0]
            ay += gravity[1]
        u = rows[i, VX]
        v = rows[i, VY]
        if drag is not None:
            u += before * (ax - drag * inverse * u)
            v += before * (ay - drag * inverse * v)
            u += after * (ax - drag * inverse * u)
            v += after * (ay - drag * inverse * v)
        else:
            u += before * ax
            v += before * ay
            u += after * ax
            v += after * ay
        rows[i, VX] = u
        rows[i, VY] = v
        rows[i, X] += dt * u
        rows[i, Y] += dt * v
        if spin is not None:
            acceleration = forces[i, TORQUE] * rows[i, INVERSE_INERTIA]
            w = rows[i, SPIN] + before * acceleration
            rows[i, SPIN] = w + after * acceleration
        if dt > 0.0:
            for k in range(4):
                forces[i, k] = 0.0


@subkernel
def farthest_move(body, cell):
    """Longest way of a grain since the list was built, and the fastest grain's speed; which one is fastest, or nowhere (NaN or inf).

    In a periodic cell these are the non-affine motions.
    """
    farthest = 0.0
    fastest = 0.0
    who = 0
    for i in range(body.x.size):
        dx = body.x[i] - body.built[i, 0]
        dy = body.y[i] - body.built[i, 1]
        du = body.vx[i]
        dv = body.vy[i]
        if cell is not None:
            dx -= cell.strain * body.built[i, 1] + (cell.stretch_x - 1.0) * body.built[i, 0]
            dy -= (cell.stretch_y - 1.0) * body.built[i, 1]
            du -= cell.shear_speed * body.y[i] / cell.height + cell.column_speed * body.x[i] / cell.width
            dv -= cell.row_speed * body.y[i] / cell.height
        way = dx * dx + dy * dy
        speed = du * du + dv * dv
        if not way + speed < math.inf:
            return math.inf, math.inf, i
        farthest = max(farthest, way)
        if speed > fastest:
            fastest = speed
            who = i
    return math.sqrt(farthest), math.sqrt(fastest), who


@subkernel
def look_for_deep_pairs(body, pairs, cell, counters):
    """Counts the pairs that overlap by more than DEEP of the smaller radius; DEEP_OVERLAP if one does by more than TOO_DEEP, else DONE."""
    count = 0
    deepest = 0.0
    for k in range(pairs.start[-1]):
        i = pairs.first[k]
        j = pairs.second[k]
        dx, dy, _, _ = separation(cell, body.x[j] - body.x[i], body.y[j] - body.y[i], 0.0, 0.0)
        smaller = min(body.radius[i], body.radius[j])
        reach = pairs.reach[k] - DEEP * smaller
        square = dx * dx + dy * dy
        if square < reach * reach:
            count += 1
            overlap = (pairs.reach[k] - math.sqrt(square)) / smaller
            if overlap > deepest:
                deepest = overlap
                counters.grain[0] = i
                if overlap > counters.deepest[0]:
                    counters.deepest[0] = overlap
                    counters.deep[0] = i
                    counters.deep[1] = j
    counters.deep[2] = max(counters.deep[2], count)
    return DEEP_OVERLAP if deepest > TOO_DEEP else DONE


@subkernel
def remember_places(body):
    """Counts the ways of the grains from here."""
    for i in range(body.x.size):
        body.built[i, 0] = body.x[i]
        body.built[i, 1] = body.y[i]


@subkernel
def translation_energy(rows, movable):
    """Kinetic energy of the translation of the movable grains in J."""
    total = 0.0
    for i in range(movable):
        total += 0.5 * (rows[i, VX] ** 2 + rows[i, VY] ** 2) / rows[i, INVERSE_MASS]
    return total


@kernel
def rebuild(body, pairs, wall_list, memory, boundary, movable, skin, ledger, counters):
    """A new neighbour list with the old contact memory; returns DONE or what is wrong."""
    if ledger is not None:
        ledger[BOUNDARY] -= translation_energy(body.rows, movable)
    settle(boundary, body)
    if ledger is not None:  # a grain that comes back through the other side of a moving lattice has another velocity
        ledger[BOUNDARY] += translation_energy(body.rows, movable)
    cell = lattice(boundary)
    old = PairList(pairs.first.copy(), pairs.second.copy(), pairs.reach.copy(), pairs.start.copy())
    counters.pairs[0] = find_pairs(body.x, body.y, body.radius, movable, cell, skin, pairs)
    if counters.pairs[0] < 0:
        counters.grain[0] = 0
        for i in range(body.radius.size):
            if body.radius[i] > body.radius[counters.grain[0]]:
                counters.grain[0] = i
        return CELL_TOO_SMALL
    if counters.pairs[0] > pairs.first.size:
        overwrite(pairs.first, old.first)
        overwrite(pairs.second, old.second)
        overwrite(pairs.reach, old.reach)
        overwrite(pairs.start, old.start)
        # the list stays due, but the grains may have been wrapped: from here no way would be known
        remember_places(body)
        counters.travel[0] = skin
        return LIST_FULL
    carry_over(old, pairs, memory.largest)
    carry_over(old, pairs, memory.spring)
    carry_over(old, pairs, memory.overlap)
    carry_over(old, pairs, memory.viscous)
    carry_over(old, pairs, memory.tangential)
    counters.builds[0] += 1
    remember_places(body)
    counters.travel[0] = 0.0
    counters.grain[0] = find_wall_contacts(boundary, body, movable, skin, wall_list)
    if counters.grain[0] >= 0:
        return OUTSIDE
    return look_for_deep_pairs(body, pairs, cell, counters)


@kernel
def run_steps(
    body, spin, pairs, wall_list, memory, wall_memory, normal, friction, wall_friction, gravity, drag, boundary, movable, skin, reach,
    step_limit, ledger, out, counters, dt, steps,
):  # fmt: skip
    """Up to `steps` steps; returns DONE, or why it stopped early at counters.step (LIST_FULL: make room and call again).

    `reach` is the distance at which grains may touch, `step_limit` the longest way of a grain in one step.
    """
    half = 0.5 * dt
    owed = 0.0  # the second half kick of the step before; it is done together with the first one of the next step
    code = DONE
    for _ in range(steps):
        if counters.step[0] % CHECK_EVERY == 0:
            # no kick may be owed when the list is judged and the grains are wrapped, or a split run would do so by other velocities
            kick_and_drift(body.rows, body.forces, spin, gravity, drag, movable, owed, 0.0, 0.0)
            owed = 0.0
            way, speed, counters.grain[0] = farthest_move(body, lattice(boundary))
            approach = 2.0 * way + counters.travel[0]
            counters.travel[2] = max(counters.travel[2], speed * dt)
            if way == math.inf:
                code = NOT_FINITE
            elif max(speed * dt, counters.travel[1]) > step_limit:
                code = TOO_FAST
            elif approach + CHECK_EVERY * (2.0 * speed * dt + counters.travel[1]) > 0.95 * skin:
                code = rebuild(body, pairs, wall_list, memory, boundary, movable, skin, ledger, counters)
                counters.late[0] += code in (DONE, LIST_FULL) and approach > skin
            elif counters.step[0] % DEEP_EVERY == 0:
                code = look_for_deep_pairs(body, pairs, lattice(boundary), counters)
            if code != DONE:
                break
        kick_and_drift(body.rows, body.forces, spin, gravity, drag, movable, owed, half, dt)
        counters.step[0] += 1
        counters.travel[1] = advance(boundary, body, spin, movable, reach, counters.step[0] * dt, dt)
        counters.travel[0] += counters.travel[1]
        add_all_forces(
            body, spin, pairs, wall_list, memory, wall_memory, normal, friction, wall_friction, drag, boundary, movable, ledger, out, dt
        )
        owed = half
    kick_and_drift(body.rows, body.forces, spin, gravity, drag, movable, owed, 0.0, 0.0)
    return code
