"""What a run writes down on its way: rows of the series, snapshots by name, blocks of a field; and all of it as plain arrays and back."""

from dataclasses import fields

import numpy as np

from anisogran.averaging import TimeBlocks
from anisogran.snapshot import Snapshot


class Records:
    """rows: dicts of numbers with the same keys, one of them "time"; snapshots: dict; blocks: TimeBlocks, or None if none are asked for."""

    def __init__(self):
        self.rows, self.snapshots, self.blocks = [], {}, None

    def add_to_blocks(self, quantities, size):
        """Takes the quantities of one more snapshot into blocks of `size` snapshots."""
        self.blocks = self.blocks or TimeBlocks(size)
        self.blocks.add(quantities)

    def packed(self):
        """A dict of arrays and plain values that `unpacked` makes the same Records of."""
        plain = {"rows": {name: np.array([row[name] for row in self.rows]) for name in (self.rows[0] if self.rows else ())}}
        plain["snapshots"] = {name: _parts(snapshot) for name, snapshot in self.snapshots.items()}
        if self.blocks is not None:
            sums = {name: np.stack([part[name] for part in self.blocks.sums]) for name in self.blocks.sums[0]}
            plain["blocks"] = {"size": self.blocks.size, "counts": self.blocks.counts, "sums": sums}
        return plain

    @classmethod
    def unpacked(cls, plain):
        """The Records of such a dict. Raises LookupError, TypeError, ValueError or AttributeError for another one."""
        records = cls()
        columns = plain["rows"]
        records.rows = [dict(zip(columns, row, strict=True)) for row in zip(*(column.tolist() for column in columns.values()), strict=True)]
        records.snapshots = {name: Snapshot(**parts) for name, parts in plain["snapshots"].items()}
        if "blocks" in plain:
            stored = plain["blocks"]
            blocks = records.blocks = TimeBlocks(stored["size"])
            blocks.counts = list(stored["counts"])
            blocks.sums = [{name: stack[k].copy() for name, stack in stored["sums"].items()} for k in range(len(blocks.counts))]
        return records


def _parts(snapshot):
    """The fields of a Snapshot that are not None."""
    parts = {field.name: getattr(snapshot, field.name) for field in fields(snapshot)}
    return {name: part for name, part in parts.items() if part is not None}
