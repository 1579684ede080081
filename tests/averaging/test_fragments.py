"""Fragments that can be counted by hand: who hangs together, and what connects nobody."""

import numpy as np
import pytest
from clusters import make

import anisogran as ag
from anisogran import fragments
from anisogran.outcome import InputError

PULL = (0.5, 0.0)  # on the first grain of a pair along x: tension holds together too


def in_a_row(count, pairs, force, radius=0.5, **more):
    """Discs in a row along x, with the same force in each pair."""
    position = np.stack([np.arange(count, dtype=float), np.zeros(count)], axis=1)
    force = np.broadcast_to(force, (len(pairs), 2))
    return make(position, np.broadcast_to(radius, count), pairs, force, point=position[[first for first, _ in pairs]], **more)


def test_two_pairs_and_a_loner():
    snapshot = in_a_row(5, [(0, 1), (4, 2)], PULL, mass=np.array([1.0, 1.0, 1.5, 1.0, 1.0]))
    found = fragments(snapshot)
    assert found.fragment_of.values.tolist() == [1, 1, 0, 2, 0]  # the heavier pair comes first
    assert found.fragment_grains.values.tolist() == [2, 2, 1]
    mass = snapshot.mass
    np.testing.assert_allclose(found.fragment_mass, [mass[2] + mass[4], mass[0] + mass[1], mass[3]], rtol=1e-15)
    assert found.fragments == 3
    assert float(found.largest_fragment) == pytest.approx((mass[2] + mass[4]) / mass.sum(), rel=1e-15)
    assert float(found.mean_fragment_mass) == pytest.approx(mass.sum() / 3, rel=1e-15)


def test_a_chain_around_a_periodic_cell_is_one():
    """Its last contact is with the image of the first grain; cut twice, it is two."""
    around = [(k, (k + 1) % 6) for k in range(6)]
    assert fragments(in_a_row(6, around, PULL, cell=(6.0, 3.0))).fragments == 1
    cut = [pair for pair in around if pair not in [(1, 2), (5, 0)]]
    found = fragments(in_a_row(6, cut, PULL, cell=(6.0, 3.0)))
    assert found.fragment_of.values.tolist() == [1, 1, 0, 0, 0, 0]


def test_a_ring_is_one_until_it_is_cut_twice():
    angle = 2 * np.pi * np.arange(12) / 12
    position = 2.0 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    pairs = np.array([(k, (k + 1) % 12) for k in range(12)])
    for cuts, count in (([], 1), ([3], 1), ([3, 7], 2), ([3, 7, 11], 3)):
        kept = np.delete(pairs, cuts, axis=0)
        ring = make(position, [0.52] * 12, kept, position[kept[:, 1]] - position[kept[:, 0]], point=position[kept[:, 0]])
        found = fragments(ring)
        assert found.fragments == count
        assert found.fragment_grains.sum() == 12


def test_contacts_that_bear_nothing_connect_nobody():
    pairs = [(0, 1), (1, 2), (2, 3)]
    snapshot = in_a_row(4, pairs, [(1.0, 0.0), (0.0, 0.0), (-2e-3, 0.0)])
    assert fragments(snapshot).fragment_of.values.tolist() == [0, 0, 1, 1]
    assert fragments(snapshot, least_force=2e-3).fragment_of.values.tolist() == [0, 0, 1, 2]  # it must be above
    assert fragments(snapshot, least_force=1.0).fragments == 4


def test_walls_and_their_grains_connect_nobody():
    """Two grains on one wall stay two; so do two that are glued to the same grain of a wall, which itself is in no fragment."""
    assert fragments(in_a_row(2, [(0, -1), (1, -1)], PULL)).fragments == 2
    glued = in_a_row(3, [(0, 1), (1, 2)], PULL, fixed=[False, True, False])
    found = fragments(glued)
    assert found.fragment_of.values.tolist() == [0, -1, 1]
    assert found.fragment_grains.values.tolist() == [1, 1]
    assert float(found.largest_fragment) == 0.5


def test_without_free_grains_nothing_is_made_up():
    found = fragments(in_a_row(2, [(0, 1)], PULL, fixed=[True, True]))
    assert found.fragments == 0
    assert found.sizes["fragment"] == 0
    assert np.isnan(found.largest_fragment)
    assert np.isnan(found.mean_fragment_mass)


def test_every_number_is_labelled():
    found = ag.fragments(in_a_row(2, [(0, 1)], PULL))
    assert all(found[name].attrs["long_name"] for name in found.data_vars)
    assert found.mean_fragment_mass.attrs["units"] == "kg"


@pytest.mark.parametrize("bad", [-1.0, np.nan, "much"])
def test_a_bad_force_is_refused(bad):
    with pytest.raises(InputError, match=r"^fragments: least_force"):
        fragments(in_a_row(2, [(0, 1)], PULL), least_force=bad)
