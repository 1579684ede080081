"""The same sample on the box, rings, grids and points: sums agree, affine fields are exact, everything turns with the frame."""

import numpy as np
import pytest
import xarray as xr
from clusters import make

from anisogran import average
from anisogran.averaging import known_at
from anisogran.averaging.choosing import place_of
from anisogran.outcome import InputError
from anisogran.snapshot import Snapshot

GRADIENT = np.array([[0.1, 0.7], [-0.3, 0.2]])
START = np.array([1.0, 2.0])


def crowd(rng, count=300, d=2, **more):
    """Grains at random, with an affine velocity and random contacts between neighbours in the list (only for sums over contacts)."""
    position = rng.uniform(-10, 10, (count, d))
    radius = rng.uniform(0.2, 0.4, count)
    pairs = np.stack([np.arange(count - 1), np.arange(1, count)], axis=1)
    point = position[pairs[:, 0]] + rng.normal(size=(count - 1, d))
    defaults = {
        "position": position, "radius": radius, "mass": rng.uniform(1, 2, count), "velocity": rng.normal(size=(count, d)),
        "spin": rng.normal(size=count if d == 2 else (count, d)), "pairs": pairs, "force": rng.normal(size=(count - 1, d)),
        "point": point, "overlap": rng.uniform(0.01, 0.02, count - 1),
    }  # fmt: skip
    return Snapshot(**(defaults | more))


def totals(data, name):
    """Sum over the cells of a density times the volume of its cell."""
    return (data[name] * data.volume).sum([dim for dim in data[name].dims if dim not in "ij"])


def test_cells_of_a_grid_add_up_to_the_box(rng):
    """Extensive quantities over all rectangles are those of the whole box, to rounding."""
    snapshot = crowd(rng)
    names = ["density", "momentum_density", "area_fraction", "stress_static", "fabric", "spin_density", "couple_stress", "number_density"]
    box, grid = average(snapshot, fields=names), average(snapshot, on="grid", width=1.3, fields=names)
    for name in names:
        np.testing.assert_allclose(totals(grid, name), totals(box, name), rtol=1e-12, atol=1e-12 * abs(totals(box, name)).max())


def test_each_rectangle_has_its_own_area():
    disc = make([[0.5, 3.5]], [0.4], [], [], mass=[6.0])
    data = average(disc, on="grid", edges=([0.0, 1.0, 4.0], [0.0, 3.0, 5.0]), fields="density")
    np.testing.assert_allclose(data.volume, [[3.0, 2.0], [9.0, 6.0]], rtol=1e-14)
    np.testing.assert_allclose(data.density, [[0.0, 3.0], [0.0, 0.0]], atol=1e-14)


def test_rings_add_up_to_the_box(rng):
    """Scalars over all rings are those of the box; so are the traces, which no frame changes. In space too, over rings and levels."""
    for d in (2, 3):
        snapshot = crowd(rng, d=d)
        fraction = "area_fraction" if d == 2 else "volume_fraction"
        names = ["density", "number_density", fraction, "stress_static", "fabric"]
        box, rings = average(snapshot, fields=names), average(snapshot, on="rings", width=1.3, fields=names)
        for name in names:
            whole, parts = totals(box, name), totals(rings, name)
            if whole.ndim == 2:
                whole, parts = np.trace(whole), np.trace(parts)
            np.testing.assert_allclose(parts, whole, rtol=1e-11)  # spheres: shares to 1e-9 each, but their sums to rounding


@pytest.mark.parametrize("cell_velocity", [None, [[0.0, 0.0], [1.1, 0.0]]])
def test_cells_of_a_sheared_periodic_cell_add_up_to_it(rng, cell_velocity):
    """A disc that hangs over the border has its other part on the other side, also where the cell is sheared by Lees-Edwards."""
    cell = np.array([[7.0, 0.0], [2.6, 5.0]])
    position = rng.uniform(-3, 12, (200, 2))  # grains may have wandered out of the cell
    snapshot = crowd(rng, 200, position=position, cell=cell, cell_velocity=cell_velocity)
    names = ["density", "area_fraction", "stress_static", "fabric", "number_density"]
    box, grid = average(snapshot, fields=names), average(snapshot, on="grid", width=0.9, fields=names)
    for name in names:
        np.testing.assert_allclose(totals(grid, name), totals(box, name), rtol=1e-11, atol=1e-11)
    assert float(grid.volume.sum()) == pytest.approx(35.0)


@pytest.mark.parametrize("on", ["box", "grid", "points", "kernel grid"])
def test_an_affine_motion_is_recovered_exactly(rng, on):
    """v = v0 + G x: velocity and gradient to rounding at any place, no fluctuation, spin of the continuum half the curl of G."""
    n = 300
    base = crowd(rng, n)
    velocity = START + base.position @ GRADIENT.T
    spin = 0.4 + base.position @ [0.05, -0.02]
    snapshot = make(base.position, base.radius, [], [], mass=base.mass, velocity=velocity, spin=spin)
    options = {
        "box": {}, "grid": {"on": "grid", "width": 4.0}, "points": {"on": "points", "points": rng.uniform(-6, 6, (7, 2)), "width": "1.5d"},
        "kernel grid": {"on": "grid", "width": 3.0, "kernel": "lucy"},
    }[on]  # fmt: skip
    names = ["velocity", "velocity_gradient", "stress_dynamic", "continuum_spin", "eigen_rotation", "spin", "curvature", "shear_rate"]
    data = average(snapshot, fields=names, **options)
    x = base.mass @ base.position / base.mass.sum() if on == "box" else np.stack(xr.broadcast(data.x, data.y))
    x = x.reshape(2, -1)

    def flat(name):
        array = data[name].values
        rank = {"velocity": 1, "velocity_gradient": 2, "stress_dynamic": 2, "curvature": 1}.get(name, 0)
        return array.reshape(*array.shape[:rank], -1)

    exact = {"rtol": 0, "atol": 1e-12}
    np.testing.assert_allclose(flat("velocity"), START[:, None] + GRADIENT @ x, **exact)
    np.testing.assert_allclose(flat("velocity_gradient"), np.broadcast_to(GRADIENT[:, :, None], (2, 2, x.shape[1])), **exact)
    np.testing.assert_allclose(flat("stress_dynamic"), 0, atol=1e-11)  # of a density of about 1 and velocities up to 10
    np.testing.assert_allclose(flat("continuum_spin"), 0.5 * (-0.3 - 0.7), **exact)
    np.testing.assert_allclose(flat("spin"), 0.4 + np.array([0.05, -0.02]) @ x, **exact)
    np.testing.assert_allclose(flat("eigen_rotation"), flat("spin") - flat("continuum_spin"), **exact)
    np.testing.assert_allclose(flat("curvature"), np.broadcast_to([[0.05], [-0.02]], (2, x.shape[1])), **exact)
    np.testing.assert_allclose(flat("shear_rate"), 2 * np.hypot(0.5 * (0.1 - 0.2), 0.5 * (0.7 - 0.3)), **exact)


def test_uniform_shear_of_a_periodic_cell_crosses_its_border(rng):
    """Images above move by rate * height, so the gradient is the same at the border as in the middle."""
    rate, cell = 0.6, np.array([[8.0, 0.0], [1.7, 6.0]])
    position = rng.uniform(0, 1, (400, 2)) @ cell
    velocity = np.stack([rate * position[:, 1], 0 * position[:, 1]], axis=1)
    snapshot = make(
        position, np.full(400, 0.2), [], [], velocity=velocity, cell=cell, cell_velocity=[[0, 0], [rate * 6.0, 0]], spin=np.full(400, -0.3)
    )
    border = np.array([[0.0, 0.0], [4.0, 6.0], [8.0, 3.0], [-3.0, 14.0]])
    for data in (
        average(snapshot, on="points", points=border, width=1.0, kernel="lucy", fields=["velocity_gradient", "eigen_rotation", "velocity"]),
        average(snapshot, on="grid", width=2.0, fields=["velocity_gradient", "eigen_rotation", "velocity"]),
    ):
        gradient = data.velocity_gradient.values.reshape(2, 2, -1)
        np.testing.assert_allclose(gradient, np.broadcast_to([[[0], [rate]], [[0], [0]]], gradient.shape), atol=1e-12)
        np.testing.assert_allclose(data.eigen_rotation, 0.0, atol=1e-12)
        y = np.broadcast_arrays(data.velocity[0], data.y)[1]
        np.testing.assert_allclose(data.velocity[0], rate * y, atol=1e-12)


def test_a_sector_is_the_whole_ring(rng):
    """A quarter of a ring with contacts across its seam has the same profile as the ring made of four of it, on rings and on points."""
    n, angle = 60, np.pi / 2
    r, phi = rng.uniform(4, 8, n), rng.uniform(0, angle, n)
    position = np.stack([r * np.cos(phi), r * np.sin(phi)], axis=1)
    first, second = np.arange(n - 1), np.arange(1, n)
    force, radius = rng.normal(size=(n - 1, 2)), rng.uniform(0.2, 0.4, n)

    def turned(vectors, k):
        c, s = np.cos(k * angle), np.sin(k * angle)
        return np.stack([c * vectors[:, 0] - s * vectors[:, 1], s * vectors[:, 0] + c * vectors[:, 1]], axis=1)

    # the nearest image of the second grain, as the first one sees it
    k = np.rint((phi[first] - phi[second]) / angle).astype(int)
    images = np.array([turned(position[j : j + 1], turns)[0] for j, turns in zip(second, k, strict=True)])
    point = 0.5 * (position[first] + images)
    velocity, spin = rng.normal(size=(n, 2)), rng.normal(size=n)
    common = {"radius": radius, "mass": radius**2, "spin": spin, "overlap": np.full(n - 1, 0.01)}
    sector = Snapshot(
        position=position, velocity=velocity, pairs=np.stack([first, second], 1), force=force, point=point, sector=angle, **common
    )
    whole = Snapshot(
        position=np.concatenate([turned(position, m) for m in range(4)]), velocity=np.concatenate([turned(velocity, m) for m in range(4)]),
        pairs=np.concatenate([np.stack([first + m * n, second + ((m + k) % 4) * n], 1) for m in range(4)]),
        force=np.concatenate([turned(force, m) for m in range(4)]), point=np.concatenate([turned(point, m) for m in range(4)]),
        **{name: np.tile(values, 4) for name, values in common.items()},
    )  # fmt: skip
    names = ["density", "velocity", "velocity_gradient", "stress", "fabric", "spin_density", "couple_stress", "elastic_strain"]
    edges = np.linspace(3.5, 8.5, 6)
    points = np.array([[6.0, 0.1], [0.1, 6.0], [3.0, 5.0]])
    for options in ({"on": "rings", "edges": edges}, {"on": "points", "points": points, "width": 0.8}):
        one, four = (average(snapshot, fields=names, **options) for snapshot in (sector, whole))
        for name in names:
            np.testing.assert_allclose(one[name], four[name], atol=1e-11, err_msg=name)


def test_turning_everything_turns_every_field(rng):
    """Scalars stay, vectors and tensors turn: on the box and on turned points; on rings nothing changes at all."""
    snapshot = crowd(rng)
    angle = 0.7
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    moved = Snapshot(
        snapshot.position @ turn.T, snapshot.radius, snapshot.mass, snapshot.velocity @ turn.T, snapshot.spin, snapshot.pairs,
        snapshot.force @ turn.T, snapshot.point @ turn.T, snapshot.overlap, volume=snapshot.volume,
    )  # fmt: skip
    points = rng.uniform(-6, 6, (5, 2))
    for here, there in (
        ({}, {}),
        ({"on": "points", "points": points, "width": 2.0}, {"on": "points", "points": points @ turn.T, "width": 2.0}),
        ({"on": "rings", "edges": np.arange(2.0, 9.0)},) * 2,
    ):
        place = place_of(snapshot, **{"on": "box", **here})
        names = known_at(place)
        before, after = average(snapshot, fields=names, **here), average(moved, fields=names, **there)
        for name in names:
            expected, found = before[name].values, after[name].values
            if here.get("on") != "rings":
                if "j" in before[name].dims:
                    expected = np.einsum("ik,kl...,jl->ij...", turn, expected, turn)
                elif "i" in before[name].dims:
                    expected = np.einsum("ik,k...->i...", turn, expected)
                elif name.endswith("_angle") and "_to_" not in name:
                    expected = expected + angle
                    expected, found = np.mod(expected, np.pi), np.mod(found, np.pi)
            scale = np.nanmax(np.abs(expected)) if np.isfinite(expected).any() else 1.0
            np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-10 * max(scale, 1e-3), err_msg=name)
    assert len(names) > 30


def test_rings_in_space_see_a_turning_column(rng):
    """v_phi = a r (1 + b z) and v_z = c z: the gradient in the frame (r, phi, z) in closed form, on the affine part to rounding."""
    position = rng.uniform(-6, 6, (4000, 3))
    x, y, z = position.T
    velocity = np.stack([-0.3 * y, 0.3 * x, 0.2 * z], axis=1)
    snapshot = Snapshot(position, np.full(4000, 0.2), np.ones(4000), velocity, np.tile([0, 0, 0.3], (4000, 1)), [], [], [], [])
    data = average(
        snapshot,
        on="rings",
        edges=([1.0, 2.0, 3.0, 4.0], [-3.0, 0.0, 3.0]),
        fields=["velocity", "velocity_gradient", "eigen_rotation", "density"],
    )
    assert data.velocity.dims == ("i", "r", "z")
    np.testing.assert_allclose(data.velocity[1], np.broadcast_to(0.3 * data.r.values[:, None], (3, 2)), atol=1e-12)
    np.testing.assert_allclose(data.velocity[2], np.broadcast_to(0.2 * data.z.values, (3, 2)), atol=1e-12)
    expected = np.zeros((3, 3, 3, 2))
    expected[0, 1], expected[1, 0], expected[2, 2] = -0.3, 0.3, 0.2
    np.testing.assert_allclose(data.velocity_gradient, expected, atol=1e-12)
    np.testing.assert_allclose(data.eigen_rotation, 0, atol=1e-12)
    assert data.density.attrs["units"] == "kg/m3"


def test_empty_cells_and_single_grains_say_what_they_lack():
    one = make([[0.5, 0.5]], [0.4], [], [], velocity=[[1.0, 2.0]], spin=[3.0])
    data = average(
        one, on="grid", edges=([0.0, 1.0, 2.0], [0.0, 1.0]), fields=["velocity", "velocity_gradient", "density", "stress", "spin"]
    )
    np.testing.assert_allclose(data.velocity[:, 0, 0], [1.0, 2.0])
    assert np.isnan(data.velocity[:, 1]).all()
    assert np.isnan(data.velocity_gradient).all()  # one grain tells no gradient
    assert "too few to tell a gradient" in data.velocity_gradient.attrs["reason"]
    assert "reason" not in data.density.attrs
    np.testing.assert_array_equal(data.density, [[1.0], [0.0]])
    np.testing.assert_array_equal(data.stress, 0.0)
    nothing = average(one, on="points", points=[[9.0, 9.0]], width=0.1)
    assert float(nothing.density[0]) == 0.0
    assert np.isnan(nothing.velocity).all()


@pytest.mark.hard_case("D10")
def test_only_rattlers_carry_nothing():
    chain = make([[0, 0], [1, 0], [2, 0]], [0.5] * 3, [(0, 1), (1, 2)], [(-1, 0), (-1, 0)])
    data = average(chain, fields=["coordination_number", "rattler_fraction", "fabric_trace"])
    assert float(data.coordination_number) == 0.0
    assert float(data.rattler_fraction) == 1.0
    assert float(data.fabric_trace) == pytest.approx(4 * np.pi * 0.25 / 3.0)  # the fabric counts every contact


def test_wall_grains_are_wall(rng):
    """Driven grains weigh nothing at any place; a contact with one is a contact with the wall."""
    snapshot = make([[0, 0], [1, 0]], [0.5, 0.5], [(0, 1)], [(-2.0, 0.0)], fixed=[False, True], volume=2.0)
    edges = ([-1.0, 2.0], [-1.0, 1.0])
    for data in (average(snapshot), average(snapshot, on="grid", edges=edges)):
        area = float(data.volume.sum())
        assert float(totals(data, "area_fraction")) == pytest.approx(np.pi * 0.25)
        np.testing.assert_allclose(totals(data, "stress"), np.diag([2.0 * 0.5, 0.0]), atol=1e-14)
        assert area in (2.0, 6.0)


def test_widths_are_metres_or_mean_diameters():
    snapshot = make([[0.0, 0.0], [4.0, 0.0]], [0.5, 0.5], [], [])
    assert average(snapshot, on="grid", width="2.5d").sizes["x"] == 2  # 5 m wide
    assert average(snapshot, on="points", points=[[0, 0]], width="2.5d").attrs["width"] == 2.5
    assert average(snapshot, on="points", points=[[0, 0]], width=0.3).attrs["width"] == 0.3
    large = make([[0.0, 0.0], [4.0, 0.0]], [1.0, 3.0], [], [], fixed=[False, True])
    assert average(large, on="points", points=[[0, 0]], width="0.3").attrs["width"] == 0.3
    assert average(large, on="points", points=[[0, 0]], width="1.5d").attrs["width"] == 3.0  # of the free grains
    assert average(snapshot, on="points", points=[[0, 0]]).attrs["kernel"] == "gaussian"
    for wrong in ("d", "1.0 m", "-1d", 0, -1.0, np.nan, "x"):
        with pytest.raises(InputError, match="width"):
            average(snapshot, on="points", points=[[0, 0]], width=wrong)


def test_options_that_do_not_fit_are_refused():
    flat = make([[0.0, 0.0], [4.0, 0.0]], [0.5, 0.5], [], [])
    periodic = make([[0.0, 0.0], [4.0, 0.0]], [0.5, 0.5], [], [], cell=[9.0, 9.0])
    space = Snapshot([[0, 0, 0]], [1.0], [1.0], [[0, 0, 0]], [[0, 0, 0]], [], [], [], [])
    for snapshot, options, message in [
        (flat, {"width": 1.0}, "the whole sample has no width"),
        (flat, {"on": "rings", "kernel": "lucy"}, "a kernel is for on='points' and on='grid'"),
        (flat, {"on": "points"}, r"the points are missing; give points=, an array \(P, 2\)"),
        (flat, {"on": "points", "points": [[0, 0, 0]]}, r"shape \(P, 2\)"),
        (flat, {"on": "points", "points": [["a", "b"]]}, "no array of numbers"),
        (flat, {"on": "box", "points": [[0, 0]]}, "points are for on='points'"),
        (flat, {"on": "points", "points": [[0, 0]], "edges": [1, 2]}, "edges are for on='rings' and on='grid'"),
        (flat, {"on": "points", "points": [[0, 0]], "kernel": "hat"}, "hat"),
        (flat, {"on": "points", "points": [[0, 0]], "kernel": "heaviside", "fields": "density_gradient"}, "heaviside"),
        (flat, {"on": "grid", "edges": ([0, 1],)}, "each of the 2 axes"),
        (flat, {"on": "grid", "edges": ([0, 1], [1, 0])}, "edges along y must be at least 2 ascending numbers"),
        (flat, {"on": "grid", "fields": "wall_force_density"}, "known on points only"),
        (flat, {"on": "box", "fields": "v_phi"}, "known on rings only"),
        (flat, {"fields": "volume_fraction"}, "not known in 2 dimensions"),
        (space, {"fields": "anisotropy"}, "not known in 3 dimensions"),
        (space, {"on": "grid"}, "no exact shares of spheres"),
        (periodic, {"on": "rings"}, "no axis to lay rings about"),
        ([], {}, "no snapshot to average"),
        (7, {}, "int is no Snapshot"),
        ([flat, space], {}, "must hold snapshots of 2 dimensions"),
    ]:
        with pytest.raises(InputError, match=message) as caught:
            average(snapshot, **options)
        assert "\n" not in str(caught.value)


def test_rattlers_are_told_by_whether_there_is_friction():
    """Three discs on a bent line between walls, two contacts each: enough with a tangential force somewhere, too few without."""
    position = [[0, 0], [1, 0.2], [2, 0]]
    for tangential, carried in ((0.0, 0.0), (0.3, 2.0)):
        branch = np.array([1, 0.2]) / np.hypot(1, 0.2)
        force = [-branch, [-1.0, 0.2] / np.hypot(1, 0.2), [1.0, tangential], [-1.0, 0.0]]
        pairs = [(0, 1), (1, 2), (0, -1), (2, -2)]
        point = [[0.5, 0.1], [1.5, 0.1], [-0.5, 0], [2.5, 0]]
        snapshot = make(position, [0.51] * 3, pairs, force, point=point)
        assert float(average(snapshot, fields="coordination_number").coordination_number) == carried
        assert float(average(snapshot, fields="coordination_number", least_contacts=2).coordination_number) == 2.0


def test_the_default_grid_covers_the_grains_or_one_period(rng):
    """A sample that is periodic along one axis only comes with a very long lattice vector along the other: no grid runs along that."""
    position = rng.uniform(0, 1, (50, 2)) * [5.0, 3.0]
    slab = crowd(rng, 50, position=position, radius=np.full(50, 0.3), cell=[5.0, 1e6])
    data = average(slab, on="grid", width=1.0, fields="density")
    assert data.sizes["x"] == 5
    assert data.sizes["y"] < 5
    assert float(totals(data, "density")) == pytest.approx(slab.mass.sum(), rel=1e-12)
    tilted = crowd(rng, 5, position=rng.uniform([1.0, 2.5], [2.0, 3.5], (5, 2)), radius=np.full(5, 0.3), cell=[[5.0, 0.0], [2.0, 3.0]])
    data = average(tilted, on="grid", width=1.0, fields="density")
    assert data.density.shape == (5, 3)
    assert float(totals(data, "density")) == pytest.approx(tilted.mass.sum(), rel=1e-12)
