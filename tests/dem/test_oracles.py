"""Whole simulations of one, two or a few grains against exact solutions: restitution, sticking, sliding, oscillation, rotation."""

import math
from dataclasses import replace

import numpy as np
import pytest
from crowds import EVERY_LAW, FRICTION, LAW, K, crowd, state
from scipy.linalg import expm

from anisogran.dem import Box, Friction, Grains, Linear, Luding, Open, Simulation, collision_time
from anisogran.dem.laws import stored_energy

SIZE = 0.5  # 2 a1 a2/(a1 + a2) of two radii of 0.5


def pair(speed=1.0, gap=0.0):
    """Two unit masses of diameter 1 that meet head-on."""
    return Grains([[0.0, 0.0], [1.0 + gap, 0.0]], [0.5, 0.5], mass=[1.0, 1.0], velocity=[[0.5 * speed, 0.0], [-0.5 * speed, 0.0]])


def restitution_error(law, share, exact, speed=1.0):
    """Largest error of the restitution with dt = share * t_c, over phases of the first touch within a step: it depends on them."""
    dt = share * collision_time(law, np.ones(2))
    softest = getattr(law, "k1", law.stiffest)
    steps = int(6 / share * math.sqrt(law.stiffest / softest))
    errors = []
    for phase in np.linspace(0, 1, 7)[:-1]:
        sim = Simulation(pair(speed, phase * speed * dt), law, dt=dt)
        sim.run(steps)
        assert sim.position[1, 0] - sim.position[0, 0] > 1.0  # apart again
        errors.append(abs((sim.velocity[1, 0] - sim.velocity[0, 0]) / speed - exact))
    return max(errors)


def order(error, coarse=1 / 50, fine=1 / 200):
    """Measured order in the time step."""
    return math.log(error(coarse) / error(fine)) / math.log(coarse / fine)


def dashpot(e):
    """Linear contact of two unit masses with that restitution, e = exp(-g t_c/(2 m12))."""
    ratio = -math.log(e) / math.hypot(math.pi, math.log(e))  # of the critical damping
    return Linear(K, 2 * ratio * math.sqrt(0.5 * K))


@pytest.mark.parametrize("e", [0.9, 0.5, 0.1])
def test_linear_restitution_is_the_closed_form(e):
    """First order in dt, whatever the integrator: the dashpot force jumps at the first touch, somewhere within a step."""
    law = dashpot(e)
    assert math.exp(-law.damping * collision_time(law, np.ones(2)) / (2 * 0.5)) == pytest.approx(e, rel=1e-12)
    assert restitution_error(law, 1 / 200, e) < 4e-3  # measured 9e-4, 1.8e-3, 3.3e-3
    assert order(lambda share: restitution_error(law, share, e)) == pytest.approx(1.0, abs=0.1)  # measured 1.00 to 1.02


def test_without_dashpot_restitution_is_exact_to_third_order():
    law = Linear(K)
    assert restitution_error(law, 1 / 50, 1.0) < 3e-5  # measured 1.6e-5
    assert order(lambda share: restitution_error(law, share, 1.0)) == pytest.approx(3.0, abs=0.1)


def hysteretic_restitution(k1, k2, kc):
    """e^2 = k1/k2 - (kc/k1)(k2 - k1)^2/(k2 (k2 + kc)) from the work along the branches; negative where the pair sticks."""
    return k1 / k2 - kc / k1 * (k2 - k1) ** 2 / (k2 * (k2 + kc))


@pytest.mark.parametrize(
    ("ratio", "adhesion"),
    [
        (1, 5.0), (2, 0.0), (2, 0.2), (2, 1.0), (2, 5.0), (5, 0.0), (5, 0.02), (5, 0.2),
        pytest.param(2, 20.0, marks=pytest.mark.hard_case("D4", of="luding")),
        pytest.param(100, 0.0, marks=pytest.mark.hard_case("D3", of="luding")),
    ],
)  # fmt: skip
def test_luding_restitution_is_the_closed_form(ratio, adhesion, answer):
    """k2/k1 up to 100 and kc/k1 up to 20, which is kc/k2 = 10; the step follows the stiffest of all branches."""
    k1 = K / ratio
    law = Luding(k1, K, adhesion * k1)
    exact = math.sqrt(hysteretic_restitution(k1, K, law.kc))
    for share, bound in ((1 / 50, 1e-3), (1 / 200, 1e-4)):  # measured 3.4e-4 and 2.2e-5 at most
        error = restitution_error(law, share, exact)
        assert error < bound
        answer.computed(error, f"restitution at t_c/{1 / share:.0f}")


@pytest.mark.parametrize("chi", [0.2, 0.5, 0.9, 1.4])
@pytest.mark.parametrize("adhesion", [0.0, 0.05, 0.2])
def test_restitution_with_growing_stiffness_is_the_closed_form(chi, adhesion):
    """chi = v/(d_p sqrt(k1/m12)): below 1 with the stiffness reached, above 1 all plastic work is done and the rest is elastic."""
    k1, depth, kc = K / 5, 0.05, adhesion * K / 5
    plastic = K / (K - k1) * depth * SIZE
    reached = hysteretic_restitution(k1, k1 + (K - k1) * min(chi, 1.0), kc)
    square = 1 - (1 - reached) / max(chi, 1.0) ** 2
    law, speed = Luding(k1, K, kc, plastic_depth=depth), chi * plastic * math.sqrt(k1 / 0.5)
    for share, bound in ((1 / 50, 1e-3), (1 / 200, 1e-4)):  # measured 3.5e-4 and 1.4e-5 at most
        assert restitution_error(law, share, math.sqrt(square), speed) < bound


@pytest.mark.hard_case("D4", of="luding")
@pytest.mark.parametrize(
    "law",
    [Luding(0.2 * K, K, 0.1 * K), Luding(0.2 * K, K, 10 * K), Luding(0.01 * K, K, K), Luding(0.2 * K, K, K, plastic_depth=0.03)],
    ids=repr,
)
def test_luding_sticks_where_the_closed_form_has_no_root(law, answer):
    """kc > k1^2/(k2 - 2 k1), up to kc/k2 = 10: the pair stays in contact, oscillates about d_0, and never gains energy."""
    assert hysteretic_restitution(law.k1, law.k2, law.kc) < 0
    parameters = law.parameters()
    sim = Simulation(pair(), law, dt=collision_time(law, np.ones(2)) / 100)
    energies = [sim.kinetic_energy()]
    for _ in range(400):
        sim.run(20)
        overlap = 1.0 - (sim.position[1, 0] - sim.position[0, 0])
        assert overlap > 0
        energies.append(sim.kinetic_energy() + stored_energy(parameters, overlap, sim._state.memory.largest[0], SIZE))
    # measured at most 2e-4: velocity Verlet keeps a harmonic energy to (omega dt)^2/8 = 1.2e-4, and each kink costs a little
    gain = np.diff(energies).max() / energies[0]
    assert gain < 5e-4
    answer.computed(gain, "gain of energy while stuck")
    assert energies[-1] < energies[0]


@pytest.mark.hard_case("D6", of="luding")
def test_equal_stiffnesses_are_the_linear_law_bit_for_bit(rng, answer):
    """A crowd that implodes, with dashpots: without friction whatever the adhesion; with it kc = 0, for adhesion raises its bound."""
    grains, _ = crowd(rng, origin=0.5)
    grains = replace(grains, velocity=-50.0 * grains.position)
    for friction, kc in ((FRICTION, 0.0), (None, 3e4)):
        runs = [Simulation(grains, law, friction) for law in (Linear(1e5, 0.1), Luding(1e5, 1e5, kc, 0.1))]
        for sim in runs:
            sim.run(20_000)
        assert np.count_nonzero(runs[0].velocity[:, 0] != grains.velocity[:, 0]) > 50  # of 60 have collided
        np.testing.assert_array_equal(state(runs[0]), state(runs[1]))
    answer.computed(0.0, "20,000 steps of the linear law")


@pytest.mark.parametrize(("inertia", "rolling"), [(0.4, 5 / 7), (0.5, 2 / 3)])
def test_a_thrown_bowl_slides_and_then_rolls(inertia, rolling):
    """Sphere and disc: it rolls from t = v0/(mu g (1 + 1/inertia)) at v0/(1 + inertia): v0 5/7, v0 2/3 at v0/(3 mu g)."""
    k, mu, g, v0 = 1e6, 0.3, 10.0, 1.0
    grains = Grains([[1.0, 0.5 - g / k]], [0.5], mass=[1.0], velocity=[[v0, 0.0]], inertia_factor=inertia)  # the floor bears it
    law = Linear(k)
    friction = Friction(0.2 * k, mu, damping=100.0)  # a tenth of the critical damping of the rolling grain on its spring
    sim = Simulation(
        grains, law, gravity=(0.0, -g), boundary=Box(50.0, 2.0), wall_friction=friction, dt=collision_time(law, grains.mass) / 50
    )
    exact = v0 / (mu * g * (1 + 1 / inertia))
    slip, times = [v0], [0.0]
    while sim.time < 1.3 * exact:
        sim.run(1)
        slip.append(sim.velocity[0, 0] + (0.5 - 0.5 * g / k) * sim.spin[0])
        times.append(sim.time)
    first = np.flatnonzero(np.array(slip) <= 0)[0]
    found = np.interp(0.0, [slip[first], slip[first - 1]], [times[first], times[first - 1]])
    assert found == pytest.approx(exact, rel=1e-3)  # measured 1.7e-4: the spring is stretched first
    assert sim.velocity[0, 0] == pytest.approx(rolling * v0, rel=1e-3)  # measured 2.4e-5
    assert sim.position[0, 1] == pytest.approx(0.5 - g / k, abs=1e-12)


@pytest.mark.parametrize("name", EVERY_LAW)
def test_oblique_impact_never_gains_energy(name):
    """No angle of impact from 0 to 89 degrees raises the kinetic energy, with dashpot or without; momentum is kept."""
    for law in (EVERY_LAW[name], replace(EVERY_LAW[name], damping=0.0)):
        gain = []
        for angle in np.radians(np.linspace(0, 89, 24)):
            v = np.array([-math.cos(angle), math.sin(angle)])
            grains = replace(pair(), velocity=[[0.0, 0.0], v])
            sim = Simulation(grains, law, friction=Friction(0.3 * K, 0.2), dt=collision_time(law, grains.mass) / 100)
            before = sim.kinetic_energy()
            sim.run(400)
            gain.append(sim.kinetic_energy() / before - 1)
            np.testing.assert_allclose(sim.velocity.sum(axis=0), v, atol=1e-12)  # momentum, to rounding
        assert max(gain) < 1e-3


@pytest.mark.parametrize("angle", [75, 80, 85])
def test_gross_sliding_obeys_coulomb(angle):
    """A grazing impact slides throughout: the tangential velocity changes by mu (1 + e) v_n."""
    mu, law = 0.2, Linear(K)
    # so slow that the pair does not turn while it slides past: v t_c is 1e-4 of a diameter
    v = 5e-3 * np.array([-math.cos(math.radians(angle)), math.sin(math.radians(angle))])
    grains = replace(pair(), velocity=[[0.0, 0.0], v])
    sim = Simulation(grains, law, friction=Friction(2 * K, mu), dt=collision_time(law, grains.mass) / 200)
    sim.run(800)
    change = sim.velocity[1] - sim.velocity[0] - v
    assert change[0] == pytest.approx(-2 * v[0], rel=1e-3)  # e = 1
    assert change[1] == pytest.approx(-mu * abs(change[0]), rel=5e-3)  # measured 1e-3 at most: the spring has to be stretched first


def oscillation_error(share, damping):
    """Two unequal grains squeezed between two walls against m x'' = -k A (x - x_eq) - g A x', A = (2 -1; -1 2), over ten t_c."""
    width, radius, mass = 1.74, np.array([0.5, 0.4]), np.array([1.0, 2.0])
    start, law = np.array([0.49, 1.355]), Linear(K, damping)
    sim = Simulation(
        Grains(np.stack([start, [1.0, 1.0]], axis=1), radius, mass=mass), law, boundary=Box(width, 2.0),
        dt=share * math.pi * math.sqrt(0.5 / K),
    )  # fmt: skip
    coupling = np.array([[2.0, -1.0], [-1.0, 2.0]]) / mass[:, None]
    rest = np.linalg.solve(coupling * mass[:, None], [-radius[1], radius[0] + width])
    motion = np.block([[np.zeros((2, 2)), np.eye(2)], [-K * coupling, -damping * coupling]])
    error = 0.0
    for _ in range(20):
        sim.run(int(0.5 / share))
        x = sim.position[:, 0]
        assert min(radius[0] - x[0], 0.9 - (x[1] - x[0]), x[1] + radius[1] - width) > 0  # all three contacts are closed
        exact = rest + (expm(motion * sim.time) @ [*(start - rest), 0.0, 0.0])[:2]
        error = max(error, float(np.abs(x - exact).max() / np.abs(start - rest).max()))
    return error


@pytest.mark.parametrize(("damping", "expected", "bound"), [(0.0, 2.0, 1e-3), (20.0, 1.0, 6e-3)])
def test_two_grains_between_walls_are_a_coupled_oscillator(damping, expected, bound):
    """Second order in dt: (omega dt)^2/24 of phase; with dashpots first order, for they take the velocities of half a step before."""
    assert oscillation_error(1 / 200, damping) < bound  # measured 3.4e-4 and 3.0e-3
    assert order(lambda share: oscillation_error(share, damping)) == pytest.approx(expected, abs=0.15)


@pytest.mark.hard_case("D21")
@pytest.mark.parametrize("law", [Linear(1e5, 0.1), LAW], ids=["linear", "luding"])
def test_rigid_rotation_turns_all_forces(law, rng, answer):
    """Grains with loaded contacts, turned as a whole with its memory: the same forces, turned.

    No better than to eps side/overlap = 5e-14 of the largest force: an overlap is the small difference of positions that are rounded.
    """
    grains, _ = crowd(rng, count=150, origin=0.5)
    grains = replace(grains, position=0.95 * grains.position)
    sim = Simulation(grains, law, friction=FRICTION)
    sim.run(20)
    plain = sim.next_stage(Open())
    scale, turning = np.abs(plain.net_force).max(), np.abs(plain.torque).max()
    fresh = Simulation(replace(grains, position=sim.position, velocity=sim.velocity, spin=sim.spin), law, friction=FRICTION)
    assert np.abs(fresh.torque).max() == 0 < turning  # the memory matters
    for angle in (0.7, 2.0, math.pi / 2):
        turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
        turned = sim.next_stage(Open(), velocity=sim.velocity @ turn.T, position=sim.position @ turn.T)
        # measured 4e-14 and 1e-15 (the springs turn with their contacts, and no overlap enters while they stick)
        error = np.abs(turned.net_force - plain.net_force @ turn.T).max() / scale
        assert error < 2e-13
        assert np.abs(turned.torque - plain.torque).max() < 2e-13 * turning
        answer.computed(error, "forces of a turned packing")
