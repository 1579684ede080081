"""`anisogran average`: files in, fields out, and one line for what does not fit."""

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import anisogran as ag
from anisogran import cli
from anisogran.files import snapshot_stream
from anisogran.outcome import InputError

DATA = Path(__file__).parent / "files" / "data"


def run(capsys, *arguments):
    with pytest.raises(SystemExit) as end:
        cli.main(["average", *map(str, arguments)])
    captured = capsys.readouterr()
    return end.value.code, captured.out, captured.err


@pytest.fixture(scope="module")
def sheared(tmp_path_factory):
    path = tmp_path_factory.mktemp("run") / "shear.h5"
    ag.SimpleShear(n=60, strain=1.0, discard=0.4, inertial_number=0.05, frames=8, seed=3).run().save(path)
    return path


def test_fields_of_a_results_file_go_to_hdf5_and_json(sheared, tmp_path, capsys):
    out, numbers = tmp_path / "F.h5", tmp_path / "J.json"
    code, printed, _ = run(capsys, sheared, "--fields", "stress, pressure", "--out", out, "--json", numbers)
    assert code == 0
    expected = ag.average(ag.open(sheared), fields=["stress", "pressure"])
    saved = ag.open(out)["average"].to_dataset()
    xr.testing.assert_equal(saved, expected)
    assert saved.pressure.attrs["units"] == "N/m"
    assert saved.attrs["snapshots"] == 8
    data = json.loads(numbers.read_text())
    np.testing.assert_array_equal(data["fields"]["stress"]["values"], expected.stress)
    assert data["fields"]["stress"]["dims"] == ["i", "j"]
    assert data["fields"]["pressure_error"]["units"] == "N/m"
    assert f"{float(expected.pressure):.5g} +- {float(expected.pressure_error):.2g} N/m" in printed
    code, _, error = run(capsys, sheared, "--out", out)
    assert code == 2
    assert "the file is there; choose another or add --force" in error
    assert run(capsys, sheared, "--out", out, "--force")[0] == 0


def test_a_grid_and_points_from_a_file(sheared, tmp_path, capsys):
    points = tmp_path / "points.txt"
    points.write_text("1.0 2.0\n3.0 1.5\n")
    code, printed, _ = run(capsys, sheared, "--on", "points", "--points", points, "--width", "1.5d", "--fields", "density,velocity")
    assert code == 0
    assert "over 2 point" in printed
    code, printed, _ = run(capsys, sheared, "--on", "grid", "--width", "2.0d", "--kernel", "lucy", "--every", "4")
    assert code == 0
    assert " x " in printed


def test_lammps_files_are_read_as_they_are(capsys):
    code, printed, error = run(capsys, DATA / "periodic_grains.dump", DATA / "periodic_contacts.dump", "--fields", "pressure,fabric_trace")
    assert code == 0, error
    (snapshot,) = list(snapshot_stream(DATA / "periodic_grains.dump", DATA / "periodic_contacts.dump"))[:1]
    assert len(snapshot.pairs) > 10
    assert "pressure" in printed


def test_what_does_not_fit_is_one_line(sheared, tmp_path, capsys):
    (tmp_path / "bad.txt").write_text("1.0 x\n")
    (tmp_path / "grains.data").write_text("")
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "results.h5").touch()
    for arguments, message in [
        ([tmp_path / "none.h5"], "none.h5: cannot be read (No such file"),
        ([tmp_path], "is a folder, not a file\n"),
        ([tmp_path / "run"], f"run: is a folder, not a file; did you mean {tmp_path / 'run' / 'results.h5'}?"),
        ([sheared, "--on", "sphere"], "on = 'sphere' must be one of"),
        ([sheared, "--fields", "strss"], "unknown field 'strss'; did you mean stress?"),
        ([sheared, "--on", "rings"], "no axis to lay rings about"),
        ([sheared, "--width", "1.0d"], "the whole sample has no width"),
        ([sheared, "--on", "points", "--points", tmp_path / "bad.txt"], "--points "),
        ([sheared, DATA / "periodic_contacts.dump"], "give neither contacts nor density"),
        ([tmp_path / "grains.data"], "the density of the grains is needed"),
        ([DATA / "periodic_grains.dump", "--code", "yade"], "code = 'yade' must be one of"),
        ([DATA / "periodic_contacts.dump"], "periodic_contacts.dump"),
        ([sheared, "--json", tmp_path / "no" / "a.json"], "cannot be written"),
        ([sheared, "--every", "0"], "--every"),
    ]:
        code, printed, error = run(capsys, *arguments)
        assert code == 2, (arguments, error)
        assert message in error
        assert error.count("\n") == 1
        assert printed == ""


def test_a_file_is_told_by_its_name(sheared):
    with pytest.raises(InputError, match="masses"):
        snapshot_stream(sheared, density=2000.0)
    assert len(snapshot_stream(sheared, every=3)) == 3
