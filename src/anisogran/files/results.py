"""Results as one HDF5 file that `xarray.open_datatree(path, engine="h5netcdf")` opens: labelled data with units, and where they come from."""

import os
from pathlib import Path

import xarray as xr

import anisogran
from anisogran.glossary import CONVENTIONS
from anisogran.outcome import InputError


def save_results(path, datasets, attributes):
    """Writes a mapping of "group/name" to Dataset, with attributes at the root; an older file is replaced only when all is written."""
    root = xr.Dataset(attrs={"anisogran": anisogran.__version__, "conventions": CONVENTIONS, **attributes})
    tree = xr.DataTree.from_dict({"/": root, **{f"/{name}": dataset for name, dataset in datasets.items()}})
    temporary = Path(f"{path}.tmp")
    tree.to_netcdf(temporary, engine="h5netcdf")
    os.replace(temporary, path)


def open(path):
    """A results file as an xarray.DataTree, read into memory. Raises InputError naming the file if it cannot be read."""
    try:
        with xr.open_datatree(path, engine="h5netcdf") as tree:
            return tree.load()
    except (OSError, ValueError, KeyError) as error:
        raise InputError(f"{path}: not a readable results file ({str(error).splitlines()[0]})") from None
