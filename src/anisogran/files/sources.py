"""Snapshots from any file that holds grains: a results file of ours, or the output of another code."""

from pathlib import Path

from anisogran.files.lammps import read_lammps
from anisogran.files.mercury import read_mercury
from anisogran.files.results import open as open_results
from anisogran.outcome import InputError
from anisogran.whole_file import check_no_folder

CODES = ("anisogran", "lammps", "mercury")


def code_of(path):
    """The code that wrote a file of grains, told by its name: .h5 and .hdf5 are ours, .data is MercuryDPM's, all else LAMMPS's."""
    return {".h5": "anisogran", ".hdf5": "anisogran", ".data": "mercury"}.get(Path(path).suffix.lower(), "lammps")


def snapshot_stream(path, contacts=None, code=None, density=None, every=1):
    """The snapshots of a file of grains and one of contacts, as `read_lammps`, `read_mercury` and `Results.frames` give them.

    `code` is one of CODES, by default told by the name of the file. Raises InputError for options that do not fit.
    """
    check_no_folder(path, "results.h5")
    code = code_of(path) if code is None else code
    if code not in CODES:
        raise InputError(f"{path}: code = {code!r} must be one of {', '.join(CODES)}")
    if code == "anisogran":
        if contacts is not None or density is not None:
            raise InputError(f"{path}: a results file holds contacts and masses already; give neither contacts nor density")
        return open_results(path).frames[::every]
    if code == "lammps":
        return read_lammps(path, contacts, density=density, every=every)
    if density is None:
        raise InputError(f"{path}: MercuryDPM writes no masses; the density of the grains is needed")
    return read_mercury(path, contacts, density=density, every=every)
