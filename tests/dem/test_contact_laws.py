"""Contact laws against their closed forms, two grains at a time; the general tests run over every law in the list."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from crowds import EVERY_LAW, K

from anisogran.dem import NORMAL_LAWS, Friction, Grains, Linear, Luding, Simulation, longest_step
from anisogran.dem.laws import luding, normal_force, reloading_line, stored_energy, tangential_energy, tangential_force
from anisogran.dem.pairs import pair_forces, scratch
from anisogran.dem.rows import DV, DX
from anisogran.keys import REQUIRED, record_keys
from anisogran.outcome import InputError


def test_every_law_is_tested():
    """Every kernel of every law: each NamedTuple of parameters in the files of the laws."""
    assert {type(law) for law in EVERY_LAW.values()} == set(NORMAL_LAWS)
    kernels = {value for file in NORMAL_LAWS.values() for name, value in vars(file).items() if name.endswith("Parameters")}
    assert {type(law.parameters()) for law in EVERY_LAW.values()} == kernels


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


def test_growing_stiffness_in_numbers():
    """Loading k1, unloading k1 + (k2 - k1) d_max/d_p; beyond d_p one elastic line through depth * size. All lengths scale with size."""
    law = Luding(1.0, 5.0, 0.7, plastic_depth=0.1).parameters()  # d_p = 5/4 * 0.1
    for size in (1.0, 0.01):

        def at(overlap, largest, size=size):
            force, bound, memory = normal_force(law, size * overlap, 0.0, size * largest, size)
            assert bound == pytest.approx(force + 0.7 * size * overlap, rel=1e-12)  # from the adhesive limit
            return force / size, memory / size

        assert at(0.0625, 0.0) == (pytest.approx(0.0625), pytest.approx(0.0625))
        assert at(0.05, 0.0625) == (pytest.approx(0.0625 - 3.0 * 0.0125), pytest.approx(0.0625))  # half of d_p, halfway to k2
        assert at(0.125, 0.0) == (pytest.approx(0.125), pytest.approx(0.125))
        assert at(0.2, 0.125) == (pytest.approx(5.0 * (0.2 - 0.1)), pytest.approx(0.125))
        assert at(0.15, 0.125) == (pytest.approx(5.0 * (0.15 - 0.1)), pytest.approx(0.125))
        assert at(0.05, 0.125)[0] == pytest.approx(-0.7 * 0.05)
        assert reloading_line(law, 0.0625 * size, size) == pytest.approx((3.0, 0.0625 * size * 2 / 3, 0.0625 * size * 2 / 3.7))
        assert reloading_line(law, 0.2 * size, size) == pytest.approx((5.0, 0.1 * size, 0.125 * size * 4 / 5.7))


@pytest.mark.parametrize("name", ["luding", "growing luding"])
@pytest.mark.parametrize("deepest", [0.003, 0.01, 0.02, 0.05])
def test_turning_round_at_the_adhesive_limit_makes_no_jump(name, deepest):
    """Anywhere on the limit, d_max is lowered to a line that passes through the present force, and reloading follows this line."""
    law = EVERY_LAW[name].parameters()
    size = 1.5
    memory = normal_force(law, deepest, 0.0, 0.0, size)[2]
    meeting = reloading_line(law, memory, size)[2]
    assert normal_force(law, meeting * (1 + 1e-9), 0.0, memory, size)[2] == memory  # just before it: nothing is lowered
    for share in (1 - 1e-9, 0.7, 0.1, 1e-3):
        overlap = share * meeting
        force, _, lowered = normal_force(law, overlap, 0.0, memory, size)
        assert force == pytest.approx(-law.kc * overlap, rel=1e-14)
        assert lowered < memory
        stiffness, zero, again = reloading_line(law, lowered, size)
        # three products of rounded numbers
        assert again == pytest.approx(overlap, rel=1e-13)
        assert stiffness * (overlap - zero) == pytest.approx(force, rel=1e-12)
        assert normal_force(law, 1.1 * overlap, 0.0, lowered, size)[0] == pytest.approx(force + 0.1 * stiffness * overlap, rel=1e-12)
        memory = lowered


def test_equal_stiffnesses_leave_nothing_to_grow():
    assert Luding(2.0, 2.0, 1.0, 3.0, plastic_depth=0.1).parameters() == Luding(2.0, 2.0, 1.0, 3.0).parameters()
    assert type(Luding(2.0, 2.0, plastic_depth=0.1).parameters()) is luding.LudingParameters


@pytest.mark.parametrize("name", EVERY_LAW)
def test_a_contact_gives_back_what_it_has_stored_and_no_more(name, rng):
    """Without dashpot, over random cycles: on the un- and reloading line the work is what is stored; nowhere is more stored than put in."""
    law, size = replace(EVERY_LAW[name], damping=0.0).parameters(), 0.7
    knots = np.concatenate([[0.0], rng.uniform(0.0, 0.03, 40), [0.0], rng.uniform(0.0, 0.01, 40), [0.0]])
    path = np.concatenate([np.linspace(a, b, 201)[1:] for a, b in pairwise(knots)])
    overlap, force, largest, stored, elastic = 0.0, 0.0, 0.0, 0.0, 0
    for after in path:
        force_after, _, memory = normal_force(law, after, 0.0, largest, size)
        energy = stored_energy(law, after, memory, size)
        assert energy >= 0
        work = 0.5 * (force + force_after) * (after - overlap)  # exact on straight branches
        if memory == largest:
            elastic += 1
            assert energy - stored == pytest.approx(work, abs=1e-13)
        else:  # a step of 0.03/200 across a kink between two branches does up to (k2 + kc) step^2/8 more work than the trapezoid
            assert energy - stored < work + 4e-5
        overlap, force, largest, stored = after, force_after, memory, energy
    assert elastic > 3000
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


@pytest.mark.parametrize("name", EVERY_LAW)
def test_an_open_contact_forgets(name):
    """Two grains that have parted, by however much, leave no force and no memory: the next contact begins afresh."""
    for gap in (1e-9, 0.1, 1.5):
        out, largest, spring = scratch(virial=False, whole=True), np.array([0.1]), np.array([0.1])
        laws = (EVERY_LAW[name].parameters(), Friction(1.0, 0.5, damping=0.1).parameters())
        out.pairs[[DX, DV], 0] = 1.0 + gap, 1.0
        pair_forces.py_func(out.pairs, np.ones(1), *laws, None, largest, spring, None, out, 0.1)
        assert (largest[0], spring[0]) == (0, 0)
        np.testing.assert_array_equal(out.force[:, 0], 0.0)


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
        (lambda: Luding(1.0, 2.0, -1.0), "Luding: kc = -1 must be at least 0 N/m"),
        (lambda: Luding(1.0, 2.0, plastic_depth=0.0), "Luding: plastic_depth = 0 must be above 0"),
        (lambda: Luding(1.0, float("inf")), "Luding: k2 = inf must be a finite number"),
        (lambda: Luding(0.0, 1.0), "Luding: k1 = 0 must be above 0 N/m"),
        (lambda: Luding(1.0, 1.0, damping=-1.0), "Luding: damping = -1 must be at least 0 kg/s"),
        (lambda: Friction(0.0, 0.5), "Friction: stiffness = 0 must be above 0 N/m"),
        (lambda: Friction(1.0, -0.1), "Friction: mu = -0.1 must be at least 0"),
        (lambda: Friction(1.0, 0.1, 0.2), "Friction: mu_dynamic = 0.2 must be at most 0.1"),
        (lambda: Linear(float("nan")), "Linear: stiffness = nan must be a finite number"),
    ],
)
def test_impossible_parameters_are_refused(make, message):
    with pytest.raises(InputError, match=message):
        make()


@pytest.mark.hard_case("D5")
@pytest.mark.parametrize("law", NORMAL_LAWS, ids=lambda law: law.__name__.lower())
def test_every_parameter_of_every_law_has_its_bound(law, answer):
    """By the keys that it declares: what lies below, NaN and infinity are refused by name."""
    keys = record_keys(law)
    good = {name: one.example for name, one in keys.items() if one.default is REQUIRED}
    for name, one in keys.items():
        below = one.above if one.above is not None else one.at_least - 1.0
        for value in (below, math.nan, math.inf):
            with pytest.raises(InputError, match=f"^{law.__name__}: {name} = {value:g} must be ") as caught:
                law(**good | {name: value})
            answer.refused(caught)


@pytest.mark.hard_case("D5", of="luding")
def test_unloading_softer_than_loading_is_refused(answer):
    with pytest.raises(InputError, match="Luding: k2 = 1 must be at least 2") as caught:
        Luding(2.0, 1.0)
    answer.refused(caught)


def test_parameters_are_floats_whatever_was_given():
    """An int where the kernel expects a float would compile another kernel."""
    for law in (Linear(1, 0), Luding(1, 2, 0, 0), Luding(1, 2, 0, 0, 1), Luding(1, 1), Friction(1, 1)):
        assert all(type(value) is float for value in law.parameters())
