"""Samples on the edge: narrow cells, grains that just touch a cell, nothing but rounding, huge offsets, odd arrays."""

import numpy as np
import pytest
from clusters import make

from anisogran import average
from anisogran.averaging.overlap_areas import grid_shares, ring_shares
from anisogran.files import read_snapshot, snapshot_dataset
from anisogran.outcome import InputError
from anisogran.snapshot import Snapshot

EXACT = {"rtol": 0, "atol": 1e-12}


def test_grains_that_touch_on_both_sides_of_a_narrow_cell():
    """Discs on a square lattice with one, two or three of them in the cell: the pressure is force over length, whatever the cell."""
    for side in (1, 2, 3):
        i = np.arange(side)
        position = np.stack([i + 0.5, 0 * i + 0.5], axis=1)
        pairs = np.concatenate([np.stack([i, (i + 1) % side], 1), np.stack([i, i], 1)])
        point = np.concatenate([position + np.array([0.5, 0.0]), position + np.array([0.0, 0.5])])
        force = np.concatenate([np.tile([-2.0, 0.0], (side, 1)), np.tile([0.0, -2.0], (side, 1))])
        snapshot = make(position, [0.5] * side, pairs, force, point=point, cell=[float(side), 1.0])
        np.testing.assert_allclose(average(snapshot).stress, 2.0 * np.eye(2), **EXACT)
        smooth = average(snapshot, on="points", points=[[0.3, 0.2]], width=3.0, fields="stress_static").stress_static
        np.testing.assert_allclose(smooth[:, :, 0], 2.0 * np.eye(2), rtol=1e-9, atol=1e-9)  # the Gaussian is cut off at 7e-10


def test_images_of_unequal_grains_are_those_beyond_the_contact_point():
    """A large and a small disc across the border of a tilted cell that is hardly larger than the large one."""
    cell = np.array([[2.2, 0.0], [0.9, 2.1]])
    branch = 1.2 * np.array([0.96, 0.28])  # longer than half the cell
    snapshot = make(
        [[1.0, 1.0], 1.0 + branch - 2 * cell[1] + 3 * cell[0]], [1.0, 0.2], [(0, 1)], [-branch], point=[[1.96, 1.28]], cell=cell
    )
    np.testing.assert_allclose(average(snapshot).stress, np.outer(branch, branch) / (2.2 * 2.1), **EXACT)


def test_nobody_is_seen_in_a_cell_that_a_disc_only_touches_or_passes_by(rng):
    """A disc beside the corner of a cell, and one that touches its side: no share, of either sign, and no velocity."""
    for _ in range(100):
        x = rng.uniform(0.55, 0.69, 2)  # the corner (1, 1) is farther than the radius
        disc = make([x], [0.4], [], [], velocity=[[1.0, 2.0]])
        data = average(disc, on="grid", edges=([0, 1, 2], [0, 1, 2]), fields=["density", "velocity"])
        assert float(data.density[1, 1]) == 0.0
        assert np.isnan(data.velocity[:, 1, 1]).all()
    for _ in range(100):
        r, z = rng.uniform(0.55, 0.69, 2)  # in space the corner is a circle
        ball = Snapshot([[0.0, r, z]], [0.4], [1.0], [[1.0, 2.0, 3.0]], [[0, 0, 0]], [], [], [], [])
        data = average(ball, on="rings", edges=([0, 1, 2], [0, 1, 2]), fields=["density", "velocity"])
        assert float(data.density[1, 1]) == 0.0
        assert np.isnan(data.velocity[:, 1, 1]).all()
    n = 2000
    position, radius = rng.uniform(0, 9, (n, 2)), rng.uniform(0.2, 1.5, n)
    r = np.hypot(*position.T)
    touching = np.sort(np.concatenate([[0.0], (r + radius)[:40], np.abs(r - radius)[40:80]]))
    edges = np.sort(np.concatenate([(position[:40, 0] + radius[:40]), (position[40:80, 0] - radius[40:80])]))
    space, levels = np.column_stack([position, rng.uniform(-2, 2, n)]), np.linspace(-1, 1, 5)
    for indptr, indices, shares in (
        ring_shares(position, radius, np.ones(n, bool), touching, None),
        ring_shares(space, radius, np.ones(n, bool), touching, levels),
        grid_shares(position, radius, edges, edges),
    ):
        assert shares.min() >= 0.0
        assert len(indices) == indptr[-1]
    indptr, indices, _ = ring_shares(position, radius, np.ones(n, bool), touching, None)
    for p in range(80):  # the edge that the disc touches belongs to one ring only
        beyond = np.searchsorted(touching, r[p] + radius[p]) if p < 40 else np.searchsorted(touching, abs(r[p] - radius[p])) - 1
        assert (p >= 40 and r[p] < radius[p]) or beyond not in indices[indptr[p] : indptr[p + 1]]


def test_images_of_a_sector_are_turned_with_all_they_carry(rng):
    """A sixth of a ring, seen at a point in its third image, is the sector seen at the point turned back."""
    angle, n = np.pi / 3, 40
    r, phi = rng.uniform(3, 6, n), rng.uniform(0, angle, n)
    position = np.stack([r * np.cos(phi), r * np.sin(phi)], axis=1)
    normal = rng.normal(size=(n, 2))
    point = position + 0.2 * normal / np.hypot(*normal.T)[:, None]
    snapshot = make(
        position, np.full(n, 0.3), [(k, -1) for k in range(n)], rng.normal(size=(n, 2)), point=point, sector=angle,
        velocity=rng.normal(size=(n, 2)), spin=rng.normal(size=n),
    )  # fmt: skip
    c, s = np.cos(2 * angle), np.sin(2 * angle)
    turn = np.array([[c, -s], [s, c]])
    here = np.array([[4.0, 1.5], [3.5, 3.0]])
    vectors = ["velocity", "velocity_density", "couple_stress", "curvature", "wall_force_density", "stress_divergence"]
    dyads = ["stress_static", "stress_dynamic", "fabric", "velocity_gradient", "elastic_strain_raw"]
    one, other = (average(snapshot, on="points", points=points, width=0.6, fields=vectors + dyads) for points in (here, here @ turn.T))
    for name in vectors:
        np.testing.assert_allclose(other[name], turn @ one[name].values, rtol=1e-9, atol=1e-11, err_msg=name)
    for name in dyads:
        np.testing.assert_allclose(other[name], np.einsum("ik,klp,jl->ijp", turn, one[name], turn), rtol=1e-9, atol=1e-11, err_msg=name)


@pytest.mark.parametrize(
    "options", [{}, {"on": "rings", "width": 0.3}, {"on": "grid", "width": 0.3}, {"on": "points", "points": [[3.2, 0.2]], "width": 0.5}]
)
def test_a_grain_that_flies_alone_presses_nothing(options):
    """What rounding leaves of its momentum flux is no pressure: no ratio and no inertial number is made of it."""
    one = make([[3.3, 0.1]], [0.4], [], [], velocity=[[1.1, 2.3]], mass=[0.37], spin=[0.3])
    data = average(one, fields=["stress_dynamic", "pressure", "s_D", "inertial_number"], **options)
    np.testing.assert_array_equal(data.stress_dynamic, 0.0)
    assert np.isnan(data.s_D).all()
    assert np.isnan(data.inertial_number).all()
    assert data.s_D.attrs["reason"] == "no pressure"
    assert "no pressure" in data.inertial_number.attrs["reason"]


def test_an_affine_crowd_presses_nothing(rng):
    position = rng.uniform(-5, 5, (200, 2))
    crowd = make(position, np.full(200, 0.3), [], [], velocity=position @ np.array([[0.1, 0.7], [-0.3, 0.2]]) + 30.0)
    for options in ({}, {"on": "grid", "width": 2.0}):
        data = average(crowd, fields=["stress_dynamic", "s_D"], **options)
        np.testing.assert_array_equal(data.stress_dynamic, 0.0)
        assert np.isnan(data.s_D).all()


@pytest.mark.parametrize(("far", "fast"), [(1e3, 0.0), (1e6, 0.0), (0.0, 1e4), (1e6, 1e4)])
def test_far_away_and_fast_the_mean_field_is_the_same(rng, far, fast):
    """A sample 10^6 diameters away, at 10^4 times its fluctuations."""
    n = 400
    position, noise = rng.uniform(0, 20, (n, 2)), rng.normal(size=(n, 2))
    velocity = position @ np.array([[0.1, 0.7], [-0.3, 0.2]]) + noise
    near = make(position, np.full(n, 0.5), [], [], velocity=velocity)
    away = make(position + far, np.full(n, 0.5), [], [], velocity=velocity + fast)
    names = ["velocity", "velocity_gradient", "stress_dynamic"]
    for here, there in (
        ({}, {}),
        ({"on": "grid", "edges": ([5, 10], [5, 10])}, {"on": "grid", "edges": ([5 + far, 10 + far],) * 2}),
        ({"on": "points", "points": [[10, 10]], "width": 2.0}, {"on": "points", "points": [[10 + far] * 2], "width": 2.0}),
    ):
        one, other = average(near, fields=names, **here), average(away, fields=names, **there)
        np.testing.assert_allclose(other.velocity - fast, one.velocity, atol=1e-10)  # positions and speeds are rounded to 1e-10 and 1e-12
        np.testing.assert_allclose(other.velocity_gradient, one.velocity_gradient, atol=1e-9)
        # the flux 10^8 times as large is rounded to 10^-15: measured 2e-7
        np.testing.assert_allclose(other.stress_dynamic, one.stress_dynamic, rtol=1e-10 + 1e-14 * fast**2, atol=1e-10 + 1e-14 * fast**2)


def test_arrays_of_any_kind_give_the_same_averages(rng, tmp_path):
    """Integers, lists, slices that are not contiguous, other byte orders, and arrays that are only mapped into memory."""
    position = np.array([[0, 0], [2, 0], [0, 2], [2, 2]])
    pairs, force, point = [[0, 1], [1, 3], [0, -1]], [[-1, 0], [0, -2], [3, 1]], [[1, 0], [2, 1], [-1, 0]]
    arrays = {
        "position": position,
        "radius": [1, 1, 1, 1],
        "mass": [1, 2, 3, 4],
        "velocity": [[1, 0], [0, 2], [3, 1], [2, 2]],
        "spin": [1, 2, 3, 4],
    }
    arrays |= {"pairs": pairs, "force": force, "point": point, "overlap": [0, 0, 0]}

    def mapped(value):
        path = tmp_path / f"{len(list(tmp_path.iterdir()))}.npy"
        np.save(path, np.asarray(value, float))
        return np.load(path, mmap_mode="r")

    reference = None
    for made in (
        np.asarray, list, mapped, lambda value: np.repeat(np.asarray(value, np.float32), 2, axis=0)[::2],
        lambda value: np.asfortranarray(value), lambda value: np.asarray(value, ">f8"),
    ):  # fmt: skip
        snapshot = Snapshot(**{name: made(value) for name, value in arrays.items()})
        for options in ({}, {"on": "rings", "edges": [0, 1, 4]}, {"on": "grid", "edges": ([-1, 0, 3], [-1, 3])}):
            data = average(snapshot, fields=["stress", "fabric", "velocity", "coordination_number"], **options)
            key = options.get("on", "box")
            reference = {**(reference or {}), key: (reference or {}).get(key, data)}
            assert data.identical(reference[key])


def test_a_snapshot_refuses_what_cannot_be():
    two = {"position": [[0, 0], [1, 0]], "radius": [0.5, 0.5], "pairs": [], "force": []}
    for wrong, message in [
        ({"radius": [0.5, 0.0]}, r"radius\[1\] = 0 must be above 0"),
        ({"mass": [-1.0, 1.0]}, r"mass\[0\] = -1 must be above 0"),
        ({"volume": np.inf}, "volume = inf must be above 0, and finite"),
    ]:
        with pytest.raises(InputError, match=message):
            make(**two | wrong)
    with pytest.raises(InputError, match=r"sector = 1 rad must be a whole part of the full turn"):
        make(**two, sector=1.0)
    make(**two, mass=[1.0, 0.0], fixed=[False, True])  # a wall grain need not weigh anything
    with pytest.raises(InputError, match=r"pairs\[0\] is not of whole numbers"):
        Snapshot([[0, 0], [1, 0]], [0.5] * 2, [1, 1], [[0, 0]] * 2, [0, 0], [[0.5, 1.0]], [[0, 0]], [[0, 0]], [0])
    with pytest.raises(InputError, match="with P > 0"):
        average(make(**two), on="points", points=np.zeros((0, 2)), width=1.0)


def test_a_snapshot_in_space_survives_its_dataset(rng):
    sphere = Snapshot([[0, 0, 0]], [1.0], [1.0], [[0, 0, 0]], [[1.0, 2.0, 3.0]], [], [], [], [], cell=[4.0, 4.0, 4.0])
    back = read_snapshot(snapshot_dataset(sphere))
    np.testing.assert_array_equal(back.spin, [[1.0, 2.0, 3.0]])
    np.testing.assert_array_equal(back.cell, np.diag([4.0, 4.0, 4.0]))
    assert back.cell_velocity is None
    drift = [[0.0, 0.0], [0.5, 0.0]]
    sheared = make([[0, 0]], [1.0], [], [], cell=[4.0, 4.0], cell_velocity=drift)
    np.testing.assert_array_equal(read_snapshot(snapshot_dataset(sheared)).cell_velocity, drift)
    assert read_snapshot(snapshot_dataset(make([[5, 1]], [1.0], [], [], sector=np.pi / 3))).sector == np.pi / 3


def test_cells_too_many_to_be_meant_are_refused():
    pair = make([[0.0, 0.0], [1.0, 1.0]], [1.0, 1.0], [], [])
    for options in ({"on": "rings", "width": 1e-8}, {"on": "grid", "width": 1e-4}, {"on": "grid", "width": 1e-4, "kernel": "lucy"}):
        with pytest.raises(InputError, match="cells, at most 10000000"):
            average(pair, fields="density", **options)


def test_an_isotropic_strain_tells_no_shear_modulus():
    """A grain between four turned walls, pressed more one way: the deviator of the strain is rounding, and nothing is divided by it."""
    angle = 0.3 + np.arange(4) * np.pi / 2
    normal = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    pressed = [1.0, 2.0, 1.0, 2.0]
    pairs = [(0, -1 - k) for k in range(4)]
    snapshot = Snapshot(
        [[0.0, 0.0]], [1.0], [1.0], [[0.0, 0.0]], [0.0], pairs, -np.array(pressed)[:, None] * normal, 0.99 * normal, [0.01] * 4
    )
    data = average(snapshot, fields=["shear_modulus", "bulk_modulus", "elastic_strain"])
    np.testing.assert_allclose(data.elastic_strain, 0.0099 * np.eye(2), **EXACT)
    assert float(data.bulk_modulus) > 0
    assert np.isnan(data.shear_modulus)
    assert data.shear_modulus.attrs["reason"] == "no contacts, or an isotropic strain"
