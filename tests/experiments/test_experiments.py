"""Small versions of the experiments: each protocol runs for real, and the physics that must hold on any size holds."""

import json
import re
import tomllib
from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from scipy.optimize import brentq

from anisogran import Biaxial, CohesiveGas, RingShear, SimpleShear, Stiffness, Tablet, average
from anisogran import open as open_results
from anisogran.dem import Friction, Linear, Luding, Simulation, longest_step
from anisogran.experiments import simple_shear
from anisogran.experiments.biaxial import BEARING
from anisogran.experiments.steady_shear import blocks_of, steady_state
from anisogran.glossary import GLOSSARY
from anisogran.outcome import InputError, RunFailed, Status
from anisogran.runs.estimates import estimate
from anisogran.runs.session import Session
from anisogran.runs.stages import Stage, equilibrium


@pytest.fixture(scope="module")
def biaxial():
    wall = {"wall_mass": 2e-5, "wall_damping": 0.02}
    return Biaxial(n=150, friction=Friction(2e4, 0.5), strain=0.05, duration=0.03, samples=40, seed=3, **wall).run()


@pytest.fixture(scope="module")
def ring():
    return RingShear(n=250, inner_radius=4.0, travel=10.0, discard=2.0, block=1.0, seed=3).run()


@pytest.fixture(scope="module")
def shear():
    return SimpleShear(inertial_number=0.05, n=100, strain=3.0, discard=1.0, seed=3).run()


def test_biaxial_box_starts_isotropic_and_keeps_its_pressure(biaxial):
    s = biaxial.series
    assert abs(float(s.s_D[0])) < 0.02  # the gate: both walls within 1 % of the pressure
    assert float(s.eps_zz[0]) == 0.0
    assert float(s.eps_zz[-1]) == pytest.approx(0.05, abs=1e-9)
    np.testing.assert_allclose(s.sigma_xx, 100.0, rtol=0.03)
    # grains and walls measure the same stress, but for inertia
    np.testing.assert_allclose(s.sigma_zz_grains, s.sigma_zz, rtol=0.15)
    assert float(abs(s.sigma_zz_grains / s.sigma_zz - 1).median()) < 0.02


def test_biaxial_box_shows_what_granular_matter_does(biaxial):
    """Contraction first, dilation later; a stress ratio of a frictional packing; contacts are lost along the minor axis."""
    s = biaxial.series
    assert float(s.eps_V.max()) > 0
    assert float(s.eps_V[-1]) < 0
    assert 0.3 < float(s.s_D.max()) < 0.65  # asin: 17 to 40 degrees
    assert float(s.anisotropy.max()) > 0.1
    assert float(s.coordination_number[-1]) < float(s.coordination_number[0])


def test_snapshots_are_kept_at_the_strains_of_the_slides(biaxial):
    s = biaxial.series
    assert set(biaxial.snapshots) == {"start", "peak", "end", "eps_zz-0.011", "eps_zz-0.042"}  # 9.1 % is not reached
    for strain in (0.011, 0.042):
        first = int(np.argmax(s.eps_zz.values >= strain))
        assert biaxial.snapshots[f"eps_zz-{strain:.3f}"].time == float(s.time[first])


def test_over_consolidation_is_common_and_without_adhesion():
    """Pressed at the larger pressure without adhesion, released to its own with it; contacts remember the larger pressure."""
    small = {"n": 80, "strain": 0.01, "duration": 0.002, "wall_mass": 1e-4, "wall_damping": 0.02, "samples": 10, "seed": 2}
    sticky = Luding(5e4, 1e5, 1e5, 0.1)
    assert [stage.name for stage in Biaxial(**small).stages()] == ["press", "relax", "load"]
    assert [stage.name for stage in Biaxial(contact=sticky, **small).stages()] == ["press", "relax", "release", "load"]
    started, laws = {}, {}
    for p0 in (None, 800.0):
        scene = Biaxial(contact=sticky, overconsolidation=p0, **small)
        session, laws[p0] = Session(scene), {}

        def listen(session=session, seen=laws[p0]):
            if session.begun is not None:
                seen[session.stage_name] = session.simulation.effects["normal"].kc

        session.go(listen)
        started[p0] = session.result().series.isel(time=0)
        assert laws[p0] == {"press": 0.0, "relax": 0.0, "release": 1e5, "load": 1e5}
        assert float(started[p0].sigma_xx) == pytest.approx(100.0, rel=0.011)  # the gate, and a step
    assert float(started[800.0].area_fraction) > float(started[None].area_fraction) + 0.002


LIGHT = {"n": 150, "wall_mass": 2e-5, "wall_damping": 0.02, "duration": 0.02, "samples": 40, "seed": 3}


def test_the_top_comes_back():
    """Three half periods: the strain returns to zero and grows again; unloading is stiff."""
    run = Biaxial(friction=Friction(2e4, 0.5), strain=0.012, half_periods=3, **LIGHT).run()
    s = run.series
    assert s.sizes["time"] == 121
    np.testing.assert_allclose(s.eps_zz[:81], s.eps_zz[80::-1], atol=1e-5)  # whole steps of time fall beside the turn
    np.testing.assert_allclose(s.eps_zz[80:], s.eps_zz[:41], atol=1e-5)
    assert float(s.eps_zz[40]) == pytest.approx(0.012, abs=1e-9)
    assert run.snapshots["eps_zz-0.011"].time < 0.02  # of the first loading, not of the second
    down, up = s.sigma_zz.values[15], s.sigma_zz.values[65]  # the same strain, on the way there and back
    assert down > 1.3 * up
    assert float(s.sigma_zz[80]) < float(s.sigma_xx[80])  # passive: now the side is stronger


def test_friction_while_pressing_leaves_the_sample_loose():
    dense, loose = (Biaxial(friction=Friction(2e4, 0.5), pressing_friction=mu, strain=0.03, **LIGHT).run() for mu in (None, 0.5))
    assert float(loose.series.area_fraction[0]) < float(dense.series.area_fraction[0]) - 0.015
    assert float(loose.series.coordination_number[0]) < float(dense.series.coordination_number[0]) - 0.3  # 3 hold a grain, not 4
    assert float(loose.series.eps_V.max()) > 1.2 * float(dense.series.eps_V.max())  # and it is pressed together more


def test_drag_while_loading_presses_on_the_top():
    """A grain at z moves with rate z, so drag alone adds N drag rate/2; what holds the sides back adds to that."""
    scene = Biaxial(strain=0.04, **LIGHT)
    free, held = scene.run().series, Biaxial(**{**scene.model_dump(), "drag": 0.02}).run().series
    middle = slice(15, 26)
    rate = np.gradient(free.eps_zz.values, free.time.values)[middle].mean()
    alone = 0.5 * scene.n * 0.02 * rate  # N/m, of 160
    assert alone < float((held.sigma_zz - free.sigma_zz)[middle].mean()) < 4 * alone


def test_strain_measures_are_half_half(biaxial):
    s = biaxial.series
    np.testing.assert_allclose(s.eps_V + s.eps_D, s.eps_zz, atol=1e-15)
    np.testing.assert_allclose(s.eps_V - s.eps_D, s.eps_xx, atol=1e-15)


def test_same_seed_same_bits(biaxial):
    again = biaxial.scene.run()
    for name in biaxial.series.data_vars:
        np.testing.assert_array_equal(again.series[name], biaxial.series[name])
    np.testing.assert_array_equal(again.snapshots["end"].force, biaxial.snapshots["end"].force)


def test_series_repeats_the_averages_of_its_snapshots(biaxial, shear):
    """The last row, and the row of the peak, are the averages of the snapshots that are kept; without friction 3 contacts hold a grain."""
    highest = int(np.argmax(biaxial.series.s_D.values))
    for name, k in (("start", 0), ("peak", highest), ("end", -1)):
        row, box = biaxial.series.isel(time=k), average(biaxial.snapshots[name].bearing(BEARING), least_contacts=2)
        fabric, stress = box.fabric.values, box.stress.values
        assert float(row.sigma_zz_grains) == stress[1, 1]
        assert float(row.sigma_xx_grains) == stress[0, 0]
        assert float(row.s_D) == float((row.sigma_zz - row.sigma_xx) / (row.sigma_zz + row.sigma_xx))
        assert float(row.fabric_deviator) == pytest.approx(0.5 * (fabric[1, 1] - fabric[0, 0]))
        assert float(row.anisotropy) == pytest.approx(4 * float(row.fabric_deviator) / float(row.fabric_trace))
        assert float(row.coordination_number) == float(box.coordination_number)
    row, box = shear.series.isel(time=-1), average(shear.snapshots["end"], least_contacts=2)
    stress = box.stress.values
    assert float(row.pressure) == pytest.approx(0.5 * (stress[0, 0] + stress[1, 1]))
    half = 0.5 * (stress[0, 1] + stress[1, 0])
    assert float(row.s_D) == pytest.approx(np.hypot(0.5 * (stress[0, 0] - stress[1, 1]), half) / float(row.pressure))
    assert float(row.stress_ratio) == pytest.approx(-half / float(row.pressure))
    assert float(row.anisotropy) == pytest.approx(float(box.anisotropy))
    assert float(row.coordination_number) == float(box.coordination_number)


def test_everything_is_labelled(biaxial, ring, shear):
    for dataset in (biaxial.series, ring.series, ring.profiles, shear.series):
        for name in dataset.data_vars:
            assert dataset[name].attrs["long_name"], name
            assert dataset[name].attrs["units"] == GLOSSARY[name.removesuffix("_error")].unit
        assert "compression positive" in dataset.attrs["conventions"]


def test_provenance_tells_scene_and_effects(biaxial):
    p = biaxial.provenance
    assert tomllib.loads(p["scene"])["friction"]["mu"] == 0.5
    assert "Friction" in p["active_effects"]
    assert p["absent_effects"] == "rolling, gravity, wall_friction, drag"
    assert p["late_builds"] == 0
    assert p["particle_steps_per_s"] > 1e5


def test_frictionless_scene_leaves_friction_out():
    run = Biaxial(n=60, contact=Linear(1e5, 0.1), strain=0.01, duration=0.005, samples=10).run()
    assert run.provenance["absent_effects"] == "friction, rolling, gravity, wall_friction, drag"
    np.testing.assert_array_equal(run.snapshots["end"].spin, 0.0)


def test_torque_is_the_same_on_every_circle(ring):
    """r^2 sigma_rphi is constant: nothing but the rings gives the sample a torque."""
    r, stress = ring.profiles.r.values, ring.profiles.stress.values
    torque = r**2 * 0.5 * (stress[0, 1] + stress[1, 0])
    assert np.std(torque) / np.mean(torque) < 0.12  # 250 grains over 8 d of travel: a tenth is the noise of so short a run
    late = ring.series.isel(time=slice(len(ring.series.time) // 5, None))
    inner = float(late.wall_shear_stress.mean()) * ring.scene.inner_radius**2
    outer = float((late.outer_shear_stress * late.outer_radius**2).mean())
    assert np.mean(torque) == pytest.approx(inner, rel=0.05)
    assert outer == pytest.approx(inner, rel=0.05)


def test_ring_shears_next_to_its_inner_wall(ring):
    v = ring.profiles.v_phi.values / ring.scene.wall_speed
    assert 0.3 < v[0] < 1.0
    assert v[-1] < 0.05
    assert np.all(np.diff(v) < 0.02)
    assert float(ring.profiles.area_fraction[0]) < float(ring.profiles.area_fraction[3])  # dilated at the inner ring
    assert float(ring.series.outer_pressure.mean()) == pytest.approx(1.0, rel=0.02)
    assert ring.profiles.attrs["blocks"] == 8
    assert float(ring.profiles.v_phi_error[0]) > 0


def test_the_wall_of_the_ring_measures_its_contacts(ring):
    """Torque and pressure on the inner ring are the moments and radial forces of the contacts on its discs, about the axis."""
    snapshot, scene, row = ring.snapshots["end"], ring.scene, ring.series.isel(time=-1)
    inner = np.flatnonzero(snapshot.fixed & (np.hypot(*snapshot.position.T) < scene.inner_radius))
    on_ring = np.isin(snapshot.pairs[:, 1], inner)
    force, point = -snapshot.force[on_ring], snapshot.point[on_ring]
    torque = np.sum(point[:, 0] * force[:, 1] - point[:, 1] * force[:, 0])
    length = 2 * np.pi * scene.inner_radius
    # the forces of the series are those of the half step, with other dashpots: measured 1e-4
    assert float(row.wall_shear_stress) == pytest.approx(-torque / (scene.inner_radius * length), rel=2e-3)
    pressing = 0.0
    for (i, j), force in zip(snapshot.pairs, snapshot.force, strict=True):  # every contact across the circle over the tops of the discs
        start, end = snapshot.position[i], snapshot.position[j]
        if j < 0 or (np.hypot(*start) < scene.inner_radius) == (np.hypot(*end) < scene.inner_radius):
            continue
        share = brentq(lambda t, a, b: np.hypot(*(a + t * (b - a))) - scene.inner_radius, 0, 1, args=(start, end))
        outwards = (start + share * (end - start)) / scene.inner_radius
        pressing += abs(force @ outwards)
    assert float(row.wall_pressure) == pytest.approx(pressing / length, rel=2e-3)
    np.testing.assert_allclose(ring.profiles.depth, (ring.profiles.r - scene.inner_radius) / scene.mean_diameter)


def test_homogeneous_shear_is_steady_under_its_pressure(shear):
    steady = shear.scene.steady(shear.series)
    assert float(steady.sigma_yy.mean()) == pytest.approx(1.0, rel=0.03)
    assert 0.2 < float(steady.stress_ratio.mean()) < 0.45
    assert float(steady.inertial_number.mean()) == pytest.approx(0.05, rel=0.08)  # ten seeds: 0.0505 to 0.0529
    state = steady_state(shear)
    assert 0 < float(state.stress_ratio_error) < 0.05
    assert shear.series.strain[-1] == pytest.approx(3.0, rel=1e-3)


@pytest.mark.hard_case("S5")
@pytest.mark.parametrize(
    ("scene", "words"),
    [
        (Biaxial(duration=1e300), "Biaxial: duration = 1e+300 s makes "),
        (CohesiveGas(duration=1e15), "CohesiveGas: duration = 1e+15 s makes "),
        (Tablet(duration=1e300), "Tablet: duration = 1e+300 s makes "),
        (Stiffness(inertial_number=1e-30), "Stiffness: inertial_number = 1e-30 makes "),
    ],
)
def test_what_takes_for_ever_is_refused(scene, words, answer):
    """Before the first step; numbers of steps beyond 2^63 would wrap around."""
    with pytest.raises(InputError, match=f"^{re.escape(words)}.* time steps of .* s; at most 1e\\+14 are taken$") as caught:
        estimate(scene)
    answer.refused(caught)


@pytest.mark.parametrize("kind", [Biaxial, Tablet, Stiffness])
def test_any_ratio_of_sizes_can_be_prepared(kind):
    """The lightest of the grains weighs a two-thousandth of the mean; the damping is made for the mean, and the step for the contacts."""
    scene = kind(n=60, size_ratio=20.0, contact_steps=5.0)
    sim = scene.stages()[0].begin(None)
    assert sim.dt <= longest_step(sim.effects["normal"], None, sim.effects["drag"], sim.grains.mass)


def test_the_time_step_counts_the_drag_of_loading():
    """It is not changed when loading begins, where no step is refused."""
    mass = np.array([1e-6, 1e-5])
    assert Biaxial(drag=0.02).step(mass) == Biaxial().step(mass)
    assert Biaxial(drag=100.0).step(mass) <= 0.5 * 1e-6 / 100.0


@pytest.mark.hard_case("D22", of="ring_shear")
def test_absurd_runs_are_warned_of(answer):
    soft = Biaxial(n=40, pressure=3e3, contact=Linear(1e5, 0.1), strain=0.01, duration=0.005, samples=10).run()
    assert "of the mean radius: too soft for this load" in str(soft.status)
    fast = RingShear(n=150, inner_radius=3.0, wall_speed=2.0, travel=6.0, discard=2.0, block=2.0, seed=1).run()
    assert "far from quasi-static" in str(fast.status)
    answer.named(fast.status)
    one = RingShear(n=150, inner_radius=3.0, travel=4.0, discard=2.0, block=2.0).run()
    assert "one block only: no error bars" in str(one.status)
    assert np.isnan(one.profiles.v_phi_error).all()


def test_fast_shear_holds_its_pressure():
    run = SimpleShear(inertial_number=0.3, n=100, strain=4.0, discard=1.0, seed=2).run()
    # agitation adds 6 % to the contacts here; 100 grains over three strains fluctuate by two
    assert float(run.scene.steady(run.series).sigma_yy.mean()) == pytest.approx(1.0, abs=0.04)
    assert run.status.level == "ok"


def test_shear_at_constant_volume():
    """The area fraction is the one asked for, all along; so is the rate; the stress is an outcome that nobody warns of."""
    run = SimpleShear(rate=0.1, area_fraction=0.8, n=60, strain=2.0, discard=0.5, seed=3).run()
    np.testing.assert_allclose(run.series.area_fraction, 0.8, rtol=1e-9)  # thousands of steps of the compressed height
    np.testing.assert_allclose(run.series.strain, 0.1 * run.series.time, rtol=1e-12)
    width, height = np.diag(run.snapshots["end"].cell)
    assert width == pytest.approx(height, rel=1e-9)
    state = steady_state(run)
    # pressed at I = 0.05 the grains flow at 0.80 with mu = 0.335; 60 grains over two strains: three seeds gave 0.040 to 0.049
    assert float(state.inertial_number) == pytest.approx(0.05, rel=0.3)
    assert float(state.stress_ratio) == pytest.approx(0.335, abs=0.03)
    mass = np.pi / 6 * np.mean((2 * run.snapshots["end"].radius) ** 3)
    assert float(state.inertial_number) == pytest.approx(0.1 * np.sqrt(mass / float(state.pressure)), rel=1e-9)
    relative = float(state.inertial_number_error / state.inertial_number), float(state.pressure_error / state.pressure)
    assert relative[0] == pytest.approx(0.5 * relative[1])
    assert "vertical" not in str(run.status)


@pytest.mark.parametrize(("area_fraction", "inertial_number"), [(0.45, 0.01), (0.8, 1e-3), (0.9, 1e-4)])
def test_any_volume_is_brought_to_rest(area_fraction, inertial_number):
    """Loose grains too, whose few contacts would take for ever: dashpots alone left the first two in motion after 200 looks."""
    session = Session(SimpleShear(n=60, area_fraction=area_fraction, inertial_number=inertial_number))

    class AtRestError(Exception):
        pass

    def leave():
        if session.stage_name == "shear":
            raise AtRestError

    with pytest.raises(AtRestError):
        session.go(leave)
    scene, simulation = session.scene, session.simulation
    assert not scene.calm(simulation)
    # the centre of mass rests better than the grains: there is nothing that drifts
    drift = np.average(simulation.velocity, axis=0, weights=simulation.grains.mass)
    assert np.hypot(*drift) < scene.shear_rate(simulation.grains.radius) * scene.mean_diameter
    assert scene.sheared(simulation).effects["drag"] is None


def test_the_ring_begins_before_its_first_step(ring):
    """The first snapshot is of the prepared sample, the first row of the first sample of travel."""
    assert ring.snapshots["start"].time == 0.0
    assert float(ring.series.time[0]) == pytest.approx(float(ring.series.time[1]) / 2)
    discarded, samples, _ = ring.scene.counts()
    assert len(ring.series.time) == samples
    assert ring.profiles.attrs["snapshots"] == samples - discarded


def test_the_rate_of_shear_is_said_once():
    assert SimpleShear().inertial_number == 0.01
    assert SimpleShear(rate=0.2).inertial_number is None
    for scene in (SimpleShear(), SimpleShear(rate=0.2, area_fraction=0.8)):  # as the provenance of a run tells it
        assert SimpleShear(**json.loads(scene.model_dump_json())) == scene


def test_blocks_hold_ratios_of_means():
    """Two samples a block with pressures 1 and 3: stress ratios count as shear stresses do, angles are those of the mean tensors."""
    columns = {
        "pressure": [1.0, 3.0], "stress_ratio": [0.1, 0.5], "s_D": [0.2, 0.6], "sigma_xx": [1.0, 3.0], "sigma_yy": [1.0, 3.0],
        "sigma_xy": [-0.1, -1.5], "fabric_xx": [2.0, 2.2], "fabric_yy": [1.6, 1.8], "fabric_xy": [-0.3, -0.1],
    }  # fmt: skip
    series = xr.Dataset({name: ("time", values * 2) for name, values in columns.items()})
    blocks = blocks_of(series.assign(strain=("time", [0.0, 0.1, 0.2, 0.3])))
    np.testing.assert_allclose(blocks.stress_ratio, [0.4, 0.4])
    np.testing.assert_allclose(blocks.s_D, [0.5, 0.5])
    np.testing.assert_allclose(blocks.pressure, [2.0, 2.0])
    np.testing.assert_allclose(np.degrees(blocks.stress_angle), -45.0)
    np.testing.assert_allclose(np.degrees(blocks.rate_to_stress_angle), 0.0, atol=1e-12)  # the flow presses along -45 degrees
    np.testing.assert_allclose(np.degrees(blocks.fabric_angle), -22.5)  # of (0.4, -0.4)
    np.testing.assert_allclose(np.degrees(blocks.rate_to_fabric_angle), 22.5)


def test_progress_is_reported():
    seen = []
    SimpleShear(inertial_number=0.1, n=60, strain=0.6, discard=0.1, samples_per_strain=50).run(progress=seen.append)
    assert seen[-1] == 1.0
    assert all(b >= a for a, b in pairwise(seen))


def test_no_state_passes_the_gate_but_equilibrium():
    """A gate opens only if kinetic energy, stress and the contacts themselves are as wanted; else the stage is refused by name."""
    force = np.array([[3.0, 4.0]])  # f^2/(2 k) = 2.5 J

    def is_over(kinetic, error, force=force, done=3):
        grains = SimpleNamespace(snapshot=lambda: SimpleNamespace(force=force), kinetic_energy=lambda rotation: kinetic)
        stage = Stage("relax", 10 * np.arange(1, 4), gate=equilibrium(5.0, lambda simulation: error))
        return stage.is_over(grains, done)

    assert is_over(kinetic=2.4e-5, error=0.009)
    assert is_over(kinetic=2.4e-5, error=0.009, done=1)
    for kinetic, error, bad in ((2.6e-5, 0.0, force), (0.0, 0.011, force), (0.0, 0.0, np.zeros((0, 2)))):
        assert not is_over(kinetic, error, bad, done=2)
        with pytest.raises(RunFailed, match="stage relax: no equilibrium after 30 steps: E_kin/E_pot = "):
            is_over(kinetic, error, bad)


def test_a_stage_without_a_gate_ends_with_its_marks():
    stage = Stage("load", np.array([0, 5, 12]))
    assert [stage.is_over(None, done) for done in (1, 2, 3)] == [False, False, True]
    assert stage.steps == 12
    assert Stage("relax", 10 * np.arange(1, 201), gate=None, expected=60).steps == 600


def grown_late(late, overlap=0.0):
    """What a judge asks of a simulation: lists built late, and overlaps of grains of radius 1."""
    snapshot = SimpleNamespace(overlap=np.full(3, overlap), radius=np.ones(4))
    return SimpleNamespace(counters={"late_builds": late}, snapshot=lambda: snapshot)


@pytest.mark.hard_case("D22", of="biaxial")
def test_biaxial_warnings(answer):
    def judge(side, scene=Biaxial(strain=0.1, duration=1.0), **simulation):  # noqa: B008
        return str(scene.judge(xr.Dataset({"sigma_xx": ("time", [side] * 3)}), None, grown_late(**{"late": 0, **simulation})))

    assert judge(101.9) == "ok"
    assert judge(97.0) == "warned: the side wall holds its pressure only to 3.0% (median)"
    fast = Biaxial(strain=0.1, duration=0.01, size_ratio=1.0, density=3e6 / np.pi)  # grains of 4 g: 2 * 0.1 pi/2/0.01 * sqrt(0.004/100)
    assert judge(100.0, fast) == "warned: inertial number up to 0.2: not quasi-static"
    answer.named(judge(100.0, fast))
    assert judge(100.0, late=2) == "warned: 2 neighbour lists were built late"
    assert judge(100.0, overlap=0.04) == "ok"
    assert judge(100.0, overlap=0.06) == "warned: the mean overlap is 6.0% of the mean radius: too soft for this load"


def test_ring_shear_warnings():
    scene = RingShear()
    discarded, _, a_block = scene.counts()

    def judge(v_phi, late=0, inertial=0.01, pressure=1.0, outer=15.0):
        count = len(v_phi)
        dense = np.random.default_rng(1).normal(0.8, 0.01, (count, 2))
        values = {"v_phi": np.outer(v_phi, [1.0, 1.0]), "inertial_number": np.full((count, 2), inertial)}
        values |= {"area_fraction": dense, "stress_ratio": dense}
        blocks = xr.Dataset({name: (("block", "r"), one) for name, one in values.items()})
        rows = discarded + count * a_block
        series = {"outer_pressure": pressure, "wall_pressure": 1.0, "wall_shear_stress": 0.3}
        series = {name: ("time", np.full(rows, value)) for name, value in series.items()}
        series["outer_radius"] = ("time", np.append(np.zeros(discarded), np.repeat(outer * np.ones(count), a_block)))
        return str(scene.judge(xr.Dataset(series, {"time": np.arange(float(rows))}), blocks, grown_late(late)))

    assert judge([1.0, 1.1, 1.0, 1.1, 1.0, 1.1]) == "ok"
    assert judge([1.0, 1.1, 1.0, 1.1]) == "warned: only 4 blocks: the error bars are rough"
    drifting = judge([1.0, 1.1, 1.2, 1.7, 1.8, 1.9])
    assert drifting == "warned: not steady: the velocity in the second ring drifts by 8.6 standard errors"
    breathing = judge([1.0, 1.1, 1.0, 1.1, 1.0, 1.1], outer=np.array([15.0, 15.1, 15.0, 15.5, 15.6, 15.5]))
    assert breathing == "warned: not steady: the outer radius drifts by 10.6 standard errors"
    assert judge([1.0] * 6, late=3) == "warned: 3 neighbour lists were built late"
    assert judge([1.0] * 6, inertial=0.3) == "warned: inertial number up to 0.3: far from quasi-static"
    assert judge([1.0] * 6, pressure=1.1) == "warned: the mean outer pressure is 1.10 times the one asked for"
    assert judge([1.0]) == "warned: one block only: no error bars"


def test_simple_shear_starts_in_flow_and_warns(monkeypatch):
    """The sheared stage begins with the linear velocity profile; drift and late lists reach the status."""
    begun, next_stage, counters = [], Simulation.next_stage, Simulation.counters.fget

    def spy(self, **changes):
        begun.append((changes["velocity"] - self.velocity, self.position))
        return next_stage(self, **changes)

    monkeypatch.setattr(Simulation, "next_stage", spy)
    monkeypatch.setattr(Simulation, "counters", property(lambda self: {**counters(self), "late_builds": 2}))
    monkeypatch.setattr(simple_shear, "drift", lambda values: 5.0)
    scene = SimpleShear(inertial_number=0.1, n=60, strain=0.6, discard=0.1)
    run = scene.run()
    (velocity, position), rate = begun[0], float(run.series.strain[-1] / run.series.time[-1])
    np.testing.assert_allclose(velocity, np.outer(position[:, 1], [rate, 0.0]), atol=1e-12)
    assert re.match(r"the mean vertical stress is 1\.[12]", run.status.reasons[0])  # 60 grains over half a strain: not yet settled
    assert run.status.reasons[1:] == ("not steady: the stress ratio drifts by 5.0 standard errors", "2 neighbour lists were built late")


def test_a_saved_run_holds_all_of_it(ring, tmp_path):
    """Every group comes back, with status and provenance at the root."""
    replace(ring, status=Status().warn("for a reason")).save(tmp_path / "ring.h5")
    tree = open_results(tmp_path / "ring.h5")
    assert tree.attrs["status"] == "warned: for a reason"
    assert tree.attrs["late_builds"] == 0
    assert float(tree["snapshots/end"].attrs["time"]) == ring.snapshots["end"].time > 0
    np.testing.assert_array_equal(tree["snapshots/end"]["fixed"], ring.snapshots["end"].fixed)
    for name in ("series", "profiles", "blocks"):
        xr.testing.assert_equal(tree[name].to_dataset(), getattr(ring, name))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Biaxial(pressure=-1.0), "Biaxial: pressure = -1 must be above 0 N/m"),
        (lambda: Biaxial(overconsolidation=100.0), "overconsolidation = 100 must be above the pressure, 100 N/m, or left out"),
        (lambda: Biaxial(pressing_friction=0.3), "pressing_friction = 0.3 needs the table friction, whose stiffness it takes"),
        (lambda: Biaxial(half_periods=5000), "Biaxial: samples = 400 and half_periods = 5000 make 2e\\+06 rows of the series"),
        (lambda: Biaxial(presure=1.0), "Biaxial: unknown key 'presure', did you mean 'pressure'\\? biaxial has pressure, contact"),
        (lambda: Biaxial(n=3), "Biaxial: n = 3 must be at least 20"),
        (lambda: RingShear(wall_speed="fast"), "RingShear: wall_speed = 'fast' is not a number"),
        (lambda: SimpleShear(inertial_number=float("nan")), "SimpleShear: inertial_number = nan must be a finite number"),
        (lambda: RingShear(travel=35.0), "travel = 35 must be at least discard \\+ block = 20 \\+ 20, or there is nothing to average"),
        (lambda: RingShear(n=60), "RingShear: the grains fill a gap of 1.1 mean diameters; 4.5 are needed"),
        (lambda: RingShear(inner_radius=0.8), "inner_radius = 0.8 m must be at least two mean diameters"),
        (lambda: RingShear(block=0.02), "block = 0.02 holds no sample"),
        (
            lambda: RingShear(travel=2.5, discard=1.9, block=0.6, samples_per_diameter=1),
            "travel = 2.5 less discard = 1.9 leaves 0 samples, fewer than the 1 of a block",
        ),
        (
            lambda: RingShear(travel=1e9),
            r"RingShear: travel = 1e\+09 and samples_per_diameter = 10 make 1e\+10 rows of the series; at most",
        ),
        (lambda: SimpleShear(strain=1e9), r"SimpleShear: strain = 1e\+09 and samples_per_strain = 50 make 5e\+10 rows of the series"),
        (lambda: SimpleShear(inertial_number=0.1, rate=0.2), "inertial_number = 0.1 and rate = 0.2 1/s: give one of them"),
        (lambda: SimpleShear(area_fraction=0.3), "SimpleShear: area_fraction = 0.3 must be above 0.4"),
        (lambda: SimpleShear(rate=0.0), "SimpleShear: rate = 0 must be above 0 1/s"),
        (lambda: SimpleShear(strain=1.0), "strain = 1 must be at least discard \\+ 0.5 = 2"),
        (lambda: Biaxial(n=True), "Biaxial: n = True is not a number"),
        (lambda: Biaxial(n=20.5), "Biaxial: n = 20.5 is not a whole number"),
        (lambda: Biaxial(seed=None), "Biaxial: seed = None is not a number"),
        (lambda: Biaxial(seed=10**400), "Biaxial: seed is too large a number"),
        (lambda: Biaxial(contact=3.0), "Biaxial: contact = 3.0 must be Linear or Luding"),
        (lambda: Biaxial(friction="none"), "Biaxial: friction = 'none' must be Friction or None"),
        (lambda: Biaxial(contact={"k1": -1.0, "k2": 2.0}), r"Biaxial: \[contact\] k1 = -1 must be above 0 N/m"),
        (lambda: Biaxial(contact={"law": "luding", "k1": 1.0}), r"Biaxial: \[contact\] k2 is missing; luding has k1, k2, kc"),
        (lambda: Biaxial(contact=Luding(True, 1.0)), "Luding: k1 = True is not a number"),
        (lambda: Biaxial(contact=Luding(2.0, 1.0)), "Luding: k2 = 1 must be at least 2"),
    ],
)
def test_bad_scenes_get_one_line(make, message):
    with pytest.raises(InputError, match=message) as caught:
        make()
    assert "\n" not in str(caught.value)
