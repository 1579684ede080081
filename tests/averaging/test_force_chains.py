"""Force statistics and force chains: patterns that can be counted by hand, then a sheared packing."""

import numpy as np
import pytest
from clusters import make

from anisogran import SimpleShear, average, tensors
from anisogran.averaging import force_network, grain_chains
from anisogran.outcome import InputError
from anisogran.snapshot import Snapshot

EXACT = {"rtol": 0, "atol": 1e-12}


def line_up(*paths, idle=10, force=1.0, turn=0.0, scale=1.0):
    """Unit discs along each path (n, 2) that press each other with `force` along their branches, and unloaded discs far away.

    Walls hold the ends of a path along its first and last branch. The whole is turned by `turn`, and the forces are scaled.
    """
    position, pairs, forces, points = [], [], [], []
    for path in (np.asarray(path, float) for path in paths):
        first = len(position)
        position += list(path)
        branch = np.diff(path, axis=0)
        count = len(path)
        pairs += [(first + k, first + k + 1) for k in range(count - 1)] + [(first, -1), (first + count - 1, -2)]
        normal = np.concatenate([branch, [-branch[0], branch[-1]]])
        forces += list(-force * normal)
        points += list(path[[*range(count - 1), 0, count - 1]] + 0.5 * normal)
    position += [(20.0 + 2 * k, 0.0) for k in range(idle)]
    turning = tensors.rotation(turn)
    position, forces, points = (np.array(a).reshape(-1, 2) @ turning.T for a in (position, forces, points))
    return make(position, [0.5] * len(position), pairs, scale * forces, point=points)


def column(x, count=5):
    return np.stack([np.full(count, x), np.arange(count)], axis=1)


def bent(angle, arm=3):
    """A path of 2 arm + 1 discs along x that turns left by the angle at the middle one."""
    straight = np.arange(-arm, 1.0)[:, None] * [1.0, 0.0]
    return np.concatenate([straight, np.arange(1.0, arm + 1)[:, None] * [np.cos(angle), np.sin(angle)]])


def lattice(count=4, horizontal=1.0, vertical=1.0):
    """Unit discs on a square lattice in a periodic cell, each contact with its force."""
    x, y = np.meshgrid(np.arange(count), np.arange(count), indexing="ij")
    grain = (count * x + y).ravel()
    right, up = (count * ((x + 1) % count) + y).ravel(), (count * x + (y + 1) % count).ravel()
    position = np.stack([x.ravel(), y.ravel()], axis=1) + 0.5
    pairs = np.concatenate([np.stack([grain, right], axis=1), np.stack([grain, up], axis=1)])
    normal = np.repeat([[1.0, 0.0], [0.0, 1.0]], count**2, axis=0)
    force = -normal * np.repeat([horizontal, vertical], count**2)[:, None]
    return make(position, [0.5] * count**2, pairs, force, point=np.tile(position, (2, 1)) + 0.5 * normal, cell=count * np.eye(2))


def test_equal_forces_have_no_strong_network():
    network = force_network(lattice(horizontal=0.1, vertical=0.1))
    assert network.contacts == 32
    assert network.mean_normal_force == pytest.approx(0.1)
    assert (network.participation, network.largest_force) == (pytest.approx(1.0), pytest.approx(1.0))
    assert (network.strong_share, network.strong_pressure_share) == (0.0, 0.0)
    assert np.isnan(network.strong_deviator_share)  # there is no deviator


def test_two_forces_make_a_strong_and_a_weak_network():
    """3 along x and 1 along y: mean 2; half of the contacts bear 3/4 of the trace and, of the deviator (3 - 1)/2, the whole 3/2."""
    network = force_network(lattice(horizontal=3.0, vertical=1.0), bins=[0.0, 1.0, 2.0, 4.0])
    assert network.mean_normal_force == pytest.approx(2.0)
    assert network.largest_force == pytest.approx(1.5)
    assert network.strong_share == 0.5
    assert network.strong_pressure_share == pytest.approx(0.75)
    assert network.strong_deviator_share == pytest.approx(1.5)
    assert network.participation == pytest.approx(4.0**2 / (2 * (9.0 + 1.0)))
    np.testing.assert_allclose(network.force_density, [0.5, 0.5, 0.0], **EXACT)
    np.testing.assert_allclose(network.force_density_error[:2], 0.5 / np.sqrt(16), **EXACT)
    assert np.isnan(network.force_density_error[2])
    np.testing.assert_allclose(network.relative_force, [0.5, 1.5, 3.0], **EXACT)


def test_the_weak_network_takes_away_from_the_deviator():
    """4 along x; along y half of the contacts with 3.5, half with 1: mean 3.125, whole stress diag(64, 36), strong diag(64, 28)."""
    even = lattice(horizontal=4.0, vertical=3.5)
    force = even.force.copy()
    force[24:] /= 3.5
    network = force_network(make(even.position, even.radius, even.pairs, force, point=even.point, cell=even.cell))
    assert network.strong_share == 24 / 32
    assert network.strong_pressure_share == pytest.approx(92 / 100)
    assert network.strong_deviator_share == pytest.approx(36 / 28)


def test_a_contact_counts_once_with_a_grain_a_wall_or_a_wall_grain():
    """Forces 1, 2 and 6 on disc 0: participation 9^2/(3 * 41)."""
    snapshot = make(
        [[0, 0], [1.5, 0], [0, 1]], [0.5, 1.0, 0.5], [(0, 1), (0, 2), (0, -3)], [(-1.0, 0.7), (0.3, -2.0), (0, 6.0)],
        point=[[0.5, 0], [0, 0.5], [0, -0.5]], fixed=[0, 0, 1],
    )  # fmt: skip
    network = force_network(snapshot, bins=6)
    assert network.contacts == 3
    assert network.mean_normal_force == pytest.approx(3.0)  # the tangential parts do not count
    assert network.participation == pytest.approx(81 / (3 * 41))
    assert network.strong_share == pytest.approx(1 / 3)
    # the trace: branches of 1.5 between the two free discs, of 0.5 at the wall grain and at the wall
    assert network.strong_pressure_share == pytest.approx(3.0 / (1.5 + 1.0 + 3.0))
    np.testing.assert_allclose(network.attrs["edges"], np.arange(7) / 3, **EXACT)
    assert float(network.force_density.sum()) / 3 == pytest.approx(1.0)
    assert network.force_density[5] == pytest.approx(1.0)  # a third of the contacts, in a bin of a third


def test_tension_counts_as_a_negative_force():
    path = [[0, 0], [1, 0], [2, 0]]
    network = force_network(make(path, [0.5] * 3, [(0, 1), (1, 2)], [(-3.0, 0), (1.0, 0)]), bins=8)
    assert network.mean_normal_force == 1.0
    np.testing.assert_allclose(network.attrs["edges"][[0, -1]], [-1.0, 3.0], **EXACT)
    assert network.force_density[0] == pytest.approx(1.0)
    assert network.force_density[-1] == pytest.approx(1.0)
    pulled = force_network(make(path, [0.5] * 3, [(0, 1), (1, 2)], [(3.0, 0), (1.0, 0)]))
    assert pulled.mean_normal_force == -2.0
    assert np.isnan(pulled.force_density).all()
    assert np.isnan(pulled.participation)
    assert pulled.attrs["reason"] == "the mean normal force is -2 N"


def test_a_straight_column_is_a_chain():
    chains = grain_chains(line_up(column(0.0), idle=5))
    assert chains.chain_of.values.tolist() == [0] * 5 + [-1] * 5
    assert chains.chain_grains.values.tolist() == [5]
    assert chains.chain_length[0] == pytest.approx(4.0)
    assert np.abs(chains.chain_axis[0]) == pytest.approx(np.pi / 2)
    assert chains.chain_share == 0.5
    assert chains.alignment == pytest.approx(1.0)
    assert chains.links.values.tolist() == [[0, 1], [1, 2], [2, 3], [3, 4]]
    np.testing.assert_allclose(chains.major_stress, [1.0 / (np.pi * 0.25)] * 5 + [0.0] * 5, **EXACT)


def test_the_length_of_a_chain_is_in_mean_diameters():
    path = line_up(column(0.0), idle=5)
    small = make(0.1 * path.position, 0.1 * path.radius, path.pairs, path.force, point=0.1 * path.point)
    assert grain_chains(small).chain_length[0] == pytest.approx(4.0)


def test_parallel_columns_are_two_chains_and_the_largest_is_the_first():
    chains = grain_chains(line_up(column(0.0, 3), column(1.0, 6)))
    assert chains.chain_grains.values.tolist() == [6, 3]
    assert chains.chain_of.values.tolist() == [1] * 3 + [0] * 6 + [-1] * 10
    np.testing.assert_allclose(chains.chain_length, [5.0, 2.0], **EXACT)


def test_a_bent_chain_breaks_where_it_turns_too_much():
    """A disc at a bend of 60 degrees has its major stress 30 degrees from both its contacts."""
    path = line_up(bent(np.pi / 3))
    assert grain_chains(path).chain_grains.values.tolist() == [7]
    for turn in np.linspace(0.3, 1.3, 20):  # on the limit it still holds, by more than a rounding
        assert grain_chains(line_up(bent(turn)), angle=turn / 2).chain_grains.values.tolist() == [7]
    assert grain_chains(path, angle=np.pi / 6.1).chain_grains.values.tolist() == [3, 3]
    assert grain_chains(path).mean_axis == pytest.approx(np.pi / 6)
    # three links along 0 and three along 60 degrees
    assert grain_chains(path).alignment == pytest.approx(np.abs(1 + np.exp(2j * np.pi / 3)) / 2)
    # at a right angle the stress of the corner is isotropic and has no direction
    assert grain_chains(line_up(bent(np.pi / 2)), angle=np.pi / 2).chain_grains.values.tolist() == [3, 3]


def test_a_row_that_ends_on_a_stronger_column_is_a_chain_of_its_own():
    """The last disc of the row sees the column ahead, the column sees it from the side; a wall stands for no disc."""
    position = np.array([[0, 1], [0, 0], [0, 2], [3, 1], [2, 1], *[(9 + 2 * k, 9) for k in range(6)], [1, 1]], float)
    pairs = [(1, -1), (2, -2), (3, -3), (0, 1), (0, 2), (3, 4), (4, 11), (11, 0)]
    normal = np.array([[0, -1], [0, 1], [1, 0], [0, -1], [0, 1], [-1, 0], [-1, 0], [-1, 0]], float)
    force = -normal * np.array([5, 5, 2, 5, 5, 2, 2, 2])[:, None]
    junction = make(position, [0.5] * 12, pairs, force, point=position[[i for i, _ in pairs]] + 0.5 * normal)
    assert grain_chains(junction).chain_of.values.tolist() == [0, 0, 0, 1, 1, *[-1] * 6, 1]


def test_an_evenly_loaded_lattice_has_no_chains():
    for vertical in (0.1, 0.3):
        chains = grain_chains(lattice(7, horizontal=0.1, vertical=vertical))  # all grains bear the mean, none more but by rounding
        assert (chains.chain_of == -1).all()
        assert chains.chain_share == 0.0
        assert np.isnan(chains.alignment)
        assert np.isnan(chains.mean_axis)
        assert chains.sizes == {"grain": 49, "link": 0, "end": 2, "chain": 0}
    for turn in np.linspace(0.1, 1.5, 15):
        assert grain_chains(line_up(column(0.0, 40), idle=0, turn=turn), least_grains=2).sizes["chain"] == 0


def test_a_pair_is_no_chain_but_on_demand():
    pair = line_up(column(0.0, 2))
    assert grain_chains(pair).sizes["chain"] == 0
    assert grain_chains(pair, least_grains=2).chain_grains.values.tolist() == [2]
    assert grain_chains(make([[0, 0], [1, 0]], [0.5] * 2, [(0, 1)], [(-1, 0)]), least_grains=2).sizes["chain"] == 0  # both bear the mean


def test_chains_cross_the_border_of_a_periodic_cell():
    """One column of the lattice bears more: a closed ring of four links."""
    snapshot = lattice()
    force = snapshot.force.copy()
    force[16:20, 1] *= 5.0
    whole = make(snapshot.position, snapshot.radius, snapshot.pairs, force, point=snapshot.point, cell=snapshot.cell)
    chains = grain_chains(whole)
    assert chains.chain_of.values.tolist() == [0] * 4 + [-1] * 12
    assert chains.chain_length[0] == pytest.approx(4.0)
    assert chains.links.values.tolist() == [[0, 1], [1, 2], [2, 3], [0, 3]]


def test_wall_grains_are_wall():
    path = line_up(column(0.0, 5))
    fixed = np.arange(15) == 0
    floor = make(path.position, path.radius, path.pairs, path.force, point=path.point, fixed=fixed)
    chains = grain_chains(floor)
    assert chains.chain_of.values.tolist() == [-1] + [0] * 4 + [-1] * 10
    assert chains.chain_share == pytest.approx(4 / 14)
    assert chains.major_stress[0] == 0.0
    idle_walls = make(path.position, path.radius, path.pairs, path.force, point=path.point, fixed=np.arange(15) >= 5)
    assert grain_chains(idle_walls).sizes["chain"] == 0  # the mean is that of the free grains, which all bear the same
    nothing_free = grain_chains(make(path.position, path.radius, path.pairs, path.force, point=path.point, fixed=[True] * 15))
    assert np.isnan(nothing_free.chain_share)


def test_grains_without_contacts_have_neither_forces_nor_chains():
    snapshot = make([[0, 0], [3, 0]], [0.5] * 2, [], [])
    chains, network = grain_chains(snapshot), force_network(snapshot)
    assert chains.chain_of.values.tolist() == [-1, -1]
    assert chains.chain_share == 0.0
    assert network.contacts == 0
    assert network.attrs["reason"] == "no contacts"
    for name in set(network.data_vars) - {"contacts"}:
        assert np.isnan(network[name]).all(), name


@pytest.fixture(scope="module")
def sheared():
    return SimpleShear(n=150, strain=0.6, discard=0.1, inertial_number=0.05).run().snapshots["end"]


def test_rotation_and_scale_change_nothing():
    paths = bent(np.pi / 3), column(-8.0, 4)
    plain, changed = line_up(*paths), line_up(*paths, turn=0.3, scale=1e-6)
    chains, turned = grain_chains(plain), grain_chains(changed)
    for name in ("chain_of", "links", "chain_grains", "chain_length", "alignment", "chain_share"):
        np.testing.assert_allclose(turned[name], chains[name], **EXACT)
    np.testing.assert_allclose(turned.major_stress, 1e-6 * chains.major_stress, rtol=1e-12)
    for name in ("chain_axis", "mean_axis"):
        np.testing.assert_allclose(np.tan(turned[name] - chains[name]), np.tan(0.3), rtol=1e-9)
    before, after = force_network(plain), force_network(changed)
    for name in set(before.data_vars) - {"mean_normal_force", "force_density", "force_density_error"}:
        np.testing.assert_allclose(after[name], before[name], rtol=1e-9)
    assert after.mean_normal_force == pytest.approx(1e-6 * float(before.mean_normal_force))


def test_scaling_the_forces_of_a_packing_keeps_their_distribution(sheared):
    scaled = make(
        sheared.position, sheared.radius, sheared.pairs, 8.0 * sheared.force, point=sheared.point, cell=sheared.cell, volume=sheared.volume
    )
    np.testing.assert_array_equal(force_network(scaled).force_density, force_network(sheared).force_density)
    np.testing.assert_array_equal(grain_chains(scaled).links, grain_chains(sheared).links)


def test_chains_of_a_sheared_packing_bear_the_deviator(sheared):
    """Chains along the major stress, in a part of the grains; the strong network has more than its share of the deviator."""
    stress = average(sheared).stress_static.values
    chains, network = grain_chains(sheared), force_network(sheared)
    # over eight seeds: 0.31 to 0.42 of the grains, mean axis within 8 degrees of the stress, alignment 0.30 to 0.49
    assert 0.25 < chains.chain_share < 0.5
    assert np.tan(chains.mean_axis - tensors.principal_angle(stress)) == pytest.approx(0.0, abs=0.15)
    assert chains.alignment > 0.25
    # over eight seeds: 0.37 to 0.47 of the contacts, 0.68 to 0.78 of the trace, 0.65 to 0.92 of the deviator; 0.90 for this one
    assert 0.35 < network.strong_share < 0.5
    assert network.strong_share < network.strong_pressure_share < network.strong_deviator_share
    assert network.strong_deviator_share > 0.8
    assert 0.5 < network.participation < 0.8  # 0.55 to 0.70
    assert network.force_density.values @ np.diff(network.attrs["edges"]) == pytest.approx(1.0)


def test_bad_options_are_refused():
    snapshot = lattice()
    with pytest.raises(InputError, match=r"grain_chains: angle = 0 must be above 0 rad"):
        grain_chains(snapshot, angle=0)
    with pytest.raises(InputError, match=r"grain_chains: angle = 45 must be at most 1\.5708 rad"):
        grain_chains(snapshot, angle=45)
    with pytest.raises(InputError, match="least_grains = 1 must be at least 2"):
        grain_chains(snapshot, least_grains=1)
    with pytest.raises(InputError, match="bins = 0 must be at least 1"):
        force_network(snapshot, bins=0)
    with pytest.raises(InputError, match="must be a whole number, or edges"):
        force_network(snapshot, bins=2.5)
    for edges in ([0.0], [1.0, 0.0], [0.0, np.nan], [[0.0, 1.0]]):
        with pytest.raises(InputError, match="two or more ascending edges"):
            force_network(snapshot, bins=edges)
    sphere = Snapshot([[0, 0, 0]], [1.0], [1.0], [[0, 0, 0]], [[0, 0, 0]], [], [], [], [])
    for function in (force_network, grain_chains):
        with pytest.raises(InputError, match=f"{function.__name__}: the snapshot is three-dimensional"):
            function(sphere)
