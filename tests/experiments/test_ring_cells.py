"""The ring shear cells: exact cases first, then small samples under pressure and at constant volume."""

from dataclasses import replace

import numpy as np
import pytest

from anisogran import InputError, RingShear, RingShearVolume
from anisogran.dem import Fixed, Simulation

SMALL = RingShear.quick | {"n": 150, "inner_radius": 3.0, "travel": 4.0, "discard": 1.0, "block": 0.5, "frames": 0, "seed": 1}


def prepared(**changes):
    """The Simulation of the small cell, pressed together."""
    relax, _ = RingShear(**SMALL | changes).stages()
    simulation = relax.begin(None)
    while relax.gate(simulation):
        simulation.run(5000)
    return simulation


def forces(simulation):
    """{pair of grains: normal and tangential force, sizes} of all contacts."""
    snapshot = simulation.snapshot()
    first, second = snapshot.pairs.T
    normal = snapshot.position[second] - snapshot.position[first]
    normal /= np.hypot(*normal.T)[:, None]
    along, whole = np.einsum("cd,cd->c", snapshot.force, normal), np.hypot(*snapshot.force.T)
    across = np.sqrt(np.maximum(whole**2 - along**2, 0.0))
    return dict(zip(map(tuple, np.sort(snapshot.pairs, axis=1).tolist()), np.stack([-along, across], axis=1), strict=True))


def test_a_sample_that_turns_with_both_rings_keeps_its_forces():
    """Pressed with friction; the tangential springs are seen from the grains, and turn with them."""
    pressed = prepared(pressing_friction=0.44)
    held = replace(pressed.boundary, radius=float(pressed.walls.position[0]), rim=Fixed())
    rest = pressed.next_stage(boundary=held)
    rest.run(100_000)  # to a rest far deeper than a shear needs
    before, angle, omega = forces(rest), 0.2, 2e-3
    turning = omega * np.stack([-rest.position[:, 1], rest.position[:, 0]], axis=1)
    grains = replace(rest.grains, position=rest.position, velocity=turning, spin=np.full(len(rest.grains), omega))
    turned = Simulation(
        grains, predecessor=(rest, None), **rest.arguments() | {"boundary": replace(held, omega=omega, outer_omega=omega), "drag": None}
    )
    turned.run(round(angle / omega / turned.dt))
    after = forces(turned)
    pairs = [pair for pair, (normal, _) in before.items() if normal > 0.05]
    old, new = (np.array([table[pair] for pair in pairs]) for table in (before, after))
    assert len(pairs) > 180
    assert np.mean(old[:, 1] > 0.05) > 0.3  # springs that a wrong frame would lose
    np.testing.assert_allclose(new, old, atol=2e-3)  # centrifugal forces of 1e-5 a grain and their jerk: 4e-4, and less for slower turns
    cosine, sine = np.cos(angle), np.sin(angle)
    bearing = sorted({grain for pair in pairs for grain in pair})  # rattlers drift outwards
    np.testing.assert_allclose(turned.position[bearing], rest.position[bearing] @ [[cosine, sine], [-sine, cosine]], atol=2e-3)


@pytest.fixture(scope="module")
def pressed():
    return RingShear(**SMALL).run()


@pytest.fixture(scope="module")
def closed():
    return RingShearVolume(**RingShearVolume.quick | {"travel": 10.0, "block": 1.0, "frames": 0, "seed": 2}).run()


def averaged(run):
    """The part of the series that the profiles are made of."""
    return run.series.isel(time=slice(run.scene.counts()[0], None))


@pytest.mark.parametrize("name", ["pressed", "closed"])
def test_circles_tell_what_the_rings_and_the_sample_bear(name, request):
    """On the innermost the torque and pressure of the series; the torque is the same on all; between two the hoop stress presses."""
    run = request.getfixturevalue(name)
    circles, series, r = run.tables["circles"], averaged(run), run.tables["circles"].r.values
    assert float(circles.cut_pressure[0]) == pytest.approx(float(series.wall_pressure.mean()), rel=1e-9)
    torque = (circles.cut_shear_stress * r**2).values
    assert torque[0] == pytest.approx(float(series.wall_shear_stress.mean()) * run.scene.inner_radius**2, rel=0.01)  # of the half step
    np.testing.assert_allclose(torque, torque.mean(), rtol=0.06)  # 60 samples of a sample that shakes
    # rings smear the stress of a grain over its area, a circle cuts it: they agree in the sum over some, to a tenth in each
    pressing, hoop = np.diff(r * circles.cut_pressure.values) / np.diff(r), run.profiles.stress.values[1, 1]
    np.testing.assert_allclose(pressing[1:], hoop[1:], rtol=0.15)
    assert pressing[1:].sum() == pytest.approx(hoop[1:].sum(), rel=0.1)


@pytest.mark.parametrize("name", ["pressed", "closed"])
def test_layers_hold_every_grain(name, request):
    """But those beyond the last ring; and they see the flow that the rings see."""
    run = request.getfixturevalue(name)
    layers, profiles, d = run.tables["layers"], run.profiles, run.scene.mean_diameter
    edges = run.scene.layer_edges(profiles.sizes["r"])
    assert len(layers.r) == 10 * profiles.sizes["r"] + 5
    assert np.diff(edges) == pytest.approx(0.1 * d)
    grains = float(np.sum(layers.number_density * np.pi * np.diff(edges**2)))
    beyond = np.hypot(*run.snapshots["end"].position[run.snapshots["end"].free].T) > edges[-1]
    assert grains == pytest.approx(run.scene.n - beyond.sum(), abs=5)  # of the mean and of the end
    for k in range(1, profiles.sizes["r"]):
        inside = np.abs(layers.r - profiles.r[k]) < 0.5 * d
        mean = float((layers.v_phi * layers.number_density)[inside].sum() / layers.number_density[inside].sum())
        assert mean == pytest.approx(float(profiles.v_phi[k]), abs=0.04 * run.scene.wall_speed)


def test_constant_volume_keeps_the_volume(closed):
    """The rings stay where they are, and so does every grain between them; the flow is that of the inner ring."""
    scene, end = closed.scene, closed.snapshots["end"]
    assert (closed.series.outer_radius == scene.outer_radius).all()
    r = np.hypot(*end.position[end.free].T)
    assert r.min() > scene.inner_radius + 0.9 * end.radius.min()
    assert r.max() < scene.outer_radius - 0.9 * end.radius[end.free].min()
    assert float(closed.series.turns[-1]) == pytest.approx(10.0 * scene.mean_diameter / (2 * np.pi * scene.inner_radius), rel=1e-3)
    assert 0.2 < float(closed.profiles.v_phi[0]) / scene.wall_speed < 1
    assert float(closed.profiles.v_phi[-1]) < 0.2 * scene.wall_speed
    assert end.mass[end.free].sum() == pytest.approx(1060 * 0.006 * np.pi * np.sum(end.radius[end.free] ** 2))


def test_stresses_are_told_over_the_pressure_of_their_block(closed):
    means = averaged(closed).wall_pressure.values.reshape(closed.blocks.sizes["block"], -1).mean(axis=1)
    np.testing.assert_allclose(closed.blocks.relative_stress.values, closed.blocks.stress.values / means[:, None, None, None], rtol=1e-9)
    np.testing.assert_allclose(closed.profiles.relative_stress.values, closed.blocks.relative_stress.values.mean(axis=0), rtol=1e-12)
    assert (closed.profiles.relative_stress_error > 0).all()


def test_a_pressure_that_wanders_is_told(closed):
    count = closed.blocks.sizes["block"]
    rows = np.repeat(np.linspace(2.0, 1.0, count), closed.scene.counts()[2])
    wall = closed.series.wall_pressure.copy(data=np.append(np.ones(closed.scene.counts()[0]), rows))

    class Quiet:
        counters = {"late_builds": 0}  # noqa: RUF012

        def snapshot(self):
            return closed.snapshots["end"]

    told = str(closed.scene.judge(closed.series.assign(wall_pressure=wall), closed.blocks, Quiet()))
    assert "the pressure on the inner ring went from 2 to 1 N/m, 1 to 2 in all: take stresses relative to it" in told
    wall = wall.copy(data=np.full(len(wall), 1.5))
    assert "take stresses relative" not in str(closed.scene.judge(closed.series.assign(wall_pressure=wall), closed.blocks, Quiet()))


def test_friction_while_pressing_makes_a_looser_start():
    """Of 150 grains of three seeds the outer ring starts farther out with it, every time."""
    for seed in range(3):
        smooth, rough = (float(prepared(seed=seed, pressing_friction=mu).walls.position[0]) for mu in (None, 0.44))
        assert rough > smooth + 0.02


def test_the_innermost_circle_cuts_the_contacts_with_discs_on_it():
    """A contact that ends on a circle, but for rounding, does not cross it; a millionth of a diameter farther out it does."""
    scene = RingShearVolume()
    inner, *others = scene.circles(3)
    assert scene.inner_radius * (1 + 1e-9) < inner < scene.inner_radius * (1 + 1e-6)
    np.testing.assert_allclose(others, scene.inner_radius + scene.mean_diameter * np.arange(1, 4))


def test_without_friction_no_couples_are_summed():
    scene = RingShear(**SMALL | {"friction": None})
    assert "couple_stress" in RingShear(**SMALL).profile_needs
    assert "couple_stress" not in scene.profile_needs
    assert "torque_stiffness" not in scene.profile_names


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: RingShearVolume(pressure=1.0), "RingShearVolume: unknown key 'pressure'"),
        (lambda: RingShear(outer_radius=1.0), "RingShear: unknown key 'outer_radius'"),
        (lambda: RingShearVolume(outer_radius=0.1), "outer_radius = 0.1 m must be above inner_radius = 0.1032 m"),
        (lambda: RingShearVolume(large=3000), "RingShearVolume: large = 3000 must be at most n = 2939"),
        (lambda: RingShearVolume(n=3500), r"RingShearVolume: n = 3500 discs fill 0\.95\d of the cell; at most 0\.9"),
        (lambda: RingShear(wall_spacing=1.7), r"RingShear: wall_spacing = 1\.7 must be at most 1\.53 with wall_disc = 1, or the smallest"),
        (lambda: RingShear(pressing_friction=0.3, friction=None), r"pressing_friction = 0\.3 needs the table friction"),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_refused(make, message):
    with pytest.raises(InputError, match=message):
        make()


@pytest.mark.parametrize("scene", [RingShear(**SMALL), RingShearVolume(**RingShearVolume.quick)], ids=["pressed", "closed"])
def test_the_shear_has_friction_and_no_drag(scene):
    """The grains are prepared the other way round; then the inner ring turns at its speed, and discs have the inertia of their kind."""
    start = next(iter(scene.stages())).begin(None)
    sheared = scene.turned(start)
    assert start.effects.get("drag")
    assert not start.effects.get("friction")
    assert sheared.effects["friction"] == scene.friction
    assert not sheared.effects.get("drag")
    assert sheared.boundary.omega * scene.inner_radius == pytest.approx(scene.wall_speed)
    assert sheared.boundary.outer_omega == 0
    factor = 0.4 if scene.kind == "ring_shear" else 0.5  # spheres in a plane, cylinders
    assert sheared.grains.inertia_factor == factor
