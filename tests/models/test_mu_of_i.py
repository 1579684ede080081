import numpy as np
import pytest

from anisogran.models import ill_posed, mu_linear, mu_of_I, mu_regularised, neutral_inertial_numbers, well_posedness
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


def test_well_posed_ranges():
    # the neutral numbers belong to laws evaluated by others too; 3 digits are given
    assert neutral_inertial_numbers(*LAW) == pytest.approx((0.00397, 0.280), rel=2e-3)
    I1, I2 = neutral_inertial_numbers(*LAW)
    assert ill_posed(np.array([0.999 * I1, 1.001 * I1, 0.999 * I2, 1.001 * I2]), *LAW).tolist() == [True, False, False, True]
    for (mu_s, b), (low, high) in {(0.25, 1.1): (0.0037, 0.97), (0.26, 1.0): (0.0046, 1.07), (0.11, 2.0): (1.7e-4, 0.49)}.items():
        for I, sign in ((0.95 * low, 1), (1.05 * low, -1), (0.98 * high, -1), (1.02 * high, 1)):
            assert np.sign(well_posedness(I, mu_linear(I, mu_s, b), b)) == sign  # two digits given: 5 % and 2 % aside


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
