"""Files that other programs can read."""

from anisogran.files.results import open, save_results, snapshot_dataset

__all__ = ["open", "save_results", "snapshot_dataset"]
