"""The ring solver against exact flows: Newtonian, local mu(I), thin gap, rigid rotation."""

import numpy as np
import pytest
from newtonian import Newtonian
from scipy.integrate import quad
from scipy.optimize import brentq

from anisogran.continuum import Jop, LocalMuI, Nonlocal, Regularised, RingFlow, local_mu_i, newtonian_couette
from anisogran.continuum.exact import local_speed, local_stress_ratio

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


def test_small_inner_radius_on_a_graded_mesh():
    """R_i/R_o = 0.01: the torque is right to 1e-8, so 1/r^2 is integrated well."""
    flow = RingFlow(0.01, 1.0, Newtonian(1.0), 1.0, 1.0, elements=512).solve()
    exact = 4.0 * np.pi * 0.99 * (1.0 / 0.01) * 1e-4 / (1.0 - 1e-4)
    assert flow.torques.inner == pytest.approx(exact, rel=1e-8)


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


@pytest.mark.parametrize("wall_speed", [1e-5, 1e-2, -0.3, 3.0])
def test_stress_ratio_of_the_local_law(wall_speed):
    flow = RingFlow(13.0, 33.0, LAW, wall_speed, 1.0, elements=128).solve()
    exact = local_stress_ratio(wall_speed, LAW, 13.0, 33.0, 1.0)
    assert flow.stress_ratio_wall == pytest.approx(exact, rel=2e-4)  # 1e-6 in slow flow; the floor at -0.3
    assert np.sign(flow.stress[0, 1, 0]) == np.sign(flow.torques.inner) == np.sign(wall_speed)


def test_thin_gap_is_plane_couette_flow():
    """Gap over radius 1e-3: v falls linearly to 1e-3 (curvature), and the stress is uniform."""
    flow = RingFlow(1000.0, 1001.0, LAW, 0.1, 1.0).solve()
    plane = 0.1 * (1001.0 - flow.r)
    assert np.abs(flow.v_phi - plane).max() < 2.5e-3 * 0.1  # mu falls by 2e-3 across the gap, I = (mu - mu_s)/b = 0.1 by 2 % of itself
    plane_ratio = LAW.mu_s + LAW.b * 0.1
    assert flow.stress_ratio_wall == pytest.approx(plane_ratio, rel=2e-3)


@pytest.mark.parametrize("law", [LAW, Nonlocal(0.26, 1.0, 0.9), Newtonian(1.0)])
@pytest.mark.parametrize("dimension", [1, 2])
def test_rings_that_turn_together_carry_the_grains_along_without_shear(law, dimension):
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
