"""Results as one HDF5 file that `xarray.open_datatree(path, engine="h5netcdf")` opens: labelled data with units.

After the HDF5 data the file carries a seal, which other programs do not see: a line of text that ends in the SHA-256 of the whole file
with "0" in the place of its digits. It is written whole or not at all, so that it can be read at any time while a run goes on.
"""

from dataclasses import MISSING, fields

import xarray as xr

from anisogran.files.hdf5_reading import read_tree
from anisogran.files.hdf5_writing import tree_bytes
from anisogran.files.provenance import software
from anisogran.glossary import CONVENTIONS, attributes
from anisogran.outcome import InputError
from anisogran.snapshot import Snapshot, frames
from anisogran.whole_file import DIGITS, check_no_folder, check_target, read_whole, seal, write_whole

HDF5 = b"\x89HDF\r\n\x1a\n"
MARK = b"\nresults of anisogran, SHA-256 "
ANYWAY = "xarray.open_datatree(path, engine='h5netcdf') may read it all the same"


def save_results(path, datasets, attributes):
    """Writes a mapping of "group/name" to Dataset, with attributes at the root; an older file is replaced only when all is written.

    Raises InputError if no file can be made at that path, RunFailed if the machine does not take it, TypeError for values that such a
    file does not hold; in each case an older file is untouched.
    """
    check_target(path)
    write_whole(path, results_bytes(datasets, attributes))


def results_bytes(datasets, attributes):
    """The sealed bytes of a results file, as a memoryview; see `save_results`."""
    root = {**software(), "conventions": CONVENTIONS, **attributes}
    return sealed(tree_bytes(datasets, root, room=len(MARK) + DIGITS).getbuffer())


def sealed(content):
    """The writable bytes of a file, with mark and seal upon the last of them."""
    content[-len(MARK) - DIGITS : -DIGITS] = MARK
    content[-DIGITS:] = seal(content)
    return content


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


def open(path, holds=None):
    """A results file as a Results, an xarray.DataTree, read into memory.

    `holds`: a group that it must have, such as "series" or "p100/cases", so that a file of another kind is told of here.
    Raises InputError, one line naming file and reason, if it is no results file, is not as it was written, or has no such group. No other
    file is touched, whatever it holds. Files without a good seal never reach the HDF5 library; this library has had faults that a file
    forged with a good seal could use, so open results of people whom you do not trust in a sandbox only.
    """
    check_no_folder(path, "results.h5")
    content = read_whole(path)
    if content[-len(MARK) - DIGITS : -DIGITS] != MARK:
        raise InputError(f"{path}: {_without_seal(content)}")
    if content[-DIGITS:] != seal(content):
        raise InputError(f"{path}: was damaged or changed by hand, it does not have the SHA-256 that it carries; {ANYWAY}")
    try:
        results = Results.from_dict(read_tree(content))
    except (OSError, ValueError, LookupError, TypeError, RuntimeError, ArithmeticError, AttributeError, MemoryError) as error:
        raise InputError(f"{path}: is no results file, though it has the seal of one: {' '.join(str(error).split())}") from None
    if holds is not None and holds not in {group.lstrip("/") for group in results.groups}:
        raise InputError(f"{path}: has no group {holds}, so it was made for something else; it has {', '.join(results.children)}")
    return results


def _without_seal(content):
    """What a file without a seal is, in words."""
    if content.startswith(HDF5):
        return f"has no seal of anisogran; it was cut or changed after it was written, or another program wrote it; {ANYWAY}"
    if content.startswith(b"PK"):
        return "is a zip archive, such as a checkpoint (Simulation.load reads it), and no results file"
    if content.startswith(b"CDF"):
        return "is a netCDF-3 file, which xarray.open_dataset reads, and no results file of anisogran"
    try:
        content[:4096].decode()
    except UnicodeDecodeError:
        return "is no HDF5 file, and so no results file"
    return "is a text, and no results file"


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
