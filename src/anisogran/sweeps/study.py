"""A study: several sweeps, and of all their cases the wanted quantities in one small results file."""

import sys
from pathlib import Path

import numpy as np
import xarray as xr

from anisogran.files import check_writable, save_results
from anisogran.outcome import InputError
from anisogran.sweeps.collecting import collect_sweep
from anisogran.sweeps.running import sweep


def study(file, sweeps, variables, workers=None):
    """Runs sweeps {name: (scene, vary)} in folders beside a file and writes into it, and returns as an xarray.DataTree, what they recorded.

    `file.h5` gets the groups `name/cases` and `name/series` as `collect_sweep` gives them: of the series `variables`, in single
    precision (rounding of 6e-8, far below the noise of grains). The folder is the file without its suffix; it holds everything else,
    and what is done there is not done again, so that the same call goes on after an interruption. Scene and values that were varied stand
    in the attributes of each sweep, versions and a digest of the sources in those of the file. Raises what `sweep` raises,
    and InputError if the file cannot be written or a variable is none of the series.
    """
    check_writable(file)
    folder = Path(file).with_suffix("")
    if folder == Path(file):
        raise InputError(f"{file}: must have a suffix, such as .h5; without it, it names the folder of the sweeps")
    groups, attributes = {}, {}
    for name, (scene, vary) in sweeps.items():
        show = _Line(name) if sys.stderr.isatty() else None
        sweep(scene, vary, folder / name, workers=workers, listen=show)
        collected = collect_sweep(folder / name)
        groups[f"{name}/cases"] = collected["cases"].to_dataset().assign_attrs(collected.attrs)
        groups[f"{name}/series"] = in_single_precision(collected["series"].to_dataset(), variables)
    save_results(file, groups, attributes)
    return xr.DataTree.from_dict(groups)


def in_single_precision(series, variables):
    """These variables of a Dataset, real numbers as float32. Raises InputError for one that it has not."""
    missing = [name for name in variables if name not in series]
    if missing:
        raise InputError(f"study: {missing[0]} is not recorded; there are {', '.join(sorted(map(str, series.data_vars)))}")
    return series[list(variables)].map(lambda values: values.astype(np.float32), keep_attrs=True)


class _Line:
    """Shows how far a sweep is, on one line of a terminal."""

    def __init__(self, name):
        self.name = name

    def __call__(self, progress):
        end = "\n" if progress.finished + progress.failed == progress.cases else "\r"
        print(f"{self.name}: {progress.finished} of {progress.cases} cases, {progress.fraction:4.0%}", end=end, file=sys.stderr, flush=True)
