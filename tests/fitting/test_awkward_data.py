"""Data as they come: labelled, repeated, of a million points, of another law."""

import numpy as np
import pytest

from anisogran.fitting import DataSet, mu_of_I, relaxation, relaxations
from anisogran.fitting.least_squares import Parameter, fit_curve
from anisogran.fitting.observations import observations
from anisogran.models import mu_of_I as saturating_law
from anisogran.outcome import NotConverged

STRAIN = np.linspace(0.0, 0.1, 100)
CURVE = 0.4 - 0.35 * np.exp(-60.0 * STRAIN)


class Column:
    """What a column of a table offers: values behind `__array__`, labels of its own, no positional slices."""

    def __init__(self, values):
        self._values = np.asarray(values)
        self.index = np.arange(100, 100 + self._values.size)

    def __array__(self, dtype=None, copy=None):
        return np.array(self._values, dtype=dtype)

    def __len__(self):
        return self._values.size

    def __getitem__(self, label):
        return self._values[label - 100]


def test_a_column_of_a_table_is_a_row_of_numbers(rng):
    y = CURVE + 0.01 * rng.normal(size=100)
    assert relaxation(Column(STRAIN), Column(y), Column(np.full(100, 0.01))).values == relaxation(STRAIN, y, np.full(100, 0.01)).values
    assert relaxations([DataSet(Column(STRAIN), Column(y))]).values == relaxation(STRAIN, y).values


def test_several_measurements_at_one_abscissa_are_no_copies(rng):
    x = np.repeat(np.linspace(0.0, 0.1, 25), 4)
    result = relaxation(x, 0.4 - 0.35 * np.exp(-60.0 * x) + 0.01 * rng.normal(size=100))
    assert result.verdict, str(result)
    assert "copies" not in str(result.verdict)


def test_a_hundred_thousand_points(rng):
    x = np.linspace(0.0, 0.1, 100_000)
    result = relaxation(x, 0.4 - 0.35 * np.exp(-60.0 * x) + 0.02 * rng.normal(size=x.size))
    assert result.verdict
    for name, value in {"s_0": 0.05, "s_max": 0.4, "beta": 60.0}.items():
        assert abs(result.values[name] - value) < 4 * result.errors[name]  # four standard errors, fixed seed
    assert result.errors["beta"] == pytest.approx(0.10, rel=0.05)  # linear theory; the scatter of 1e5 points and of tau


def test_a_wrong_law_for_independent_points_has_no_errors(rng):
    I = np.geomspace(1e-3, 2.0, 40)
    result = mu_of_I(I, saturating_law(I, 0.25, 0.55, 0.2) + 0.003 * rng.normal(size=40))
    assert "the law is wrong for independent points: long runs of one sign" in str(result.verdict)
    assert not result.verdict
    assert np.isnan(result.errors["b"])


def test_points_that_alternate_are_no_wrong_law():
    I = np.linspace(0.01, 0.2, 40)
    assert mu_of_I(I, 0.26 + I + 0.01 * (-1.0) ** np.arange(40)).verdict


def test_a_curve_without_finite_values_is_named():
    x = np.linspace(1.0, 2.0, 20)
    data = observations("test", x, x, None, parameters=1)
    with pytest.raises(NotConverged, match="no finite values from any of the starts"):
        fit_curve(
            "y = nan", lambda x, a: a * x * np.nan, (Parameter("a", 1.0, 0.1, 10.0),), data, [(1.0,)], scales=(1.0, 1.0), series=False
        )


def test_a_start_without_finite_values_is_passed_over():
    x = np.linspace(1.0, 2.0, 20)
    data = observations("test", x, 2.0 * x, None, parameters=1)

    def curve(x, a):
        return a * x if np.real(a) < 5.0 else np.full(x.shape, np.inf) * a

    starts = [(a,) for a in (0.5, 1.0, 1.5, 3.0, 4.0, 6.0, 7.0, 8.0)]
    result = fit_curve("y = a x", curve, (Parameter("a", 1.0, 0.1, 10.0),), data, starts, scales=(1.0, 1.0), series=False)
    assert result.values["a"] == pytest.approx(2.0, rel=1e-9)  # linear
