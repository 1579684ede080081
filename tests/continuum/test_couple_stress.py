"""The spin of the grains: exact solutions, order, conditions at the rings, averages."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import iv, kv

from anisogran.continuum import LocalMuI, Nonlocal, RingFlow, spin
from anisogran.continuum.couple_stress import SpinEquation, continuum_spin, mesh_points
from anisogran.outcome import InputError

LENGTH = 0.5


@pytest.fixture(scope="module")
def flow():
    return RingFlow(13.0, 33.0, Nonlocal(0.26, 1.0, 0.9), 1e-2, 1.0).solve()


def test_uniform_spin_of_the_flow_between_rings_that_turn_otherwise():
    """W = const (solid rotation, or v = a r + b/r): the excess is a sum of modified Bessel functions of r sqrt(2)/l."""
    r = np.linspace(1.0, 3.0, 65)
    equation = SpinEquation(r, lambda r: np.full_like(r, -0.3))
    k = np.sqrt(2.0) / LENGTH
    a, b = np.linalg.solve([[iv(0, k), kv(0, k)], [iv(0, 3 * k), kv(0, 3 * k)]], [1.0, -0.2])  # the excesses at the rings
    found = equation.at(equation.solve(LENGTH, inner=0.7, outer=-0.5), r)
    np.testing.assert_allclose(found, -0.3 + a * iv(0, k * r) + b * kv(0, k * r), atol=1e-6)  # measured 2e-7
    a, b = np.linalg.solve([[iv(0, k), kv(0, k)], [iv(1, 3 * k), -kv(1, 3 * k)]], [1.0, 0.0])  # no couple at the outer ring
    found = equation.at(equation.solve(LENGTH, inner=0.7), r)
    np.testing.assert_allclose(found, -0.3 + a * iv(0, k * r) + b * kv(0, k * r), atol=1e-6)
    np.testing.assert_allclose(equation.solve(LENGTH), -0.3, rtol=1e-12)  # without a couple at any ring the grains turn with the flow


def test_order():
    """omega_p = cos r, from W = omega_p - l^2/2 lap omega_p."""
    errors = []
    for elements in (16, 32, 64):
        equation = SpinEquation(np.linspace(1.0, 3.0, elements + 1), lambda r: np.cos(r) + 0.5 * LENGTH**2 * (np.cos(r) + np.sin(r) / r))
        values = equation.solve(LENGTH, np.cos(1.0), np.cos(3.0))
        r = np.linspace(1.0, 3.0, 4001)
        errors.append(np.sqrt(np.mean((equation.at(values, r) - np.cos(r)) ** 2)))
    np.testing.assert_allclose(np.log2(np.divide(errors[:-1], errors[1:])), 3.0, atol=0.05)  # measured 3.00


def test_order_with_the_flow():
    """What is left of the error of the flow itself: third order too."""
    problem = RingFlow(13.0, 33.0, Nonlocal(0.26, 1.0, 0.9), 1e-2, 1.0)
    r = np.linspace(13.0, 20.0, 200)
    coarse, middle, fine = (spin(replace(problem, elements=n).solve(), 1.0, inner="ring").at(r).spin for n in (16, 32, 256))
    errors = [np.sqrt(np.mean((one - fine) ** 2)) for one in (coarse, middle)]
    assert errors[0] > 6.0 * errors[1] > 0.0, errors  # 8, measured
    assert errors[1] < 1e-4 * np.abs(fine).max()


def test_the_length_is_analytic():
    equation = SpinEquation(np.linspace(1.0, 3.0, 33), np.sin)
    slope = equation.solve(LENGTH + 1e-30j, inner=0.2).imag / 1e-30
    difference = (equation.solve(LENGTH + 1e-6, inner=0.2) - equation.solve(LENGTH - 1e-6, inner=0.2)) / 2e-6
    np.testing.assert_allclose(slope, difference, atol=1e-8)  # rounding 1e-16/1e-6 and more


def test_conditions_at_the_rings(flow):
    with_ring, excess = spin(flow, 1.0, inner="ring"), spin(flow, 1.0, inner=2e-3, outer=0.0)
    assert with_ring.spin[0] == pytest.approx(1e-2 / 13.0, rel=1e-14)
    assert with_ring.eigen_rotation[0] > 0.0 > with_ring.continuum_spin[0]  # the flow falls outward and turns the other way
    np.testing.assert_allclose(excess.eigen_rotation[[0, -1]], [2e-3, 0.0], atol=1e-17)
    free = spin(flow, 1.0)
    step = 1e-4
    near = free.at(13.0 + np.array([0.0, step])).spin
    assert abs(np.diff(near)[0] / step) < 1e-2 * np.abs(free.continuum_spin).max()  # no couple: no slope, beside 1/d of W


def test_short_lengths_follow_the_flow(flow):
    """omega* -> l^2/2 lap W away from the rings: a quarter for half the length."""
    deviations = [np.abs(spin(flow, length).at(np.linspace(15.0, 30.0, 50)).eigen_rotation).max() for length in (0.8, 0.4, 0.2)]
    assert deviations[0] > 3.5 * deviations[1] > 12.0 * deviations[2] > 0.0, deviations


def test_mirrored_rotation(flow):
    other = spin(replace(flow.problem, wall_speed=-1e-2).solve(), 1.0, inner="ring")
    np.testing.assert_allclose(other.at(flow.r).spin, -spin(flow, 1.0, inner="ring").at(flow.r).spin, atol=1e-9)


def test_averages_over_rings(flow):
    found, edges = spin(flow, 1.0, inner="ring"), np.array([13.0, 13.7, 15.0, 20.0])
    averages = found.ring_average(edges)
    for i in range(3):
        r = np.linspace(edges[i], edges[i + 1], 20001)
        here, area = found.at(r), 0.5 * (edges[i + 1] ** 2 - edges[i] ** 2)
        assert averages.spin[i] == pytest.approx(np.trapezoid(here.spin * r, r) / area, rel=1e-6)
        assert averages.continuum_spin[i] == pytest.approx(np.trapezoid(here.continuum_spin * r, r) / area, rel=1e-5)  # rate from g, v
    np.testing.assert_allclose(averages.eigen_rotation, averages.spin - averages.continuum_spin, rtol=1e-14)


def test_spin_of_a_flow_is_half_its_curl():
    flow = RingFlow(13.0, 33.0, LocalMuI(0.26, 1.0), -1e-2, 1.0, elements=128).solve()
    r, step = np.linspace(13.1, 13.8, 9), 1e-4
    curl = ((r + step) * flow.at(r + step).v_phi - (r - step) * flow.at(r - step).v_phi) / (2.0 * step * r)
    np.testing.assert_allclose(continuum_spin(flow.at(r)), 0.5 * curl, rtol=1e-2)  # the slope jumps from element to element
    assert np.all(curl > 0.0)


def test_mesh_points_have_no_twins():
    points = mesh_points(np.linspace(1.0, 3.0, 129))
    assert np.diff(points).min() > 1e-9
    assert (points[0], points[-1]) == (1.0, 3.0)


def test_mesh_and_rings_of_the_flow():
    """A flow on r and phi gives what that on a line gives; grains between rings that turn alike turn like them."""
    problem = RingFlow(13.0, 33.0, Nonlocal(0.26, 1.0, 0.9), 1e-2, 1.0, elements=32, elements_around=8)
    line, plane = (spin(replace(problem, dimension=dimension).solve(), 1.0, inner="ring") for dimension in (1, 2))
    np.testing.assert_allclose(plane.spin, line.spin, atol=1e-6 * np.abs(line.spin).max())
    solid = RingFlow(13.0, 33.0, LocalMuI(0.26, 1.0), 1.3, 1.0, outer_speed=3.3).solve()
    np.testing.assert_allclose(spin(solid, 1.0, inner="ring", outer="ring").spin, 0.1, rtol=1e-6)
    with pytest.raises(InputError, match=r"eccentricity = 0\.5 m"):
        spin(replace(problem, dimension=2, eccentricity=0.5).solve(), 1.0)


def test_bad_input_is_named(flow):
    for arguments, message in (
        ((flow, 0.0), r"spin: length = 0 must be at least 0\.02 m"),
        ((flow, 1.0, "wall"), "spin: inner = .wall. must be None"),
        ((flow, 1.0, None, np.nan), "spin: outer = nan must be a finite number"),
        ((None, 1.0), "spin: the flow is a NoneType"),
    ):
        with pytest.raises(InputError, match=message):
            spin(*arguments)
    with pytest.raises(InputError, match="between 13 and 33"):
        spin(flow, 1.0).at(12.0)
