"""The room of the whole way: a small job through all its sweeps to budget and rows, by the command; and the errors of made-up cases."""

import json
import math
from types import SimpleNamespace

import pytest

from anisogran.cost.box_errors import at_least
from anisogran.cost.budget import budget_from
from anisogran.cost.cases import Case, by_value, cases_of, done_cases, left_out, turned, work_of
from anisogran.cost.main_job import MainJob
from anisogran.cost.whole_way import sweeps_of
from anisogran.experiments import SimpleShear
from anisogran.sweeps import sweep
from scripts import ROOT, script

ANSWERS = ("s_max", "phi", "v_phi of the grains", "v_phi of the continuum", "mu_s", "b")


def block(rows, beginning):
    found = [row for row in rows if row["knob"].startswith(beginning)]
    assert found, beginning
    return found


def case(seed, steps, work=100.0, **more):
    """A Case of nothing but its keys."""
    return Case(SimpleNamespace(seed=seed, contact_steps=steps, kind="ring_shear", **more), None, work)


def test_runs_here_and_in_folders_are_the_same_cases(tmp_path):
    scene = SimpleShear(n=50, inertial_number=0.1, strain=1.2, discard=0.1, frames=0)
    vary = {"contact_steps": [10.0, 20.0]}
    here = done_cases(scene, vary)
    sweep(scene, vary, tmp_path / "sweep", workers=1)
    for one, other in zip(here, cases_of(tmp_path / "sweep"), strict=True):
        assert one.scene == other.scene
        assert one.grain_steps == other.grain_steps > 0
        assert one.group("series").equals(other.group("series"))
        assert float(one.group("steady").stress_ratio) == float(other.group("steady").stress_ratio)
    assert here[1].grain_steps == pytest.approx(2 * here[0].grain_steps, rel=0.05)  # twice as many steps, but for looks at the gate


def test_only_seeds_that_all_values_have_are_compared():
    groups = by_value([case(1, 20.0), case(2, 20.0), case(3, 20.0), case(3, 10.0), case(1, 10.0)], "contact_steps")
    assert {value: [one.scene.seed for one in some] for value, some in groups.items()} == {10.0: [1, 3], 20.0: [1, 3]}
    assert work_of([case(1, 5.0, 3.0), case(1, 5.0, 4.0), case(2, 5.0, 5.0)]) == 6.0  # several tests with each seed


def test_what_a_knob_does_is_told_at_its_usual_value_and_drawn_at_all():
    """An answer 1 + 0.5/steps: at the usual 20 steps it is off by 0.025."""
    groups = by_value([case(seed, steps, 100.0 * steps) for steps in (5.0, 10.0, 20.0) for seed in (1, 2)], "contact_steps")
    values = [[1 + 0.5 / steps + 0.1 * seed for seed in (1, 2)] for steps in groups]
    source, curve = turned("x", "time step", "ring.contact_steps", 1.0, groups, values, 20.0)
    limit = 1.15  # the mean over both seeds
    assert source.error == pytest.approx(0.025 / limit, rel=1e-12)
    assert source.uncertainty < 1e-12
    assert (source.knobs, source.order) == (("ring.contact_steps",), 1.0)
    assert [value for value, _, _ in curve.points] == [5.0, 10.0, 20.0]
    assert [error for _, error, _ in curve.points] == pytest.approx([0.1 / limit, 0.05 / limit, 0.025 / limit], rel=1e-12)
    assert [work for _, _, work in curve.points] == [500.0, 1000.0, 2000.0]


def test_points_that_are_left_out_tell_their_root_mean_square():
    found = left_out("x", "points", [1.0, 1.0], [1.1, 0.9], ("boxes",))
    assert found.error == pytest.approx(0.1)
    assert (found.knobs, found.order) == (("boxes",), 0.5)


def test_best_answers_come_from_runs_that_are_nowhere_coarser_than_usual():
    usual = SimpleNamespace(n=1000, contact_steps=10.0, duration=0.25)
    cases = [case(1, steps, n=n, duration=0.25) for steps, n in ((10.0, 1000), (20.0, 1000), (5.0, 1000), (10.0, 500), (10.0, 2000))]
    assert [(one.scene.contact_steps, one.scene.n) for one in at_least(cases, usual)] == [(10.0, 1000), (20.0, 1000), (10.0, 2000)]


def test_sweeps_turn_one_knob_at_a_time():
    job = MainJob()
    for name, (scene, vary) in sweeps_of(job).items():
        base = {"box": job.biaxial, "shea": job.shear, "ring": job.ring}[name[:4] if name[:3] != "box" else "box"]
        ours = {key for key in type(scene).model_fields if getattr(scene, key) != getattr(base, key)} | set(vary)
        assert len(ours - {"seed", "frames", "inertial_number", "travel"}) == (0 if name in ("box", "shear", "ring") else 1), name


@pytest.fixture(scope="module")
def way_rows(tmp_path_factory):
    """Those of data_generation/whole_way.py --quick, whose file the demo could choose by."""
    path = tmp_path_factory.mktemp("way") / "whole_way.json"
    budget = script(ROOT / "data_generation" / "whole_way.py").main([str(path), "--quick"])
    content = json.loads(path.read_text())
    assert budget_from(content).names == budget.names == ANSWERS
    assert set(content["made"]) >= {"date", "machine", "numba", "seconds_per_grain_step", "grain_steps_per_second"}
    return content["rows"]


def test_the_budget_of_each_answer_adds_up(way_rows):
    for answer in ANSWERS:
        *parts, whole = block(way_rows, f"{answer}: budget at the defaults")
        assert whole["value"] == "all together"
        assert whole["error"] == pytest.approx(math.hypot(*(part["error"] for part in parts)), rel=1e-3)  # four digits are kept
        assert [part["error"] for part in parts] == sorted((part["error"] for part in parts), reverse=True)


def test_a_turned_knob_lowers_the_error_and_costs_seconds(way_rows):
    for answer in ANSWERS:
        usual = block(way_rows, f"{answer}: budget at the defaults")[-1]
        for turned_up in block(way_rows, f"{answer}: one knob a fifth up, best first"):
            assert 0 < turned_up["error"] <= usual["error"]  # of four digits: what hardly matters may not show
            assert turned_up["seconds"] > usual["seconds"]
        best = block(way_rows, f"{answer}: one knob a fifth up, best first")[0]
        assert best["error"] < usual["error"]


def test_the_law_itself_leaves_more_with_the_local_law(way_rows):
    nonlocal_, local = block(way_rows, "v_phi of the continuum: what the law itself leaves to the grains")
    assert nonlocal_["value"] == "nonlocal"
    assert 0 < nonlocal_["error"] < local["error"]


def test_the_mesh_and_the_rate_floor_are_far_below_chance(way_rows):
    parts = {row["value"]: row["error"] for row in block(way_rows, "v_phi of the continuum: budget at the defaults")}
    assert max(parts["mesh"], parts["rate floor"]) < 0.01 * parts["chance"]
