"""Results as one HDF5 file that `xarray.open_datatree(path, engine="h5netcdf")` opens: labelled data with units."""

import os
from pathlib import Path

import xarray as xr

import anisogran
from anisogran.glossary import CONVENTIONS, attributes
from anisogran.outcome import InputError


def save_results(path, datasets, attributes):
    """Writes a mapping of "group/name" to Dataset, with attributes at the root; an older file is replaced only when all is written."""
    root = xr.Dataset(attrs={"anisogran": anisogran.__version__, "conventions": CONVENTIONS, **attributes})
    tree = xr.DataTree.from_dict({"/": root, **{f"/{name}": dataset for name, dataset in datasets.items()}})
    temporary = Path(f"{path}.tmp")
    tree.to_netcdf(temporary, engine="h5netcdf")
    os.replace(temporary, path)


def snapshot_dataset(snapshot):
    """A Snapshot as a labelled Dataset over grain, contact and axis."""
    grain, contact = ("grain", "axis"), ("contact", "axis")
    variables = {
        "position": (grain, snapshot.position, {"units": "m", "long_name": "centre"}),
        "velocity": (grain, snapshot.velocity, attributes("velocity")),
        "radius": ("grain", snapshot.radius, {"units": "m", "long_name": "radius"}),
        "mass": ("grain", snapshot.mass, {"units": "kg", "long_name": "mass"}),
        "spin": ("grain", snapshot.spin, attributes("spin")),
        "fixed": ("grain", snapshot.fixed.astype("i1"), {"units": "1", "long_name": "1 for a grain that belongs to a wall"}),
        "pairs": (("contact", "partner"), snapshot.pairs, {"units": "1", "long_name": "grain indices; a wall w is -1 - w"}),
        "force": (contact, snapshot.force, {"units": "N", "long_name": "whole force on the first grain of the pair"}),
        "point": (contact, snapshot.point, {"units": "m", "long_name": "contact point"}),
        "overlap": ("contact", snapshot.overlap, {"units": "m", "long_name": "overlap"}),
    }
    cell = {} if snapshot.cell is None else {"cell": (("lattice", "axis"), snapshot.cell, {"units": "m", "long_name": "lattice vectors"})}
    return xr.Dataset(variables | cell, attrs={"volume": snapshot.volume, "time": snapshot.time})


def open(path):
    """A results file as an xarray.DataTree, read into memory. Raises InputError naming the file if it cannot be read."""
    try:
        with xr.open_datatree(path, engine="h5netcdf") as tree:
            return tree.load()
    except (OSError, ValueError, KeyError) as error:
        raise InputError(f"{path}: not a readable results file ({str(error).splitlines()[0]})") from None
