"""The time loop: reproducible, restartable, honest about effects, and loud when something goes wrong."""

import os
import re
import subprocess
import sys

import numba
import numpy as np
import pytest
from crowds import EVERY_LAW, FRICTION, LAW, crowd, state

from anisogran.compiled import OPTIONS
from anisogran.dem import Box, Cosine, Friction, Grains, Linear, Periodic, Pressure, Ring, Simulation
from anisogran.dem.pairs import pair_forces, scratch
from anisogran.outcome import InputError, RunFailed

BOUNDARIES = {
    "box": lambda side: Box(side, side, right=Pressure(50.0, 1e-4, 0.5), top=Cosine(side, 0.8 * side, 0.02)),
    "ring": lambda side: Ring(0.75 * side, rim=Pressure(20.0, 1e-4, 0.5), omega=3.0),
    "periodic": lambda side: Periodic(side, side, shear_rate=20.0, pressure=(None, 50.0), viscosity=20.0),
}


@pytest.mark.parametrize("name", BOUNDARIES)
def test_a_split_run_is_the_straight_run(name, rng):
    """Bit for bit, whatever the pieces; the list is rebuilt many times in between."""
    grains, side = crowd(rng, origin=0.5 if name == "ring" else 0.0)
    runs = []
    for pieces in ([3000], [1, 1336, 7, 10, 646, 1000]):
        sim = Simulation(
            grains, LAW, friction=FRICTION, boundary=BOUNDARIES[name](side), wall_friction=FRICTION if name == "ring" else None
        )
        for steps in pieces:
            sim.run(steps)
        runs.append(sim)
    assert runs[0].counters["builds"] > 5
    assert runs[0].counters == runs[1].counters
    np.testing.assert_array_equal(state(runs[0]), state(runs[1]))


@pytest.mark.hard_case("F7")
def test_output_changes_nothing(rng):
    grains, side = crowd(rng)
    quiet, watched = (Simulation(grains, LAW, friction=FRICTION, boundary=Box(side, side)) for _ in range(2))
    quiet.run(2000)
    for _ in range(200):
        watched.run(10)
        watched.snapshot()
    np.testing.assert_array_equal(state(quiet), state(watched))


def test_an_absent_effect_is_an_effect_of_no_strength(rng):
    """No friction equals mu = 0 bit for bit, and carries the given spin along; without it no memory is held."""
    grains, side = crowd(rng)
    without = Simulation(grains, Linear(1e5, 0.1), boundary=Box(side, side))
    with_zero = Simulation(grains, Linear(1e5, 0.1), friction=Friction(2e4, 0.0), boundary=Box(side, side))
    for sim in (without, with_zero):
        sim.run(2000)
    np.testing.assert_array_equal(without.position, with_zero.position)
    np.testing.assert_array_equal(without.spin, grains.spin)
    assert without._state.memory.spring is None
    assert without._state.memory.largest is None
    assert with_zero.active_effects()[1] == ["rolling", "gravity", "wall_friction", "drag"]


def test_kinetic_energy_is_that_of_the_free_grains():
    """m v^2/2 and I w^2/2 with I = 0.4 m a^2; what is driven holds no energy, and is marked as wall in the snapshot."""
    grains = Grains(
        [[0.0, 0.0], [3.0, 0.0], [6.0, 0.0]], [0.5, 1.0, 0.5], mass=[2.0, 3.0, 5.0], velocity=[[1.0, 2.0], [0, 1.0], [7.0, 7.0]],
        spin=[4.0, -1.0, 9.0], driven=1,
    )  # fmt: skip
    sim = Simulation(grains, Linear(1e4), friction=Friction(1e4, 0.5))
    assert sim.kinetic_energy() == pytest.approx(0.5 * (2 * 5 + 3 * 1 + 0.4 * (2 * 0.25 * 16 + 3 * 1 * 1)))
    assert sim.snapshot().fixed.tolist() == [False, False, True]


def test_the_coordination_number_counts_the_contacts_of_free_grains():
    """A row of three on a wall: 2 contacts each for the two free ones, the driven one at the end is not counted."""
    grains = Grains([[0.49, 1.0], [1.48, 1.0], [2.47, 1.0]], np.full(3, 0.5), driven=1)
    sim = Simulation(grains, Linear(1e3), boundary=Box(4.0, 4.0))
    assert sim.coordination_number() == 2.0
    assert Simulation(Grains([[0.0, 0.0]], [1.0]), Linear(1e3)).coordination_number() == 0.0


def test_mass_is_that_of_a_sphere():
    assert Grains([[0.0, 0.0]], [2.0], density=3.0).mass[0] == pytest.approx(32 * np.pi)


def test_momentum_is_conserved_in_the_periodic_cell(rng):
    grains, side = crowd(rng)
    sim = Simulation(grains, LAW, friction=FRICTION, boundary=Periodic(side, side))
    before = grains.mass @ grains.velocity
    sim.run(3000)
    scale = np.abs(grains.mass[:, None] * grains.velocity).sum()
    np.testing.assert_allclose(grains.mass @ sim.velocity, before, atol=1e-12 * scale)


@pytest.mark.hard_case("D21")
def test_sheared_image_is_the_same_contact(answer):
    """Two grains that touch across the moving border feel what two grains in the middle of the cell feel."""
    force = []
    for y in (5.0, 0.0):
        state = Periodic(10.0, 10.0, shear_rate=0.1)
        position = np.array([[5.0, y + 0.46], [5.0, (y - 0.46) % 10.0]])
        velocity = np.stack([0.1 * (position[:, 1]), np.zeros(2)], axis=1)
        sim = Simulation(
            Grains(position, [0.5, 0.5], mass=[1.0, 1.0], velocity=velocity), Linear(1e3, 5.0), friction=Friction(1e3, 0.5), boundary=state
        )
        sim.run(1)
        force.append(sim.net_force[0])
    np.testing.assert_allclose(force[0], force[1], atol=1e-9)
    answer.computed(np.abs(force[0] - force[1]).max() / np.abs(force[1]).max(), "force across a sheared border")


@pytest.mark.hard_case("D15")
def test_pressed_wall_reaches_its_pressure(answer):
    """One grain between a fixed and a pressed wall: its overlap carries pressure times length."""
    grains = Grains([[0.5, 0.5]], [0.5], mass=[1.0])
    box = Box(1.0, 1.0, right=Pressure(10.0, mass=1.0, damping=80.0))
    sim = Simulation(grains, Linear(1e3, 20.0), boundary=box, drag=20.0)
    sim.run(6000)
    assert sim.walls.force[1] == pytest.approx(10.0, rel=1e-6)
    assert sim.walls.force[0] == pytest.approx(10.0, rel=1e-6)
    assert 1.0 - sim.walls.position[1] == pytest.approx(2 * 10.0 / 1e3, rel=1e-6)  # two contacts in series
    answer.computed(abs(float(sim.walls.force[1]) / 10.0 - 1.0), "pressure of a wall at rest")


def test_cosine_wall_follows_the_lecture():
    box = Box(2.0, 4.0, top=Cosine(4.0, 3.0, duration=1.0))
    sim = Simulation(Grains([[1.0, 0.5]], [0.4], mass=[1.0]), Linear(10.0), boundary=box, dt=1e-3)
    for steps, height, speed in ((500, 3.5, -0.5 * np.pi), (500, 3.0, 0.0), (300, 3.0, 0.0)):
        sim.run(steps)
        assert sim.walls.position[3] == pytest.approx(height, abs=1e-12)
        assert sim.walls.velocity[3] == pytest.approx(speed, abs=1e-12)


def test_driven_grains_ride_on_their_ring():
    angle = np.linspace(0, 2 * np.pi, 7)[:-1]
    ring = 3.0 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    outer = 2.0 * ring
    grains = Grains(np.concatenate([[[4.5, 0.0]], ring, outer]), np.full(13, 0.5), driven=12)
    rim = Pressure(1.0, mass=1e4, damping=1e4)
    sim = Simulation(grains, Linear(1e3), friction=Friction(1e3, 0.5), boundary=Ring(6.0, rim=rim, omega=0.5, inner=6), dt=1e-3)
    sim.run(1000)
    turned = 3.0 * np.stack([np.cos(angle + 0.5), np.sin(angle + 0.5)], axis=1)
    np.testing.assert_allclose(sim.position[1:7], turned, atol=1e-11)
    np.testing.assert_allclose(sim.velocity[1:7], 0.5 * np.stack([-turned[:, 1], turned[:, 0]], axis=1), atol=1e-11)
    np.testing.assert_array_equal(sim.spin[1:7], 0.5)
    radius = float(sim.walls.position[0])
    assert radius < 6.0  # nothing holds the outer ring, it closes
    np.testing.assert_allclose(sim.position[7:], outer * radius / 6.0, atol=1e-12)


@pytest.mark.hard_case("D14")
def test_a_blow_up_stops_and_names_the_grain(answer):
    grains = Grains([[0.0, 0.0], [0.95, 0.0]], [0.5, 0.5], mass=[1.0, 1.0], velocity=[[300.0, 0.0], [-300.0, 0.0]])
    sim = Simulation(grains, Linear(1e3))
    with pytest.raises(RunFailed, match=r"stopped at step \d+ .* at grain [01], .*moves more than half the smallest radius"):
        sim.run(1000)
    grains = Grains([[0.0, 0.0], [1.0, 0.0]], [0.5, 0.5], mass=[1.0, 1.0], velocity=[[10.0, 0.0], [-10.0, 0.0]])
    sim = Simulation(grains, Linear(1e2), skin=1.0)
    with pytest.raises(RunFailed, match="overlaps a neighbour by more than half a radius"):
        sim.run(1000)
    sim = Simulation(Grains([[0.0, 0.0]], [0.5], mass=[1.0], velocity=[[1e308, 0.0]]), Linear(1e3))
    with pytest.raises(RunFailed, match="not a finite number"):
        sim.run(1000)
    sim = Simulation(Grains([[0.5, 0.5]], [0.4], mass=[1.0], velocity=[[3.0, 0.0]]), Linear(1.0), boundary=Box(1.0, 1.0))
    with pytest.raises(RunFailed, match="lies beyond a wall") as caught:
        sim.run(1000)
    answer.named(caught)


def test_bad_input_is_refused_before_the_first_step():
    good = {"position": [[0.0, 0.0], [1.0, 0.0]], "radius": [0.5, 0.5]}
    for change, message in [
        ({"density": -2.0}, "density = -2 must be above 0 kg/m3"),
        ({"velocity": np.zeros((3, 2))}, r"velocity of shape \(3, 2\) does not fit \(2, 2\)"),
        ({"position": np.zeros((2, 3))}, r"must be \(N, 2\) with N > 0; three dimensions are not there yet"),
        ({"driven": 3}, "driven = 3 must be a whole number between 0"),
    ]:
        with pytest.raises(InputError, match=message):
            Grains(**{**good, **change})
    with pytest.raises(InputError, match=r"dt = 1 must be at most"):
        Simulation(Grains(**good), Linear(1e5), dt=1.0)
    pair = Grains(**good)
    for make, message in [
        (
            lambda: Simulation(Grains([[0.0, 0.0], [0.0, 0.0]], [0.5, 0.5]), Linear(1e5)),
            "grains 0 and 1 overlap by 200% of the smaller radius at the start",
        ),
        (lambda: Simulation(pair, Linear(1e5), boundary=Box(0.5, 1.0)), r"grain \d .* has its centre beyond a wall at the start"),
        (lambda: Simulation(pair, None), "normal = None must be a contact law"),
        (lambda: Simulation(pair, Linear), "must be a contact law .* with its parameters"),
        (lambda: Simulation(pair, Linear(1e5), friction=0.5), "friction = 0.5 must be a Friction record"),
        (lambda: Simulation(pair, Linear(1e5), boundary="periodic"), "boundary = 'periodic' must be one of Open, Box, Ring, Periodic"),
        (lambda: Simulation(pair, Linear(1e5), boundary=Ring(5.0, inner=1)), "inner = 1 driven grains, but only 0 are given"),
        (lambda: Simulation(pair, Linear(1e5), boundary=Periodic(2.0, 9.0)), "is too large for the periodic cell, .* at the start"),
        (lambda: Ring(5.0, inner=1.5), "inner = 1.5 must be a whole number"),
        (lambda: Grains(**good, driven=1.5), "driven = 1.5 must be a whole number"),
        (lambda: Simulation(pair, Linear(1e5)).run(0.5), "steps = 0.5 must be a whole number; dt is"),
        (lambda: Simulation(pair, Linear(1e5)).run(-5), "steps = -5 must be at least 0"),
    ]:
        with pytest.raises(InputError, match=message):
            make()


@pytest.mark.hard_case("D11")
def test_no_grain_at_all_is_refused(answer):
    with pytest.raises(InputError, match=r"must be \(N, 2\) with N > 0") as caught:
        Grains(np.zeros((0, 2)), [])
    answer.refused(caught)


@pytest.mark.hard_case("D7")
@pytest.mark.parametrize("key", ["radius", "mass"])
@pytest.mark.parametrize(
    ("value", "words"), [(0.0, "= 0 must be above 0"), (-1.0, "= -1 must be above 0"), (np.nan, "= nan is not finite")]
)
def test_the_first_bad_grain_is_named(key, value, words, answer):
    with pytest.raises(InputError, match=rf"{key}\[2\] {words}") as caught:
        Grains(**{"position": np.zeros((4, 2)), "radius": np.ones(4), key: [1.0, 1.0, value, value]})
    answer.refused(caught)


def test_radii_given_are_not_shared_with_the_run():
    radius = np.array([0.5, 0.5])
    grains = Grains([[0.0, 0.0], [1.0, 0.0]], radius)
    sim = Simulation(grains, Linear(1e5))
    radius[0] = grains.radius[1] = 9.0
    sim.run(50)
    np.testing.assert_array_equal(sim.net_force, 0.0)


@pytest.mark.parametrize("damping", [0.5, 0.99, 1.0, 3.0, 30.0, 300.0])
def test_no_damping_makes_energy(damping):
    """In units of the critical one: the default time step follows strong dashpots, normal and tangential ones and drag."""
    critical = 2 * np.sqrt(1e4 * 0.5)
    grains = Grains([[0.0, 0.0], [1.0, 0.0]], [0.5, 0.5], mass=[1.0, 1.0], velocity=[[0.5, 0.3], [-0.5, 0.0]])
    sim = Simulation(
        grains, Linear(1e4, damping * critical), friction=Friction(2e3, 0.5, damping=damping * critical), drag=damping * critical
    )
    energy = [sim.kinetic_energy()]
    for _ in range(40):
        sim.run(50)
        energy.append(sim.kinetic_energy())
    assert max(energy) <= energy[0] * (1 + 1e-12)
    assert energy[-1] < 0.5 * energy[0]


def test_pair_loop_is_vectorised():
    """The assembly of the pair loop holds a packed square root: without the no-alias promise the compiler would stay scalar."""
    if numba.config.DISABLE_JIT:
        pytest.skip("nothing is compiled with NUMBA_DISABLE_JIT")
    fresh = numba.njit(**OPTIONS)(pair_forces.py_func)  # code from the disk cache cannot be inspected
    out, memory = scratch(virial=False, whole=True), (np.zeros(8), np.zeros(8))
    for law in EVERY_LAW.values():
        largest = memory[0] if law.remembers else None
        fresh(out.pairs, np.ones(0), law.parameters(), None, None, largest, None, None, out, 0.0)
        fresh(out.pairs, np.ones(0), law.parameters(), FRICTION.parameters(), None, largest, memory[1], None, out, 0.0)
    assert len(fresh.signatures) == 2 * len(EVERY_LAW)
    for text in fresh.inspect_asm().values():
        assert "sqrtpd" in text or re.search(r"fsqrt\s+v\d+\.2d", text)  # x86, Arm


@pytest.mark.parametrize("switch", ["NUMBA_DISABLE_JIT", "NUMBA_BOUNDSCHECK"])
def test_kernels_are_plain_python_too(switch, tmp_path):
    """The same tiny run with the compiler off, or with bounds checked, gives the compiled result."""
    code = """
import numpy as np
from anisogran.dem import *
rng = np.random.default_rng(3)
p = 1.9e-3 * np.stack(np.meshgrid(np.arange(3), np.arange(3)), -1).reshape(-1, 2) + 1e-3
g = Grains(p, np.full(9, 1e-3), velocity=rng.normal(0, 0.05, (9, 2)))
box = Box(5.8e-3, 5.8e-3, right=Pressure(10.0, 1e-4, 1.0))
s = Simulation(g, Luding(5e4, 1e5, 2e4, 0.1), friction=Friction(2e4, 0.5), wall_friction=Friction(2e4, 0.5), boundary=box)
s.run(60)
t = Simulation(g, Linear(1e5, 0.1), boundary=Periodic(6e-3, 6e-3, shear_rate=5.0, pressure=(None, 10.0), viscosity=10.0))
t.run(60)
print(repr(np.concatenate([s.position, t.position, s.snapshot().force.sum(axis=0)[None]]).tolist()))
"""
    results = []
    for value in ("0", "1"):
        # code compiled with bounds checks must not stay in the cache
        environment = {**os.environ, switch: value} | ({"NUMBA_CACHE_DIR": str(tmp_path)} if value == "1" else {})
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment)
        assert done.returncode == 0, done.stderr[-2000:]
        results.append(np.array(eval(done.stdout, {"__builtins__": {}})))
    # fused multiply-add and vector order differ from plain Python in the last digits
    np.testing.assert_allclose(results[1], results[0], rtol=1e-9)
