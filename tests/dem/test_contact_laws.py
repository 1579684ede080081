"""Contact laws against their closed forms, two grains at a time; the general tests run over every law in the list."""

import math
from itertools import pairwise

import numpy as np
import pytest

from anisogran.dem import NORMAL_LAWS, Friction, Grains, Linear, Luding, Simulation, collision_time, longest_step
from anisogran.dem.laws import luding, normal_force, stored_energy, tangential_energy, tangential_force
from anisogran.dem.pairs import pair_forces, scratch
from anisogran.dem.rows import DV, DX
from anisogran.outcome import InputError

K = 1e4
EVERY_LAW = {Linear: Linear(K, 10.0), Luding: Luding(K / 2, K, K / 4, 10.0)}


def head_on(law, share, speed=1.0, gap=0.0):
    """Restitution of two unit masses of diameter 1 that meet head-on, with dt = share * t_c."""
    grains = Grains([[0.0, 0.0], [1.0 + gap, 0.0]], [0.5, 0.5], mass=[1.0, 1.0], velocity=[[0.5 * speed, 0.0], [-0.5 * speed, 0.0]])
    sim = Simulation(grains, law, dt=share * collision_time(law, grains.mass))
    sim.run(int(4 / share))
    return (sim.velocity[1, 0] - sim.velocity[0, 0]) / speed


def worst(law, share, exact):
    """Largest error of restitution over phases of the first touch within a step: the figure depends on where it falls."""
    step = share * collision_time(law, np.ones(2))
    return max(abs(head_on(law, share, gap=phase * step) - exact) for phase in np.linspace(0, 1, 7)[:-1])


def test_every_law_is_tested():
    assert set(EVERY_LAW) == set(NORMAL_LAWS)


@pytest.mark.parametrize("damping", [0.0, 5.0, 40.0])
def test_linear_restitution_is_the_closed_form(damping):
    """e = exp(-g t_c/(2 m12)). First order in dt with a dashpot, whose force jumps at first touch; third order without."""
    law = Linear(K, damping)
    exact = math.exp(-damping * collision_time(law, np.ones(2)) / (2 * 0.5))
    # measured: 1e-3 at t_c/200 with e = 0.45; times 3
    assert worst(law, 1 / 200, exact) < (1e-6 if damping == 0 else 3e-3)


@pytest.mark.parametrize(("damping", "order"), [(0.0, 3.0), (20.0, 1.0)])
def test_order_in_time(damping, order):
    law = Linear(K, damping)
    exact = math.exp(-damping * collision_time(law, np.ones(2)) / (2 * 0.5))
    coarse, fine = (worst(law, share, exact) for share in (1 / 40, 1 / 160))
    # worst of six phases is a rough measure: it catches the order, not its decimals
    assert math.log(coarse / fine) / math.log(4) == pytest.approx(order, abs=0.35)


@pytest.mark.parametrize(("k1", "kc"), [(0.5, 0.0), (0.5, 0.5), (0.2, 0.02), (0.01, 0.0)])
def test_luding_restitution_is_the_closed_form(k1, kc):
    """Undamped: e^2 = k1/k2 - (kc/k1)(k2 - k1)^2/(k2 (k2 + kc)), from the work along the branches."""
    law = Luding(k1 * K, K, kc * K)
    exact = math.sqrt(k1 - kc / k1 * (1 - k1) ** 2 / (1 + kc))
    duration = math.sqrt(1 / k1)  # the softest branch takes this much longer than t_c
    grains = Grains([[0.0, 0.0], [1.0, 0.0]], [0.5, 0.5], mass=[1.0, 1.0], velocity=[[0.5, 0.0], [-0.5, 0.0]])
    sim = Simulation(grains, law, dt=collision_time(law, grains.mass) / 200)
    sim.run(int(1200 * duration))
    assert sim.velocity[1, 0] - sim.velocity[0, 0] == pytest.approx(exact, abs=1e-4)


def test_luding_sticks_where_the_closed_form_has_no_root():
    law = Luding(0.2 * K, K, 0.1 * K)  # kc > k1^2/(k2 - 2 k1)
    grains = Grains([[0.0, 0.0], [1.0, 0.0]], [0.5, 0.5], mass=[1.0, 1.0], velocity=[[0.5, 0.0], [-0.5, 0.0]])
    sim = Simulation(grains, law, dt=collision_time(law, grains.mass) / 100)
    sim.run(5000)
    assert sim.position[1, 0] - sim.position[0, 0] < 1.0
    assert abs(sim.velocity[1, 0] - sim.velocity[0, 0]) < 1.0  # no energy was made


def test_luding_branches_meet_where_the_lecture_says():
    """Load to d_max, unload through d_0 and d_min onto the adhesive limit, reload from there on the k2 line of the lowered d_max."""
    record = Luding(1.0, 2.0, 1.0)
    law = record.parameters()

    def at(overlap, largest):
        force, _, largest = normal_force(law, overlap, 0.0, largest, 1.0)
        return force, largest

    force, largest = at(1.0, 0.0)
    assert (force, largest) == (1.0, 1.0)  # k1 d_max
    assert at(0.5, largest)[0] == 0.0  # d_0 = (1 - k1/k2) d_max
    lowest = (2.0 - 1.0) / (2.0 + 1.0)  # d_min = (k2 - k1)/(k2 + kc) d_max
    assert at(lowest, largest)[0] == pytest.approx(-lowest, abs=1e-15)  # f_min = -kc d_min
    force, lowered = at(0.2, largest)
    assert force == -0.2
    assert lowered == pytest.approx(0.2 * 3.0)  # d_max <- d (k2 + kc)/(k2 - k1)
    assert at(0.2, lowered)[0] == pytest.approx(-0.2, abs=1e-15)  # no jump on turning round
    assert at(0.3, lowered)[0] == pytest.approx(-0.2 + 2.0 * 0.1)  # reload along k2


def test_luding_with_equal_stiffnesses_is_linear_bit_for_bit(rng):
    linear, plastic = Linear(K, 3.0).parameters(), Luding(K, K, 0.3 * K, 3.0).parameters()
    for overlap, rate in rng.uniform([0, -1], [0.1, 1], (200, 2)):
        assert normal_force(plastic, overlap, rate, overlap, 1.0)[0] == normal_force(linear, overlap, rate, 0.0, 1.0)[0]


def test_a_contact_cycle_never_makes_energy(rng):
    """Work over random closed paths of the overlap is never negative, for every law without dashpot."""
    for law in (Linear(1.0).parameters(), Luding(0.3, 1.0, 0.5).parameters()):
        for _ in range(20):
            knots = np.concatenate([[0.0], rng.uniform(0.0, 1.0, 8), [0.0]])
            path = np.concatenate([np.linspace(a, b, 2001)[1:] for a, b in pairwise(knots)])
            largest, work, before, force_before = 0.0, 0.0, 0.0, 0.0
            for overlap in path:
                force, _, largest = normal_force(law, overlap, 0.0, largest, 1.0)
                work += 0.5 * (force + force_before) * (overlap - before)
                before, force_before = overlap, force
            assert work > -1e-3  # trapezoids across the kinks of the branches


@pytest.mark.parametrize("law", [Linear(1.0), Luding(0.3, 1.0, 0.5)], ids=repr)
def test_a_contact_gives_back_what_it_has_stored(law, rng):
    """Without dashpot: on the un- and reloading line the work is what is stored; nowhere is more stored than was put in."""
    parameters = law.parameters()
    knots = np.concatenate([[0.0], rng.uniform(0.0, 1.0, 40), [0.0]])
    path = np.concatenate([np.linspace(a, b, 201)[1:] for a, b in pairwise(knots)])
    overlap, force, largest, stored, elastic = 0.0, 0.0, 0.0, 0.0, 0
    for after in path:
        force_after, _, memory = normal_force(parameters, after, 0.0, largest, 1.0)
        energy = stored_energy(parameters, after, memory, 1.0)
        work = 0.5 * (force + force_after) * (after - overlap)  # exact on straight branches
        if memory == largest:
            elastic += 1
            assert energy - stored == pytest.approx(work, abs=1e-14)
        else:  # a step across a kink between two branches does up to (k2 - k1) step^2/8 more work than the trapezoid
            assert energy - stored < work + 3e-6
        overlap, force, largest, stored = after, force_after, memory, energy
    assert elastic > 500
    assert stored == 0.0  # at zero overlap


def test_friction_sticks_then_slides_at_the_limit():
    law = Friction(10.0, 0.5, 0.3).parameters()
    assert tangential_force(law, 0.0, 0.1, 1.0, 0.1) == (pytest.approx(-0.1), pytest.approx(0.01))
    force, spring = tangential_force(law, 0.0, 1.0, 1.0, 0.1)  # trial 1.0 is beyond 0.5: slides at 0.3
    assert force == pytest.approx(-0.3)
    assert -law.stiffness * spring == pytest.approx(force)
    assert tangential_energy(law, spring) == pytest.approx(0.5 * 0.3 * 0.03)  # half of force times stretch
    assert tangential_force(law, 0.02, 0.0, 0.0, 0.1) == (pytest.approx(0.0), pytest.approx(0.0))  # no normal force, no friction


def test_a_sliding_spring_gives_way_to_the_dashpot():
    """Dashpot included: sticking, the force is k stretch + g slip; sliding, spring and dashpot together are at the limit."""
    law = Friction(10.0, 0.5, 0.3, damping=2.0).parameters()
    assert tangential_force(law, 0.0, 0.1, 1.0, 0.1) == (pytest.approx(-0.3), pytest.approx(0.01))
    force, spring = tangential_force(law, 0.0, 1.0, 1.0, 0.1)
    assert force == pytest.approx(-0.3)
    assert -law.stiffness * spring - law.damping * 1.0 == pytest.approx(force)


def test_the_bound_of_friction_is_the_normal_force_with_its_dashpot():
    """Linear: the whole force, whatever its sign; Luding: measured from the adhesive limit, so that tension leaves friction."""
    linear = Linear(10.0, 2.0).parameters()
    assert normal_force(linear, 0.1, -0.5, 0.0, 1.0)[:2] == (pytest.approx(2.0), pytest.approx(2.0))
    assert normal_force(linear, 0.1, 1.5, 0.0, 1.0)[:2] == (pytest.approx(-2.0), pytest.approx(2.0))
    plastic = Luding(1.0, 2.0, 1.0, 2.0).parameters()  # at d = 0.6 with d_max = 1: elastic 0.2, limit -0.6
    assert normal_force(plastic, 0.6, -0.25, 1.0, 1.0)[:2] == (pytest.approx(0.7), pytest.approx(1.3))


def test_an_open_contact_forgets():
    """Two grains that have parted leave no force and no memory: the next contact loads along k1, with a relaxed spring."""
    out, largest, spring = scratch(virial=False, whole=True), np.array([0.1]), np.array([0.1])
    laws = (Luding(1.0, 2.0, 1.0).parameters(), Friction(1.0, 0.5, damping=0.1).parameters())
    out.pairs[[DX, DV], 0] = 1.1, 1.0
    pair_forces.py_func(out.pairs, np.ones(1), *laws, None, largest, spring, None, out, 0.1)
    assert (largest[0], spring[0]) == (0, 0)
    np.testing.assert_array_equal(out.force[:, 0], 0.0)


@pytest.mark.parametrize("law", EVERY_LAW.values(), ids=lambda law: type(law).__name__)
def test_oblique_impact_never_gains_energy(law):
    """No angle of impact raises the kinetic energy, and momentum is kept."""
    mu, steps = 0.2, 400
    gain = []
    for angle in np.radians(np.linspace(0, 89, 24)):
        v = np.array([-math.cos(angle), math.sin(angle)])
        grains = Grains([[0.0, 0.0], [1.0, 0.0]], [0.5, 0.5], mass=[1.0, 1.0], velocity=[[0.0, 0.0], v])
        sim = Simulation(grains, law, friction=Friction(0.3 * K, mu), dt=collision_time(law, grains.mass) / 100)
        before = sim.kinetic_energy()
        sim.run(steps)
        gain.append(sim.kinetic_energy() / before - 1)
        np.testing.assert_allclose(sim.velocity.sum(axis=0), v, atol=1e-12)  # momentum, to rounding
    assert max(gain) < 1e-3


def test_stiff_friction_shortens_the_step():
    """k_t far above k_n: the default step follows the tangential oscillation, and no angle of impact gains energy."""
    mass = np.ones(2)
    soft, stiff = (longest_step(Linear(K), Friction(share * K, 0.5), None, mass) for share in (0.6, 100.0))
    assert soft == pytest.approx(math.pi / 5 * math.sqrt(0.5 / K), rel=1e-2)
    assert stiff == pytest.approx(0.3 * math.pi * math.sqrt(0.5 / (350 * K)))
    for angle in np.radians([5, 30, 60, 85]):
        v = [-math.cos(angle), math.sin(angle)]
        grains = Grains([[0.0, 0.0], [1.0, 0.0]], [0.5, 0.5], mass=mass, velocity=[[0.0, 0.0], v])
        sim = Simulation(grains, Linear(K), friction=Friction(100 * K, 0.5))
        before = sim.kinetic_energy()
        sim.run(5000)
        assert np.hypot(*(sim.position[1] - sim.position[0])) > 1.0  # apart again
        assert sim.kinetic_energy() < before * (1 + 1e-3)


@pytest.mark.parametrize("angle", [75, 80, 85])
def test_gross_sliding_obeys_coulomb(angle):
    """A grazing impact slides throughout: the tangential velocity changes by mu (1 + e) v_n."""
    mu, law = 0.2, Linear(K)
    # so slow that the pair does not turn while it slides past: v t_c is 1e-4 of a diameter
    v = 5e-3 * np.array([-math.cos(math.radians(angle)), math.sin(math.radians(angle))])
    grains = Grains([[0.0, 0.0], [1.0, 0.0]], [0.5, 0.5], mass=[1.0, 1.0], velocity=[[0.0, 0.0], v])
    sim = Simulation(grains, law, friction=Friction(2 * K, mu), dt=collision_time(law, grains.mass) / 200)
    sim.run(800)
    change = sim.velocity[1] - sim.velocity[0] - v
    assert change[0] == pytest.approx(-2 * v[0], rel=1e-3)  # e = 1
    assert change[1] == pytest.approx(-mu * abs(change[0]), rel=5e-3)  # measured 1e-3 at most: the spring has to be stretched first


def test_angular_momentum_is_conserved():
    """Orbital and spin together, since both grains share the contact point."""
    grains = Grains([[0.0, 0.0], [1.2, 0.1]], [0.5, 0.75], mass=[1.0, 3.0], velocity=[[0.3, 0.2], [-1.0, 0.4]], spin=[3.0, -1.0])
    sim = Simulation(grains, Linear(K, 10.0), friction=Friction(0.3 * K, 0.4))

    def momentum():
        (x, y), (u, v) = sim.position.T, sim.velocity.T
        return float(np.sum(grains.mass * (x * v - y * u)) + np.sum(0.4 * grains.mass * grains.radius**2 * sim.spin))

    before = momentum()
    sim.run(300)
    assert abs(sim.spin[0] - 3.0) > 0.1  # friction acted
    # each step's torques cancel about its own contact point; the drift comes from the half-step positions: O(dt^2) of the exchange
    assert momentum() == pytest.approx(before, abs=1e-10)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Linear(0.0), "Linear: stiffness = 0 must be above 0 N/m"),
        (lambda: Linear(1.0, -1.0), "Linear: damping = -1 must be at least 0 kg/s"),
        (lambda: Luding(2.0, 1.0), "Luding: k2 = 1 must be at least 2"),
        (lambda: Luding(1.0, 2.0, -1.0), "Luding: kc = -1 must be at least 0 N/m"),
        (lambda: Friction(1.0, -0.1), "Friction: mu = -0.1 must be at least 0"),
        (lambda: Friction(1.0, 0.1, 0.2), "Friction: mu_dynamic = 0.2 must be at most 0.1"),
        (lambda: Linear(float("nan")), "Linear: stiffness = nan must be a finite number"),
    ],
)
def test_impossible_parameters_are_refused(make, message):
    with pytest.raises(InputError, match=message):
        make()


def test_parameters_are_floats_whatever_was_given():
    """An int where the kernel expects a float would compile another kernel."""
    for law in (Linear(1, 0), Luding(1, 2, 0, 0), Friction(1, 1)):
        assert all(type(value) is float for value in law.parameters())
    assert luding.Luding(1, 1).parameters().reset == 0.0
