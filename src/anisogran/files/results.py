"""Results as one HDF5 file that `xarray.open_datatree(path, engine="h5netcdf")` opens: labelled data with units."""

import os
from dataclasses import MISSING, fields
from pathlib import Path

import xarray as xr

import anisogran
from anisogran.files.numbers import check_writable
from anisogran.glossary import CONVENTIONS, attributes
from anisogran.outcome import InputError
from anisogran.snapshot import Snapshot, frames


def save_results(path, datasets, attributes):
    """Writes a mapping of "group/name" to Dataset, with attributes at the root; an older file is replaced only when all is written."""
    check_writable(path)
    root = xr.Dataset(attrs={"anisogran": anisogran.__version__, "conventions": CONVENTIONS, **attributes})
    tree = xr.DataTree.from_dict({"/": root, **{f"/{name}": dataset for name, dataset in datasets.items()}})
    temporary = Path(f"{path}.tmp")
    try:
        tree.to_netcdf(temporary, engine="h5netcdf")
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


def snapshot_dataset(snapshot):
    """A Snapshot as a labelled Dataset over grain, contact and axis."""
    grain, contact = ("grain", "axis"), ("contact", "axis")
    variables = {
        "position": (grain, snapshot.position, {"units": "m", "long_name": "centre"}),
        "velocity": (grain, snapshot.velocity, attributes("velocity")),
        "radius": ("grain", snapshot.radius, {"units": "m", "long_name": "radius"}),
        "mass": ("grain", snapshot.mass, {"units": "kg", "long_name": "mass"}),
        "spin": (grain[: snapshot.spin.ndim], snapshot.spin, attributes("spin")),
        "fixed": ("grain", snapshot.fixed.astype("i1"), {"units": "1", "long_name": "1 for a grain that belongs to a wall"}),
        "pairs": (("contact", "partner"), snapshot.pairs, {"units": "1", "long_name": "grain indices; a wall w is -1 - w"}),
        "force": (contact, snapshot.force, {"units": "N", "long_name": "whole force on the first grain of the pair"}),
        "point": (contact, snapshot.point, {"units": "m", "long_name": "contact point"}),
        "overlap": ("contact", snapshot.overlap, {"units": "m", "long_name": "overlap"}),
    }
    if snapshot.cell is not None:
        variables["cell"] = (("lattice", "axis"), snapshot.cell, {"units": "m", "long_name": "lattice vectors"})
    if snapshot.cell_velocity is not None:
        meaning = {"units": "m/s", "long_name": "rate of change of the lattice vectors"}
        variables["cell_velocity"] = (("lattice", "axis"), snapshot.cell_velocity, meaning)
    sector = {} if snapshot.sector is None else {"sector": snapshot.sector}
    return xr.Dataset(variables, attrs={"volume": snapshot.volume, "time": snapshot.time, **sector})


class Results(xr.DataTree):
    """A results file in memory: an xarray.DataTree that knows its snapshots, so that it can be averaged like the run that left it."""

    __slots__ = ()

    @property
    def frames(self):
        """The Snapshots of the steady state in order of time, or the last one; see `snapshot.frames`."""
        group = self.get("snapshots")
        if group is None:
            raise InputError("this results file holds no snapshots")
        return frames({name: read_snapshot(node) for name, node in group.children.items()})


def open(path):
    """A results file as a Results, an xarray.DataTree, read into memory.

    Raises InputError naming the file if it cannot be read, or was not written by anisogran.
    """
    try:
        with xr.open_datatree(path, engine="h5netcdf", phony_dims="access") as tree:
            tree = tree.load()
    except (OSError, ValueError, KeyError, TypeError, RuntimeError, AttributeError) as error:  # what h5py makes of damaged files
        reason = (str(error).splitlines() or [type(error).__name__])[0]
        raise InputError(f"{path}: not a readable results file ({reason})") from None
    if "anisogran" not in tree.attrs:
        raise InputError(f"{path}: not written by anisogran")
    return Results.from_dict(tree.to_dict())


def read_snapshot(dataset):
    """The Snapshot that a group "snapshots/NAME" of a results file holds; `dataset` is that group, as tree node or Dataset.

    Raises InputError if it holds none.
    """
    names = [field.name for field in fields(Snapshot) if field.default is MISSING or field.name == "fixed"]
    missing = [name for name in names if name not in dataset]
    if missing:
        raise InputError(f"read_snapshot: no variable {missing[0]!r}; it must be a group snapshots/NAME")
    arrays = {name: dataset[name].values for name in names}
    arrays |= {name: dataset[name].values for name in ("cell", "cell_velocity") if name in dataset}
    return Snapshot(**arrays, **{name: float(dataset.attrs[name]) for name in ("volume", "time", "sector") if name in dataset.attrs})
