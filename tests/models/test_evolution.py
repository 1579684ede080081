import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from anisogran.models import relax
from anisogran.outcome import InputError

ROUNDING = 1e-12  # a few operations on numbers of order one, each good to 2e-16


def test_monotonic_loading_is_the_exponential_of_the_lecture():
    eps_D = np.linspace(0.0, 0.2, 50)
    np.testing.assert_allclose(relax(0.05, 0.4, 60.0, eps_D), 0.4 - 0.35 * np.exp(-60.0 * eps_D), rtol=ROUNDING)


@pytest.mark.parametrize("kind", [float, complex])
def test_limits_are_exact(kind):
    assert relax(kind(0.3), 0.4, 0.0, 0.1) == 0.3  # beta = 0
    assert relax(kind(0.3), 0.4, 50.0, 0.0) == 0.3  # no increment
    assert relax(kind(0.0), 0.0, 50.0, 0.1) == 0.0  # x_max = 0
    assert relax(kind(0.5), -0.4, 1e300, 1e3) == pytest.approx(-0.4, rel=ROUNDING)  # negative limit, endless strain


def test_reversal_relaxes_towards_the_negative_limit_and_starts_steep():
    beta, s_max, s = 60.0, 0.4, 0.3
    assert relax(s, s_max, beta, -1e3) == pytest.approx(-s_max, rel=ROUNDING)
    slope = (s - relax(s, s_max, beta, -1e-9)) / 1e-9
    assert slope == pytest.approx(beta * (s_max + s), rel=1e-6)  # difference quotient: 1e-9 * beta and rounding/1e-9


def test_a_start_above_the_limit_comes_down_monotonically():
    s = relax(0.6, 0.4, 30.0, np.linspace(0.0, 1.0, 100))
    assert np.all(np.diff(s) <= 0.0)
    assert np.all(s >= 0.4 * (1 - ROUNDING))


def test_derivatives_by_complex_step():
    h = 1e-30
    for d in (0.02, 0.0, -0.02):
        sense = -1.0 if d < 0 else 1.0
        exact = 60.0 * (0.4 * sense - 0.1) * np.exp(-60.0 * abs(d)) * sense
        assert np.imag(relax(0.1, 0.4, 60.0, d + 1j * h)) / h == pytest.approx(exact, rel=ROUNDING)


def test_negative_beta_is_refused():
    with pytest.raises(InputError, match="beta = -1 must be at least 0"):
        relax(0.0, 0.4, [1.0, -1.0], 0.1)


amounts = st.floats(-0.9, 0.9)


@settings(derandomize=True, max_examples=60, deadline=None)
@given(amounts, amounts, st.floats(0.0, 1e4), st.lists(st.floats(-1.0, 1.0), min_size=1, max_size=20))
def test_any_path_stays_between_start_and_limits_and_steps_may_be_split(x0, x_max, beta, path):
    x, bound = x0, max(abs(x0), abs(x_max))
    for d in path:
        halves = relax(relax(x, x_max, beta, 0.5 * d), x_max, beta, 0.5 * d)
        x = relax(x, x_max, beta, d)
        assert abs(x) <= bound * (1 + ROUNDING)
        assert halves == pytest.approx(x, abs=ROUNDING)
