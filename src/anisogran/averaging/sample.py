"""One snapshot as a place sees it, and the sums over its grains and contacts that the extensive quantities are made of."""

import math
from functools import cached_property
from typing import NamedTuple

import numpy as np

from anisogran.averaging.coarse_graining import gradient_weights, grain_weights, line_weights
from anisogran.averaging.grain_sums import backbone, body_volume, contact_ends, dyad_sums, has_friction
from anisogran.averaging.images import Images
from anisogran.averaging.places import Shares, shares_of
from anisogran.compiled import kernel


@kernel
def weighted_sums(indptr, indices, shares, rows, cells):
    """sum_b share[cell, b] rows[:, b] for each cell, shape (rows, cells); row by row, so that one row of sums stays in the cache."""
    sums = np.zeros((len(rows), cells))
    for k in range(len(rows)):
        for b in range(len(indptr) - 1):
            value = rows[k, b]
            for e in range(indptr[b], indptr[b + 1]):
                sums[k, indices[e]] += shares[e] * value
    return sums


class Lines(NamedTuple):
    """Contacts as lines: from the centre of a free grain along the branch to the other grain, or to the contact point with a wall."""

    start: np.ndarray  # (S, d)
    branch: np.ndarray  # (S, d)
    force: np.ndarray  # (S, d), on the grain at the start
    wall: np.ndarray  # (S,) bool


def contact_lines(snapshot, ends):
    """The Lines of all contacts; `ends` in the laboratory, those of one contact one after the other."""
    leads = np.ones(len(ends.contact), bool)
    leads[1:] = ends.contact[1:] != ends.contact[:-1]
    first = np.flatnonzero(leads)
    inner = np.diff(first, append=len(leads)) == 2
    arm = ends.arm[first[inner] + 1]
    if snapshot.sector is not None:  # the second grain sees the contact in its own part of the ring
        azimuth = np.arctan2(*snapshot.position.T[1::-1])
        apart = azimuth[ends.grain[first[inner]]] - azimuth[ends.grain[first[inner] + 1]]
        turn = np.rint(apart / snapshot.sector) * snapshot.sector
        arm = Images(np.arange(len(arm)), arm, turn=turn).vectors(arm)
    branch = ends.arm[first]
    branch[inner] -= arm
    return Lines(snapshot.position[ends.grain[first]], branch, ends.force[first], ~inner)


class Sample:
    """What several quantities need is found once, and only when one of them asks for it.

    Bodies are the grains of the snapshot, or where the place has images those; B of them, `cells` of the place.
    """

    def __init__(self, snapshot, place, least_contacts):
        self.snapshot, self.place, self.least_contacts = snapshot, place, least_contacts
        self.cells = len(place.centre)
        self.images = place.bodies(snapshot)

    @cached_property
    def shares(self):
        return self.place.shares(self.snapshot, self.images)

    @cached_property
    def axes(self):
        return self.place.axes(self.snapshot)

    # what the bodies carry, along the axes of the place

    def scalar(self, values):
        """(B, ...) from values (N, ...) of the grains."""
        return values if self.images is None else self.images.scalars(values)

    def vector(self, values):
        """(B, d) from vectors (N, d) in the laboratory."""
        if self.images is not None:
            return self.images.vectors(values)
        return values if self.axes is None else np.einsum("nij,nj->ni", self.axes, values)

    def end_dyads(self, first, second):
        """sum_c first_i second_j over the ends of each grain, (B, i, d), from (E, i) and (E, d); i is 1 for a moment in the plane."""
        sums = dyad_sums(self.ends.grain, first, second, len(self.snapshot.radius))
        if self.images is None:
            return sums
        return self.images.dyads(sums) if sums.shape[1] > 1 else self.images.vectors(sums[:, 0])[:, None]

    @cached_property
    def mass(self):
        return self.scalar(self.snapshot.mass)

    @cached_property
    def grain_volume(self):
        return self.scalar(body_volume(self.snapshot))

    @cached_property
    def velocity(self):
        velocity = self.vector(self.snapshot.velocity)
        return velocity if self.images is None or self.images.drift is None else velocity + self.images.drift

    @cached_property
    def spin(self):
        """(B, 1) in the plane, (B, 3) in space."""
        spin = self.snapshot.spin
        return self.scalar(spin)[:, None] if spin.ndim == 1 else self.vector(spin)

    @cached_property
    def ends(self):
        return contact_ends(self.snapshot, self.axes)

    @cached_property
    def backbone(self):
        least = self.least_contacts
        if least is None:
            least = 2 if has_friction(self.ends) else self.snapshot.dimension + 1
        return backbone(self.snapshot, self.ends, least)

    @cached_property
    def offset(self):
        """(E, k): coordinates of a body less those of the middle of the cell, for each share."""
        position = self.snapshot.position if self.images is None else self.images.position
        counts = np.diff(self.shares.indptr)
        return np.repeat(self.place.coordinate(position), counts, axis=0) - self.place.centre[self.shares.indices]

    # sums over the bodies, shape (cells, ...)

    def sums(self, values, shares=None):
        """sum_b w Q_b from values (B, ...)."""
        rows = np.ascontiguousarray(values.reshape(len(values), math.prod(values.shape[1:])).T, dtype=float)
        total = weighted_sums(*(self.shares if shares is None else shares), rows, self.cells)
        return total.T.reshape(self.cells, *values.shape[1:])

    def offset_sums(self, values):
        """sum_b w Q_b x_b, shape (cells, ..., k)."""
        indptr, indices, data = self.shares
        return np.stack([self.sums(values, Shares(indptr, indices, data * x)) for x in self.offset.T], axis=-1)

    def spread_sums(self, values):
        """sum_b w Q_b x_b x_b, shape (cells, k, k)."""
        indptr, indices, data = self.shares
        rows = [[self.sums(values, Shares(indptr, indices, data * x * y)) for y in self.offset.T] for x in self.offset.T]
        return np.moveaxis(np.array(rows), -1, 0)

    # coarse graining: gradients of the kernel, and contacts spread along their branches

    @cached_property
    def slopes(self):
        """The Shares of the kernel's gradient, one for each axis."""
        return [shares_of(matrix) for matrix in gradient_weights(self.place.centre, self.images.position, self.place.smoothing)]

    def gradient_sums(self, values):
        """sum_b Q_b d phi/d x, shape (cells, ..., d)."""
        return np.stack([self.sums(values, shares) for shares in self.slopes], axis=-1)

    @cached_property
    def lines(self):
        """The Lines around the points, images included."""
        lines = contact_lines(self.snapshot, self.ends)
        longest = np.sqrt((lines.branch**2).sum(axis=1).max(initial=0.0))
        seen = self.place.around(self.snapshot, lines.start, longest)
        return Lines(seen.position, seen.vectors(lines.branch), seen.vectors(lines.force), seen.scalars(lines.wall))

    def line_stress(self):
        """-sum f b int phi over the lines b, (cells, d, d)."""
        start, branch, force, _ = self.lines
        weights = line_weights(self.place.centre, start, branch, self.place.smoothing)
        return self.sums(-force[:, :, None] * branch[:, None, :], shares_of(weights))

    def line_end_sums(self, position, force):
        """sum f phi at the positions (S, d), (cells, d)."""
        return self.sums(force, shares_of(grain_weights(self.place.centre, position, self.place.smoothing)))

    def wall_forces(self):
        """sum of the forces of walls on grains, each where it is exerted, (cells, d)."""
        start, branch, force, wall = self.lines
        return self.line_end_sums((start + branch)[wall], force[wall])

    def line_divergence(self):
        """sum_j d/dx_j of line_stress, (cells, d), from the kernel itself: a line integral differs by phi at its ends."""
        start, branch, force, _ = self.lines
        return self.line_end_sums(start + branch, force) - self.line_end_sums(start, force)
