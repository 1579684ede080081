"""Exact cases of the whole-sample averages, then a packing against the forces on its walls."""

import numpy as np
import pytest
from clusters import make

from anisogran import average
from anisogran.averaging import contact_network
from anisogran.averaging.grain_sums import backbone, contact_ends
from anisogran.dem import Box, Friction, Grains, Linear, Periodic, Pressure, Simulation
from anisogran.dem.packing import uniform_radii
from anisogran.outcome import InputError
from anisogran.snapshot import Snapshot

EXACT = {"rtol": 0, "atol": 1e-12}


def square(force=2.0, **more):
    """Four unit-diameter discs on a square, pressed along x and y, between walls: every contact carries `force`."""
    position = np.array([[0.5, 0.5], [1.5, 0.5], [0.5, 1.5], [1.5, 1.5]])
    pairs = [(0, 1), (2, 3), (0, 2), (1, 3), (0, -1), (2, -1), (1, -2), (3, -2), (0, -3), (1, -3), (2, -4), (3, -4)]
    normal = np.array([(1, 0), (1, 0), (0, 1), (0, 1), (-1, 0), (-1, 0), (1, 0), (1, 0), (0, -1), (0, -1), (0, 1), (0, 1)], float)
    point = position[[i for i, _ in pairs]] + 0.5 * normal
    return make(position, [0.5] * 4, pairs, -force * normal, point=point, volume=4.0, **more)


def test_square_under_isotropic_pressure():
    """Stress = wall force over wall length = 2 * 2.0 / 2.0; half/half deviator 0; four contacts a grain."""
    box = average(square(2.0), on="box")
    np.testing.assert_allclose(box.stress, 2.0 * np.eye(2), **EXACT)
    assert float(box.area_fraction) == pytest.approx(np.pi / 4)
    assert float(box.fabric_trace) == pytest.approx(4 * np.pi / 4)
    assert float(box.fabric_deviator) == pytest.approx(0, abs=1e-14)
    assert float(box.coordination_number) == 4.0


def test_stress_is_the_sum_over_contacts_once():
    """One contact in a periodic cell: sigma = -f (x) l / V with the whole branch, first index force, compression positive."""
    cell = 4.0 * np.eye(2)
    snapshot = make([[0.2, 1.0], [3.9, 1.4]], [0.3, 0.3], [(0, 1)], [(1.0, -2.0)], point=[[0.05, 1.2]], cell=cell)
    branch = np.array([-0.3, 0.4])  # across the border, not 3.7
    np.testing.assert_allclose(average(snapshot).stress, -np.outer([1.0, -2.0], branch) / 16.0, **EXACT)


def test_aligned_contacts_have_the_largest_anisotropy():
    """All contacts along x: F has one eigenvalue, a_2 = 2 (F_1 - F_2)/tr F = 2, and a_4 = 2."""
    snapshot = make([[0, 0], [1, 0], [2, 0]], [0.5] * 3, [(0, 1), (1, 2)], [(-1, 0), (-1, 0)], volume=3.0)
    assert float(average(snapshot).anisotropy) == pytest.approx(2.0)
    network = contact_network(snapshot)
    assert (network.a2, network.a4) == (pytest.approx(2.0), pytest.approx(2.0))
    assert network.scale == pytest.approx(2 * 1.0 / 3.0)  # two contacts of branch 1 in the volume 3


def test_uniform_deformation_is_no_agitation(rng):
    """The fluctuation stress is taken about the best linear velocity field: an affine motion has none."""
    snapshot = square()
    gradient = np.array([[0.3, -0.7], [0.2, 0.1]])
    moving = square(velocity=snapshot.position @ gradient.T + [5.0, -2.0])
    np.testing.assert_allclose(average(moving, fields=["stress_dynamic"]).stress_dynamic, 0, atol=1e-12)
    velocity = np.array([[1.0, 0], [-1.0, 0], [-1.0, 0], [1.0, 0]])  # the mode that no linear field can make
    dynamic = average(square(velocity=velocity), fields=["stress_dynamic"]).stress_dynamic
    np.testing.assert_allclose(dynamic, np.diag([4 * 1.0 / 4.0, 0]), **EXACT)


@pytest.mark.hard_case("D10")
def test_rattlers_are_removed_until_none_is_left():
    """A chain hanging on a wall: the free end goes first, then its neighbour, then all."""
    chain = make([[0, 0], [1, 0], [2, 0]], [0.5] * 3, [(0, 1), (1, 2), (0, -1)], np.zeros((3, 2)), point=[[0.5, 0], [1.5, 0], [-0.5, 0]])
    kept, live = backbone(chain, contact_ends(chain), least_contacts=2)
    assert not kept.any()
    assert not live.any()
    assert float(average(chain, fields=["coordination_number"], least_contacts=2).coordination_number) == 0.0
    kept, _ = backbone(square(), contact_ends(square()), least_contacts=3)
    assert kept.all()


def test_a_grain_of_a_rough_wall_bears_like_a_wall():
    """A free grain between a wall and a wall grain has two contacts that count."""
    pinched = make(
        [[0, 0], [1, 0]], [0.5, 0.5], [(0, -1), (0, 1)], np.zeros((2, 2)), point=[[-0.5, 0], [0.5, 0]], fixed=np.array([False, True])
    )
    kept, live = backbone(pinched, contact_ends(pinched), least_contacts=2)
    assert kept.tolist() == [True, False]
    assert live.all()
    assert float(average(pinched, fields=["coordination_number"], least_contacts=2).coordination_number) == 2.0


def test_agitation_is_weighed_by_mass():
    """The linear field that fits best by mass leaves c/m where c is at right angles to every linear field; wall grains count nowhere."""
    corner = np.array([[0, 0], [2, 0], [0, 2], [2, 2], [5, 5]], float)
    mass, c = np.array([1.0, 2.0, 4.0, 5.0, 100.0]), np.array([1.0, -1.0, -1.0, 1.0, 0.0])
    velocity = corner @ [[0.3, 0.1], [-0.2, 0.4]] + np.outer(c / mass, [1.0, 2.0])
    velocity[4] = [70.0, -30.0]
    snapshot = make(corner, [0.5] * 5, [], [], mass=mass, velocity=velocity, fixed=np.arange(5) == 4, volume=3.0)
    dynamic = average(snapshot, fields=["stress_dynamic"]).stress_dynamic
    np.testing.assert_allclose(dynamic, np.outer([1, 2], [1, 2]) * np.sum(c**2 / mass) / 3.0, **EXACT)


def test_fabric_is_weighed_by_the_area_of_each_disc():
    box = average(make([[0, 0], [1.5, 0]], [0.5, 1.0], [(0, 1)], [(-1, 0)], volume=2.0), fields=["fabric"])
    np.testing.assert_allclose(box.fabric, np.diag([np.pi * (0.25 + 1.0) / 2.0, 0]), **EXACT)


def test_contact_network_weighs_by_squared_branch():
    """One contact of branch 1.5 along the axis and one at a wall, 0.5 long, across it, as a whole turned by 30 degrees."""
    axis, across = np.array([np.sqrt(3) / 2, 0.5]), np.array([-0.5, np.sqrt(3) / 2])
    snapshot = make([0 * axis, 1.5 * axis], [0.5, 1.0], [(0, 1), (0, -1)], np.zeros((2, 2)), point=[0.5 * axis, 0.5 * across], volume=2.0)
    for network in (contact_network(snapshot), contact_network(snapshot, angle=np.pi / 6)):
        assert network.a2 == pytest.approx(2 * (2.25 - 0.25) / 2.5)
        assert network.a4 == pytest.approx(2.0)
        assert network.scale == pytest.approx(2.5 / 2.0)
    assert contact_network(snapshot, angle=0.0).a2 == pytest.approx(1.6 * np.cos(np.pi / 3))


def test_wall_grains_take_no_part():
    fixed = np.array([False, True])
    snapshot = make([[0, 0], [1, 0]], [0.5, 0.5], [(0, 1)], [(-3.0, 0)], fixed=fixed, volume=2.0)
    box = average(snapshot, fields=["area_fraction", "stress"])
    assert float(box.area_fraction) == pytest.approx(np.pi * 0.25 / 2)
    np.testing.assert_allclose(box.stress, np.diag([3.0 * 0.5 / 2.0, 0]), **EXACT)  # its own half of the branch only


@pytest.mark.hard_case("D11")
def test_no_contacts_is_an_answer_with_a_reason(answer):
    box = average(make([[0.0, 0.0]], [1.0], [], []))
    np.testing.assert_array_equal(box.stress, 0)
    assert np.isnan(box.anisotropy)
    assert box.anisotropy.attrs["reason"] == "no contacts"
    answer.named(f"stress 0, anisotropy NaN: {box.anisotropy.attrs['reason']}")
    assert float(box.area_fraction) == pytest.approx(np.pi / 4)  # the bounding box of one disc


def test_one_grain_between_walls():
    """More walls than grains."""
    one = make(
        [[0.5, 0.5]],
        [0.5],
        [(0, -1), (0, -2), (0, -3), (0, -4)],
        [(1, 0), (-1, 0), (0, 1), (0, -1)],
        point=[[0, 0.5], [1, 0.5], [0.5, 0], [0.5, 1]],
    )
    box = average(one)
    assert float(box.coordination_number) == 4.0
    np.testing.assert_allclose(box.stress, np.eye(2), **EXACT)


def test_a_snapshot_takes_lists_and_refuses_what_is_no_snapshot():
    two = {"position": [[0, 0], [1, 0]], "radius": [0.5, 0.5], "mass": [1, 1], "velocity": [[0, 0], [0, 0]], "spin": [0, 0]}
    snapshot = Snapshot(**two, pairs=[], force=[], point=[], overlap=[], fixed=[0, 1])
    assert snapshot.pairs.shape == (0, 2)
    assert snapshot.fixed.dtype == bool
    np.testing.assert_array_equal(snapshot.free, [True, False])
    with pytest.raises(InputError, match="mass is no array of numbers"):
        Snapshot(**{**two, "mass": ["a", "b"]}, pairs=[], force=[], point=[], overlap=[])
    sphere = Snapshot([[0, 0, 0]], [1.0], [1.0], [[0, 0, 0]], [[0, 0, 0]], [], [], [], [])
    assert float(average(sphere).volume_fraction) == pytest.approx(np.pi / 6)  # in the cube that holds it


def test_unknown_names_are_refused():
    for edges in ([-3, -2, -1, 0], [3, 2, 1, 0], [1, 1, 2, 3], [1]):
        with pytest.raises(InputError, match="edges of the rings must be at least 2 ascending numbers, none below 0"):
            average(square(), on="rings", edges=edges)
    with pytest.raises(InputError, match="on = 'sphere' must be one of 'box', 'rings'"):
        average(square(), on="sphere")
    with pytest.raises(InputError, match="unknown field 'strss'"):
        average(square(), fields="strss")
    with pytest.raises(InputError, match="did you mean stress"):
        average(square(), fields="strss")
    with pytest.raises(InputError, match=r"force\[1\] is not finite"):
        make([[0, 0], [1, 0], [2, 0]], [0.5] * 3, [(0, 1), (1, 2)], [(0, 0), (np.nan, 0)])
    with pytest.raises(InputError, match=r"pairs must hold grain indices 0\.\.1"):
        make([[0, 0], [1, 0]], [0.5] * 2, [(0, 2)], [(0, 0)], point=[[0, 0]])


def test_rotation_turns_every_tensor(rng):
    snapshot = square()
    angle = 0.4
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    forces = snapshot.force * rng.uniform(0.5, 2, (12, 1))
    kept = {"volume": 4.0, "velocity": rng.normal(size=(4, 2))}
    plain = make(snapshot.position, snapshot.radius, snapshot.pairs, forces, point=snapshot.point, **kept)
    kept["velocity"] = kept["velocity"] @ turn.T
    turned = make(snapshot.position @ turn.T, snapshot.radius, snapshot.pairs, forces @ turn.T, point=snapshot.point @ turn.T, **kept)
    for name in ("stress", "stress_dynamic", "fabric"):
        np.testing.assert_allclose(average(turned)[name], turn @ average(plain)[name].values @ turn.T, **EXACT)
    for name in ("area_fraction", "anisotropy", "coordination_number"):
        np.testing.assert_allclose(average(turned)[name], average(plain)[name], **EXACT)


def test_packing_between_walls_bears_what_the_walls_measure(rng):
    """A settled packing: the stress from its contacts is the force on the walls over their length."""
    radius = uniform_radii(80, 1e-3, 2.0, rng)
    grid = np.stack(np.meshgrid(np.arange(10), np.arange(10)), -1).reshape(-1, 2)[:80]
    position = 1.34e-3 * 1.5 + grid * 2.7e-3
    side = 2.7e-3 * 10 + 1e-3
    grains = Grains(position, radius, velocity=rng.normal(0, 0.1, (80, 2)))
    push = {"mass": 1e-4, "damping": 5.0}
    box = Box(side, side, right=Pressure(100.0, **push), top=Pressure(150.0, **push))
    sim = Simulation(grains, Linear(1e5, 0.1), friction=Friction(2e4, 0.3), boundary=box, drag=0.02)
    sim.run(250_000)
    _, width, _, height = sim.walls.position
    snapshot = sim.snapshot()
    stress = average(snapshot).stress.values
    walls = np.diag([sim.walls.force[1] / height, sim.walls.force[3] / width])
    np.testing.assert_allclose(np.diag(stress), np.diag(walls), rtol=1e-5)  # measured 1e-8: the packing is at rest
    np.testing.assert_allclose(np.diag(walls), [100.0, 150.0], rtol=1e-5)
    # smooth walls bear no shear, but where they are pressed is free: the mean shear stress is symmetric, not zero
    assert stress[0, 1] == pytest.approx(stress[1, 0], abs=1e-6)
    # equal and opposite forces leave no net force on a grain at rest
    net = np.zeros((80, 2))
    first, second = snapshot.pairs.T
    np.add.at(net, first, snapshot.force)
    np.add.at(net, second[second >= 0], -snapshot.force[second >= 0])
    np.testing.assert_allclose(net, sim.net_force, atol=1e-3 * np.abs(snapshot.force).max())


def test_volume_is_that_of_the_cell_or_of_the_bounding_box():
    discs = ([[0.0, 0.0], [3.0, 1.0]], [0.5, 1.0], [], [])
    assert make(*discs).volume == pytest.approx((4.0 + 0.5) * (2.0 + 0.5))
    assert make(*discs, cell=np.array([[4.0, 0.0], [1.0, 3.0]])).volume == pytest.approx(12.0)
    assert make(*discs, cell=[4.0, 3.0]).volume == pytest.approx(12.0)
    with pytest.raises(InputError, match="lower triangular with a positive diagonal"):
        make(*discs, cell=np.array([[0.0, 3.0], [4.0, 0.0]]))
    with pytest.raises(InputError, match=r"volume = 0\.0 must be above 0"):
        make(*discs, volume=0.0)
    with pytest.raises(InputError, match=r"pairs must hold grain indices 0\.\.1"):
        make([[0, 0], [1, 0]], [0.5] * 2, [(-1, 0)], [(0, 0)], point=[[0, 0]])


def test_periodic_cell_gives_its_volume():
    snapshot = Simulation(Grains([[1.0, 1.0]], [0.5]), Linear(1e3), boundary=Periodic(4.0, 3.0)).snapshot()
    assert snapshot.volume == pytest.approx(12.0)
    assert float(average(snapshot).area_fraction) == pytest.approx(np.pi * 0.25 / 12)


def hanging_square(**more):
    """The square, every grain with four contacts, and a fifth grain, the last, that hangs on the third with one contact and a wall."""
    base = square()
    pairs = np.concatenate([base.pairs, [(2, 4), (4, -5)]])
    position = np.concatenate([base.position, [[0.5, 2.4]]])
    force = np.concatenate([base.force, np.zeros((2, 2))])
    return make(position, [0.5] * 5, pairs, force, point=np.concatenate([base.point, [[0.5, 1.95], [0.5, 2.9]]]), volume=6.0, **more)


def test_contacts_with_rattlers_are_not_counted():
    """The fifth grain has two contacts: a rattler without friction, which is the default; its contact with the square goes as well."""
    names = ["coordination_number", "rattler_fraction"]
    data = average(hanging_square(), fields=names)
    assert float(data.coordination_number) == pytest.approx(4.0)
    assert float(data.rattler_fraction) == pytest.approx(0.2)
    data = average(hanging_square(), fields=names, least_contacts=2)
    assert float(data.coordination_number) == pytest.approx((16 + 3) / 5)
    assert float(data.rattler_fraction) == 0.0
    walls = average(hanging_square(fixed=np.arange(5) == 4), fields=names)
    assert float(walls.coordination_number) == pytest.approx(17 / 4)  # as a wall it bears


def test_a_lost_contact_with_a_wall_is_lost_for_one_grain_only():
    """A rattler on a wall, between a first and a last grain that have just the contacts they need."""
    pairs = [(0, -1), (0, -2), (1, -1), (2, -1), (2, -2)]
    point = [[-0.5, 0], [0.5, 0], [4.5, 0], [8.5, 0], [9.5, 0]]
    snapshot = make([[0, 0], [5, 0], [9, 0]], [0.5] * 3, pairs, np.zeros((5, 2)), point=point)
    kept, live = backbone(snapshot, contact_ends(snapshot), least_contacts=2)
    assert kept.tolist() == [True, False, True]
    assert live.tolist() == [True, True, False, True, True]


def test_couple_stress_in_space():
    """M_ij = (l x f)_i l_j/V of one contact at a wall: l = 2 x, f = 3 y gives the couple 6 z, carried along x."""
    sphere = Snapshot([[0, 0, 0]], [1.0], [1.0], [[0, 0, 0]], [[0, 0, 0]], [(0, -1)], [[0, 3.0, 0]], [[2.0, 0, 0]], [0.0], volume=10.0)
    expected = np.zeros((3, 3))
    expected[2, 0] = 6.0 * 2.0 / 10.0
    np.testing.assert_allclose(average(sphere, fields="couple_stress").couple_stress, expected, **EXACT)
