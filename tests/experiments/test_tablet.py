"""Tablets: a chain as strong as its weakest contact, no strength without adhesion, and the stages as on the slide."""

import numpy as np
import pytest

from anisogran import InputError, Luding, Tablet, average, contact_path, fit
from anisogran.dem import Box, Friction, Grains, Open, Pressure, Simulation, longest_step
from anisogran.experiments.preparation import sphere_mass
from anisogran.experiments.tablet_tests import WIDE, platen_row, torn
from anisogran.runs.session import Session

STICKY = Luding(5e4, 1e5, 1e5, 0.1)
SMALL = {"n": 60, "pressure": 10.0, "duration": 0.03, "samples": 150, "seed": 2}


@pytest.fixture(scope="module")
def pressed():
    return Tablet(test="compression", **SMALL).run()


@pytest.fixture(scope="module")
def pulled():
    return Tablet(test="tension", strain=0.01, **SMALL).run()


def strength(run):
    """In N/m, positive in both tests."""
    sense = np.sign(run.series.eps_zz.values[-1])
    return fit.peak(sense * run.series.eps_zz.values, sense * run.series.sigma_zz.values, width=5e-4).value


@pytest.mark.parametrize("kc", [2.5e4, 1e5, 4e5])
def test_a_chain_is_as_strong_as_its_weakest_contact(kc):
    """Discs in a column are pressed, freed and torn: the platens feel f_min of the contact law, for the least remembered overlap."""
    scene, count = Tablet(test="tension", strain=1e-3, duration=0.02), 8
    position = np.stack([np.full(count, 5e-3), 1e-3 + 1.999e-3 * np.arange(count)], axis=1)
    law = Luding(5e4, 1e5, kc, 0.1)
    press = Box(1e-2, 2e-3 * count - 1e-5, top=Pressure(20.0, 1e-4, 5.0))
    sim = Simulation(Grains(position, 1e-3), law, boundary=press, drag=0.02)
    sim.run(20_000)
    sim = sim.next_stage(boundary=Box(1e-2, float(sim.walls.position[3]), top=Pressure(0.2, 1e-4, 5.0)))
    sim.run(20_000)
    free = sim.next_stage(boundary=Open())
    free.run(20_000)
    assert free.kinetic_energy() < 1e-14
    assert len(free.snapshot().pairs) == count - 1
    remembered = free._state.memory.largest[: count - 1]
    assert remembered.min() == pytest.approx(20.0 * 1e-2 / 5e4, rel=0.2)  # p times width over k1
    expected = contact_path(law, [remembered[1:-1].min()]).f_min  # the outermost contacts are of glued grains
    test = torn(scene, free)
    assert test.grains.driven == 4
    force = []
    for _ in range(1000):
        test.run(int(0.02 / test.dt / 1000))
        force.append(platen_row(scene, test, test.snapshot())["sigma_zz"] * test.boundary.width / WIDE)
    # three contacts at 1e-3 of strain in 20 ms: the dashpots take 1e-4 of f_min, the waves more
    assert min(force) == pytest.approx(expected, rel=0.01)
    assert abs(force[-1]) < 1e-3 * abs(expected)  # broken


def test_stages_as_on_the_slide():
    """Pressed low without adhesion; high with it; low again; free; and only then friction, and no damping."""
    session, seen = Session(Tablet(test="tension", **SMALL)), {}

    def listen():
        if session.begun is not None:
            effects = session.simulation.effects
            seen[session.stage_name] = effects["normal"].kc, effects["friction"] is not None, effects["drag"] is not None
        elif session.stage_name == "free":  # the release is over
            _, right, _, top = session.simulation.walls.position
            stress = session.simulation.walls.force[[1, 3]] / (top, right)
            np.testing.assert_allclose(stress, 10.0, rtol=0.01)
        elif session.stage_name == "release":
            _, right, _, top = session.simulation.walls.position
            np.testing.assert_allclose(session.simulation.walls.force[[1, 3]] / (top, right), 100.0, rtol=0.01)

    session.go(listen)
    damped = (0.0, False, True), (1e5, False, True)
    assert seen == {
        "press": damped[0], "relax": damped[0], "compact": damped[1], "release": damped[1], "free": damped[1], "test": (1e5, True, False),
    }  # fmt: skip


def test_a_free_tablet_bears_nothing(pressed):
    """Its contacts balance by themselves: no stress, and all but its rattlers hang together."""
    start = pressed.snapshots["start"]
    assert abs(average(start, fields="stress").stress.values).max() < 1e-2
    assert float(pressed.series.largest_fragment[0]) > 0.9
    assert float(pressed.series.eps_zz[0]) == 0.0


def test_the_platens_and_the_grains_measure_the_same_stress(pressed):
    """Force times height is the sum over the contacts of force times branch."""
    for name, snapshot in pressed.snapshots.items():
        row = pressed.series.sel(time=snapshot.time)
        grains = float(average(snapshot, fields="stress_static").stress_static[1, 1]) * WIDE  # the box is wider than the tablet
        assert grains == pytest.approx(float(row.sigma_zz), rel=0.02, abs=2.0), name  # N/m: inertia, where pieces slip


def pressed_width(run):
    """Of the box of the test, in m."""
    start = run.snapshots["start"]
    return WIDE * float(np.ptp(np.concatenate([start.position[:, 0] + start.radius, start.position[:, 0] - start.radius])))


def test_a_tablet_resists_both_ways(pressed, pulled):
    """It bears more when it is crushed than when it is torn, and less after its peak; stress and strain have the sign of the test."""
    crushed, torn_ = strength(pressed), strength(pulled)
    assert 5.0 < torn_ < crushed < 300.0
    assert float(pressed.series.eps_zz[-1]) == pytest.approx(0.02, abs=1e-9)
    assert float(pulled.series.eps_zz[-1]) == pytest.approx(-0.01, abs=1e-9)
    assert float(pulled.series.sigma_zz.min()) < -torn_ < 0
    assert abs(float(pulled.series.sigma_zz[-1])) < 0.7 * torn_
    assert float(pressed.series.width[-1]) > 1.01 * float(pressed.series.width[0])
    assert set(pressed.snapshots) >= {"start", "peak", "end"}


def test_without_adhesion_nothing_is_torn(pulled):
    loose = Tablet(test="tension", strain=0.01, contact=Luding(5e4, 1e5, 0.0, 0.1), **SMALL).run()
    torn_ = strength(pulled)
    assert float(-loose.series.sigma_zz.min()) < 0.01 * torn_  # dashpots of grains that part
    assert int(loose.series.fragments[0]) > 30
    assert loose.status.level == "ok"


def test_a_floor_at_rest_breaks_nothing():
    """On the floor, without vibration, a tablet settles and stays one."""
    run = Tablet(test="vibration", amplitude=0.0, **SMALL).run()
    assert float(run.series.largest_fragment.min()) == float(run.series.largest_fragment[0]) > 0.9  # the rest is one that rattles
    assert int(run.series.fragments.max()) == int(run.series.fragments[0])
    np.testing.assert_array_equal(run.series.floor_height, 0.0)
    weight = 9.81 * run.snapshots["end"].mass.sum()
    assert float(run.series.sigma_zz[75:].mean()) * pressed_width(run) / WIDE == pytest.approx(weight, rel=0.2)  # it still rings


def test_a_shaken_floor_moves_as_told_and_breaks_a_weak_tablet():
    keys = SMALL | {"pressure": 2.0, "duration": 0.06}
    weak = Tablet(test="vibration", pressing_pressure=5.0, amplitude=1e-3, **keys).run()
    phase = 2 * np.pi * 50.0 * weak.series.time
    np.testing.assert_allclose(weak.series.floor_height, 1e-3 * (1 - np.cos(phase)), atol=1e-8)
    assert float(weak.series.largest_fragment[0]) > 0.9
    assert float(weak.series.largest_fragment.min()) < 0.6


def test_the_time_step_counts_the_friction_of_the_test():
    """It is the same in all stages, so the first must know of springs and dashpots that come with the last."""
    for friction in (Friction(2e4, 0.5), Friction(5e6, 0.5), Friction(2e4, 0.5, damping=10.0)):
        scene = Tablet(n=60, friction=friction)
        mass = sphere_mass(scene.box(scene.pressure).loose_box()[0], scene.density)
        assert scene.step() == pytest.approx(0.5 * longest_step(scene.contact, friction, None, mass), rel=1e-12)


def test_what_is_no_test_of_a_tablet_is_refused():
    with pytest.raises(InputError, match=r"^Tablet: pressing_pressure = 2 must be above the pressure, 2 N/m$"):
        Tablet(pressing_pressure=2.0)
    with pytest.raises(InputError, match=r"duration = 0\.1 s and frequency = 1e\+12 1/s make 6\.4e\+12 points of the path of the floor"):
        Tablet(test="vibration", frequency=1e12)
    assert Tablet(frequency=1e12).frequency == 1e12  # nothing vibrates
    assert Tablet(friction=None).friction is None
    assert Tablet().friction == Friction(2e4, 0.5)
    assert Tablet(test="vibration").nominal_inertial_number() == 0.0


@pytest.mark.hard_case("D22", of="tablet")
def test_a_test_that_is_too_fast_is_warned_of(answer):
    (warning,) = [told for told in Tablet(duration=1e-3, n=20, pressure=30.0, samples=10).run().status.reasons if "quasi-static" in told]
    answer.named(f"warned: {warning}")
