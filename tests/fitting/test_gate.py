"""Fits that a minimiser calls a success and that must not pass, and the good one that must."""

from math import isnan

import numpy as np
import pytest

from anisogran.fitting import relaxation
from anisogran.fitting.gate import Evidence, Source, Verdict, judge
from anisogran.outcome import InputError

TRUTH = {"s_0": 0.0, "s_max": 0.4, "beta": 80.0}


@pytest.fixture
def strain():
    return np.linspace(0.0, 0.1, 60)


@pytest.fixture
def noise(rng):
    return 0.005 * rng.normal(size=60)


def curve(x):
    return 0.4 * (1.0 - np.exp(-80.0 * x))


def rejected(result, words, *undetermined):
    assert not result.verdict
    assert words in str(result.verdict)
    assert "\n" not in str(result.verdict)
    for name in undetermined:
        assert isnan(result.errors[name])


def test_the_good_case_passes(strain, noise):
    result = relaxation(strain, curve(strain) + noise)
    assert result.verdict, str(result)
    assert str(result.verdict) == "trustworthy"
    for name, value in TRUTH.items():
        assert abs(result.values[name] - value) < 4 * result.errors[name]  # four standard errors, the seed is fixed
    assert abs(result.correlations["s_max", "beta"]) < 0.7
    assert result.residuals["condition"] < 20


def test_data_without_noise_pass(strain):
    result = relaxation(strain, curve(strain))
    assert result.verdict
    assert result.residuals["correlation_time"] == 1.0  # what the minimiser leaves is no noise and has no memory
    assert result.values["beta"] == pytest.approx(80.0, rel=1e-8)  # tolerance of the minimiser 1e-12, square root of rounding in chi^2


def test_all_zeros(strain):
    rejected(relaxation(strain, 0 * strain), "signal", *TRUTH)


@pytest.mark.parametrize("part", [0.0, 1.0])
def test_a_constant(strain, noise, part):
    rejected(relaxation(strain, 0.3 + part * noise), "signal", *TRUTH)


def test_two_points(strain):
    with pytest.raises(InputError, match=r"2 finite points \(of 2\) cannot determine 3"):
        relaxation(strain[:2], strain[:2])


@pytest.mark.parametrize("beta", [5e3, 1.0])
def test_a_bad_start_is_overruled_by_the_others(strain, noise, beta):
    data = strain, curve(strain) + noise
    result = relaxation(*data, start={"s_0": 0.0, "s_max": 0.4, "beta": beta})
    assert result.verdict
    assert result.values == pytest.approx(relaxation(*data).values, rel=1e-5)  # minimiser tolerance 1e-12 in chi^2, flat bottom
    assert len(result.starts) == 13


def test_a_local_minimum_is_no_answer():
    source = Source("run", 60, 1.0, 0.1, ("b",))
    good = Evidence((source,), 57.0, {"b": 1.0}, {"b": 0.1}, {"b": 1.0}, {}, (), 5.0, 1.0, (1.0,) * 8)
    assert judge(good) == ((), set())
    reasons, undetermined = judge(good._replace(chi_square=59.0))
    assert "chi^2 is 59 times the lowest" in reasons[0]
    assert undetermined == {"b"}
    for change, words in (
        ({"sources": (source._replace(points=4),)}, "only 4 points"),
        ({"free": -1.0}, "so correlated"),
        ({"errors": {"b": 0.6}}, "uncertain by 0.6"),
        ({"errors": {"b": float("nan")}}, "no error bar"),
        ({"errors": {"b": 0.3}, "free": 2.0}, "uncertain by 0.3 with 2 degrees of freedom"),  # Student's t is 4.3, not 2
        ({"condition": 1e4}, "do not tell the parameters apart"),
        ({"at_bound": ("b",)}, "at the bound"),
        ({"sources": (source._replace(noise=0.5),)}, "not above 3 times"),
        ({"all_chi_squares": (1.0,)}, "only 1 starts"),
        ({"correlations": {("b", "b"): -0.99}}, "not separated"),
    ):
        reasons, undetermined = judge(good._replace(**change))
        assert words in "; ".join(reasons)
        assert undetermined == {"b"}


def test_plateau_only(strain, noise):
    rejected(relaxation(0.2 + strain, curve(0.2 + strain) + noise), "not above 3 times the noise", "beta")


def test_initial_slope_only(strain, noise):
    result = relaxation(0.02 * strain, curve(0.02 * strain) + 0.01 * noise)
    rejected(result, "only the initial slope beta (s_max - s_0) = 3", "s_max", "beta")
    assert result.values["beta"] * (result.values["s_max"] - result.values["s_0"]) == pytest.approx(32.0, rel=0.02)  # noise
    assert result.errors["s_0"] < 1e-4


def test_one_outlier_of_five(strain):
    s = curve(strain[::12])
    s[2] *= 2
    rejected(relaxation(strain[::12], s), "only 5 points, at least 15", *TRUTH)


def test_one_nan_is_dropped_and_counted(strain, noise):
    s = curve(strain) + noise
    s[3] = np.nan
    result = relaxation(strain, s)
    assert result.verdict
    assert (result.dropped, result.points) == (1, 59)
    assert "1 points dropped" in str(result.verdict)


@pytest.mark.parametrize(
    ("x", "y", "words"),
    [
        ([], [], "0 finite points"),
        ([1.0], [1.0], "1 finite points"),
        (np.arange(5), np.full(5, np.nan), "0 finite points .of 5."),
        (np.arange(5), np.arange(4), r"shapes \(5,\), \(4,\)"),
        (np.ones((5, 5)), np.ones((5, 5)), "rows of one length"),
        (np.ones(20), np.arange(20), "same abscissa 1"),
        (["a"] * 20, np.arange(20), "x must be a row of real numbers"),
        (np.arange(20), 1j * np.arange(20), "y must be a row of real numbers"),
    ],
)
def test_what_cannot_be_fitted_is_refused_by_name(x, y, words):
    with pytest.raises(InputError, match=words):
        relaxation(x, y)


def test_a_verdict_reads_as_one_line():
    assert str(Verdict(("one", "two"), ("three",))) == "not trustworthy: one; two; three"
    assert not Verdict(("one",))
    many = tuple(f"{number}" for number in range(9))
    assert str(Verdict(many, many)) == "not trustworthy: 0; 1; 2; 3; 4; 5; 6; and 2 more; 0; 1; 2; 3; 4; 5; and 3 more"
