"""The neighbour list: complete, rebuilt in time, grown when needed, and contact memory that stays with its pair."""

import numba
import numpy as np
import pytest
from crowds import FRICTION, LAW, crowd, state

from anisogran.dem import Box, Cosine, Friction, Grains, Linear, Luding, Periodic, Pressure, Simulation, collision_time
from anisogran.dem.boundaries import periodic
from anisogran.dem.neighbours import PairList, carry_over, empty_pair_list, find_pairs
from anisogran.dem.packing import uniform_radii
from anisogran.dem.state import make_room


@numba.njit
def listed_pairs(x, y, radius, movable, cell, skin, pairs):
    """The way into a kernel that only other kernels call."""
    return find_pairs(x, y, radius, movable, cell, skin, pairs)


@pytest.mark.hard_case("D17")
@pytest.mark.parametrize("cell", [None, "periodic"])
def test_neighbour_list_is_complete_and_has_no_pair_twice(cell, rng):
    radius = uniform_radii(150, 1.0, 20.0, rng)
    side = 30.0
    x, y = rng.uniform(0, side, (2, 150))
    lattice = None
    if cell is not None:
        boundary = Periodic(side, side).state()
        boundary.lattice[2] = 7.3  # a sheared cell
        lattice = periodic.lattice(boundary)
    pairs = empty_pair_list(150, 150 * 149 // 2)
    found = listed_pairs(x, y, radius, 150, lattice, 0.3, pairs)
    listed = set(zip(pairs.first[:found].tolist(), pairs.second[:found].tolist(), strict=True))
    i, j = np.triu_indices(150, 1)
    dx, dy = x[j] - x[i], y[j] - y[i]
    if lattice is not None:
        rows = np.floor(dy / side + 0.5)
        dy, dx = dy - rows * side, dx - rows * 7.3
        dx -= np.floor(dx / side + 0.5) * side
    near = np.hypot(dx, dy) < radius[i] + radius[j] + 0.3
    assert len(listed) == found
    assert listed == set(zip(i[near].tolist(), j[near].tolist(), strict=True))


def test_contact_memory_survives_a_rebuild(rng):
    """Springs belong to pairs, not to places in the list: a run with a tiny skin (rebuilt all the time) gives the same contacts."""
    grains, side = crowd(rng)
    wide, narrow = (Simulation(grains, LAW, friction=FRICTION, boundary=Box(side, side), skin=skin) for skin in (1e-3, 5e-5))
    for sim in (wide, narrow):
        sim.run(1500)
    assert narrow.counters["builds"] > 5 * wide.counters["builds"]
    # only the order of the sums differs; collisions amplify the rounding by a few digits
    np.testing.assert_allclose(narrow.position, wide.position, atol=1e-12)


def test_memory_follows_its_pair_to_another_place():
    """Pairs 01, 02, 12 hold 1, 2, 3; in the list 02, 13, 12 they are found again, and the new pair begins with nothing."""
    old = PairList(np.array([0, 0, 1]), np.array([1, 2, 2]), np.ones(3), np.array([0, 2, 3, 3, 3]))
    new = PairList(np.array([0, 1, 1]), np.array([2, 3, 2]), np.ones(3), np.array([0, 1, 3, 3, 3]))
    memory = np.array([1.0, 2.0, 3.0])
    carry_over.py_func(old, new, memory)
    np.testing.assert_array_equal(memory, [2.0, 0.0, 3.0])


def test_lists_grow_when_needed(rng):
    """A skin that reaches everywhere lists every pair, more than there is room for at first."""
    grains, side = crowd(rng, count=40, fraction=0.05)
    sim = Simulation(grains, Linear(1e5, 0.1), boundary=Box(side, side), skin=10 * side)
    assert sim.counters["pairs"] == 40 * 39 // 2


@pytest.mark.parametrize("name", ["box", "periodic"])
def test_lists_grow_during_a_run(name):
    """Grains are pressed together until the list that they began with is too short: bit for bit the run that had room from the start."""
    rng = np.random.default_rng(1)
    side, count = 24.0, 64
    position = 3.0 * np.stack(np.meshgrid(np.arange(8), np.arange(8)), -1).reshape(-1, 2) + 1.5
    grains = Grains(position, rng.uniform(0.5, 0.8, count), mass=np.ones(count), velocity=rng.normal(0, 0.5, (count, 2)))
    boundary = {
        "box": Box(side, side, right=Pressure(20.0, 30.0, 200.0), top=Cosine(side, 0.4 * side, 3.0)),
        "periodic": Periodic(side, side, shear_rate=0.2, pressure=(None, 5.0), viscosity=15.0),
    }[name]
    short, roomy = (Simulation(grains, Luding(500.0, 1e3, 200.0, 5.0), Friction(200.0, 0.5), boundary=boundary, skin=3.0) for _ in range(2))
    roomy._state.counters.pairs[0] = 5000
    make_room(roomy._state)
    room = short._state.pairs.first.size
    for sim in (short, roomy):
        sim.run(2000)
    assert short._state.pairs.first.size > room
    np.testing.assert_array_equal(state(short), state(roomy))
    assert short.counters == roomy.counters
    assert short.counters["late_builds"] == 0


@pytest.mark.hard_case("D17")
@pytest.mark.parametrize("share", [0.35, 0.05])
def test_the_list_is_rebuilt_before_grains_can_meet(share):
    """Two grains just out of each other's list fly together, each `share` of the skin in ten steps: nothing is late, nothing is missed."""
    law, skin = Linear(1e3), 0.1
    speed = share * skin / (10 * collision_time(law, np.ones(2)) / 50)
    grains = Grains([[0.0, 0.0], [1.0 + 1.02 * skin, 0.0]], [0.5, 0.5], mass=[1.0, 1.0], velocity=[[speed, 0.0], [-speed, 0.0]])
    alone, listed = Simulation(grains, law, skin=skin), Simulation(grains, law, skin=5.0)
    for sim in (alone, listed):
        sim.run(int(1.02 / (0.2 * share)) + 20)  # to the touch and 20 of the 50 steps of the contact
    assert listed.counters["builds"] == 1
    assert alone.counters["late_builds"] == 0
    assert abs(alone.velocity[0, 0]) < 0.9 * speed  # they have met
    np.testing.assert_array_equal(alone.position, listed.position)
