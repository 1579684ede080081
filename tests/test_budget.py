"""The arithmetic of error budgets: sizes of errors from made-up runs, how they add, and the knobs that are chosen for an accuracy."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from anisogran.cost.budget import KNOBS, LEAST, Budget, Source, budget_from, measured_budget
from anisogran.cost.budget_tables import told
from anisogran.cost.main_job import MainJob, Price
from anisogran.cost.sources import chance, size, slope
from anisogran.outcome import InputError

USUAL = MainJob().knobs(KNOBS)


def budget_at_usual(*sources):
    """A Budget that was measured at the defaults of the main job; 20 diameters of travel are not averaged."""
    return Budget(sources, USUAL, {"ring.travel": 20.0})


def linear_price(choice):
    """Seconds in proportion to the travel of the ring and the number of boxes, whatever the rest."""
    return 2.0 * choice["ring.travel"] + 30.0 * choice["boxes"] + 1e-6 * sum(choice.values())


def test_a_slope_without_noise_is_found_exactly_and_each_seed_keeps_its_own_limit():
    powers, limits = np.array([4.0, 2.0, 1.0]), np.array([0.9, 1.0, 1.1])
    found = slope(powers, limits + 0.03 * powers[:, None])
    assert found.limit == pytest.approx(1.0, rel=1e-14)
    assert found.error == pytest.approx(0.03, rel=1e-12)
    assert found.uncertainty < 1e-14


def test_the_uncertainty_of_a_slope_is_its_scatter(rng):
    powers = np.array([4.0, 2.0, 1.0])
    found = [slope(powers, 1.0 + 0.02 * powers[:, None] + 0.05 * rng.standard_normal((3, 6))) for _ in range(400)]
    errors = np.array([one.error for one in found])  # 0.02 lies 2.5 deviations above 0: the sign is hardly ever lost
    assert errors.mean() == pytest.approx(0.02, abs=0.002)
    assert np.mean([one.uncertainty for one in found]) == pytest.approx(errors.std(), rel=0.15)  # 400 trials: 4 %; the rest is |.|


def test_a_slope_of_profiles_is_a_relative_l2():
    shape, change = np.array([3.0, 4.0]), np.array([0.3, 0.0])
    found = slope([2.0, 1.0], [[shape + 2 * change] * 2, [shape + change] * 2])
    assert found.error == pytest.approx(0.3 / 5.0)
    assert size([0.0, 2.0], [1.0, 2.0], weights=np.array([4.0, 1.0])) == pytest.approx(2.0 / math.sqrt(8.0))


def test_chance_falls_as_one_over_the_root_and_is_told_for_the_usual_number(rng):
    values = 2.0 + 0.2 * rng.standard_normal(4000)
    error, uncertainty, measured = chance(values, (1, 4, 16), usual=9)
    assert error == pytest.approx(0.1 / 3.0, rel=0.1)
    assert chance(values)[1] == pytest.approx(chance(values)[0] / math.sqrt(2 * 3999))  # of a standard deviation, as known
    assert error / math.sqrt(2 * 3999) < uncertainty < error / math.sqrt(2 * 249)  # between those of means of 1 and of 16
    assert [count for count, _ in measured] == [1, 4, 16]
    for count, measured_error in measured:
        assert measured_error == pytest.approx(0.1 / math.sqrt(count), rel=0.15)  # 250 means of 16 know it to 4.5 %


def test_the_uncertainty_of_chance_is_its_scatter(rng):
    """Eight repetitions, by ones, twos and fours: the fours are only two."""
    found = [chance(1.0 + 0.01 * rng.standard_normal(8), (1, 2, 4)) for _ in range(2000)]
    squares = np.array([error**2 for error, _, _ in found])
    assert squares.mean() == pytest.approx(1e-4, rel=0.06)  # 2000 trials: 2 %
    relative = found[0][1] / found[0][0]
    assert 2.0 * relative == pytest.approx(squares.std() / squares.mean(), rel=0.1)  # of a square twice that of its root


def test_errors_go_as_powers_of_their_knobs_and_add_as_squares():
    grains = Source("x", "chance", 0.03, 0.0, ("biaxial.n", "boxes"), 0.5)
    budget = budget_at_usual(grains, Source("x", "step", 0.04, 0.0, ("ring.contact_steps",), 1.0))
    assert budget.error("x", USUAL) == pytest.approx(0.05, rel=1e-14)
    assert budget.error("x", USUAL | {"boxes": 9}) == pytest.approx(math.hypot(0.01, 0.04), rel=1e-14)
    twice = USUAL | {"ring.contact_steps": 2.0 * USUAL["ring.contact_steps"]}
    assert budget.error("x", twice) == pytest.approx(math.hypot(0.03, 0.02), rel=1e-14)
    assert [source.cause for source, _ in budget.parts("x", USUAL)] == ["step", "chance"]
    travel = budget_at_usual(Source("x", "chance", 0.03, 0.0, ("ring.travel",), 0.5))
    assert travel.error("x", USUAL | {"ring.travel": 20.0 + 4 * 140.0}) == pytest.approx(0.015)  # 20 diameters are not averaged


def test_the_choice_for_an_accuracy_is_all_but_the_cheapest_one():
    """Two causes in one answer: a closed form, by Lagrange. Knobs turn by a fifth, at most a fifth is too much."""
    travel, boxes = 0.05, 0.04
    budget = budget_at_usual(Source("x", "a", travel, 0.0, ("ring.travel",), 0.5), Source("x", "b", boxes, 0.0, ("boxes",), 0.5))
    for accuracy in (0.03, 0.02, 0.01):
        choice = budget.choose(accuracy, linear_price)
        a, b = travel**2 * 140.0, boxes**2  # error^2 = a/(travel - 20) + b/boxes
        best = (math.sqrt(2.0 * a) + math.sqrt(30.0 * b)) ** 2 / accuracy**2 + 2.0 * 20.0
        assert 0.85 * accuracy < budget.error("x", choice) <= accuracy
        assert best <= linear_price(choice) < 1.25 * best


def test_what_no_cause_asks_for_stays_at_its_least():
    budget = budget_at_usual(Source("x", "a", 0.05, 0.0, ("ring.travel",), 0.5))
    choice = budget.choose(0.03, linear_price)
    assert {name: value for name, value in choice.items() if name != "ring.travel"} == {
        n: v for n, v in LEAST.items() if n != "ring.travel"
    }


def test_an_accuracy_that_no_choice_reaches_is_refused_with_the_best_and_its_cause():
    budget = budget_at_usual(Source("x", "points of the fit", 0.02, 0.0), Source("y", "a", 0.05, 0.0, ("boxes",), 0.5))
    with pytest.raises(InputError, match=r"accuracy = 0\.01: x cannot be had better than 0\.02 \(points of the fit\)"):
        budget.choose(0.01, linear_price)
    lasting = budget_at_usual(Source("x", "a", 0.05, 0.0, ("elements",), 0.1))
    with pytest.raises(InputError, match="x cannot be had better than"):  # knobs end, and the search with them
        lasting.choose(0.01, linear_price)
    assert KNOBS["elements"].turned(1024) is None
    odd = budget_at_usual(Source("x", "points of the fit", 0.02341, 0.0))
    with pytest.raises(InputError, match=r"accuracy = 0\.023: x cannot be had better than 0\.024"):  # what is named can be had
        odd.choose(0.023, linear_price)
    assert odd.choose(0.024, linear_price) == LEAST
    for bad in (0.0, -1.0, 1.0, float("nan"), float("inf")):
        with pytest.raises(InputError, match="accuracy"):
            budget.choose(bad, linear_price)


def test_the_next_second_goes_to_the_knob_that_takes_away_most():
    budget = budget_at_usual(Source("x", "a", 0.05, 0.0, ("ring.travel",), 0.5), Source("x", "b", 0.001, 0.0, ("boxes",), 0.5))
    (first, fall), (second, less) = budget.next_second("x", USUAL, linear_price)
    more = KNOBS["ring.travel"].turned(USUAL["ring.travel"])
    gone = 1.0 - budget.error("x", USUAL | {"ring.travel": more}) / budget.error("x", USUAL)
    assert fall == pytest.approx(gone / (2.0 * (more - USUAL["ring.travel"])), rel=1e-4)  # for a second, of which each diameter takes two
    assert (first, second) == ("ring.travel", "boxes")
    assert fall > less > 0


def test_a_budget_goes_through_a_file_and_back():
    source = Source("x", "a", 0.05, 0.01, ("ring.travel",), 0.5)
    budget = Budget((source,), USUAL, {"ring.travel": 20.0}, {"x": [1.0, 2.0]}, {"x": 0.01}, {"date": "today"})
    assert budget_from(json.loads(json.dumps(budget.as_dict() | {"rows": []}))) == budget
    assert budget.deviation("x", [1.0, 2.5, 9.0]) == pytest.approx(0.5 / math.sqrt(5.0))  # only as far as the best one goes


@pytest.mark.parametrize("text", ["", "{}", "[1]", '{"sources": [{"answer": "x"}]}', None])
def test_a_damaged_file_is_told_in_one_line(text, tmp_path, monkeypatch):
    if text is not None:
        (tmp_path / "whole_way.json").write_text(text)
    monkeypatch.setattr("anisogran.cost.budget.files", lambda package: tmp_path)
    with pytest.raises(InputError, match=r"whole_way\.json: is missing or damaged \(.*\); install anisogran anew"):
        measured_budget()


def test_how_well_an_error_is_known_goes_with_its_knobs_too():
    """Measured at 20 steps, told at the usual 10: twice the error, twice the uncertainty."""
    budget = Budget((Source("x", "step", 0.01, 0.003, ("ring.contact_steps",), 1.0),), USUAL | {"ring.contact_steps": 20.0})
    assert told(budget, budget.sources[0]) == "0.02 ± 0.006"
    assert told(budget, replace(budget.sources[0], uncertainty=0.011)) == "< 0.02"
    assert told(budget, replace(budget.sources[0], uncertainty=1e-4)) == "0.02"


def test_knobs_of_the_budget_are_keys_of_the_main_job():
    job = MainJob()
    assert job.turned(USUAL) == job
    for name, knob in KNOBS.items():
        assert knob.lowest <= USUAL[name] < knob.highest
        turned = job.turned({name: knob.turned(USUAL[name])})
        assert turned != job, name
        for scene in turned.experiments():
            type(scene)(**{key: getattr(scene, key) for key in type(scene).model_fields})  # within the bounds of its keys


def test_a_price_is_that_of_the_experiments_it_stands_for():
    paces = {"ring_shear": 2e-8, "biaxial": 3e-8, "simple_shear": 1e-8}
    price, choice = Price(MainJob(), paces), USUAL | {"boxes": 3, "shear.strain": 3.0}
    # seeds differ by their radii, and with them by the steps of a test: 1 %
    assert price(choice) == pytest.approx(sum(map(price.of_run, MainJob().turned(choice).experiments())), rel=0.03)


def test_the_measured_budget_promises_what_is_asked_for():
    budget = measured_budget()
    price = Price(MainJob(), budget.made["seconds_per_grain_step"], budget.made["seconds_per_element"])
    seconds = []
    for accuracy in (0.1, 0.05, 0.03):
        choice = budget.choose(accuracy, price)
        assert all(0 < budget.error(name, choice) <= accuracy for name in budget.names)
        seconds.append(price(choice))
    assert seconds == sorted(seconds)
    assert set(budget.own_errors) == set(budget.answers) == set(budget.names)
    assert set(budget.knobs) == set(KNOBS)
