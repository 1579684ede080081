"""What a run writes down on its way: rows of the series, snapshots by name, blocks of a field; and all of it as plain arrays and back."""

from dataclasses import fields

import numpy as np

from anisogran.averaging import TimeBlocks
from anisogran.snapshot import Snapshot


class Records:
    """rows: dicts of numbers with the same keys, one of them "time"; snapshots: dict; blocks: TimeBlocks, or None if none are asked for.

    tables: {name: rows} of what is not a series in time, each a list of dicts of numbers with the same keys.
    """

    def __init__(self):
        self.rows, self.snapshots, self.blocks, self.tables = [], {}, None, {}

    def add_to_blocks(self, quantities, size):
        """Takes the quantities of one more snapshot into blocks of `size` snapshots."""
        self.blocks = self.blocks or TimeBlocks(size)
        self.blocks.add(quantities)

    def packed(self):
        """A dict of arrays and plain values that `unpacked` makes the same Records of."""
        plain = {"rows": _columns(self.rows), "tables": {name: _columns(rows) for name, rows in self.tables.items()}}
        plain["snapshots"] = {name: _parts(snapshot) for name, snapshot in self.snapshots.items()}
        if self.blocks is not None:
            sums = {name: np.stack([part[name] for part in self.blocks.sums]) for name in self.blocks.sums[0]}
            plain["blocks"] = {"size": self.blocks.size, "counts": self.blocks.counts, "sums": sums}
        return plain

    @classmethod
    def unpacked(cls, plain):
        """The Records of such a dict. Raises LookupError, TypeError, ValueError or AttributeError for another one."""
        records = cls()
        records.rows = _rows(plain["rows"])
        records.tables = {name: _rows(columns) for name, columns in plain["tables"].items()}
        records.snapshots = {name: Snapshot(**parts) for name, parts in plain["snapshots"].items()}
        if "blocks" in plain:
            stored = plain["blocks"]
            blocks = records.blocks = TimeBlocks(stored["size"])
            blocks.counts = list(stored["counts"])
            blocks.sums = [{name: stack[k].copy() for name, stack in stored["sums"].items()} for k in range(len(blocks.counts))]
        return records


def _columns(rows):
    """{name: array} of rows with the same keys."""
    return {name: np.array([row[name] for row in rows]) for name in (rows[0] if rows else ())}


def _rows(columns):
    """The inverse of `_columns`."""
    return [dict(zip(columns, row, strict=True)) for row in zip(*(column.tolist() for column in columns.values()), strict=True)]


def _parts(snapshot):
    """The fields of a Snapshot that are not None."""
    parts = {field.name: getattr(snapshot, field.name) for field in fields(snapshot)}
    return {name: part for name, part in parts.items() if part is not None}
