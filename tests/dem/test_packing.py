"""Dense packings: exact area fraction, no overlap below jamming, equilibrium and pressure above it, checked by sums over all pairs."""

import numpy as np
import pytest

from anisogran.dem import Friction, Grains, Luding, Periodic, Simulation, dense_packing
from anisogran.dem.fire import BUILDS, DUE
from anisogran.dem.minimisation import Minimisation
from anisogran.dem.packing import uniform_radii
from anisogran.outcome import InputError, RunFailed

STIFFNESS = 1e5


def contacts(packed):
    """Of all overlapping pairs, by brute force: i, j, overlap (m), branch vector from i to j to its nearest image."""
    i, j = np.triu_indices(len(packed.radius), 1)
    branch = packed.position[j] - packed.position[i]
    branch -= np.rint(branch / (packed.width, packed.height)) * (packed.width, packed.height)
    overlap = packed.radius[i] + packed.radius[j] - np.hypot(*branch.T)
    closed = overlap > 0
    return i[closed], j[closed], overlap[closed], branch[closed]


def measured(packed):
    """(unbalanced force, pressure, mean contacts, mean overlap) of linear springs."""
    i, j, overlap, branch = contacts(packed)
    force = STIFFNESS * (overlap / np.hypot(*branch.T))[:, None] * branch
    net = np.zeros_like(packed.position)
    np.subtract.at(net, i, force)
    np.add.at(net, j, force)
    pressure = np.einsum("cd,cd->", force, branch) / (2 * packed.width * packed.height)
    return np.hypot(*net.T).mean() / (STIFFNESS * overlap.mean()), pressure, 2 * len(i) / len(packed.radius), overlap.mean()


@pytest.fixture
def radius(rng):
    return uniform_radii(800, 1e-3, 3.0, rng)


def test_packing_above_jamming_is_in_equilibrium(radius):
    packed = dense_packing(radius, 0.86, stiffness=STIFFNESS, aspect=1.5)
    unbalanced, pressure, mean_contacts, mean_overlap = measured(packed)
    assert unbalanced < 1e-3  # what was asked for
    assert pressure > 0
    assert packed.width / packed.height == pytest.approx(1.5, rel=1e-14)  # rounding
    assert np.pi * np.sum(radius**2) / (packed.width * packed.height) == pytest.approx(0.86, rel=1e-14)  # rounding
    assert np.all((packed.position >= 0) & (packed.position < (packed.width, packed.height)))
    # the same sums in another order
    found = (packed.unbalanced_force, packed.pressure, packed.mean_contacts, packed.mean_overlap)
    np.testing.assert_allclose(found, (unbalanced, pressure, mean_contacts, mean_overlap), rtol=1e-8)


def test_packing_at_086_looks_like_any_such_packing():
    """Contacts a disc 4.27 and overlap by mean diameter 4.9e-3, those of 10,000 discs quenched by another program."""
    radius = uniform_radii(4000, 1e-3, 3.0, np.random.default_rng(7))
    packed = dense_packing(radius, 0.86)
    # area fraction of jamming scatters by about 0.1/sqrt(N) = 0.002 of the 0.018 above jamming, and the protocol shifts it by as much
    assert packed.mean_overlap / 2e-3 == pytest.approx(4.9e-3, rel=0.25)
    assert packed.mean_contacts == pytest.approx(4.27, abs=0.12)  # grows by about 0.35 sqrt(overlap/1e-3): a quarter of it is 0.1


def test_no_contact_is_missed_between_two_neighbour_lists(rng):
    """The cell shrinks and the discs move: after every step all that touch are in the list, unless a new one is due."""
    radius, side = uniform_radii(150, 1.0, 3.0, rng), 30.0
    run = Minimisation(rng.uniform(0, side, (150, 2)), radius, Periodic(side, side), np.arange(150), skin=0.8, cap=0.1)
    run.press(0.02)
    i, j = np.triu_indices(150, 1)
    for steps in range(1, 301):
        run.run(0.0, 0.0, steps)
        if not run.progress.count[DUE]:
            branch = run.position[j] - run.position[i]
            branch -= np.rint(branch / run.cell) * run.cell
            closed = np.hypot(*branch.T) < radius[i] + radius[j]
            used = run._pairs.start[-1]
            listed = set(zip(run._pairs.first[:used].tolist(), run._pairs.second[:used].tolist(), strict=True))
            assert set(zip(i[closed].tolist(), j[closed].tolist(), strict=True)) <= listed
    assert run.cell[0] < 0.9 * side
    assert run.progress.count[BUILDS] < 100


@pytest.mark.parametrize("area_fraction", [0.3, 0.8])
def test_below_jamming_nothing_overlaps(radius, area_fraction):
    packed = dense_packing(radius, area_fraction)
    assert len(contacts(packed)[0]) == 0
    assert packed.area_fraction == pytest.approx(area_fraction, rel=1e-14)  # rounding
    assert packed.pressure == packed.mean_contacts == packed.mean_overlap == packed.unbalanced_force == 0


@pytest.mark.parametrize("pressure", [100.0, 2000.0])
def test_pressure_is_reached(radius, pressure):
    packed = dense_packing(radius, pressure=pressure, stiffness=STIFFNESS)
    unbalanced, found, _, _ = measured(packed)
    assert found == pytest.approx(pressure, rel=1.1e-3)  # asked for: 1e-3, of the sum over the contacts itself
    assert unbalanced < 1e-3
    assert 0.83 < packed.area_fraction < 0.9  # just above jamming; 2,000 N/m are a fiftieth of the stiffness


def test_a_closer_equilibrium_can_be_asked_for(radius):
    packed = dense_packing(radius, pressure=1000.0, stiffness=STIFFNESS, unbalanced_force=1e-6)
    assert measured(packed)[0] < 1e-6


def test_same_seed_same_bits_other_seed_other_packing(radius):
    one, again, other = (dense_packing(radius, 0.8, seed=seed) for seed in (3, 3, 4))
    np.testing.assert_array_equal(one.position, again.position)
    assert np.abs(one.position - other.position).max() > radius.min()


@pytest.mark.parametrize(("count", "area_fraction"), [(1, 0.15), (2, 0.3), (7, 0.7)])
def test_few_discs_are_packed_too(count, area_fraction):
    packed = dense_packing(np.full(count, 0.5), area_fraction)
    assert packed.position.shape == (count, 2)
    assert len(contacts(packed)[0]) == 0


def test_one_large_disc_among_small_ones(rng):
    """Twenty times as large as the smallest, with room for some 40 neighbours."""
    packed = dense_packing(np.append(uniform_radii(1500, 1e-3, 3.0, rng), 10e-3), pressure=1000.0, stiffness=STIFFNESS)
    i, j, _, _ = contacts(packed)
    assert measured(packed)[0] < 1e-3
    assert 12 < np.count_nonzero((i == 1500) | (j == 1500)) < 42  # pi (10 + 1) = 35 discs of mean size make a closed ring around it


def test_a_simulation_starts_from_a_packing_and_stays_near_it(radius):
    packed = dense_packing(radius, 0.86, stiffness=STIFFNESS)
    sim = Simulation(
        Grains(packed.position, packed.radius), Luding(STIFFNESS, 2 * STIFFNESS, 0.0, 0.1), Friction(2e4, 0.5),
        boundary=Periodic(packed.width, packed.height),
    )  # fmt: skip
    sim.run(500)
    assert sim.status.level == "ok" or all("overlapped" in reason for reason in sim.status.reasons)  # 5 % of the smaller radius: few pairs
    moved = sim.position - packed.position
    moved -= np.rint(moved / (packed.width, packed.height)) * (packed.width, packed.height)
    assert np.hypot(*moved.T).max() < 1e-2 * radius.min()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"area_fraction": 0.0}, "area_fraction = 0 must be above 0"),
        ({"area_fraction": 1.3}, "area_fraction = 1.3 must be at most 1.2"),
        ({"area_fraction": np.nan}, "area_fraction = nan must be a finite number"),
        ({"area_fraction": 0.8, "pressure": 10.0}, "exactly one"),
        ({}, "exactly one"),
        ({"pressure": -1.0}, "pressure = -1 must be above 0"),
        ({"pressure": 2e4}, "pressure = 20000 must be at most 10000"),
        ({"area_fraction": 0.8, "radius": []}, r"shape \(0,\)"),
        ({"area_fraction": 0.8, "radius": [1.0, -1.0]}, r"radius\[1\] = -1"),
        ({"area_fraction": 0.8, "radius": [1.0, np.inf]}, r"radius\[1\] = inf"),
        ({"area_fraction": 0.8, "radius": ["a"]}, "no array of numbers"),
        ({"area_fraction": 0.8, "radius": [1.0] * 3}, "more discs"),
        ({"area_fraction": 0.8, "aspect": 50.0}, "more discs"),
        ({"area_fraction": 0.8, "seed": -1}, "seed = -1"),
    ],
)
def test_what_cannot_be_packed_is_refused(arguments, words):
    with pytest.raises(InputError, match=words):
        dense_packing(**{"radius": np.ones(100), **arguments})


def test_no_equilibrium_is_a_failure(radius):
    with pytest.raises(RunFailed, match="no equilibrium after 60 iterations"):
        dense_packing(radius, 0.86, iterations=60)
