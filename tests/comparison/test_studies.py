"""The runs of a study of ring cells, one by one."""

import numpy as np
import pytest
import xarray as xr
from made_up import made_up_run

import anisogran as ag
from anisogran.comparison import measured, study_runs
from anisogran.files import save_results
from anisogran.outcome import InputError
from anisogran.scenes.writing import scene_text


def test_the_finished_runs_of_a_study_are_found_in_its_file(tmp_path):
    runs = {seed: made_up_run(noise=0.01, seed=seed) for seed in (1, 2, 3)}
    state = xr.DataArray(["finished", "failed", "finished"], dims="seed", coords={"seed": ("seed", list(runs), {"key": "seed"})})
    message = state.copy(data=["ok", "blew up", "warned: not steady"])
    cases = xr.Dataset({"state": state, "message": message}, attrs={"scene": scene_text(runs[1].scene)})
    parts = {
        name: xr.concat([getattr(run, name) for run in runs.values()], "seed", combine_attrs="override").assign_coords(seed=list(runs))
        for name in ("series", "profiles", "blocks")
    }
    parts["series"] = parts["series"].swap_dims(time="sample").reset_coords("time")
    path = tmp_path / "study.h5"
    save_results(path, {"cell/cases": cases} | {f"cell/{name}": part for name, part in parts.items()}, {"sources": "made up"})
    found = study_runs(ag.open(path), "cell")
    assert {name: run.status for name, run in found.items()} == {"seed=1": "ok", "seed=3": "warned: not steady"}
    for seed in (1, 3):
        run = found[f"seed={seed}"]
        assert run.scene.seed == seed
        np.testing.assert_array_equal(run.profiles.v_phi, runs[seed].profiles.v_phi)
        np.testing.assert_array_equal(run.profiles.attrs["edges"], runs[seed].profiles.attrs["edges"])
        np.testing.assert_array_equal(run.series.time, runs[seed].series.time)
        np.testing.assert_array_equal(run.blocks.v_phi.transpose("block", "r"), runs[seed].blocks.v_phi)
    with pytest.raises(InputError, match="the study has no other/cases; its sweeps are cell"):
        study_runs(ag.open(path), "other")
    with pytest.raises(InputError, match="compare: the file is a study, of cell; `study_runs` takes its runs one by one"):
        measured(ag.open(path))
