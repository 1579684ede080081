"""The ring solver against exact flows: Newtonian, local mu(I), thin gap, rigid rotation."""

import numpy as np
import pytest
from newtonian import Newtonian
from scipy.integrate import quad
from scipy.optimize import brentq

from anisogran.continuum import Jop, LocalMuI, Regularised, RingFlow, local_mu_i, newtonian_couette
from anisogran.continuum.exact import local_speed, local_stress_ratio
from anisogran.outcome import InputError
from continuum_cases import CASES, LOCAL, name

LAW = LocalMuI(mu_s=0.26, b=1.0)


def relative_error(r, found, exact):
    return np.sqrt(np.trapezoid((found - exact) ** 2 * r, r) / np.trapezoid(exact**2 * r, r))


def local_error(wall_speed=1e-3, **numerics):
    r = np.linspace(13.0, 33.0, 4001)
    flow = RingFlow(13.0, 33.0, LAW, wall_speed, 1.0, **numerics).solve()
    return relative_error(r, flow.at(r).v_phi, local_mu_i(r, wall_speed, LAW, 13.0, 33.0, 1.0))


@pytest.mark.parametrize("r_inner", [1.0, 0.1])
def test_newtonian_couette(r_inner):
    flow = RingFlow(r_inner, 2.0, Newtonian(0.1), 0.3, 7.0, elements=128).solve()
    exact = newtonian_couette(flow.r, r_inner, 2.0, 0.3)
    # mesh error of quadratic elements, h^3: 128 elements, grading ratio 1 or 19
    assert np.abs(flow.v_phi - exact).max() < 1e-5 * 0.3
    gap = 2.0 - r_inner
    viscosity = 0.1 * 7.0 * gap / 0.3
    torque = 4.0 * np.pi * viscosity * (0.3 / r_inner) * r_inner**2 * 4.0 / (4.0 - r_inner**2)
    assert flow.torques.inner == pytest.approx(torque, rel=1e-6)  # reactions converge with h^4


@pytest.mark.hard_case("N4", of=[law.kind for law in CASES])
def test_small_inner_radius_on_a_graded_mesh(answer):
    """R_i/R_o = 0.01: the torque is right to 1e-8, so 1/r^2 is integrated well."""
    flow = RingFlow(0.01, 1.0, Newtonian(1.0), 1.0, 1.0, elements=512).solve()
    exact = 4.0 * np.pi * 0.99 * (1.0 / 0.01) * 1e-4 / (1.0 - 1e-4)
    assert flow.torques.inner == pytest.approx(exact, rel=1e-8)
    answer.computed(abs(flow.torques.inner / exact - 1.0), "torque of a Newtonian fluid at R_i = R_o/100")


def test_exact_local_profile_solves_its_own_law():
    """The closed form against its definition: shear rate - r d(v/r)/dr = (mu - mu_s)/b sqrt(P/m), mu falling as 1/r^2."""
    ratio, pressure, mass = 0.3, 5.0, 2.0
    r = np.linspace(13.0, 13.9, 50)  # the layer ends at 13.96
    step = 1e-5
    omega = [local_speed(r + s, ratio, LAW, 13.0, 33.0, pressure, mass) / (r + s) for s in (step, -step)]
    rate = -r * (omega[0] - omega[1]) / (2.0 * step)
    expected = (ratio * (13.0 / r) ** 2 - LAW.mu_s) / LAW.b * np.sqrt(pressure / mass)
    np.testing.assert_allclose(rate, expected, atol=1e-8)  # truncation and rounding of the central difference
    assert local_speed(20.0, ratio, LAW, 13.0, 33.0, pressure, mass) == 0.0


def test_error_of_the_local_law_is_proportional_to_the_rate_floor():
    errors = [local_error(elements=64, rate_floor=floor) for floor in (1e-2, 1e-3, 1e-4)]
    ratios = np.divide(errors[:-1], errors[1:])
    assert np.all((ratios > 8.0) & (ratios < 12.0)), errors  # 10, up to a logarithm of the floor
    assert errors[-1] < 5e-4  # measured 3.7e-4


def test_error_of_the_local_law_falls_with_the_mesh_down_to_its_floor():
    errors = [local_error(elements=n, rate_floor=1e-6) for n in (8, 16, 32)]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert np.all((orders > 1.7) & (orders < 2.6)), (errors, orders)  # 3 where smooth, but u'' jumps at the edge of the layer: 2
    assert local_error(elements=64, rate_floor=1e-6) < 2e-5  # measured 1.0e-5; the floor alone gives 4e-6


def quadrature_speed(r, stress_ratio, law, r_inner=13.0, r_outer=33.0):
    """v_phi(r) of any local law that is at rest below a stress ratio: r times the integral of I d ln r, with mu falling as 1/r^2."""

    def inertial_number(mu):
        if mu <= law.friction(1e-12):
            return 0.0
        return np.exp(brentq(lambda log_I: law.friction(np.exp(log_I)) - mu, np.log(1e-12), np.log(1e6), xtol=1e-15))

    mu = stress_ratio * (r_inner / r) ** 2
    low = max(stress_ratio * (r_inner / r_outer) ** 2, law.friction(1e-12))
    return 0.5 * r * quad(lambda y: inertial_number(y) / y, min(low, mu), mu, epsabs=0.0, epsrel=1e-10, limit=400)[0]


@pytest.mark.parametrize("law", [Jop(0.342, 0.557, 0.069), Regularised(0.342, 0.557, 0.069)], ids=["jop", "regularised"])
def test_other_local_laws_against_quadrature(law):
    """The error is that of the rate floor and falls with it."""
    ratio, r = 0.42, np.linspace(13.0, 15.0, 9)
    exact = np.array([quadrature_speed(one, ratio, law) for one in r])
    errors = []
    for floor in (1e-2, 1e-3, 1e-4):
        flow = RingFlow(13.0, 33.0, law, exact[0], 1.0, elements=128, rate_floor=floor).solve()
        errors.append(np.max(np.abs(flow.at(r).v_phi - exact)) / exact[0])
    assert flow.stress_ratio_wall == pytest.approx(ratio, abs=2e-5)
    assert errors[2] < 1e-3, errors
    assert errors[0] > 5.0 * errors[1] > 20.0 * errors[2], errors


@pytest.mark.hard_case("N4")
@pytest.mark.parametrize("law", LOCAL, ids=name)
def test_a_hundredth_of_the_radius_inside(law, answer):
    """The stress ratio at the inner ring, from the speed that it makes; a smaller ring than 1e-6 R_o is refused."""
    flow = RingFlow(0.3, 30.0, law, 0.02, 1.0, rate_floor=1e-5, elements=256).solve()
    ratio = flow.stress_ratio_wall
    speeds = [quadrature_speed(0.3, one, law, 0.3, 30.0) for one in (ratio, 1.001 * ratio)]
    error = 0.001 * abs(speeds[0] - 0.02) / (speeds[1] - speeds[0])  # to first order
    # measured 1.7e-5 for the linear law, h^2 at the sharp edge of its layer; 3e-8 and 1e-8 for those that tend to mu_2, whatever the speed
    assert error < (5e-5 if law.kind == "local_mu_i" else 1e-7)
    answer.computed(error, "stress ratio at R_i = R_o/100")
    with pytest.raises(InputError, match=r"RingFlow: r_inner = 2e-05 must be at least 3e-05 m") as caught:
        RingFlow(2e-5, 30.0, law, 0.02, 1.0)
    answer.refused(caught)


@pytest.mark.parametrize("wall_speed", [1e-5, 1e-2, -0.3, 3.0])
def test_stress_ratio_of_the_local_law(wall_speed):
    flow = RingFlow(13.0, 33.0, LAW, wall_speed, 1.0, elements=128).solve()
    exact = local_stress_ratio(wall_speed, LAW, 13.0, 33.0, 1.0)
    assert flow.stress_ratio_wall == pytest.approx(exact, rel=2e-4)  # 1e-6 in slow flow; the floor at -0.3
    assert np.sign(flow.stress[0, 1, 0]) == np.sign(flow.torques.inner) == np.sign(wall_speed)


@pytest.mark.hard_case("N2")
@pytest.mark.parametrize("law", CASES, ids=name)
def test_thin_gap_is_plane_couette_flow(law, answer):
    """Gap over radius e = 1e-3: v is linear but for the curvature, which bends it to first order in e.

    mu falls by 2 e mu across the gap, so the rate -dv/dr + v/r by the share k = 2 e mu/(I dmu/dI): v = V (1 - s - (k - e)/2 s (1 - s)).
    The grains are small: in a gap of one diameter a nonlocal law is flatter.
    """
    flow = RingFlow(1000.0, 1001.0, law, 0.1, 1.0, grain_diameter=0.01).solve()
    s, mu = flow.r - 1000.0, law.friction(np.array(0.1))
    k = 2e-3 * mu / np.imag(law.friction(0.1 * (1.0 + 1e-30j)) / 1e-30)
    plane, bent = 1.0 - s, -0.5 * (k - 1e-3) * s * (1.0 - s)
    error = np.abs(flow.v_phi / 0.1 - plane - bent).max()
    assert error < 1e-5  # e^2 and k^2/50; k is 0.007 to 0.018
    ratio = abs(flow.stress_ratio_wall / mu - 1.0)
    assert ratio < 1.5e-3  # half of 2 e, and e k/2
    answer.computed(error, "plane Couette flow bent by the curvature")
    answer.computed(np.abs(flow.v_phi / 0.1 - plane).max(), "plane Couette flow as such")


TURNING = [*(pytest.param(law, marks=pytest.mark.hard_case("M4"), id=law.kind) for law in CASES), Newtonian(1.0)]


@pytest.mark.parametrize("law", TURNING)
@pytest.mark.parametrize("dimension", [1, 2])
def test_rings_that_turn_together_carry_the_grains_along_without_shear(law, dimension, answer):
    """The start is the answer: no stress but pressure, no torque, found at once."""
    problem = RingFlow(13.0, 33.0, law, 1.3, 1.0, outer_speed=3.3, dimension=dimension, elements=16, elements_around=8)
    flow = problem.solve()
    np.testing.assert_allclose(flow.v_phi, 0.1 * flow.r, rtol=1e-12)
    # rounding of the shear rate over the rate floors, 1e-5 and 1e-8 of the mean rate
    tolerance = 1e-5 if "g" in law.fields else 1e-9
    np.testing.assert_allclose(flow.stress, np.eye(2)[:, :, None] * np.ones(flow.r.size), atol=tolerance)
    assert flow.stress_ratio_wall < tolerance
    assert flow.status.level == "ok"
    if "g" not in law.fields:
        assert max(flow.history) < 1e-10  # rounding
    answer.computed(np.abs(flow.v_phi / (0.1 * flow.r) - 1.0).max(), "rigid rotation")
    answer.computed(flow.stress_ratio_wall, "no shear stress, of the pressure")
    answer.named(f"{flow.iterations} iterations {'on a line' if dimension == 1 else 'in the plane'}")


@pytest.mark.parametrize("law", [LAW, Newtonian(1.0)])
def test_centrifugal_load_lowers_the_pressure_inside(law):
    """dp/dr = rho v^2/r when s_rr = s_phiphi; without inertia the pressure is uniform."""
    still = RingFlow(1.0, 3.0, law, 1.0, 10.0).solve()
    np.testing.assert_allclose(still.pressure, 10.0, rtol=1e-12)
    flow = RingFlow(1.0, 3.0, law, 1.0, 10.0, inertia=True, areal_density=2.0, elements=128).solve()
    r = np.linspace(1.0, 3.0, 20001)
    load = 2.0 * flow.at(r).v_phi ** 2 / r
    expected = 10.0 - np.trapezoid(load, r)
    assert flow.pressure[0] == pytest.approx(expected, rel=1e-4)  # linear pressure, h^2: measured 2.4e-5
    assert flow.stress_ratio_wall == pytest.approx(flow.stress[0, 1, 0] / flow.stress[0, 0, 0], rel=1e-3)


def test_units_do_not_matter():
    """The same flow in metres and newtons: d = 2 mm, m = 3e-6 kg, P = 500 N/m."""
    speed_unit = 2e-3 * np.sqrt(500.0 / 3e-6)
    one = RingFlow(13.0, 33.0, LAW, 1e-2, 1.0).solve()
    two = RingFlow(0.026, 0.066, LAW, 1e-2 * speed_unit, 500.0, grain_diameter=2e-3, grain_mass=3e-6).solve()
    # I is the same: V/gap sqrt(m/P); rounding of the inputs, amplified by the Newton tolerance
    np.testing.assert_allclose(two.v_phi / speed_unit, one.v_phi, rtol=0.0, atol=1e-9 * 1e-2)
    np.testing.assert_allclose(two.inertial_number, one.inertial_number, rtol=0.0, atol=1e-8 * one.inertial_number.max())
    assert two.stress_ratio_wall == pytest.approx(one.stress_ratio_wall, rel=1e-9)
