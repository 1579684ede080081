import numpy as np
import pytest

from anisogran.fitting import area_fraction
from anisogran.outcome import InputError


def test_area_fraction_falls_with_the_inertial_number(rng):
    I = np.geomspace(1e-3, 0.2, 14)
    exact = area_fraction(I, 0.81 - 0.3 * I)
    assert list(exact.values.values()) == pytest.approx([0.81, 0.3], rel=1e-6)  # minimiser: root of 1e-12
    assert exact.verdict
    errors = 0.001 * (1 + 5 * I)
    result = area_fraction(I, 0.81 - 0.3 * I + errors * rng.normal(size=14), errors)
    assert result.verdict
    for name, value in {"nu_max": 0.81, "a": 0.3}.items():
        assert abs(result.values[name] - value) < 4 * result.errors[name]  # four standard errors, fixed seed
    np.testing.assert_allclose(result.predict(I), result.values["nu_max"] - result.values["a"] * I, rtol=1e-15)


def test_frictionless_flow_that_does_not_dilate_has_no_slope(rng):
    result = area_fraction(np.geomspace(1e-3, 0.2, 14), 0.84 + 1e-3 * rng.normal(size=14))
    assert not result.verdict
    assert np.isnan(result.errors["a"])


def test_what_is_no_area_fraction_is_refused():
    I = np.linspace(0.01, 0.1, 12)
    with pytest.raises(InputError, match=r"nu = 1\.2 must be above 0 and at most 1"):
        area_fraction(I, np.full(12, 1.2))
    with pytest.raises(InputError, match="I = -1 must be at least 0"):
        area_fraction([-1.0, 0.1, 0.2], [0.8, 0.8, 0.8])
