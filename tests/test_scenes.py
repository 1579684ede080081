"""The shipped scenes: each is right, and its quick size runs."""

from pathlib import Path

import pytest

from anisogran.experiments import KINDS, doubts_of, read_scene

SCENES = sorted((Path(__file__).parents[1] / "data_generation").glob("*.toml"))


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_the_quick_size_of_every_shipped_scene_runs(path):
    assert doubts_of(read_scene(path)) == doubts_of(read_scene(path, quick=True)) == []
    run = read_scene(path, quick=True).run()  # two seconds each, once it is compiled
    assert run.status.level == "ok"
    assert run.series.sizes["time"] > 50


def test_every_experiment_has_a_scene():
    assert {read_scene(path).kind for path in SCENES} == set(KINDS)


def test_a_kind_is_said_once():
    """As the name of the experiment in files is the name of its file."""
    for kind, experiment in KINDS.items():
        assert experiment.kind == kind == experiment.__module__.split(".")[-1]
