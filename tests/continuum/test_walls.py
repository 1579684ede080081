"""Walls that let the grains slip, a turning outer ring, and a fixed one: closed forms first, then limits and order."""

from dataclasses import replace

import numpy as np
import pytest
from newtonian import Newtonian

from anisogran.continuum import CoulombSlip, LocalMuI, NavierSlip, Nonlocal, RingFlow
from anisogran.continuum.exact import local_speed
from anisogran.continuum.walls import slip_velocity
from anisogran.outcome import InputError
from continuum_cases import CASES, name

LOCAL, NONLOCAL = LocalMuI(0.26, 1.0), Nonlocal(0.26, 1.0, 0.9)
FAST = 0.1  # wall speed at which the stress ratio, .36 and .42, is well above that of slow flow, .26 and .39


def ring(law, **changes):
    return RingFlow(**({"r_inner": 13.0, "r_outer": 33.0, "law": law, "wall_speed": FAST, "outer_pressure": 1.0} | changes))


@pytest.mark.parametrize("film", [0.05, 1.0, 300.0])
def test_navier_slip_of_a_newtonian_fluid(film):
    """v = a (R_o^2/r - r); the film, in units of viscosity over gap, carries 2 eta a R_o^2/R_i^2."""
    inner, outer, speed, viscosity = 1.0, 2.0, 0.3, 0.7
    reduced = viscosity * speed / 7.0  # the gap is 1, the pressure 7
    flow = RingFlow(inner, outer, Newtonian(reduced), speed, 7.0, inner_wall=NavierSlip(film * viscosity), elements=64).solve()
    a = film * speed / (film * (outer**2 / inner - inner) + 2.0 * outer**2 / inner**2)
    np.testing.assert_allclose(flow.v_phi, a * (outer**2 / flow.r - flow.r), atol=3e-6 * speed)  # mesh, h^3
    assert flow.slip.inner == pytest.approx(speed - a * (outer**2 / inner - inner), abs=1e-7 * speed)  # wall values converge with h^4
    assert flow.slip.outer == 0.0


@pytest.mark.parametrize("friction", [0.35, 0.3])
def test_coulomb_slip_of_the_local_law(friction):
    """Where the wall slips the stress ratio is its friction, and the speed of the grains there follows in closed form."""
    flow = ring(LOCAL, inner_wall=CoulombSlip(friction), rate_floor=1e-6, elements=64).solve()
    assert flow.stress_ratio_wall == pytest.approx(friction, rel=1e-9)
    grains = float(local_speed(13.0, friction, LOCAL, 13.0, 33.0, 1.0))
    # the mesh: second order, for u'' jumps at the edge of the layer; measured 7e-5
    assert flow.slip.inner == pytest.approx(FAST - grains, abs=2e-4 * FAST)
    assert flow.torques.difference < 1e-8


@pytest.mark.hard_case("N5")
@pytest.mark.parametrize("law", CASES, ids=name)
@pytest.mark.parametrize("wall", [CoulombSlip, NavierSlip])
def test_slip_goes_from_sticking_to_no_torque(law, wall, answer):
    """Monotone in the parameter of the wall; a large one sticks, 0 takes no torque and leaves the grains at rest."""
    rough = ring(law).solve()
    strengths = (0.0, 0.3, 0.4, 1.0) if wall is CoulombSlip else (0.0, 3.0, 30.0, 1e7)
    flows = [ring(law, inner_wall=wall(strength)).solve() for strength in strengths]
    for flow, strength in zip(flows, strengths, strict=True):
        load = strength if wall is CoulombSlip else strength * flow.slip.inner
        assert flow.stress_ratio_wall <= load * (1.0 + 1e-8) + 1e-12
        assert flow.torques.difference < 1e-8
    ratios, slips = [flow.stress_ratio_wall for flow in flows], [flow.slip.inner for flow in flows]
    assert np.all(np.diff(ratios) >= 0.0)
    assert np.all(np.diff(slips) <= 0.0)
    assert ratios[0] < 1e-12
    assert slips[0] == pytest.approx(FAST, rel=1e-12)
    assert np.abs(flows[0].v_phi).max() < 1e-12
    # the film of 1e7 slips by the stress over it
    assert ratios[-1] == pytest.approx(rough.stress_ratio_wall, rel=1e-7)
    assert slips[-1] < 1e-6 * FAST
    answer.computed(abs(ratios[-1] / rough.stress_ratio_wall - 1.0), f"stress ratio of a {wall.__name__} that all but sticks")
    answer.computed(abs(slips[0] / FAST - 1.0), "slip of a wall without friction")
    answer.named("slip falls and torque grows with the strength of the wall")


def test_friction_below_the_slow_limit_moves_nothing():
    """A nonlocal flow needs a stress ratio of .3888 in this ring; a wall of less friction slips past grains at rest."""
    for friction, share in ((0.395, 0.9), (0.385, 1e-6)):
        flow = ring(NONLOCAL, inner_wall=CoulombSlip(friction)).solve()
        assert flow.stress_ratio_wall == pytest.approx(friction, rel=1e-8)
        assert (flow.v_phi[0] / FAST > 1e-3) == (friction > 0.389)
        assert flow.v_phi[0] < share * FAST
        assert flow.status.level == "ok"


def test_the_outer_ring_slips_when_it_is_the_weaker_one():
    """The torque is one: sigma_rphi r^2 at both rings, 6.44 times less stress outside."""
    flow = ring(NONLOCAL, inner_wall=CoulombSlip(0.41), outer_wall=CoulombSlip(0.062)).solve()
    assert flow.slip.inner == 0.0
    assert flow.slip.outer < 0.0  # the grains run ahead of the resting ring
    assert flow.stress_ratio_wall == pytest.approx(0.062 * (33.0 / 13.0) ** 2, rel=1e-8)


@pytest.mark.parametrize("law", [LOCAL, NONLOCAL])
def test_a_rotating_frame_changes_nothing_but_the_rotation(law):
    still, turn = ring(law).solve(), 0.002
    turned = ring(law, wall_speed=FAST + turn * 13.0, outer_speed=turn * 33.0).solve()
    # the rate floor is in units of the faster ring, which is 26 % faster; the mesh of the layer follows it
    tolerance = 2e-3 if law is LOCAL else 2e-5
    np.testing.assert_allclose(turned.at(still.r).v_phi - turn * still.r, still.v_phi, atol=tolerance * FAST)
    assert turned.stress_ratio_wall == pytest.approx(still.stress_ratio_wall, rel=2e-4 if law is LOCAL else 1e-6)


def test_the_outer_ring_may_drive():
    flow = ring(NONLOCAL, wall_speed=0.0, outer_speed=FAST).solve()
    assert flow.v_phi[0] == 0.0
    assert flow.v_phi[-1] == pytest.approx(FAST, rel=1e-14)
    assert flow.stress[0, 1, 0] < 0.0
    assert flow.torques.difference < 1e-8


@pytest.mark.parametrize("dimension", [1, 2])
def test_a_fixed_outer_ring_keeps_the_mean_pressure(dimension):
    mesh = {"dimension": dimension, "elements": 16, "elements_around": 8}
    still = [ring(NONLOCAL, outer=outer, **mesh).solve() for outer in ("volume", "pressure")]
    np.testing.assert_allclose(still[0].v_phi, still[1].v_phi, atol=1e-9 * FAST)
    heavy = [
        ring(NONLOCAL, wall_speed=1.0, outer=outer, inertia=True, areal_density=1.0, **mesh).solve() for outer in ("volume", "pressure")
    ]
    means = [flow.ring_average([13.0, 33.0]).pressure[0] for flow in heavy]
    assert means[0] == pytest.approx(1.0, rel=1e-12)  # a linear pressure on Gauss points: exact
    assert means[1] < 0.999  # the centrifugal load takes pressure from the inside
    assert heavy[1].stress[0, 0, -1] == pytest.approx(1.0, rel=1e-4)


@pytest.mark.parametrize("wall", [CoulombSlip(0.4), NavierSlip(10.0)])
def test_slip_is_the_same_on_both_meshes(wall):
    line = ring(NONLOCAL, inner_wall=wall, elements=16)
    plane = replace(line, dimension=2, elements_around=8)
    one, two = line.solve(), plane.solve()
    assert two.slip.inner == pytest.approx(one.slip.inner, rel=1e-9)
    np.testing.assert_allclose(two.v_phi, one.v_phi, atol=1e-10 * FAST)


def test_coulomb_complementarity_at_every_node_of_a_wall_that_slips_in_part():
    """Eccentric rings: some of the outer ring slips. There the force is friction x normal force along the slip, elsewhere it is less."""
    friction = 0.25
    wall = CoulombSlip(friction)
    flow = ring(NONLOCAL, r_outer=17.0, dimension=2, elements=12, elements_around=12, eccentricity=1.0, outer_wall=wall).solve()
    slip = slip_velocity(flow.space, flow.problem, flow.unknowns, outer=True)
    slips = slip != 0.0
    assert 0 < np.count_nonzero(slips) < slips.size
    forces = forces_on(flow)
    most = friction * np.abs(forces["u_r"])
    np.testing.assert_allclose(forces["u_phi"][slips], np.sign(slip[slips]) * most[slips], rtol=1e-6)
    assert np.all(np.abs(forces["u_phi"][~slips]) <= most[~slips])
    assert flow.slip.outer < 0.0


def forces_on(flow):
    """Reduced forces of the outer wall on the grains at its nodes."""
    from anisogran.continuum.walls import equations, sticking

    reaction = equations(flow.space, flow.problem, flow.problem.setting(), sticking(flow.space)).reaction(flow.unknowns)
    return {name: reaction[flow.space.ring(name, outer=True)] for name in ("u_r", "u_phi")}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"inner_wall": 0.3}, "RingFlow: inner_wall = 0.3 is no wall"),
        ({"outer_wall": "rough"}, "RingFlow: outer_wall = 'rough' is no wall"),
        ({"outer": "free"}, "RingFlow: outer = 'free' must be one of pressure, volume"),
        ({"wall_speed": 0.0}, "RingFlow: wall_speed = 0: nothing flows"),
        ({"outer_speed": np.inf}, "RingFlow: outer_speed = inf must be a finite number"),
        ({"dimension": 3}, "RingFlow: dimension = 3 must be at most 2"),
        ({"eccentricity": 12.0, "dimension": 2}, "RingFlow: eccentricity = 12 must be below 11.7 m"),
        ({"eccentricity": 3.0, "r_outer": 16.0, "dimension": 2}, "RingFlow: eccentricity = 3 must be below 3 m"),
        ({"eccentricity": 1.0}, "RingFlow: eccentricity = 1 m is not axisymmetric and needs dimension = 2"),
        ({"eccentricity": 1.0, "dimension": 2, "inner_wall": NavierSlip(1.0)}, "RingFlow: inner_wall must be rough"),
        ({"dimension": 2, "elements_around": 2}, "RingFlow: elements_around = 2 must be at least 4"),
        ({"dimension": 2, "elements": 900}, "RingFlow: elements = 900 is above 20000 in all"),
    ],
)
def test_refused_input(change, message):
    with pytest.raises(InputError) as caught:
        ring(NONLOCAL, **change).solve()
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(("wall", "message"), [(CoulombSlip, "CoulombSlip: friction = -1"), (NavierSlip, "NavierSlip: viscosity = -1")])
def test_refused_wall(wall, message):
    with pytest.raises(InputError, match=f"{message} must be at least 0"):
        wall(-1.0)
    with pytest.raises(AttributeError):
        wall(1.0).friction = 2.0
