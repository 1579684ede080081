import numpy as np
import pytest

from anisogran.models import (
    I_linear,
    I_of_mu,
    ill_posed,
    mu_linear,
    mu_of_I,
    mu_regularised,
    neutral_inertial_numbers,
    well_posed_ranges,
    well_posedness,
    within_linear_range,
)
from anisogran.outcome import InputError

LAW = 0.342, 0.557, 0.069
ROUNDING = 1e-12


def test_limits_at_rest_and_at_any_speed():
    I = np.array([0.0, LAW[2], 1e300])
    np.testing.assert_allclose(mu_of_I(I, *LAW), [0.342, 0.4495, 0.557], rtol=ROUNDING)
    assert mu_of_I(1e300, *LAW) == 0.557
    assert mu_linear(I, 0.26, 1.0).tolist() == [0.26, 0.329, 1e300]
    assert np.all(np.isfinite(mu_regularised(I, *LAW)))
    assert mu_regularised(0.0, *LAW) == 0.0  # no yield stress is left
    assert np.isnan(mu_regularised(np.nan, *LAW))  # a NaN is not hidden
    assert ill_posed(I, *LAW).tolist() == [True, False, True]


def test_the_inverse_laws_give_the_inertial_number_back():
    I = np.array([0.0, 1e-3, 0.1, 5.0])
    np.testing.assert_allclose(I_of_mu(mu_of_I(I, *LAW), *LAW), I, rtol=1e-10, atol=ROUNDING)  # mu_d - mu loses two digits at I = 5
    np.testing.assert_allclose(I_linear(mu_linear(I, 0.26, 1.1), 0.26, 1.1), I, rtol=ROUNDING, atol=ROUNDING)
    assert I_linear(0.1, 0.26, 1.1) == I_of_mu(0.0, *LAW) == 0.0  # no flow below mu_s
    assert np.isnan(I_of_mu(np.nan, *LAW))
    for mu in (0.557, 0.6):
        with pytest.raises(InputError, match=r"must be below mu_d = 0\.557"):
            I_of_mu(mu, *LAW)
    for inverse in (lambda mu: I_of_mu(mu, *LAW), lambda mu: I_linear(mu, 0.26, 1.1)):
        with pytest.raises(InputError, match=r"mu = -0\.1 must be at least 0"):
            inverse([0.3, -0.1])


def test_the_linear_law_tells_where_it_ends():
    assert within_linear_range([0.0, 1e-3, 0.2, 0.2001, 1e300, np.nan]).tolist() == [True, True, True, False, False, False]
    assert within_linear_range(0.1)


def test_well_posed_ranges():
    # the neutral numbers belong to laws evaluated by others too; 3 digits are given, and two or three for the linear law
    assert neutral_inertial_numbers(*LAW) == pytest.approx((0.00397, 0.280), rel=2e-3)
    assert neutral_inertial_numbers(np.tan(np.radians(20.9)), np.tan(np.radians(32.76)), 0.279) == pytest.approx((0.0194, 0.852), rel=3e-3)
    I1, I2 = neutral_inertial_numbers(*LAW)
    assert ill_posed(np.array([0.999 * I1, 1.001 * I1, 0.999 * I2, 1.001 * I2]), *LAW).tolist() == [True, False, False, True]
    for law, ends in {
        (0.25, 1.1): (0.0037, 0.97),
        (0.26, 1.0): (0.0046, 1.07),
        (0.277, 0.9): (0.0063, 1.18),
        (0.11, 2.0): (1.7e-4, 0.49),
    }.items():
        (found,) = well_posed_ranges(mu_linear, *law)
        assert found == pytest.approx(ends, rel=0.02)
        np.testing.assert_allclose(well_posedness(found, mu_linear, *law), 0.0, atol=1e-11)  # a range is exact to rounding
    assert well_posed_ranges(mu_linear, 0.25, 0.0) == []  # mu'(I) = 0: ill posed everywhere


def test_the_regularised_law_is_well_posed_from_rest_to_a_large_number():
    mu_s, mu_d, I0 = LAW
    up, down, I = np.polynomial.Polynomial([mu_s * I0, mu_d, 0.05]), np.polynomial.Polynomial([I0, 1.0]), np.polynomial.Polynomial([0, 1])
    slope = I * (up.deriv() * down - up)  # mu = up/down, I mu' = slope/down^2
    roots = (4 * slope**2 * down**2 - 4 * slope * up * down**3 + up**2 * (up * down - slope / 2) ** 2).roots()  # of C mu^2 down^6
    largest_root = max(root.real for root in roots if abs(root.imag) < 1e-9)
    ((low, high),) = well_posed_ranges(mu_regularised, *LAW)
    assert low == 1e-8  # the end of the search
    assert high == pytest.approx(largest_root, rel=1e-10)  # the root of a polynomial of degree 8 has lost some digits
    assert well_posed_ranges(mu_regularised, *LAW, mu_inf=0.0)[0][1] == pytest.approx(neutral_inertial_numbers(*LAW)[1], rel=1e-9)
    I = np.array([1e-300, 1e-100, 1e-8])  # creep: n = mu^2/(2 alpha)
    mu, n = mu_regularised(I, *LAW), mu_regularised(I, *LAW) ** 2 / 3.8
    expected = 4 * n**2 - 4 * n + mu**2 * (1 - n / 2) ** 2
    np.testing.assert_allclose(well_posedness(I, mu_regularised, *LAW), expected, rtol=1e-10)  # terms cancel twentyfold
    assert np.all(expected < 0.0)


def test_well_posedness_of_any_law_by_its_definition():
    I = np.array([1e-6, 0.01, 0.3, 40.0])
    for law, n in (
        (lambda I: 0.3 * I**0.4, 0.4),  # a power law
        (lambda I: mu_of_I(I, *LAW), 0.215 * 0.069 * I / (0.069 + I) ** 2 / mu_of_I(I, *LAW)),
    ):
        C = 4 * n**2 - 4 * n + law(I) ** 2 * (1 - n / 2) ** 2
        np.testing.assert_allclose(well_posedness(I, law), C, rtol=1e-11, atol=1e-14)
    assert well_posedness(1e300, mu_linear, 0.26, 1.0) == np.inf
    assert well_posedness(1e300, mu_of_I, *LAW) == pytest.approx(0.557**2, rel=ROUNDING)
    with pytest.raises(InputError, match="mu = 0 at I = 0 must be above 0"):
        well_posedness([0.1, 0.0], mu_regularised, *LAW)
    with pytest.raises(InputError, match="I_max = 1e-09 must be above"):
        well_posed_ranges(mu_linear, 0.26, 1.0, I_max=1e-9)


def test_regularised_law_has_its_known_values_and_no_jump():
    I1, _ = neutral_inertial_numbers(*LAW)
    assert pytest.approx(0.003972, rel=1e-3) == I1  # digits given
    assert mu_regularised(I1, *LAW) == pytest.approx(0.35371, rel=2e-5)
    assert mu_regularised(1e-6, *LAW) == pytest.approx(0.2845, rel=2e-4)
    assert mu_regularised(I1 * (1 + 1e-12), *LAW) == pytest.approx(mu_regularised(I1, *LAW), rel=1e-11)
    creep = np.geomspace(1e-12, I1, 20)
    assert np.all(np.diff(mu_regularised(creep, *LAW)) > 0)


@pytest.mark.parametrize("law", [lambda I: mu_linear(I, 0.26, 1.0), lambda I: mu_of_I(I, *LAW), lambda I: mu_regularised(I, *LAW)])
def test_complex_step_is_the_slope(law):
    for I in (1e-4, 0.1, 10.0):
        h = 1e-6 * I
        difference = (law(I + h) - law(I - h)) / (2 * h)
        assert np.imag(law(I + 1e-30j)) / 1e-30 == pytest.approx(difference, rel=1e-6)  # rounding 1e-16/1e-6 over I mu'/mu > 1e-3


def test_bad_input_is_named():
    for law in (lambda I: mu_linear(I, 0.2, 1.0), lambda I: mu_of_I(I, *LAW), lambda I: mu_regularised(I, *LAW)):
        with pytest.raises(InputError, match=r"I = -0\.1 must be at least 0"):
            law(np.array([0.1, -0.1]))
    with pytest.raises(InputError, match="alpha = 2 must be below 2"):
        mu_regularised(0.1, *LAW, alpha=2.0)
    with pytest.raises(InputError, match="no bounded well-posed range"):
        neutral_inertial_numbers(3.0, 3.1, 0.1)
