import errno
import os
import re
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr

from anisogran import InputError, RunFailed, average, whole_file
from anisogran import open as open_results
from anisogran.dem import Grains, Linear, Periodic, Simulation
from anisogran.files import read_snapshot, save_results, snapshot_dataset, write_json
from anisogran.files.hdf5_writing import NUMBERS
from anisogran.files.results import MARK, results_bytes
from anisogran.snapshot import Snapshot
from anisogran.whole_file import DIGITS


def test_round_trip_keeps_values_labels_and_units(tmp_path, rng):
    data = xr.Dataset({"s_D": ("time", rng.normal(size=7), {"units": "1"})}, coords={"time": np.arange(7.0)})
    path = tmp_path / "größe.h5"
    save_results(path, {"a/series": data}, {"seed": 3})
    back = open_results(path)
    xr.testing.assert_identical(back["a/series"].to_dataset(), data)
    assert back.attrs["seed"] == 3
    assert list(tmp_path.iterdir()) == [path]  # no temporary file is left


@pytest.mark.hard_case("F4")
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


def test_places_that_cannot_be_written_are_refused_before_anything(tmp_path, monkeypatch):
    for path, message in [
        (tmp_path / "no" / "a.h5", "its folder does not exist"),
        (tmp_path, "it is a folder"),
        (Path("/dev/full"), "it is no regular file"),
        (tmp_path / ("x" * 300), "File name too long"),
        (None, "None is no path"),
        ("a\0b", "is no path"),
    ]:
        with pytest.raises(InputError, match=message) as caught:
            save_results(path, {}, {})
        assert "\n" not in str(caught.value)
    monkeypatch.setattr("os.access", lambda path, mode: False)  # root may write everywhere
    with pytest.raises(InputError, match="no permission for its folder"):
        save_results(tmp_path / "a.h5", {}, {})
    assert list(tmp_path.iterdir()) == []


def test_every_other_file_is_named_for_what_it_is(tmp_path):
    sim = Simulation(Grains([[1.0, 1.0]], [0.5]), Linear(1e3), boundary=Periodic(4.0, 5.0))
    sim.save(tmp_path / "checkpoint.npz")
    with h5py.File(tmp_path / "foreign.h5", "w") as file:
        file["x"] = np.arange(1000)
    whole = (tmp_path / "foreign.h5").read_bytes()
    for name, content in {
        "cut.h5": whole[:500],
        "scene.toml": b"[material]\n",
        "empty.h5": b"",
        "bytes": b"\xff\x00" * 90,
        "old.nc": b"CDF\1",
    }.items():
        (tmp_path / name).write_bytes(content)
    for name, message in {
        "checkpoint.npz": "is a zip archive, such as a checkpoint",
        "foreign.h5": "has no seal of anisogran; .* xarray.open_datatree",
        "cut.h5": "has no seal of anisogran",
        "scene.toml": "is a text, and no results file",
        "empty.h5": "is empty",
        "bytes": "is no HDF5 file",
        "old.nc": "is a netCDF-3 file",
        "missing.h5": "cannot be read (No such file or directory)",
        ".": "is a folder",
    }.items():
        with pytest.raises(InputError) as caught:
            open_results(tmp_path / name)
        assert re.fullmatch(re.escape(f"{tmp_path / name}: ") + message.replace("(", r"\(").replace(")", r"\)") + ".*", str(caught.value))


def test_a_file_changed_by_hand_is_refused_but_can_be_read_with_xarray(tmp_path):
    path = tmp_path / "a.h5"
    save_results(path, {"a": xr.Dataset({"x": ("t", np.arange(100.0))})}, {})
    with h5py.File(path, "a") as file:
        file["a/x"][3] = -1.0
    with pytest.raises(
        InputError, match=r"a.h5: (was damaged or changed by hand|has no seal).*xarray.open_datatree\(path, engine='h5netcdf'\)"
    ):
        open_results(path)
    with xr.open_datatree(path, engine="h5netcdf") as tree:
        assert tree["a/x"].values[3] == -1.0


KINDS = {
    "numbers": xr.Dataset({f"x{kind}": ("t", np.arange(5).astype(kind)) for kind in sorted(NUMBERS)}),
    "bool": xr.Dataset({"flag": ("t", np.array([True, False, True])), "one": ((), True)}),
    "text": xr.Dataset({"word": ("t", np.array(["a", "größer", ""])), "one": ((), "µ")}, {"t": ["p", "q", "r"]}),
    "scalars": xr.Dataset({"x": 1.5, "n": np.int64(3)}, {"z": 2.0}),
    "not a number": xr.Dataset({"x": ("t", np.array([np.nan, np.inf, -np.inf, -0.0, 5e-324]))}),
    "nothing": xr.Dataset(),
    "no contacts": xr.Dataset({"force": (("contact", "axis"), np.zeros((0, 2))), "overlap": ("contact", np.zeros(0))}),
    "nothing along time": xr.Dataset({"x": ("time", np.zeros(0))}, {"time": np.zeros(0)}),
    "a dimension alone": xr.Dataset(coords={"r": np.arange(3.0)}),
    "coordinates": xr.Dataset(
        {"x": (("t", "r"), np.arange(6.0).reshape(2, 3))},
        {"t": [0.0, 1.0], "depth": ("r", np.arange(3.0), {"units": "1"}), "both": (("t", "r"), np.ones((2, 3))), "side": ((), 4)},
    ),
    "equal sides": xr.Dataset({"x": (("t", "r"), np.eye(3)), "y": (("r", "t"), np.ones((3, 3))), "z": (("r", "r2"), np.ones((3, 3)))}),
    "order": xr.Dataset({name: ("t", np.zeros(1)) for name in "zaymb"}),
    "not in a row": xr.Dataset({"x": (("t", "r"), np.arange(12.0).reshape(3, 4).T[::2])}),
    "big end first": xr.Dataset({"x": ("t", np.arange(3, dtype=">f8"))}),
    "attributes": xr.Dataset(
        {"x": ("t", np.zeros(2), {"units": "m/s", "values": [1.0, 2.0], "count": 3, "words": ["a", "b"]})},
        attrs={"empty": "", "greek": "σ\nε", "long": "x" * 100_000, "many": np.arange(20_000.0), "one": np.float32(0.1), "none": []},
    ),
}  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_comes_back_from_us_and_from_xarray(kind, tmp_path):
    data = KINDS[kind]
    path = tmp_path / "a.h5"
    save_results(path, {"group": data}, {})
    ours = open_results(path)
    with xr.open_datatree(path, engine="h5netcdf") as tree:
        theirs = tree.load()
    assert ours.identical(theirs)
    for tree in (ours, theirs):
        back = tree["group"].to_dataset()
        xr.testing.assert_identical(back, data)
        assert list(back.data_vars) == list(data.data_vars)
        for name, variable in data.variables.items():
            assert back[name].dtype == variable.dtype.newbyteorder("=") or (variable.dtype.kind in "UT" and back[name].dtype.kind in "UTO")
            if variable.dtype.kind == "f":
                assert np.array_equal(np.signbit(back[name].values), np.signbit(variable.values))


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (xr.Dataset({"x": ("t", np.array([1, None]))}), "variable 'x': 1 is no text that can be kept"),
        (xr.Dataset({"x": ("t", np.array(["a\0b"], dtype=object))}), "is no text that can be kept"),
        (xr.Dataset({"x": ("t", np.array(["\ud800"], dtype=object))}), "is no text that can be kept"),
        (xr.Dataset({"x": ("t", np.array([1j]))}), "variable 'x' has dtype complex128"),
        (xr.Dataset({"x": ("t", np.array(["2020-01-01"], "datetime64[ns]"))}), "variable 'x' has dtype datetime64"),
        (xr.Dataset({"a/b": 1}), "'a/b' is no name of a variable"),
        (xr.Dataset({3: 1}), "3 is no name of a variable"),
        (xr.Dataset(coords={"a b": 1}), "'a b' is a coordinate with a space in its name"),
        (xr.Dataset(attrs={"x": None}), "attribute 'x' = None"),
        (xr.Dataset(attrs={"x": True}), "attribute 'x' = True"),
        (xr.Dataset(attrs={"x": [[1, 2]]}), "more than one axis"),
        (xr.Dataset(attrs={"x": ["a", 1]}), "attribute 'x' = "),
        (xr.Dataset(attrs={"x": object()}), "attribute 'x' = "),
        (xr.Dataset({"x": ("string2", ["a", "b", "c"])}), "'string2' is a name that its texts need"),
        (xr.Dataset({"x": ("t", ["a", "b"]), "string2": 1.0}), "'string2' is a name that its texts need"),
        (xr.Dataset({"x": ("t", [1.0], {"_FillValue": 2.0})}), "attribute '_FillValue' has another meaning"),
        (xr.Dataset({"x": ("t", [1.0], {"scale_factor": 2.0})}), "attribute 'scale_factor' has another meaning"),
    ],
)  # fmt: skip
def test_what_the_file_cannot_hold_is_refused_by_name(data, message, tmp_path):
    with pytest.raises(TypeError, match=message) as caught:
        save_results(tmp_path / "a.h5", {"group": data}, {})
    assert str(caught.value).startswith("group 'group': ")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("names", [["a", "a/b"], [""], ["/a"], ["a/"], ["a//b"], ["a/../b"]])
def test_groups_have_plain_names(names, tmp_path):
    with pytest.raises(TypeError, match="group '"):
        save_results(tmp_path / "a.h5", {name: xr.Dataset({"x": 1}) for name in names}, {})


def test_the_same_results_make_the_same_bytes(tmp_path):
    content = bytes(results_bytes(KINDS, {}))
    time.sleep(1.1)  # dates in HDF5 have seconds; nothing may carry one
    assert content == bytes(results_bytes(KINDS, {}))


@pytest.mark.hard_case("F3")
def test_no_damage_goes_unnoticed(damages, tmp_path, answer):
    """300 random flips, cuts and zeroed blocks anywhere in a real file: not one is read."""
    sim = Simulation(Grains([[1.0, 1.0], [1.9, 1.0]], [0.5, 0.5]), Linear(1e3), boundary=Periodic(4.0, 5.0))
    path = tmp_path / "a.h5"
    save_results(path, {"snapshots/end": snapshot_dataset(sim.snapshot()), "series": KINDS["coordinates"]}, {})
    good = path.read_bytes()
    for damaged in damages(good, 300):
        path.write_bytes(damaged)
        with pytest.raises(InputError, match=r"a.h5: [^\n]*$"):
            open_results(path)
    answer.named("300 of 300 damaged results files found")


def test_every_bit_of_the_seal_counts(tmp_path):
    path = tmp_path / "a.h5"
    save_results(path, {}, {})
    good = path.read_bytes()
    for bit in range(8 * (len(good) - DIGITS - len(MARK)), 8 * len(good)):
        damaged = bytearray(good)
        damaged[bit // 8] ^= 1 << bit % 8
        path.write_bytes(damaged)
        with pytest.raises(InputError):
            open_results(path)


def test_a_file_that_grows_too_large_leaves_the_old_one(tmp_path):
    path = tmp_path / "a.h5"
    code = """
import resource, sys
import numpy as np, xarray as xr
from anisogran.files import save_results
from anisogran.outcome import RunFailed
save_results(sys.argv[1], {"old": xr.Dataset()}, {})
resource.setrlimit(resource.RLIMIT_FSIZE, (100_000,) * 2)
try:
    save_results(sys.argv[1], {"new": xr.Dataset({"x": ("t", np.zeros(50_000))})}, {})
except RunFailed as error:
    print(error)
"""
    told = subprocess.run([sys.executable, "-c", code, path], capture_output=True, text=True, check=True).stdout
    assert told == f"{path}: cannot be written ({os.strerror(errno.EFBIG)})\n"
    assert list(open_results(path).children) == ["old"]
    assert list(tmp_path.iterdir()) == [path]


def test_a_full_disk_leaves_the_old_file(tmp_path, monkeypatch):
    """The temporary file is led to /dev/full, where every write ends in ENOSPC."""
    path = tmp_path / "a.h5"
    save_results(path, {"old": xr.Dataset()}, {})
    monkeypatch.setattr(whole_file, "open", lambda path, mode: open("/dev/full", "wb"), raising=False)  # noqa: SIM115
    with pytest.raises(RunFailed, match=re.escape(f"{path}: cannot be written ({os.strerror(errno.ENOSPC)})")):
        save_results(path, {"new": xr.Dataset()}, {})
    monkeypatch.undo()
    assert list(open_results(path).children) == ["old"]
    assert list(tmp_path.iterdir()) == [path]


def test_json_has_no_nan_and_is_replaced_whole(tmp_path):
    path = tmp_path / "numbers.json"
    path.write_text("old")
    write_json(path, {"a": 1.5, "b": float("nan")})
    assert path.read_text() == '{\n  "a": 1.5,\n  "b": null\n}\n'
    assert list(tmp_path.iterdir()) == [path]
