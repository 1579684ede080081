import numpy as np
import pytest

from anisogran.models import (
    YieldLine,
    failure_lines,
    macro_cohesion,
    mobilised_angle,
    mohr_coulomb_line,
    peak_stress,
    stress_circles,
    total_friction_line,
)
from anisogran.outcome import InputError

ROUNDING = 1e-12


def test_the_line_of_known_circles_comes_back_and_touches_them(rng):
    phi, c = 0.4, 25.0
    p = np.array([50.0, 100.0, 300.0, 500.0])
    line = mohr_coulomb_line(p, peak_stress(p, phi, c))
    assert tuple(line) == pytest.approx((phi, c), rel=1e-11)  # the cohesion is a difference of larger numbers
    two = mohr_coulomb_line(p[:2], peak_stress(p[:2], phi, c))
    assert tuple(two) == pytest.approx((phi, c), rel=1e-11)
    centre, radius = 0.5 * (p + peak_stress(p, phi, c)), 0.5 * (peak_stress(p, phi, c) - p)
    distance = np.cos(phi) * (c + np.tan(phi) * centre)  # of the centre from the line
    np.testing.assert_allclose(distance, radius, rtol=ROUNDING)


def test_a_line_touches_its_circles_in_its_touching_points():
    line, p = YieldLine(0.4, 25.0), np.array([50.0, 300.0])
    circles = stress_circles(p, peak_stress(p, *line))
    sigma, tau = line.touching_points(circles)
    np.testing.assert_allclose(tau, line.shear_stress(sigma), rtol=ROUNDING)
    np.testing.assert_allclose(np.hypot(sigma - circles.centre, tau), circles.radius, rtol=ROUNDING)
    np.testing.assert_allclose(line.excess(circles), 0.0, atol=1e-10)  # of stresses of some hundred
    # and no other point of the circles reaches the line
    sigma, tau = circles.points(1001)
    assert np.all(tau <= line.shear_stress(sigma) * (1 + ROUNDING))
    assert np.all(YieldLine(0.4, 20.0).excess(circles) == pytest.approx(5.0 * np.cos(0.4), rel=1e-10))
    # the plane of the touching point is turned by pi/4 + phi/2 from that of the larger stress, so twice this on the circle
    sigma, tau = line.touching_points(circles)
    np.testing.assert_allclose(np.arctan2(tau, sigma - circles.centre), np.pi / 2 + 0.4, rtol=ROUNDING)


def test_circles_hold_the_stress_on_every_plane():
    circle = stress_circles(100.0, 300.0)
    sigma, tau = circle.points(5)
    angle = np.linspace(0, np.pi / 2, 5)  # of the normal of the plane, from the axis of the larger stress
    normal, along = np.array([np.cos(angle), np.sin(angle)]), np.array([np.sin(angle), -np.cos(angle)])
    t = np.diag([300.0, 100.0])
    np.testing.assert_allclose(sigma, np.einsum("in,ij,jn->n", normal, t, normal), rtol=ROUNDING)
    np.testing.assert_allclose(tau, np.einsum("in,ij,jn->n", along, t, normal), atol=1e-10)
    assert stress_circles([1.0, 2.0], [[3.0], [4.0]]).points(7).shape == (2, 7, 2, 2)
    with pytest.raises(InputError, match="stress_circles: sigma_max must be at least"):
        stress_circles(2.0, 1.0)


def test_internal_and_total_angle_agree_without_cohesion_only():
    p = np.array([100.0, 500.0])
    for c, same in ((0.0, True), (30.0, False)):
        sigma = peak_stress(p, 0.4, c)
        mobilised = mobilised_angle((sigma - p) / (sigma + p))
        total = total_friction_line(p, sigma)
        assert total.c == 0.0
        assert mobilised[1] - ROUNDING <= total.phi <= mobilised[0] + ROUNDING  # a secant, and the lower the higher the pressure
        assert (abs(total.phi - mohr_coulomb_line(p, sigma).phi) < ROUNDING) == same
        assert total_friction_line(p[0], sigma[0]).phi == pytest.approx(mobilised[0], rel=ROUNDING)
    with pytest.raises(InputError, match="needs one or more"):
        total_friction_line([], [])
    with pytest.raises(InputError, match="hold the origin"):
        total_friction_line(-1.0, 2.0)


def test_peak_and_residual_line_come_from_the_same_tests():
    p = np.array([50.0, 100.0, 500.0])
    lines = failure_lines(p, peak_stress(p, 0.5, 40.0), peak_stress(p, 0.35, 0.0))
    assert tuple(lines.peak) == pytest.approx((0.5, 40.0), rel=1e-11)
    assert tuple(lines.residual) == pytest.approx((0.35, 0.0), rel=1e-11, abs=1e-10)
    with pytest.raises(InputError, match="residual = 900 must be at most the peak of its test, 850"):
        failure_lines([100, 500], [240, 850], [200, 900])
    with pytest.raises(InputError, match="two or more circles"):
        failure_lines([100, 500], [240, 850], [200])


@pytest.mark.parametrize(
    ("low", "high", "words"),
    [([100], [200], "two or more"), ([1, 2], [2, 1], "at least sigma_min"), ([1, 2], [4, 3], "same centre"),
     ([100, 90], [200, 400], "inside the other"), ([1, np.nan], [2, 3], "finite")],
)  # fmt: skip
def test_circles_without_a_tangent_are_refused(low, high, words):
    with pytest.raises(InputError, match=words):
        mohr_coulomb_line(low, high)


def test_mobilised_angle_bounds_and_derivative():
    assert mobilised_angle(np.array([0.0, 1.0])).tolist() == [0.0, np.pi / 2]
    assert np.imag(mobilised_angle(0.3 + 1e-30j)) / 1e-30 == pytest.approx(1 / np.sqrt(1 - 0.09), rel=ROUNDING)
    with pytest.raises(InputError, match=r"1\.5 must be at most 1"):
        mobilised_angle([0.1, -1.5])


def test_macro_cohesion():
    assert macro_cohesion(180.0, 5e4, 1e5, 0.0) == 0.0
    assert macro_cohesion(180.0, 1e5, 1e5, 1e5) == 0.0
    assert [macro_cohesion(1.0, 0.5, 1.0, kc) for kc in (0.5, 1, 2, 4)] == pytest.approx([1 / 6, 1 / 4, 1 / 3, 2 / 5], rel=ROUNDING)
    # the factor is the strongest attraction of the contact over k2 delta_max
    k1, k2, kc, delta_max = 3.0, 5.0, 2.0, 0.1
    delta_min = (k2 - k1) / (k2 + kc) * delta_max
    assert macro_cohesion(1.0, k1, k2, kc) == pytest.approx(kc * delta_min / (k2 * delta_max), rel=ROUNDING)
    with pytest.raises(InputError, match="k1 = 2 must be at most 1"):
        macro_cohesion(1.0, 2.0, 1.0, 1.0)
