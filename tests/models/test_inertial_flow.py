import numpy as np
import pytest

from anisogran.models import (
    I_of_area_fraction,
    area_fraction_of_I,
    cooperativity_length,
    g_local,
    inertial_number,
    mu_linear,
    mu_of_I,
    mu_regularised,
    viscosity,
)
from anisogran.outcome import InputError

LAW = 0.342, 0.557, 0.069
ROUNDING = 1e-12
P, M = 100.0, 4e-6


def test_viscosity_is_shear_stress_over_shear_rate():
    rate = np.array([0.1, 10.0, 1e3])
    I = inertial_number(rate, P, M)
    np.testing.assert_allclose(I, rate * 2e-4, rtol=ROUNDING)
    np.testing.assert_allclose(viscosity(I, P, M, mu_of_I, *LAW), mu_of_I(I, *LAW) * P / rate, rtol=ROUNDING)
    np.testing.assert_allclose(viscosity(I, P, M, mu_linear, mu_s=0.0, b=1.1), 1.1 * np.sqrt(P * M), rtol=ROUNDING)
    batch = viscosity(I[:, None], np.array([P, 4 * P]), M, mu_of_I, *LAW)
    np.testing.assert_allclose(batch[:, 1], 2 * batch[:, 0], rtol=ROUNDING)


def test_viscosity_without_flow_is_infinite_unless_a_floor_is_given():
    assert viscosity(0.0, P, M, mu_of_I, *LAW) == np.inf
    assert viscosity(1e300, P, M, mu_of_I, *LAW) < 1e-300
    floored = viscosity(np.array([0.0, 1e-6, 0.1, 1e300]), P, M, mu_of_I, *LAW, I_floor=1e-6)
    I = np.array([1e-6, np.sqrt(2) * 1e-6, 0.1, 1e300])
    np.testing.assert_allclose(floored, viscosity(I, P, M, mu_of_I, *LAW), rtol=1e-10)  # 0.1 with the floor: 5e-11 aside
    with pytest.raises(InputError, match="0/0"):
        viscosity([0.1, 0.0], P, M, mu_regularised, *LAW)
    assert np.isfinite(viscosity(0.0, P, M, mu_regularised, *LAW, I_floor=1e-6))
    assert np.isnan(viscosity(np.nan, P, M, mu_of_I, *LAW))


def test_the_area_fraction_falls_with_the_inertial_number():
    I = np.array([0.0, 0.05, 0.2])
    nu = area_fraction_of_I(I, 0.81, 0.3)
    assert nu.tolist() == pytest.approx([0.81, 0.795, 0.75], rel=ROUNDING)
    np.testing.assert_allclose(I_of_area_fraction(nu, 0.81, 0.3), I, atol=ROUNDING)
    assert I_of_area_fraction(0.83, 0.81, 0.3) == 0.0
    with pytest.raises(InputError, match="nu_max - a I = -2e\\+299 must be above 0"):
        area_fraction_of_I(np.array([0.1, 1e300]), 0.81, 0.2)


def test_the_local_fluidity_is_shear_rate_over_stress_ratio():
    mu_s, b = 0.26, 1.1
    I = np.array([1e-3, 0.05, 0.2])
    mu, rate = mu_linear(I, mu_s, b), I * np.sqrt(P / M)
    np.testing.assert_allclose(g_local(mu, P, M, mu_s, b), rate / mu, rtol=1e-11)  # mu - mu_s loses two digits
    np.testing.assert_allclose(g_local(mu, P, M, mu_s, b) * viscosity(I, P, M, mu_linear, mu_s, b), P, rtol=1e-11)  # eta = p/g
    assert g_local([0.0, 0.1, mu_s], P, M, mu_s, b).tolist() == [0.0, 0.0, 0.0]
    assert g_local(0.5, 0.0, M, mu_s, b) == 0.0


def test_grains_cooperate_over_any_distance_at_the_static_friction():
    xi = cooperativity_length(np.array([0.0, 0.25, 0.26, 0.27]), 2.0, 0.26, 0.9)
    assert xi.tolist() == pytest.approx([1.8 / np.sqrt(0.26), 18.0, np.inf, 18.0], rel=ROUNDING)
    for mu in (0.1, 0.4):
        slope = np.imag(cooperativity_length(mu + 1e-30j, 1.0, 0.26, 0.9)) / 1e-30
        assert slope == pytest.approx(0.45 * np.sign(0.26 - mu) * abs(mu - 0.26) ** -1.5, rel=ROUNDING)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: inertial_number(1.0, 0.0, M), "inertial_number: pressure = 0 must be above 0"),
        (lambda: inertial_number(-1.0, P, M), "shear_rate = -1 must be at least 0"),
        (lambda: inertial_number(1.0, P, [M, 0.0]), "mass = 0 must be above 0"),
        (lambda: viscosity(-0.1, P, M, mu_of_I, *LAW), r"I = -0\.1 must be at least 0"),
        (lambda: viscosity(0.1, -P, M, mu_of_I, *LAW), "viscosity: pressure = -100 must be at least 0"),
        (lambda: viscosity(0.1, P, -M, mu_of_I, *LAW), "viscosity: mass = -4e-06 must be above 0"),
        (lambda: viscosity(0.1, P, M, mu_of_I, *LAW, I_floor=-1.0), "I_floor = -1 must be at least 0"),
        (lambda: I_of_area_fraction(0.0, 0.81, 0.3), "nu = 0 must be above 0"),
        (lambda: I_of_area_fraction(0.8, 0.81, 0.0), "a = 0 must be above 0"),
        (lambda: g_local(-0.1, P, M, 0.26, 1.0), r"mu = -0\.1 must be at least 0"),
        (lambda: g_local(0.1, -P, M, 0.26, 1.0), "pressure = -100 must be at least 0"),
        (lambda: cooperativity_length(-0.1, 1.0, 0.26, 0.9), r"mu = -0\.1 must be at least 0"),
    ],
)
def test_bad_flow_is_named(call, words):
    with pytest.raises(InputError, match=words):
        call()
