"""Files that other programs can read."""

from anisogran.files.numbers import json_text, write_json
from anisogran.files.results import open, save_results, snapshot_dataset

__all__ = ["json_text", "open", "save_results", "snapshot_dataset", "write_json"]
