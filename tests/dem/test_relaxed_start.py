"""Deep starts are moved apart: by brute force no overlap is left, and nothing else has changed."""

import numpy as np
import pytest

from anisogran.dem import Box, Grains, Linear, Open, Periodic, Ring, Simulation, relaxed
from anisogran.outcome import InputError, RunFailed


def deepest(grains, period=None):
    """The largest overlap of two grains by the smaller radius."""
    i, j = np.triu_indices(len(grains), 1)
    branch = grains.position[j] - grains.position[i]
    if period is not None:
        branch -= np.rint(branch / period) * period
    overlap = grains.radius[i] + grains.radius[j] - np.hypot(*branch.T)
    return (overlap / np.minimum(grains.radius[i], grains.radius[j])).max()


@pytest.mark.hard_case("D13")
def test_a_start_that_was_refused_is_accepted_afterwards(answer):
    deep = Grains([[0.0, 0.0], [0.3, 0.0], [5.0, 0.0]], [0.5, 0.5, 0.5], velocity=[[1.0, 2.0]] * 3, spin=[1.0, 2.0, 3.0])
    with pytest.raises(InputError, match=r"dem\.relaxed moves such grains apart") as caught:
        Simulation(deep, Linear(1e3))
    answer.refused(caught)
    apart = relaxed(deep)
    assert deepest(apart) <= 0.01
    Simulation(apart, Linear(1e3))
    assert np.abs(apart.position[:2].mean(axis=0) - deep.position[:2].mean(axis=0)).max() < 0.01  # pushed alike, but for the nudge
    assert np.hypot(*(apart.position[2] - deep.position[2])) < 0.01 * 0.5  # only nudged
    np.testing.assert_array_equal(apart.velocity, deep.velocity)
    np.testing.assert_array_equal(apart.spin, deep.spin)


def test_grains_that_need_no_move_come_back_as_they_are():
    grains = Grains([[0.0, 0.0], [0.996, 0.0]], [0.5, 0.5])  # 0.8 % of a radius
    assert relaxed(grains) is grains


@pytest.mark.parametrize("count", [2, 3, 30])
def test_coincident_centres_part_and_always_alike(count):
    one, again = (relaxed(Grains(np.ones((count, 2)), np.full(count, 0.5)), overlap=0.0) for _ in range(2))
    assert deepest(one) <= 0.0
    np.testing.assert_array_equal(one.position, again.position)


def test_a_row_that_presses_only_along_itself_buckles():
    """Seven discs in balance around a periodic cell with room for six in a row."""
    row = np.stack([np.arange(7) * 6.0 / 7.0, np.full(7, 3.0)], axis=1)
    apart = relaxed(Grains(row, np.full(7, 0.5)), Periodic(6.0, 6.0))
    assert deepest(apart, 6.0) <= 0.01


def test_driven_grains_stay_where_they_are():
    deep = Grains([[0.1, 0.0], [0.0, 0.0], [0.05, 0.0]], [0.5, 0.5, 0.5], driven=2)
    apart = relaxed(deep)
    np.testing.assert_array_equal(apart.position[1:], deep.position[1:])
    assert np.hypot(*(apart.position[0] - apart.position[1:]).T).min() >= 1.0 - 0.01 * 0.5


@pytest.mark.hard_case("D13")
@pytest.mark.parametrize("name", ["open", "box", "ring", "periodic"])
def test_random_points_become_grains_that_do_not_overlap(name, rng):
    side, radius = 20.0, rng.uniform(0.4, 0.8, 150)  # area fraction 0.44; 0.56 in the ring
    boundary = {"open": Open(), "box": Box(side, side), "ring": Ring(side / 2), "periodic": Periodic(side, side)}[name]
    position = rng.uniform(0.15 * side, 0.85 * side, (150, 2)) - (side / 2 if name == "ring" else 0.0)
    apart = relaxed(Grains(position, radius), boundary, overlap=0.02)
    assert deepest(apart, side if name == "periodic" else None) <= 0.02
    if name == "box":
        assert np.all(apart.position > 0.98 * radius[:, None])
        assert np.all(apart.position < side - 0.98 * radius[:, None])
    if name == "ring":
        assert np.all(np.hypot(*apart.position.T) < side / 2 - 0.98 * radius)


def test_walls_push_grains_back():
    apart = relaxed(Grains([[-0.2, 3.0], [9.9, 9.9]], [0.5, 0.5]), Box(10.0, 10.0))
    assert np.all(apart.position >= 0.99 * 0.5)
    assert np.all(apart.position <= 10.0 - 0.99 * 0.5)


@pytest.mark.hard_case("D13")
def test_too_many_grains_for_the_room_are_named(rng, answer):
    with pytest.raises(
        RunFailed, match=r"overlap by .* of the smaller radius, where at most 1\.00% are wanted; they are too many"
    ) as caught:
        relaxed(Grains(rng.uniform(0, 5, (60, 2)), np.full(60, 0.5)), Box(5.0, 5.0))
    answer.named(caught)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"grains": None}, "must be a dem.Grains record"),
        ({"boundary": "box"}, "must be one of Open, Box, Ring, Periodic"),
        ({"overlap": -0.1}, "overlap = -0.1 must be at least 0"),
        ({"overlap": 0.5}, "overlap = 0.5 must be at most 0.2"),
        ({"boundary": Periodic(2.0, 2.0)}, "narrower than four of the largest radii"),
    ],
)
def test_what_cannot_be_relaxed_is_refused(arguments, words):
    with pytest.raises(InputError, match=words):
        relaxed(**{"grains": Grains([[0.0, 0.0], [0.1, 0.0]], [0.5, 0.5]), **arguments})
