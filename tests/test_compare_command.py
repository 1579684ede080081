"""`anisogran compare`: two runs in, predictions out, and one line for what does not fit."""

import json

import numpy as np
import pytest
import xarray as xr

import anisogran as ag
from anisogran import cli
from anisogran.cli.compare_command import titles
from anisogran.comparison import fitted_amplitude, frozen, predictions
from anisogran.files import save_results
from anisogran.scenes.writing import scene_text


def run(capsys, *arguments):
    with pytest.raises(SystemExit) as end:
        cli.main(["compare", *map(str, arguments)])
    captured = capsys.readouterr()
    return end.value.code, captured.out, captured.err


@pytest.fixture(scope="module")
def rings(tmp_path_factory):
    """Two small cells, one of them as a folder like `anisogran run` leaves it."""
    folder = tmp_path_factory.mktemp("rings")
    (folder / "second").mkdir()
    paths = folder / "first.h5", folder / "second"
    for path, seed in zip(paths, (1, 2), strict=True):
        cell = ag.RingShear(n=250, inner_radius=4.0, travel=12.0, discard=4.0, block=1.0, seed=seed)
        cell.run().save(path / "results.h5" if path.is_dir() else path)
    return paths


def test_a_run_is_predicted_with_what_another_was_fitted_to(rings, tmp_path, capsys):
    first, second = rings
    folder, numbers = tmp_path / "out", tmp_path / "numbers.json"
    code, printed, _ = run(capsys, second, "--calibrate", first, "--mu-s", 0.29, "--b", 1.1, "--out", folder, "--json", numbers)
    assert code == 0
    parameters = frozen([ag.open(first)], 0.29, 1.1)
    table = predictions(parameters, ag.open(second / "results.h5"))
    told = json.loads(numbers.read_text())
    assert told["parameters"]["amplitude"] == parameters.amplitude
    assert told["parameters"]["fitted_on"] == [str(first)]
    assert told["runs"][0]["rivals"]["nonlocal"]["l2"] == float(table.l2.sel(rival="nonlocal"))
    assert told["runs"][0]["rivals"]["copy"]["stress_ratio_wall"] is None
    assert f"A = {parameters.amplitude:.4g} +- {parameters.errors['amplitude']:.2g} d" in printed
    assert "very run" not in printed
    assert "warning: the error bars of the grains come from 8 blocks only" in printed
    assert "the error bars of the grains come from 8 blocks only" in told["runs"][0]["warnings"][0]
    assert told["parameters"]["warnings"] == list(parameters.reasons)
    assert json.loads(ag.open(folder / "compare.h5").attrs["parameters"]) == told["parameters"]
    np.testing.assert_array_equal(ag.open(folder / "compare.h5")["run1"].v_phi, table.v_phi)
    assert (folder / "compare.png").stat().st_size > 10_000


def test_runs_of_the_same_name_each_have_their_panel():
    assert titles(["a/results.h5", "b/results.h5"]) == ["a/results.h5", "b/results.h5"]
    assert titles(["a/first", "b/second.h5"]) == ["first", "second.h5"]


def test_friction_comes_from_a_file_of_homogeneous_shear_and_a_lone_run_is_fitted_itself(rings, tmp_path, capsys):
    inertial = np.geomspace(1e-3, 0.3, 12)
    mu = np.where(inertial < 0.2, 0.29 + 1.1 * inertial, 9.0)  # beyond 0.2 the law is not meant: it must not count
    steady = {"inertial_number": inertial, "stress_ratio": mu, "stress_ratio_error": np.full(12, 1e-3)}
    data = xr.Dataset({name: ("inertial_number_asked", value) for name, value in steady.items()})
    scene = ag.SimpleShear(friction=ag.Friction(stiffness=500.0, mu=0.3), size_ratio=2.0)
    cases = xr.Dataset({"state": ("seed", ["finished"])}, attrs={"scene": scene_text(scene)})
    save_results(tmp_path / "shear.h5", {"shear/cases": cases, "shear/steady": data}, {})
    code, printed, _ = run(capsys, rings[0], "--friction", tmp_path / "shear.h5", "--out", tmp_path / "out", "--json", tmp_path / "n.json")
    assert code == 0
    assert "(fitted on this very run)" in printed
    assert f"shear.h5; of other grains: mu = 0.3, in {rings[0]} 0.44)" in printed
    told = json.loads((tmp_path / "n.json").read_text())
    assert told["parameters"]["mu_s"] == pytest.approx(0.29, abs=1e-9)
    assert told["parameters"]["b"] == pytest.approx(1.1, abs=1e-8)
    found = fitted_amplitude(ag.open(rings[0]), told["parameters"]["mu_s"], told["parameters"]["b"])
    assert told["runs"][0]["rivals"]["nonlocal"]["l2"] == pytest.approx(found.l2, rel=1e-6)


def test_what_is_wrong_is_told_in_one_line_and_leaves_nothing(rings, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    other = tmp_path / "shear.h5"
    study = tmp_path / "study.h5"
    save_results(study, {"cell/cases": xr.Dataset({"state": ("seed", ["finished"])})}, {})
    ag.SimpleShear(n=60, strain=0.6, discard=0.1, inertial_number=0.1, frames=0).run().save(other)
    wrong = {
        (rings[0],): "compare: give --friction FILE, or --mu-s and --b",
        (rings[0], "--mu-s", 0.3): "compare: give --friction FILE, or --mu-s and --b",
        (rings[0], "--mu-s", -1, "--b", 1): "mu_s = -1 must be above 0",
        (other, "--mu-s", 0.3, "--b", 1): "shear.h5: the run has no ring profiles; it must come from RingShear",
        (study, "--mu-s", 0.3, "--b", 1): "study.h5: the file is a study, of cell; `study_runs` takes its runs one by one",
        (rings[0], "--friction", other): "shear.h5: has no group shear/steady",
        (tmp_path / "none", "--mu-s", 0.3, "--b", 1): "none",
    }
    for arguments, words in wrong.items():
        code, printed, error = run(capsys, *arguments)
        assert code == 2, arguments
        assert words in error
        assert not printed
        assert len(error.splitlines()) == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["shear.h5", "study.h5"]
