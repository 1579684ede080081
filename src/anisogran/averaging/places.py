"""Where an average is taken: the whole sample, rings about the axis, a grid of rectangles, or points with a smoothing kernel.

A place tells which share of each grain it holds, in which frame it sees vectors, and how its own coordinates make a gradient. Weights are
a sparse matrix (indptr, indices, shares), the shares of one body after the other, each with the index of its cell.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from anisogran.averaging.coarse_graining import grain_weights
from anisogran.averaging.images import Images, images
from anisogran.averaging.overlap_areas import grid_shares, ring_shares
from anisogran.averaging.smoothing_kernels import KERNELS, Smoothing, standard_deviation


class Shares(NamedTuple):
    """A sparse matrix: body b has data[indptr[b]:indptr[b + 1]] in the cells indices[indptr[b]:indptr[b + 1]]."""

    indptr: np.ndarray
    indices: np.ndarray
    data: np.ndarray


def shares_of(matrix):
    """The Shares of a scipy.sparse.csc_array (cells, bodies)."""
    return Shares(matrix.indptr.astype(np.int64, copy=False), matrix.indices.astype(np.int64, copy=False), matrix.data)


class Place:
    """What all places have in common; the cells are flat here, of `shape` in the results."""

    name = ""
    dims = ()
    shape = ()
    frame = "laboratory"
    at_centroid = False  # whether mean fields are told at the centre of mass of the grains, not at the centre of the cell

    def bodies(self, snapshot):
        """The Images of the free grains that this place can see; None stands for all grains as they are."""
        return None

    def axes(self, snapshot):
        """Rows of the local frame of each grain, (N, d, d); None for the laboratory."""
        return None

    def coordinate(self, position):
        """Of the bodies at these positions (B, d) along the directions in which fields vary here, (B, k)."""
        return position

    def gradient(self, value, slope):
        """grad[i, j] = d v_i / d x_j from the value (d, cells) and its slope (d, k, cells) along the coordinates."""
        return slope

    def scalar_gradient(self, slope):
        """(d, cells) of a scalar with the slope (k, cells)."""
        return slope


@dataclass(frozen=True, eq=False)
class WholeBox(Place):
    """The whole sample: one cell of the volume of each snapshot; mean fields are those at the centre of mass."""

    dimension: int
    centre: np.ndarray  # (1, d)
    name = "box"
    at_centroid = True

    def shares(self, snapshot, bodies):
        n = len(snapshot.radius)
        return Shares(np.arange(n + 1), np.zeros(n, np.int64), snapshot.free.astype(float))

    def volume(self, snapshot):
        return np.array([snapshot.volume])

    def coords(self):
        return {}

    def attributes(self):
        return {}


@dataclass(frozen=True, eq=False)
class Rings(Place):
    """Rings about the origin, in space also cut into levels along z; tensors in the frame (r, phi) or (r, phi, z)."""

    edges: np.ndarray  # (rings + 1,)
    levels: np.ndarray  # (levels + 1,), empty in the plane
    name = "rings"

    @property
    def frame(self):
        return "(r, phi, z)" if len(self.levels) else "(r, phi)"

    @property
    def dimension(self):
        return 3 if len(self.levels) else 2

    @property
    def dims(self):
        return ("r", "z") if len(self.levels) else ("r",)

    @property
    def shape(self):
        return tuple(len(edges) - 1 for edges in (self.edges, self.levels) if len(edges))

    @cached_property
    def centre(self):
        return grid_points(*(values for _, values in self.coords().values()))

    def axes(self, snapshot):
        x, y = snapshot.position[:, 0], snapshot.position[:, 1]
        distance = np.hypot(x, y)
        on_axis = distance == 0  # no direction is radial there: take x
        cosine, sine = (
            np.divide(x, distance, where=~on_axis, out=np.ones_like(x)),
            np.divide(y, distance, where=~on_axis, out=np.zeros_like(x)),
        )
        axes = np.zeros((len(x), self.dimension, self.dimension))
        axes[:, 0, 0], axes[:, 0, 1], axes[:, 1, 0], axes[:, 1, 1] = cosine, sine, -sine, cosine
        axes[:, 2:, 2:] = 1.0
        return axes

    def coordinate(self, position):
        r = np.hypot(position[:, 0], position[:, 1])
        return np.column_stack([r, *position.T[2:]])

    def shares(self, snapshot, bodies):
        levels = self.levels if len(self.levels) else None
        return Shares(*ring_shares(snapshot.position, snapshot.radius, snapshot.free, self.edges, levels))

    def volume(self, snapshot):
        turn = 2 * np.pi if snapshot.sector is None else snapshot.sector
        area = 0.5 * turn * np.diff(self.edges**2)
        return np.outer(area, np.diff(self.levels)).ravel() if len(self.levels) else area

    def gradient(self, value, slope):
        r = self.centre[:, 0]
        gradient = np.zeros((len(value), *value.shape))
        gradient[:, 0] = slope[:, 0]
        # the unit vectors turn along phi
        gradient[0, 1], gradient[1, 1] = -value[1] / r, value[0] / r
        if len(value) == 3:
            gradient[:, 2] = slope[:, 1]
        return gradient

    def scalar_gradient(self, slope):
        along_phi = np.zeros_like(slope[:1])
        return np.concatenate([slope[:1], along_phi, slope[1:]])

    def coords(self):
        return {name: (name, middles(edges)) for name, edges in zip("rz", (self.edges, self.levels), strict=True) if len(edges)}

    def attributes(self):
        width = {"width": float(np.diff(self.edges).mean()), "edges": self.edges}
        return {**width, "levels": self.levels} if len(self.levels) else width


@dataclass(frozen=True, eq=False)
class Grid(Place):
    """Rectangles in the plane: a disc has its exact share of area in each."""

    x_edges: np.ndarray
    y_edges: np.ndarray
    name = "grid"
    dims = ("x", "y")
    dimension = 2

    @property
    def shape(self):
        return len(self.x_edges) - 1, len(self.y_edges) - 1

    @cached_property
    def centre(self):
        return grid_points(middles(self.x_edges), middles(self.y_edges))

    def bodies(self, snapshot):
        return free_images(snapshot, self.around)

    def around(self, snapshot, position):
        """The Images of the positions (n, 2) of a snapshot whose discs may reach into the grid."""
        largest = snapshot.radius.max()
        low, high = (np.array([self.x_edges[k], self.y_edges[k]]) for k in (0, -1))
        return images(snapshot, position, low - largest, high + largest)

    def shares(self, snapshot, bodies):
        return Shares(*grid_shares(bodies.position, bodies.scalars(snapshot.radius), self.x_edges, self.y_edges))

    def volume(self, snapshot):
        return np.outer(np.diff(self.x_edges), np.diff(self.y_edges)).ravel()

    def coords(self):
        return {name: (name, middles(edges)) for name, edges in (("x", self.x_edges), ("y", self.y_edges))}

    def attributes(self):
        width = [float(np.diff(edges).mean()) for edges in (self.x_edges, self.y_edges)]
        return {"width": width, "x_edges": self.x_edges, "y_edges": self.y_edges}


@dataclass(frozen=True, eq=False)
class Points(Place):
    """Coarse graining at points (P, d): each field there is a sum over grains, weighted with the smoothing kernel; results have `shape`."""

    centre: np.ndarray
    smoothing: Smoothing
    shape: tuple
    dims: tuple
    name = "points"

    @property
    def dimension(self):
        return self.centre.shape[1]

    def around(self, snapshot, position, length=0.0):
        """The Images of the positions (n, d) of a snapshot that lie within reach of a point, or not farther beyond than `length`."""
        reach = self.smoothing.reach + length
        return images(snapshot, position, self.centre.min(axis=0) - reach, self.centre.max(axis=0) + reach)

    def bodies(self, snapshot):
        return free_images(snapshot, self.around)

    def shares(self, snapshot, bodies):
        return shares_of(grain_weights(self.centre, bodies.position, self.smoothing))

    def volume(self, snapshot):
        return np.ones(len(self.centre))  # the kernel is a density already

    def coords(self):
        if self.dims == ("point",):
            return {name: ("point", column) for name, column in zip("xyz", self.centre.T, strict=False)}
        nodes = self.centre.reshape(*self.shape, -1)
        first = [(0,) * k + (slice(None),) + (0,) * (len(self.shape) - 1 - k) for k in range(len(self.shape))]
        return {name: (name, nodes[first[k]][:, k]) for k, name in enumerate(self.dims)}

    def attributes(self):
        smoothing = self.smoothing
        deviation = standard_deviation(smoothing)
        return {"kernel": KERNELS[smoothing.kind], "width": smoothing.width, "reach": smoothing.reach, "standard_deviation": deviation}


def middles(edges):
    """The middles of the intervals between ascending edges."""
    return 0.5 * (edges[1:] + edges[:-1])


def grid_points(*axes):
    """The points (n, d) of a rectangular grid, the last axis fastest."""
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))


def free_images(snapshot, seen_from):
    """The Images of the free grains that seen_from(snapshot, position) finds."""
    free = np.flatnonzero(snapshot.free)
    seen = seen_from(snapshot, snapshot.position[free])
    return Images(free[seen.index], seen.position, seen.drift, seen.turn)
