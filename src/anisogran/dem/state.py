"""The state of a simulation: every array that the kernels work on, made for exactly the effects of the scene."""

from types import SimpleNamespace

import numpy as np

from anisogran.dem.forces import Memory, add_all_forces
from anisogran.dem.ledger import POWER_BEFORE
from anisogran.dem.neighbours import PairList, empty_pair_list
from anisogran.dem.pairs import scratch
from anisogran.dem.rows import SPIN, aligned_zeros, grain_rows
from anisogran.dem.stepping import Counters, body_of, rebuild
from anisogran.dem.walls import empty_wall_list


def new_state(grains, effects, boundary, skin, ledger, capacity=None):
    """The state at the start, without pair list and forces. `effects`: the dict of a Simulation; capacity: of the pair list.

    An absent effect is None, here and in the kernels, and has no array.
    """
    n, walls = len(grains), boundary.walls
    movable = n - grains.driven
    normal, friction, wall_friction = effects["normal"], effects["friction"], effects["wall_friction"] if walls else None
    reach = 2 * float(grains.radius.max()) + skin
    order = memory_order(grains.position, movable, reach)
    body = body_of(grain_rows(grains, order))
    pairs = empty_pair_list(n, 6 * n + 64 if capacity is None else capacity)
    moving = boundary.state()
    return SimpleNamespace(
        order=order,
        body=body,
        spin=body.rows[:, SPIN] if friction is not None or wall_friction is not None else None,
        pairs=pairs,
        wall_list=empty_wall_list(n, walls),
        memory=memory_of(pairs.first.size, normal.remembers, friction is not None, ledger),
        wall_memory=memory_of((walls, n), normal.remembers and walls, wall_friction is not None, ledger and walls),
        normal=normal.parameters(),
        friction=None if friction is None else friction.parameters(),
        wall_friction=None if wall_friction is None else wall_friction.parameters(),
        gravity=effects["gravity"],
        drag=effects["drag"],
        boundary=moving,
        movable=movable,
        skin=skin,
        reach=reach,
        step_limit=0.5 * float(grains.radius.min()),
        ledger=np.zeros(POWER_BEFORE + 1) if ledger else None,
        energy_at_start=0.0,
        out=scratch(getattr(moving, "virial", None) is not None, friction is not None or normal.sees_size, ledger),
        counters=Counters.zero(),
    )


def new_list(state):
    """Builds the neighbour list anew; returns what the kernel says."""
    s = state
    return rebuild(s.body, s.pairs, s.wall_list, s.memory, s.boundary, s.movable, s.skin, s.ledger, s.counters)


def find_forces(state):
    """Finds the forces at the present positions and velocities; springs do not stretch in no time."""
    s = state
    s.body.forces[:] = 0.0
    add_all_forces(
        s.body, s.spin, s.pairs, s.wall_list, s.memory, s.wall_memory, s.normal, s.friction, s.wall_friction, s.drag, s.boundary,
        s.movable, s.ledger, s.out, 0.0,
    )  # fmt: skip


def make_room(state):
    """Longer arrays for the list and its memory, with a reserve of a quarter."""
    s = state
    used = int(s.pairs.start[-1])
    longer = empty_pair_list(len(s.order), int(1.25 * s.counters.pairs[0]) + 64)
    longer.first[:used] = s.pairs.first[:used]
    longer.second[:used] = s.pairs.second[:used]
    longer.reach[:used] = s.pairs.reach[:used]
    s.pairs = PairList(longer.first, longer.second, longer.reach, s.pairs.start)
    kept = s.memory
    s.memory = memory_of(longer.first.size, kept.largest is not None, kept.spring is not None, kept.overlap is not None)
    for mine, theirs in zip(s.memory, kept, strict=True):
        if theirs is not None:
            mine[:used] = theirs[:used]


def inherit(state, before, order=None):
    """Takes over the pair list and the contact memory of the stage before, in the order in which `state` keeps its grains.

    `order` (N,): the numbers that the user's grains had in the stage before, if they are renumbered.
    """
    s = state
    place = np.empty(len(s.order), np.int64)
    place[s.order if order is None else order[s.order]] = np.arange(len(s.order))
    moved = place[before.order]  # where the grains of the stage before are now
    used = int(before.pairs.start[-1])
    ends = moved[np.stack([before.pairs.first[:used], before.pairs.second[:used]])]
    first, second = ends.min(axis=0), ends.max(axis=0)
    by_first = np.argsort(first, kind="stable")
    s.counters.pairs[0] = used
    make_room(s)
    s.pairs.first[:used], s.pairs.second[:used] = first[by_first], second[by_first]
    s.pairs.reach[:used] = before.pairs.reach[:used][by_first]
    s.pairs.start[:] = np.searchsorted(s.pairs.first[:used], np.arange(len(s.order) + 1))
    for mine, theirs in zip(s.memory, before.memory, strict=True):
        if mine is not None and theirs is not None:
            mine[:used] = theirs[:used][by_first]
    for mine, theirs in zip(s.wall_memory, before.wall_memory, strict=True):
        if mine is not None and theirs is not None and mine.shape == theirs.shape:
            mine[:, moved] = theirs


def memory_of(shape, remembers, rubs, accounted):
    """Contact memory of that shape for the effects that want it."""
    asked = (remembers, rubs, accounted, accounted, accounted and rubs)
    return Memory(*(aligned_zeros(shape) if wanted else None for wanted in asked))


def memory_order(position, movable, reach):
    """The order in which the grains are kept, (N,): row by row of square cells, so that neighbours in space are neighbours in memory.

    Driven grains stay the last ones, in their own order.
    """
    row, column = (np.floor(position[:movable, axis] / reach) for axis in (1, 0))
    return np.concatenate([np.lexsort((column, row)), np.arange(movable, len(position))]).astype(np.int64)
