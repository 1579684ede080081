"""The energy ledger: closed forms for two grains, and a book that balances to second order in the step, whatever moves the boundary."""

import math
import re
from dataclasses import replace

import numba
import numpy as np
import pytest
from crowds import EVERY_LAW, FRICTION, LAW, crowd, state

from anisogran.compiled import OPTIONS
from anisogran.dem import Box, Cosine, Friction, Grains, Linear, Open, Periodic, Pressure, Ring, Simulation, collision_time
from anisogran.dem.ledger import account_pairs
from anisogran.dem.pairs import scratch

RUBBING = Friction(2e4, 0.5, damping=0.05)
BOUNDARIES = {
    "open": lambda side: Open(),
    "box": lambda side: Box(side, side, right=Pressure(500.0, 1e-4, 0.5), top=Cosine(side, 0.8 * side, 0.002), sliding=(0, 0, 20, 0)),
    "ring": lambda side: Ring(0.72 * side, rim=Pressure(200.0, 1e-4, 0.5)),
    "sheared": lambda side: Periodic(side, side, shear_rate=200.0, pressure=(None, 50.0), viscosity=0.2),
    "stretched": lambda side: Periodic(side, side, stretch_rate=(-200.0, 200.0)),
}


def head_on(law, **effects):
    """A Simulation of two unit masses that have just met head-on, each with 1/8 J."""
    grains = Grains([[0.0, 0.0], [1.0, 0.0]], [0.5, 0.5], mass=[1.0, 1.0], velocity=[[0.5, 0.0], [-0.5, 0.0]])
    return Simulation(grains, law, ledger=True, **effects)


@pytest.mark.hard_case("D20")
@pytest.mark.parametrize(
    ("law", "loser"), [(Linear(1e4, 10.0), "dashpot"), (replace(LAW, damping=0.0), "plasticity")], ids=["Linear", "Luding"]
)
def test_what_an_impact_loses_is_named(law, loser, answer):
    """All that is missing afterwards has gone to the one thing that can take it; in the middle the springs hold the rest."""
    sim = head_on(law)
    sim.run(int(0.5 * collision_time(law, sim.grains.mass) / sim.dt))
    assert sim.energy()["elastic"] > 0.1  # nearly all of 0.25 J, less by what is already lost
    sim.run(400)
    energy = sim.energy()
    assert energy["elastic"] == 0.0
    assert energy["kinetic"] < 0.22
    lost = energy.pop("dissipated_" + loser)
    assert lost == pytest.approx(0.25 - energy.pop("kinetic"), rel=2e-3)  # first order: some 1e-3 at t_c/50
    answer.computed(abs(energy["imbalance"]) / 0.25, "balance of an impact at t_c/50")
    assert energy.pop("imbalance") == pytest.approx(0.0, abs=1e-3)
    assert list(energy.values()) == pytest.approx([0.0] * len(energy), abs=1e-15)  # rounding


def test_sliding_loses_to_friction_and_drag_to_drag():
    """A slow disc under its weight on a rough wall: mu m g times the way of the contact point; in free flight drag takes all."""
    mu, gravity, mass = 0.3, 10.0, 1.0
    wall = Friction(2e4, mu)
    grains = Grains([[5.0, 0.5 - mass * gravity / 1e4]], [0.5], mass=[mass], velocity=[[1.0, 0.0]])
    sim = Simulation(grains, Linear(1e4), gravity=(0.0, -gravity), boundary=Box(10.0, 5.0), wall_friction=wall, ledger=True)
    before = sim.energy()
    sim.run(int(0.05 / sim.dt))  # it would roll after v/(3.5 mu g) = 0.095 s
    energy = sim.energy()
    way = 0.05 - 0.5 * 3.5 * mu * gravity * 0.05**2  # sphere: the contact point slows down 3.5 times as fast as the centre
    assert energy["dissipated_friction"] == pytest.approx(mu * mass * gravity * way, rel=0.01)  # the spring has to be stretched first
    assert energy["potential"] == pytest.approx(before["potential"], rel=1e-3)
    assert abs(energy["imbalance"]) < 1e-4

    flying = Simulation(Grains([[0.0, 0.0]], [0.5], mass=[2.0], velocity=[[3.0, 4.0]]), Linear(1e4), drag=5.0, ledger=True)
    flying.run(1000)
    t = flying.time
    assert flying.energy()["dissipated_drag"] == pytest.approx(25.0 * (1 - math.exp(-2 * 5.0 / 2.0 * t)), rel=2e-3)  # first order


@pytest.mark.hard_case("D20", of="luding")
@pytest.mark.parametrize("name", BOUNDARIES)
def test_the_book_balances_to_second_order(name, rng, answer):
    """Kinetic + elastic + lost - work of the boundary stays what it was: to 1e-4 of the turnover, 1e-5 at a quarter of the step."""
    grains, side = crowd(rng, origin=0.5 if name == "ring" else 0.0)
    velocity = 10 * grains.velocity
    if name == "sheared":
        velocity[:, 0] += 200.0 * grains.position[:, 1]
    if name == "stretched":
        velocity += grains.position * [-200.0, 200.0]
    grains = replace(grains, velocity=velocity)
    gravity = (0.0, -500.0) if name == "box" else None  # strong enough to be seen in so short a time
    imbalance = []
    for pieces in (1, 4):
        wall_friction = RUBBING if name == "box" else None
        laws = {"friction": RUBBING, "wall_friction": wall_friction, "gravity": gravity, "boundary": BOUNDARIES[name](side), "ledger": True}
        sim = Simulation(grains, LAW, **laws, dt=Simulation(grains, LAW, **laws).dt / pieces)
        start = sim.energy()["kinetic"]
        sim.run(5000 * pieces)
        energy = sim.energy()
        imbalance.append(energy["imbalance"] / (start + abs(energy["boundary_work"])))
        assert abs(energy["boundary_work"]) > 0.01 * start or name == "open"
    assert abs(imbalance[0]) < 1e-4
    assert abs(imbalance[1]) < 1e-5
    answer.computed(abs(imbalance[0]), "balance over 5,000 steps, of the turnover")


@pytest.mark.hard_case("D20", of="linear")
def test_driven_grains_work(rng, answer):
    """A driven grain that is pushed through others, turning, at constant velocity and spin, does the work that the others get."""
    grains = Grains(
        [[0.0, 0.0], [1.0, 0.2], [-0.99, 0.0]], np.full(3, 0.5), mass=np.ones(3), velocity=[[0.0, 0.0], [0.0, 0.0], [1.0, 0.0]],
        spin=[0.0, 0.0, -20.0], driven=1,
    )  # fmt: skip
    sim = Simulation(grains, Linear(1e4, 3.0), friction=Friction(2e3, 0.5), ledger=True, boundary=Open())
    sim.run(2000)
    energy = sim.energy()
    assert energy["boundary_work"] > 1.0
    assert abs(energy["imbalance"]) < 2e-3 * energy["boundary_work"]
    answer.computed(abs(energy["imbalance"] / energy["boundary_work"]), "balance while driven")


def test_the_ledger_changes_nothing(rng):
    """The same bits with and without it; without it nothing is held."""
    grains, side = crowd(rng)
    boundary = BOUNDARIES["box"](side)
    quiet, booked = (Simulation(grains, LAW, friction=RUBBING, boundary=boundary, wall_friction=RUBBING, ledger=on) for on in (False, True))
    for sim in (quiet, booked):
        sim.run(3000)
    np.testing.assert_array_equal(state(quiet), state(booked))
    assert quiet._state.memory.overlap is None
    assert quiet._state.ledger is None
    assert set(quiet.energy()) == {"kinetic", "elastic"}
    assert quiet.energy()["elastic"] == booked.energy()["elastic"]


@pytest.mark.parametrize("name", EVERY_LAW)
def test_the_book_is_kept_in_vectors(name):
    """The assembly of the pass over a block holds a packed square root, for every law: the book costs about as much as the forces."""
    if numba.config.DISABLE_JIT:
        pytest.skip("nothing is compiled with NUMBA_DISABLE_JIT")
    law, columns = EVERY_LAW[name], [np.zeros(8) for _ in range(5)]
    fresh = numba.njit(**OPTIONS)(account_pairs.py_func)  # code from the disk cache cannot be inspected
    largest = columns[0] if law.remembers else None
    out = scratch(virial=False, whole=True, ledger=True)
    fresh(out.pairs, np.ones(0), law.parameters(), FRICTION.parameters(), None, largest, *columns[1:], out.losses, 0.0)
    (text,) = fresh.inspect_asm().values()
    assert "sqrtpd" in text or re.search(r"fsqrt\s+v\d+\.2d", text)  # x86, Arm


def test_the_next_stage_opens_a_new_book():
    sim = head_on(Linear(1e4, 10.0), friction=FRICTION)
    sim.run(40)
    stage = sim.next_stage(Open())
    energy = stage.energy()
    assert energy["elastic"] == pytest.approx(sim.energy()["elastic"], rel=1e-12)
    assert energy["dissipated_dashpot"] == 0.0
    assert energy["imbalance"] == 0.0
    assert sim.next_stage(Open(), ledger=False)._state.ledger is None
