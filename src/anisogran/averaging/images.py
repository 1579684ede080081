"""Periodic images: what a place near the border of a cell, or of a ring sector, sees on the other side."""

from dataclasses import dataclass

import numpy as np

from anisogran import tensors


@dataclass(frozen=True, eq=False)
class Images:
    """Copies of points of a snapshot (grains, or ends of contacts); B copies.

    index (B,) of the original, position (B, d), drift (B, d) by which a copy is faster than its original (None: not at all), turn (B,) the
    angle by which a copy is turned about the origin (None: not at all).
    """

    index: np.ndarray
    position: np.ndarray
    drift: np.ndarray | None = None
    turn: np.ndarray | None = None

    def scalars(self, values):
        """values (N, ...) of the originals at the copies."""
        return values[self.index]

    def vectors(self, values):
        """Vectors (N, d) of the originals, turned with the copies, (B, d)."""
        values = values[self.index]
        return values if self.turn is None else np.einsum("bij,bj->bi", self._rotation(values.shape[1]), values)

    def dyads(self, values):
        """Second-order tensors (N, d, d) of the originals, turned with the copies, (B, d, d)."""
        values = values[self.index]
        if self.turn is None:
            return values
        rotation = self._rotation(values.shape[1])
        return rotation @ values @ np.swapaxes(rotation, 1, 2)

    def _rotation(self, dimension):
        return np.moveaxis(tensors.rotation(self.turn, dimension), -1, 0)


def images(snapshot, position, low, high):
    """The Images of the points (N, d) of a snapshot that lie between the corners low and high (d,), originals included; cost linear in
    the number of points and of copies. Without a cell or sector: all points, once."""
    if snapshot.sector is not None:
        return turned_images(snapshot, position, low, high)
    if snapshot.cell is None:
        return Images(np.arange(len(position)), position)
    index, copies = np.arange(len(position)), position
    times = np.zeros(position.shape)  # of each lattice vector that has been added
    # the last lattice vector first: it moves a copy along the other axes as well
    for axis in reversed(range(len(snapshot.cell))):
        vector = snapshot.cell[axis]
        first = np.ceil((low[axis] - copies[:, axis]) / vector[axis])  # brings the copy to low[axis] or just above
        count = np.maximum(np.floor((high[axis] - copies[:, axis]) / vector[axis]) - first + 1, 0).astype(np.int64)
        repeat = np.repeat(np.arange(len(index)), count)
        step = first[repeat] + np.arange(len(repeat)) - np.repeat(np.cumsum(count) - count, count)
        index, copies, times = index[repeat], copies[repeat] + step[:, None] * vector, times[repeat]
        times[:, axis] = step
    drift = None if snapshot.cell_velocity is None else times @ snapshot.cell_velocity
    return Images(index, copies, drift)


def turned_images(snapshot, position, low, high):
    """The images of a ring sector: turned by whole multiples of its angle."""
    turns = snapshot.sector * np.arange(round(2 * np.pi / snapshot.sector))
    index, turn = np.tile(np.arange(len(position)), len(turns)), np.repeat(turns, len(position))
    copies = Images(index, position[index], turn=turn).vectors(position)
    seen = ((copies >= low) & (copies <= high)).all(axis=1)
    return Images(index[seen], copies[seen], turn=turn[seen])
