"""Files that other programs can read."""

from anisogran.files.columns import Columns, read_columns
from anisogran.files.lammps import read_lammps
from anisogran.files.mercury import read_mercury
from anisogran.files.numbers import check_writable, json_text, write_json, write_text
from anisogran.files.provenance import software
from anisogran.files.results import open, read_snapshot, save_results, snapshot_dataset
from anisogran.files.sources import CODES, snapshot_stream

__all__ = [
    "CODES", "Columns", "check_writable", "json_text", "open", "read_columns", "read_lammps", "read_mercury", "read_snapshot",
    "save_results", "snapshot_dataset", "snapshot_stream", "software", "write_json", "write_text",
]  # fmt: skip
