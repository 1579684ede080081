"""A study: several sweeps, and of all their cases the wanted quantities in one small results file."""

import sys
from pathlib import Path

import numpy as np
import xarray as xr

from anisogran.files import check_writable, save_results
from anisogran.files import open as open_results
from anisogran.outcome import InputError
from anisogran.sweeps.collecting import collect_sweep
from anisogran.sweeps.running import sweep


def study(file, sweeps, variables, workers=None, beside=(), snapshots=()):
    """Runs sweeps {name: (scene, vary)} in folders beside a file and writes into it, and returns as an xarray.DataTree, what they recorded.

    `file.h5` gets the groups `name/cases` and `name/series` as `collect_sweep` gives them: of the series `variables`, in single
    precision (rounding of 6e-8, far below the noise of grains). So does each further group of the results named in `beside`, such as
    "profiles" and "blocks", whole; and `name/snapshots/CASE/SNAPSHOT` each of the `snapshots` named, such as "end", which
    `files.read_snapshot` reads. The folder is the file without its suffix; it holds everything else, and what is done there is not done
    again, so that the same call goes on after an interruption. Scene and values that were varied stand in the attributes of each sweep,
    versions and a digest of the sources in those of the file. Raises what `sweep` raises, and InputError if the file cannot be written
    or what is asked for is not recorded.
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
        for group in beside:
            groups[f"{name}/{group}"] = in_single_precision(named(collected, group).to_dataset())
        cases = collected["cases"].to_dataset()
        for case in cases.folder.values[cases.state.values == "finished"] if snapshots else ():
            kept = open_results(folder / name / case / "results.h5")
            for snapshot in snapshots:
                groups[f"{name}/snapshots/{case}/{snapshot}"] = in_single_precision(named(kept, f"snapshots/{snapshot}").to_dataset())
    save_results(file, groups, attributes)
    return xr.DataTree.from_dict(groups)


def named(tree, group):
    """That group of a DataTree. Raises InputError for one that it has not."""
    try:
        return tree[group]
    except KeyError:
        raise InputError(f"study: {group} is not recorded; there are {', '.join(tree.children)}") from None


def in_single_precision(data, variables=None):
    """These variables (default all) of a Dataset, real numbers as float32. Raises InputError for one that it has not."""
    variables = list(data.data_vars) if variables is None else variables
    missing = [name for name in variables if name not in data]
    if missing:
        raise InputError(f"study: {missing[0]} is not recorded; there are {', '.join(sorted(map(str, data.data_vars)))}")
    return data[list(variables)].map(lambda values: values.astype(np.float32) if values.dtype.kind == "f" else values, keep_attrs=True)


class _Line:
    """Shows how far a sweep is, on one line of a terminal."""

    def __init__(self, name):
        self.name = name

    def __call__(self, progress):
        end = "\n" if progress.finished + progress.failed == progress.cases else "\r"
        print(f"{self.name}: {progress.finished} of {progress.cases} cases, {progress.fraction:4.0%}", end=end, file=sys.stderr, flush=True)
