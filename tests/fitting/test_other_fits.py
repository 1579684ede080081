from math import isnan

import numpy as np
import pytest

from anisogran.fitting import exponential_decay, mohr_coulomb, mu_of_I, shear_band
from anisogran.models import mohr_coulomb_line, mu_linear, peak_stress
from anisogran.models import mu_of_I as saturating_law
from anisogran.outcome import InputError

MINIMISER = 1e-6  # root of its tolerance of 1e-12


def near(result, **truth):
    assert result.verdict, str(result)
    for name, value in truth.items():
        assert abs(result.values[name] - value) < 4 * result.errors[name], str(result)  # four standard errors, fixed seed


def test_mohr_coulomb_exact_and_noisy(rng):
    p = np.repeat([100.0, 200.0, 300.0, 400.0, 500.0], 3)
    exact = mohr_coulomb(p, peak_stress(p, 0.23, 40.0))
    assert list(exact.values.values()) == pytest.approx([0.23, 40.0], rel=MINIMISER)
    noisy = mohr_coulomb(p, peak_stress(p, 0.23, 40.0) + 5 * rng.normal(size=15))
    near(noisy, phi=0.23, c=40.0)
    near(mohr_coulomb(p, peak_stress(p, 0.23, 0.0) + 5 * rng.normal(size=15)), c=0.0)  # no cohesion is an answer too


def test_two_circles_are_the_tangent_but_no_fit():
    result = mohr_coulomb([100, 500], [183, 798])
    line = mohr_coulomb_line([100, 500], [183, 798])
    assert list(result.values.values()) == pytest.approx(list(line), rel=MINIMISER)
    assert "only 2 points, at least 10" in str(result.verdict)
    assert all(isnan(error) for error in result.errors.values())


def test_linear_friction_law(rng):
    I = np.geomspace(1e-3, 0.2, 12)
    errors = 0.002 * (1 + 5 * I)
    result = mu_of_I(I, mu_linear(I, 0.26, 1.0) + errors * rng.normal(size=12), errors)
    near(result, mu_s=0.26, b=1.0)
    np.testing.assert_allclose(result.predict(I), mu_linear(I, **result.values), rtol=1e-15)


def test_saturating_friction_law(rng):
    I = np.geomspace(1e-3, 2.0, 25)
    near(
        mu_of_I(I, saturating_law(I, 0.25, 0.55, 0.2) + 0.003 * rng.normal(size=25), law="saturating"),
        mu_s=0.25,
        mu_d=0.55,
        I0=0.2,
    )
    slow = I[I < 0.02]  # here only the slope (mu_d - mu_s)/I0 is seen
    result = mu_of_I(slow, saturating_law(slow, 0.25, 0.55, 0.2) + 1e-3 * rng.normal(size=slow.size), law="saturating")
    assert not result.verdict
    assert isnan(result.errors["I0"])
    with pytest.raises(InputError, match="law = 'cubic'"):
        mu_of_I(I, I, law="cubic")
    with pytest.raises(InputError, match="I = -1 must be"):
        mu_of_I([-1.0, 1.0, 2.0], [1, 2, 3])


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_exponential_decay_in_logarithms(rng, sign):
    x = np.linspace(0, 10, 40)
    v = sign * 3.0 * np.exp(-x / 1.7) * np.exp(0.1 * rng.normal(size=40))
    v[[7, 9]] *= -1.0  # wrong sign: no logarithm
    result = exponential_decay(x, v)
    near(result, amplitude=sign * 3.0, length=1.7)
    assert result.dropped == 2
    np.testing.assert_allclose(result.predict(x), sign * 3.0 * np.exp(-x / 1.7), rtol=0.3)  # the noise
    assert all(error > 0 for error in result.errors.values())


def test_exponential_decay_with_errors_uses_the_floor_too(rng):
    x = np.linspace(0, 10, 40)
    near(exponential_decay(x, 3.0 * np.exp(-x / 1.7) + 0.01 * rng.normal(size=40), np.full(40, 0.01)), amplitude=3.0, length=1.7)


def test_exponential_decay_refuses_what_has_no_logarithm():
    with pytest.raises(InputError, match="fewer than 2 points of one sign"):
        exponential_decay([0.0, 1.0, 2.0], [0.0, 0.0, 0.0])
    assert not exponential_decay([0.0, 1.0], [1.0, 0.5]).verdict  # two points, two parameters


def test_shear_band(rng):
    r = np.linspace(0.07, 0.11, 60)
    omega = 0.01 + 0.05 * np.tanh(1.2 * (r - 0.085) / 0.006) / 2  # close to an error function, but not one
    result = shear_band(r, omega + 5e-4 * rng.normal(size=60))
    assert result.verdict, str(result)
    assert result.values["centre"] == pytest.approx(0.085, abs=2e-4)
    assert result.values["width"] == pytest.approx(0.006, rel=0.1)  # tanh(1.2 x) against erf(x)
    assert not shear_band(r, 0.01 + 5e-4 * rng.normal(size=60)).verdict
