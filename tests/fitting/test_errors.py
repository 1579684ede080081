"""Errors in three steps: covariance, profile likelihood, block bootstrap."""

from math import inf, isinf, isnan

import numpy as np
import pytest

from anisogran.fitting import DataSet, exponential_decay, mohr_coulomb, mu_of_I, relaxation, relaxations
from anisogran.models import mu_of_I as mu_saturating
from anisogran.models import peak_stress
from anisogran.outcome import InputError

STRAIN = np.linspace(0.0, 0.1, 100)
CURVE = 0.4 - 0.35 * np.exp(-60.0 * STRAIN)


@pytest.fixture
def line(rng):
    """A law that is linear in its parameters, white noise."""
    I = np.linspace(0.01, 0.2, 40)
    return mu_of_I(I, 0.26 + I + 0.01 * rng.normal(size=40))


def test_the_profile_of_a_linear_law_is_the_interval_of_the_covariance(line):
    for name in ("mu_s", "b"):
        profile = line.profile(name, 0.9)
        assert profile.outcome == ""
        assert profile[:2] == pytest.approx(line.interval(name, 0.9), rel=1e-4)  # the limit is sought to 1e-4 of the half-width


def test_the_profile_of_the_cohesion_is_that_of_the_fisher_test(rng):
    """By hand: the other parameter is scanned, and chi^2 at the limit is t^2 variances above its minimum."""
    p = np.linspace(100.0, 500.0, 15)
    sigma = peak_stress(p, 0.23, 40.0) + 20.0 * rng.normal(size=15)
    result = mohr_coulomb(p, sigma)
    variance = np.sum((result.predict(p) - sigma) ** 2) / 13
    for c in result.profile("c")[:2]:
        angles = np.linspace(0.0, 0.5, 20001)
        lowest = np.min(np.sum((peak_stress(p[:, None], angles, c) - sigma[:, None]) ** 2, axis=0))
        assert lowest - variance * 13 == pytest.approx(2.1604**2 * variance, rel=1e-3)  # t of 13 degrees at 95 %; the grid of angles


def test_a_law_that_bends_has_lopsided_limits(rng):
    result = relaxation(STRAIN[::5], CURVE[::5] + 0.01 * rng.normal(size=20))
    low, high = (abs(limit - result.values["beta"]) for limit in result.profile("beta")[:2])
    assert high > 1.1 * low
    believed = result.compare_errors(samples=50)
    assert believed.believed["beta"] == "profile"
    assert believed.interval("beta") == result.profile("beta")[:2]
    assert "the curve bends" in str(believed)


def test_a_profile_without_a_limit_is_an_outcome_not_an_error(rng):
    """Slow flow knows the slope (mu_d - mu_s)/I0 alone: I0 may be as large as it likes, but not small."""
    I = np.geomspace(1e-3, 0.02, 40)
    slow = mu_of_I(I, mu_saturating(I, 0.25, 0.55, 0.2) + 4e-4 * rng.normal(size=40), law="saturating")
    assert isnan(slow.errors["I0"])
    profile = slow.profile("I0")
    assert profile.high == inf
    assert 0.1 < profile.low < 0.2
    assert profile.outcome == "no upper limit: chi^2 rises only because another parameter is at the bound of its range"


def test_an_interval_is_withheld_where_the_verdict_says_undetermined(rng):
    I = np.geomspace(1e-3, 0.02, 40)
    slow = mu_of_I(I, mu_saturating(I, 0.25, 0.55, 0.2) + 2e-4 * rng.normal(size=40), law="saturating")
    assert "not separated (correlation" in str(slow.verdict)
    profile = slow.profile("I0")
    assert isnan(profile.low)
    assert isnan(profile.high)
    assert profile.outcome == "the data do not determine it, see the verdict"


@pytest.mark.parametrize(
    ("x", "y"),
    [
        (STRAIN, 0.0 * STRAIN),
        (STRAIN, CURVE),
        (STRAIN, np.full(100, 0.3)),
        (STRAIN[::20], CURVE[::20]),
        (STRAIN[::20], CURVE[::20] * [1, 1, 2, 1, 1]),
        (STRAIN[::40], CURVE[::40]),
        (0.1 + STRAIN, 0.3 + 0.01 * np.sin(1e5 * STRAIN**2)),
        (0.01 * STRAIN, STRAIN + 1e-4 * np.sin(1e5 * STRAIN)),
    ],
)
def test_no_fit_however_bad_breaks_its_errors(x, y):
    result = relaxation(x, y)
    again = result.bootstrap(samples=20)
    for name in result.values:
        profile = result.profile(name)
        assert profile.outcome or profile.low < result.values[name] < profile.high
        if not np.isfinite(result.errors[name]):  # no error bar in whatever way
            assert isnan(again.errors[name])
            assert isnan(again.interval(name)[0])
            assert not np.isfinite(profile.low) or isinf(profile.high)
    assert "\n" in str(result.compare_errors(samples=20))


def test_a_negative_unit_does_not_turn_the_limits_round(rng):
    x = np.linspace(0, 10, 40)
    result = exponential_decay(x, -3.0 * np.exp(-x / 1.7) + 0.01 * rng.normal(size=40), np.full(40, 0.01))
    assert result.verdict, str(result)
    low, high, _, outcome = result.profile("amplitude")
    assert outcome == ""
    assert low < -3.0 < high
    assert (low, high) == pytest.approx(result.interval("amplitude"), rel=0.01)  # nearly linear


def test_the_bootstrap_of_white_noise_agrees_with_the_covariance(line):
    again = line.bootstrap(400, seed=1)
    for name, error in line.errors.items():
        assert again.errors[name] == pytest.approx(error, rel=0.11)  # 1/sqrt(2 x 400) = 3.5 %, three of them
    assert again.blocks == {"": 1}
    assert again.failed == 0
    assert "400 samples (seed 1, blocks of 1 points)" in str(again)


def test_the_bootstrap_is_that_of_its_seed(line):
    first, same, other = line.bootstrap(20, seed=1), line.bootstrap(20, seed=1), line.bootstrap(20, seed=2)
    np.testing.assert_array_equal(first.draws["b"], same.draws["b"])
    assert not np.array_equal(first.draws["b"], other.draws["b"])


def test_noise_that_remembers_is_drawn_in_blocks(rng):
    noise = rng.normal(size=400)
    for i in range(1, 400):
        noise[i] = 0.8 * noise[i - 1] + 0.6 * noise[i]
    x = np.linspace(0.0, 0.1, 400)
    result = relaxation(x, 0.4 - 0.35 * np.exp(-60.0 * x) + 0.02 * noise)
    again = result.bootstrap(300)
    assert again.blocks[""] == np.ceil(4.0 * result.residuals["correlation_time"])
    for name, error in result.errors.items():
        assert again.errors[name] == pytest.approx(error, rel=0.3)  # ten blocks, and 300 samples
    single = result.bootstrap(300, block=1)
    assert single.blocks == {"": 1}


@pytest.mark.parametrize("copies", [2, 3])
def test_copies_of_points_shrink_no_error(rng, copies):
    y = CURVE + 0.01 * rng.normal(size=100)
    once, often = relaxation(STRAIN, y), relaxation(np.tile(STRAIN, copies), np.tile(y, copies))
    assert often.values == pytest.approx(once.values, rel=1e-6)  # minimiser: root of 1e-12
    assert often.errors == pytest.approx(once.errors, rel=1e-3)  # the search for tau
    assert f"occur {copies} times on average, copies do not shrink the errors" in str(often.verdict)
    assert "structure left" not in str(often.verdict)  # neighbours of one sign, but only since they are one point
    many, few = often.bootstrap(300), once.bootstrap(300)
    for name in once.values:
        assert many.errors[name] == pytest.approx(few.errors[name], rel=0.2)  # 300 samples of each: 6 %
        assert often.profile(name)[:2] == pytest.approx(once.profile(name)[:2], rel=1e-3)
    assert "law is wrong" not in str(mu_of_I(np.repeat(STRAIN[1:], 2), np.repeat(0.3 + STRAIN[1:] + 0.01 * rng.normal(size=99), 2)).verdict)


def test_a_robust_loss_takes_outliers_for_what_they_are(rng):
    y = CURVE + 0.005 * rng.normal(size=100)
    y[[20, 50, 70]] += 0.3
    plain, robust = relaxation(STRAIN, y), relaxation(STRAIN, y, loss="soft_l1")
    assert robust.verdict, str(robust)
    assert robust.errors_from == "bootstrap"
    assert abs(robust.values["s_max"] - 0.4) < 4 * robust.errors["s_max"]  # four standard errors, fixed seed
    assert robust.errors["s_max"] < 0.5 * plain.errors["s_max"]
    assert "a robust loss has no likelihood" in robust.profile("beta").outcome
    table = robust.compare_errors(samples=100)
    assert table.believed["beta"] == "bootstrap"
    low, high = table.interval("s_max")
    assert low < robust.values["s_max"] < high
    with pytest.raises(InputError, match="loss = 'huber' must be"):
        relaxation(STRAIN, y, loss="huber")


def test_a_robust_fit_of_clean_data_has_nearly_the_errors_of_least_squares(rng):
    y = CURVE + 0.01 * rng.normal(size=100)
    plain, robust = relaxation(STRAIN, y), relaxation(STRAIN, y, loss="soft_l1")
    for name, error in plain.errors.items():
        assert robust.errors[name] == pytest.approx(error, rel=0.25)  # 95 % efficient; sampling of both
        assert abs(robust.values[name] - plain.values[name]) < error


def test_the_errors_of_a_global_fit_agree_in_all_ways(rng):
    sets = [
        DataSet(STRAIN, top - (top - 0.05) * np.exp(-60.0 * STRAIN) + 0.01 * rng.normal(size=100), label=f"{top}") for top in (0.3, 0.4)
    ]
    result = relaxations(sets, {"beta": "all"})
    table = result.compare_errors(samples=200)
    for name, (low, high) in table.covariance.items():
        for ends in (table.profile[name], table.bootstrap[name]):
            assert ends == pytest.approx((low, high), abs=0.25 * (high - low))  # percentiles of 200 samples: 10 % of a half-width each
    assert set(table.blocks) == {"0.3", "0.4"}
    assert str(table).splitlines()[0].startswith("95% intervals; points in a block of the bootstrap: 0.3: ")


def test_bad_questions_are_named(line):
    for ask in (lambda: line.profile("c"), lambda: line.profile("b", 1.0), lambda: line.bootstrap(20).interval("c")):
        with pytest.raises(InputError, match="interval: needs one of mu_s, b"):
            ask()
    for settings in ({"samples": 5}, {"samples": 100.0}, {"block": 0}):
        with pytest.raises(InputError, match="bootstrap: samples ="):
            line.bootstrap(**settings)
