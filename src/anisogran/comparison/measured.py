"""The ring shear cell as it was measured: a run in memory, a results file, or a case of a study."""

from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from anisogran.experiments import RingShear
from anisogran.experiments.scene_file import scene_from
from anisogran.outcome import InputError


@dataclass(frozen=True, eq=False)
class Measured:
    """What a comparison needs of a run: scene, series over time, profiles over r with their errors, blocks (None if they are not kept), and
    how it ended, the text of its Status."""

    scene: RingShear
    series: xr.Dataset
    profiles: xr.Dataset
    blocks: xr.Dataset | None = None
    status: str = "ok"


def measured(run, who="compare"):
    """The run itself, or the Measured of a results file as `open` gives it. Raises InputError if it is none of a RingShear."""
    if isinstance(run, (str, Path)):
        raise InputError(f"{who}: {str(run)!r} is a path; give a run, or what `open` makes of its results file")
    if isinstance(run, xr.DataTree):
        if any("cases" in child.children for child in run.children.values()):
            raise InputError(f"{who}: the file is a study, of {', '.join(run.children)}; `study_runs` takes its runs one by one")
        if "scene" not in run.attrs or "series" not in run.children:
            raise InputError(f"{who}: the results file is not that of a run; it has {', '.join(run.children) or 'nothing'}")
        groups = {name: run[name].to_dataset() if name in run.children else None for name in ("series", "profiles", "blocks")}
        run = Measured(
            scene_from(run.attrs["scene"], f"{who}: attribute scene of the results file"), **groups, status=run.attrs.get("status", "ok")
        )
    if getattr(run, "profiles", None) is None or "v_phi" not in run.profiles:
        raise InputError(f"{who}: the run has no ring profiles; it must come from RingShear")
    return run


def remarks(run):
    """What a reader of any number must know of a run: a tuple of one sentence if it ended with a warning, else empty."""
    return () if str(run.status) == "ok" else (f"the run of the grains ended as {run.status}",)
