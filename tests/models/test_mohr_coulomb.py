import numpy as np
import pytest

from anisogran.models import macro_cohesion, mobilised_angle, mohr_coulomb_line, peak_stress
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


def test_tangent_and_secant_angle_agree_without_cohesion_only():
    for c, same in ((0.0, True), (30.0, False)):
        sigma = peak_stress(100.0, 0.4, c)
        secant = mobilised_angle((sigma - 100) / (sigma + 100))
        assert (abs(secant - 0.4) < ROUNDING) == same


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
