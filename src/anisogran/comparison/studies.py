"""The runs of a study of ring cells, one by one, as a comparison takes them."""

import itertools
import math

import numpy as np

from anisogran.comparison.measured import Measured
from anisogran.experiments.scene_file import scene_from
from anisogran.outcome import InputError
from anisogran.scenes.changes import changed


def study_runs(study, group):
    """{"seed=1": Measured, ...} of the finished cases of one sweep (`group`) of a study file of ring cells, as `open` gives it.

    Raises InputError if the study has no such sweep, or this no profiles.
    """
    wanted = [f"{group}/{name}" for name in ("cases", "series", "profiles", "blocks")]
    groups = {path.lstrip("/") for path in study.groups}  # a DataTree finds a path by [], but not by "in"
    missing = [name for name in wanted if name not in groups]
    if missing:
        raise InputError(f"study_runs: the study has no {missing[0]}; its sweeps are {', '.join(study.children)}")
    cases, series, profiles, blocks = (study[name].to_dataset() for name in wanted)
    scene, axes, runs = scene_from(cases.attrs["scene"], f"study_runs: {group}"), cases.state.dims, {}
    for place in itertools.product(*(range(cases.sizes[dim]) for dim in axes)):
        at = dict(zip(axes, place, strict=True))
        if str(cases.state.isel(at).values) == "finished":
            values = {cases[dim].attrs["key"]: cases[dim].values[k].item() for dim, k in at.items()}
            own = changed(scene, values)
            parts = over_time(series.isel(at), own), over_r(profiles.isel(at), own), over_r(blocks.isel(at), own)
            runs[", ".join(f"{key}={value}" for key, value in values.items())] = Measured(own, *parts, str(cases.message.isel(at).values))
    return runs


def over_r(data, scene):
    """Profiles (or blocks of them) of one case over its own rings: where cases differ in these, shorter ones end in NaN in a study."""
    if "r_index" in data.dims:
        data = data.isel(r_index=np.isfinite(data.r.values)).swap_dims(r_index="r")
    d, r = scene.mean_diameter, data.r.values
    count = data.sizes.get("block", data.attrs.get("blocks", 1))
    edges = np.append(r - 0.5 * d, r[-1] + 0.5 * d)
    return data.assign_coords(r=r, depth=("r", (r - scene.inner_radius) / d)).assign_attrs(edges=edges, blocks=count)


def over_time(series, scene):
    """The series of one case over time, which the turns of the inner ring and its speed tell where it is not kept."""
    if "time" not in series:
        series = series.assign(time=series.turns * (2 * math.pi * scene.inner_radius / scene.wall_speed))
    return series.isel(sample=np.isfinite(series.time.values)).swap_dims(sample="time")
