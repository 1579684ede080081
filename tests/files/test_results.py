from dataclasses import replace

import h5py
import numpy as np
import pytest
import xarray as xr

from anisogran import InputError, average
from anisogran import open as open_results
from anisogran.dem import Grains, Linear, Periodic, Simulation
from anisogran.files import read_snapshot, save_results, snapshot_dataset, write_json
from anisogran.snapshot import Snapshot


def test_round_trip_keeps_values_labels_and_units(tmp_path, rng):
    data = xr.Dataset({"s_D": ("time", rng.normal(size=7), {"units": "1"})}, coords={"time": np.arange(7.0)})
    path = tmp_path / "größe.h5"
    save_results(path, {"a/series": data}, {"seed": 3})
    back = open_results(path)
    xr.testing.assert_identical(back["a/series"].to_dataset(), data)
    assert back.attrs["seed"] == 3
    assert list(tmp_path.iterdir()) == [path]  # no temporary file is left


def test_a_failing_write_keeps_the_old_file(tmp_path):
    path = tmp_path / "r.h5"
    save_results(path, {"a": xr.Dataset(attrs={"n": 1})}, {})
    with pytest.raises(TypeError):
        save_results(path, {"a": xr.Dataset(attrs={"n": object()})}, {})
    assert open_results(path)["a"].attrs["n"] == 1


def test_snapshot_has_all_its_arrays():
    snapshot = Snapshot(
        [[0.0, 0.0], [0.9, 0.0]], [0.5, 0.5], [1.0, 1.0], np.zeros((2, 2)), np.zeros(2), np.array([[0, 1]]), [[-1.0, 0]], [[0.45, 0]],
        [0.1], cell=4 * np.eye(2), fixed=[False, True], time=0.25,
    )  # fmt: skip
    data = snapshot_dataset(snapshot)
    assert data.sizes == {"grain": 2, "axis": 2, "contact": 1, "partner": 2, "lattice": 2}
    assert data.attrs["volume"] == pytest.approx(16.0)
    assert data.attrs["time"] == 0.25
    assert data.fixed.values.tolist() == [0, 1]
    assert all("units" in data[name].attrs for name in data)


def test_a_snapshot_is_read_back(tmp_path):
    sim = Simulation(Grains([[1.0, 1.0], [1.9, 1.0], [0.1, 3.0]], [0.5, 0.5, 0.5]), Linear(1e3), boundary=Periodic(4.0, 5.0))
    snapshot = replace(sim.snapshot(), fixed=[False, False, True])
    save_results(tmp_path / "s.h5", {"snapshots/end": snapshot_dataset(snapshot)}, {})
    back = read_snapshot(open_results(tmp_path / "s.h5")["snapshots/end"])
    for name in ("position", "radius", "mass", "velocity", "spin", "pairs", "force", "point", "overlap", "cell", "fixed"):
        np.testing.assert_array_equal(getattr(back, name), getattr(snapshot, name))
    assert (back.volume, back.time, back.fixed.dtype) == (snapshot.volume, snapshot.time, bool)
    xr.testing.assert_identical(average(back), average(snapshot))
    with pytest.raises(InputError, match="no variable 'position'"):
        read_snapshot(xr.Dataset())


def test_places_that_cannot_be_written_are_refused_before_anything(tmp_path):
    for path, message in [(tmp_path / "no" / "a.h5", "No such file or directory"), (tmp_path, "is a folder"), (None, "is no path")]:
        with pytest.raises(InputError, match=message):
            save_results(path, {}, {})
    assert list(tmp_path.iterdir()) == []


def test_unreadable_files_get_one_line(tmp_path):
    text = tmp_path / "text.h5"
    text.write_text("no HDF5")
    with h5py.File(tmp_path / "cut.h5", "w") as file:
        file["x"] = np.arange(1000)
    whole = (tmp_path / "cut.h5").read_bytes()
    (tmp_path / "cut.h5").write_bytes(whole[: len(whole) // 2])
    with h5py.File(tmp_path / "foreign.h5", "w") as file:
        file["x"] = np.arange(3)
    with pytest.raises(InputError, match=r"foreign.h5: not"):
        open_results(tmp_path / "foreign.h5")
    for path in (text, tmp_path / "cut.h5", tmp_path / "missing.h5"):
        with pytest.raises(InputError, match=path.name) as caught:
            open_results(path)
        assert "\n" not in str(caught.value)


def test_json_has_no_nan_and_is_replaced_whole(tmp_path):
    path = tmp_path / "numbers.json"
    path.write_text("old")
    write_json(path, {"a": 1.5, "b": float("nan")})
    assert path.read_text() == '{\n  "a": 1.5,\n  "b": null\n}\n'
    assert list(tmp_path.iterdir()) == [path]
