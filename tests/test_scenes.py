"""The shipped scenes: each is right, and `anisogran run` runs its quick size."""

from pathlib import Path

import pytest

from anisogran import cli
from anisogran import open as open_results
from anisogran.experiments import KINDS, read_scene
from anisogran.scenes import doubts_of

WARNED = {"ring_shear_volume": "warned: at constant volume the pressure on the inner ring went"}  # as it has to

SCENES = sorted((Path(__file__).parents[1] / "data_generation").glob("*.toml"))


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_the_quick_size_of_every_shipped_scene_runs(path, tmp_path):
    assert doubts_of(read_scene(path)) == doubts_of(read_scene(path, quick=True)) == []
    with pytest.raises(SystemExit) as end:
        cli.main(["run", str(path), "--quick", "--out", str(tmp_path / "run")])  # two seconds each, once it is compiled
    assert end.value.code == 0
    results = open_results(tmp_path / "run" / "results.h5")
    assert results.attrs["status"].startswith(WARNED.get(path.stem, "ok"))
    assert results["series"].sizes["time"] > 50


def test_every_experiment_has_a_scene():
    assert {read_scene(path).kind for path in SCENES} == set(KINDS)


def test_a_kind_is_said_once():
    """As the name of the experiment in files is the name of its file."""
    for kind, experiment in KINDS.items():
        assert experiment.kind == kind == experiment.__module__.split(".")[-1]
