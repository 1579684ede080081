"""A study keeps of each sweep what was asked for, and refuses a file that it cannot write before anything runs."""

import numpy as np
import pytest

import anisogran as ag
from anisogran.files import read_snapshot
from anisogran.sweeps.study import in_single_precision

SCENE = ag.SimpleShear(n=60, strain=0.6, discard=0.05, inertial_number=0.2, frames=0)


def test_two_sweeps_in_one_file(tmp_path):
    path = tmp_path / "both.h5"
    sweeps = {"slow": (SCENE, {"seed": [1]}), "fast": (ag.SimpleShear(**{**SCENE.model_dump(), "inertial_number": 0.3}), {"seed": [1, 2]})}
    made = ag.study(path, sweeps, ["strain", "s_D"], workers=1)
    whole = ag.collect_sweep(tmp_path / "both" / "fast")
    kept = ag.open(path)
    assert set(kept.children) == {"slow", "fast"}
    assert set(kept["fast/series"].data_vars) == {"strain", "s_D"}
    np.testing.assert_array_equal(kept["fast/series"].s_D, whole["series"].s_D.astype(np.float32))
    assert kept["fast/series"].s_D.attrs == whole["series"].s_D.attrs
    assert kept["fast/cases"].attrs["scene"] == whole.attrs["scene"]
    assert kept["slow/cases"].sizes["seed"] == 1
    assert made["slow/series"].to_dataset().equals(kept["slow/series"].to_dataset())


def test_what_is_wrong_is_told_in_one_line(tmp_path):
    with pytest.raises(ag.InputError, match=r"both: must have a suffix, such as .h5"):
        ag.study(tmp_path / "both", {"one": (SCENE, {"seed": [1]})}, ["s_D"])
    with pytest.raises(ag.InputError, match=r"nowhere"):
        ag.study(tmp_path / "nowhere" / "both.h5", {"one": (SCENE, {"seed": [1]})}, ["s_D"])
    assert not list(tmp_path.iterdir())
    series = ag.SimpleShear(**{**SCENE.model_dump(), "strain": 0.55}).run().series
    with pytest.raises(ag.InputError, match=r"study: sigma_zz is not recorded; there are anisotropy, area_fraction"):
        in_single_precision(series, ["s_D", "sigma_zz"])


def test_whole_groups_and_snapshots_are_kept_when_asked_for(tmp_path):
    """Of a ring: profiles, blocks and tables in single precision, and the last snapshot of each case, which can be averaged again."""
    scene = ag.RingShear(n=150, inner_radius=3.0, travel=2.0, discard=0.5, block=0.5, frames=0)
    beside = ["profiles", "blocks", "circles"]
    ag.study(tmp_path / "ring.h5", {"one": (scene, {"seed": [1]})}, ["turns"], workers=1, beside=beside, snapshots=["end"])
    kept, run = ag.open(tmp_path / "ring.h5"), ag.open(tmp_path / "ring" / "one" / "seed_1" / "results.h5")
    assert set(kept["one"].children) == {"cases", "series", *beside, "snapshots"}
    for group, name in (("profiles", "v_phi"), ("blocks", "stress"), ("circles", "cut_pressure_error")):
        values = kept[f"one/{group}"][name]
        assert values.dtype == np.float32
        np.testing.assert_array_equal(values.sel(seed=1), run[group][name].astype(np.float32))
    end = read_snapshot(kept["one/snapshots/seed_1/end"])
    assert end.pairs.dtype == np.int64
    np.testing.assert_array_equal(end.position, run["snapshots/end"].position.astype(np.float32))
    with pytest.raises(ag.InputError, match="study: layer is not recorded; there are cases, series, profiles, blocks"):
        ag.study(tmp_path / "ring.h5", {"one": (scene, {"seed": [1]})}, ["turns"], workers=1, beside=["layer"])
    with pytest.raises(ag.InputError, match="study: snapshots/last is not recorded"):
        ag.study(tmp_path / "ring.h5", {"one": (scene, {"seed": [1]})}, ["turns"], workers=1, snapshots=["last"])
