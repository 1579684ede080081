"""Several data sets in one fit: what is shared, what is own, and what is found wrong with it."""

from math import isnan

import numpy as np
import pytest

from anisogran.fitting import DataSet, cohesion, mohr_coulomb_lines, relaxation, relaxations
from anisogran.models import macro_cohesion, peak_stress
from anisogran.outcome import InputError

MINIMISER = 1e-6  # root of its tolerance of 1e-12
STRAIN = np.linspace(0.0, 0.1, 100)
LOWER = {0.0: 0.3, 0.5: 0.45}  # s_max for each mu


def curve(x, s_0, s_max, beta):
    return s_max - (s_max - s_0) * np.exp(-beta * x)


def four(rng, noise, beta=lambda p: 60.0, x=lambda p: STRAIN, **settings):
    return [
        DataSet(x(p), curve(x(p), 0.05, s_max, beta(p)) + noise * rng.normal(size=x(p).size), conditions={"p": p, "mu": mu}, **settings)
        for mu, s_max in LOWER.items()
        for p in (100.0, 200.0)
    ]


def test_exact_data_give_back_shared_and_own_parameters(rng):
    result = relaxations(four(rng, 0.0, beta=lambda p: 0.4 * p), {"s_max": ("mu",), "beta": ("p",), "s_0": "all"})
    truth = {"s_0": 0.05, "s_max[mu=0]": 0.3, "s_max[mu=0.5]": 0.45, "beta[p=100]": 40.0, "beta[p=200]": 80.0}
    assert result.verdict, str(result)
    assert result.values == pytest.approx(truth, rel=MINIMISER)
    assert result.of("p=200, mu=0.5") == pytest.approx({"s_0": 0.05, "s_max": 0.45, "beta": 80.0}, rel=MINIMISER)
    np.testing.assert_allclose(result.predict(STRAIN, "p=200, mu=0"), curve(STRAIN, 0.05, 0.3, 80.0), rtol=MINIMISER)


def test_the_table_says_which_variable_each_parameter_is(rng):
    result = relaxations(four(rng, 0.01), {"s_max": "mu", "beta": ()})
    assert result.table.variables["p=100, mu=0.5", "s_max"] == "s_max[mu=0.5]"
    assert result.table.variables["p=100, mu=0.5", "beta"] == "beta"
    lines = str(result.table).splitlines()
    assert lines[0].split() == ["data", "set", "points", "weight", "s_0", "s_max", "beta"]
    assert lines[3].split() == ["p=100,", "mu=0.5", "100", "1", "own", "mu=0.5", "all"]
    assert lines[-1] == "7 variables for 400 points"


def test_data_sets_that_share_nothing_are_fitted_as_if_alone(rng):
    sets = four(rng, 0.01)
    result = relaxations(sets)
    for one, label in zip(sets, result.table.labels, strict=True):
        alone = relaxation(one.x, one.y)
        assert result.of(label) == pytest.approx(alone.values, rel=MINIMISER)
        assert result.errors_of(label) == pytest.approx(alone.errors, rel=1e-5)  # the search for tau
        assert result.interval(f"beta[{label}]") == pytest.approx(alone.interval("beta"), rel=1e-5)


def test_what_is_shared_has_the_smaller_error_of_all_the_points(rng):
    sets = four(rng, 0.01)
    own, shared = relaxations(sets), relaxations(sets, {"beta": "all"})
    errors = np.array([own.errors_of(label)["beta"] for label in own.table.labels])
    expected = np.sum(errors**-2.0) ** -0.5  # the weighted mean of separate fits
    assert shared.verdict, str(shared)
    assert shared.errors["beta"] == pytest.approx(expected, rel=0.05)  # linear theory; each set estimates its own noise
    assert abs(shared.values["beta"] - 60.0) < 4 * shared.errors["beta"]  # four standard errors, fixed seed


def test_a_parameter_shared_by_mistake_is_found(rng):
    result = relaxations(four(rng, 0.01, beta=lambda p: 0.4 * p), {"beta": "all"})
    assert not result.verdict
    assert "do not share these values: chi^2 is" in str(result.verdict)
    assert "beta differs most" in str(result.verdict)
    assert isnan(result.errors["beta"])
    assert relaxations(four(rng, 0.01, beta=lambda p: 0.4 * p), {"beta": ("p",)}).verdict


def test_sharing_is_not_doubted_because_one_data_set_is_noisy(rng):
    doubted = 0
    for _ in range(10):
        quiet, *noisy = four(rng, 0.03)
        quiet = DataSet(quiet.x, curve(STRAIN, 0.05, 0.3, 60.0) + 0.004 * rng.normal(size=100), conditions=quiet.conditions)
        result = relaxations([quiet, *noisy], {"beta": "all"})
        assert "the noise of the data sets differs by a factor of" in str(result.verdict)
        doubted += "do not share" in str(result.verdict)
    assert doubted == 0  # a false alarm has the probability 1e-3


def test_a_long_data_set_is_said_to_dominate_unless_balanced(rng):
    def x(p):
        return STRAIN if p < 150.0 else np.linspace(0.0, 0.1, 4000)

    sets = four(rng, 0.01, x=x)[:2]
    result = relaxations(sets, {"beta": "all"})
    assert "p=200, mu=0 dominates beta" in str(result.verdict)
    balanced = relaxations(sets, {"beta": "all"}, balance=True)
    assert "dominates" not in str(balanced.verdict)
    assert balanced.table.weights["p=100, mu=0"] == pytest.approx(20.5)
    assert balanced.errors["beta"] > 1.5 * result.errors["beta"]  # the price: the short data set is as loud as the long one


def test_weights_do_not_shrink_errors(rng):
    sets = four(rng, 0.01)
    heavy = [DataSet(one.x, one.y, conditions=one.conditions, weight=100.0) for one in sets]
    light, loud = relaxations(sets, {"beta": "all"}), relaxations(heavy, {"beta": "all"})
    assert loud.values == pytest.approx(light.values, rel=MINIMISER)
    assert loud.errors == pytest.approx(light.errors, rel=1e-5)  # the search for tau
    for weight in (1.0, 100.0):  # errors that were given ten times too large are believed, whatever the weight
        given = [DataSet(one.x, one.y, np.full(100, 0.1), conditions=one.conditions, weight=weight) for one in sets]
        assert relaxations(given, {"beta": "all"}).errors["beta"] == pytest.approx(10.0 * light.errors["beta"], rel=0.15)  # noise and tau


def test_weights_do_not_shrink_the_errors_of_short_data_sets(rng):
    """Two points tell no noise of their own, they take that of all."""
    p, few = np.linspace(100.0, 500.0, 20), np.array([100.0, 500.0])
    stress = peak_stress(p, 0.23, 10.0) + 2.0 * rng.normal(size=20), peak_stress(few, 0.23, 10.0) + 2.0 * rng.normal(size=2)

    def errors(weight):
        sets = [DataSet(x, y, label=label, weight=weight) for x, y, label in zip((p, few), stress, ("long", "short"), strict=True)]
        result = mohr_coulomb_lines(sets, {"phi": "all", "c": "all"})
        return result.errors

    assert all(error > 0.0 for error in errors(1.0).values())
    assert errors(100.0) == pytest.approx(errors(1.0), rel=1e-9)  # rounding


@pytest.mark.parametrize(
    ("shared", "words"),
    [
        ({"bta": "all"}, r"shared parameter 'bta' is unknown; did you mean 'beta'\?"),
        ({"beta": ("mus",)}, r"beta is shared by 'mus', which data set 'p=100, mu=0' does not state; did you mean 'mu'\?"),
        ({"beta": ("width",)}, "there are p, mu"),
    ],
)
def test_unknown_names_are_refused_with_the_nearest_known(rng, shared, words):
    with pytest.raises(InputError, match=words):
        relaxations(four(rng, 0.01), shared)


def test_data_sets_that_cannot_be_used_are_named(rng):
    sets = four(rng, 0.01)
    with pytest.raises(InputError, match="2 data sets have the label 'run'"):
        relaxations([DataSet(STRAIN, STRAIN, label="run"), DataSet(STRAIN, STRAIN, label="run")])
    with pytest.raises(InputError, match="'a' and 'b' hold the same points"):
        relaxations([DataSet(STRAIN, sets[0].y, label="a"), DataSet(STRAIN, sets[0].y, label="b")])
    with pytest.raises(InputError, match="none, 'b' has none"):
        relaxations([DataSet(STRAIN, sets[0].y, 0.01 + 0 * STRAIN, label="a"), DataSet(STRAIN, sets[1].y, label="b")])
    with pytest.raises(InputError, match="relaxations b: 2 finite points"):
        relaxations([DataSet(STRAIN, sets[0].y, label="a"), DataSet(STRAIN[:2], STRAIN[:2], label="b")])
    for bad, words in (
        ([], "needs one data set"),
        ([(STRAIN, STRAIN)], "one is tuple"),
        ([DataSet(STRAIN, STRAIN, weight=0)], "weight = 0"),
    ):
        with pytest.raises(InputError, match=words):
            relaxations(bad)
    with pytest.raises(InputError, match=r"did you mean 'p=100, mu=0'"):
        relaxations(sets).of("p=100, mu=1")


def test_a_short_data_set_spoils_only_its_own_parameters(rng):
    *long, last = four(rng, 0.01)
    short = DataSet(last.x[::15], last.y[::15], label="short", conditions=last.conditions)
    result = relaxations([*long, short], {"beta": "all"})
    assert "only 7 points in short for its 2 own parameters" in str(result.verdict)
    assert isnan(result.errors["s_max[short]"])
    assert result.errors["beta"] < 2.0


def test_lines_share_the_angle_and_own_their_cohesions(rng):
    p = np.linspace(100.0, 500.0, 12)
    sets = [DataSet(p, peak_stress(p, 0.23, c) + 2.0 * rng.normal(size=12), conditions={"kc": c}) for c in (10.0, 40.0, 70.0)]
    result = mohr_coulomb_lines(sets)
    assert result.verdict, str(result)
    for name, value in {"phi": 0.23, "c[kc=10]": 10.0, "c[kc=40]": 40.0, "c[kc=70]": 70.0}.items():
        assert abs(result.values[name] - value) < 4 * result.errors[name]  # four standard errors, fixed seed


def test_the_cohesion_of_all_adhesions_at_once(rng):
    kc = np.repeat([0.0, 0.5, 1.0, 2.0, 4.0], 4)
    p = np.tile([100.0, 200.0, 300.0, 500.0], 5)
    exact = np.array([peak_stress(one, 0.23, macro_cohesion(176.0, 0.5, 1.0, adhesion)) for one, adhesion in zip(p, kc, strict=True)])
    result = cohesion(p, kc, exact, 0.5, 1.0)
    assert result.verdict, str(result)
    assert result.values == pytest.approx({"phi": 0.23, "c0": 176.0}, rel=MINIMISER)
    assert result.predict(300.0, "kc=2") == pytest.approx(peak_stress(300.0, 0.23, macro_cohesion(176.0, 0.5, 1.0, 2.0)), rel=MINIMISER)
    rest = cohesion(p, kc, exact + 2.0 * 11.0 * np.sqrt((1 + np.sin(0.23)) / (1 - np.sin(0.23))), 0.5, 1.0, offset=True)
    assert rest.values == pytest.approx({"phi": 0.23, "c0": 176.0, "c_rest": 11.0}, rel=1e-5)  # the minimiser, c_rest is small
    noisy = cohesion(p, kc, exact + 3.0 * rng.normal(size=20), 0.5, 1.0)
    assert abs(noisy.values["c0"] - 176.0) < 4 * noisy.errors["c0"]
    assert noisy.errors["c0"] < 10.0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (([1, 2], [0, 0], [3, 4], 0.5, 1.0), "the formula gives no cohesion"),
        (([1, 2], [1, 1], [3, 4], 2.0, 1.0), "k1 = 2 must be at most 1"),
        (([1, 2], [-1, 1], [3, 4], 0.5, 1.0), "kc = -1 must be at least 0"),
        (([1, 2], [1, np.nan], [3, 4], 0.5, 1.0), "every kc must be a finite number"),
        (([1, 2], [1], [3, 4], 0.5, 1.0), "rows of one length"),
    ],
)
def test_a_series_of_adhesions_that_cannot_be_fitted_is_refused(arguments, words):
    with pytest.raises(InputError, match=words):
        cohesion(*arguments)
