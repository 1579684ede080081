"""From the tables of another code's frame to a Snapshot: what the readers of all codes have in common."""

from typing import NamedTuple

import numpy as np

from anisogran.files.frames import LARGEST
from anisogran.outcome import InputError, checked
from anisogran.snapshot import Snapshot

FINE = 0.01  # of the sum of the radii: by so much may a stated distance differ from that of the stated positions


class Grains(NamedTuple):
    """The grains of one frame and their box, arrays as in Snapshot."""

    position: np.ndarray
    radius: np.ndarray
    mass: np.ndarray
    velocity: np.ndarray
    spin: np.ndarray
    fixed: np.ndarray
    cell: np.ndarray | None
    volume: float


class Contacts(NamedTuple):
    """Contacts of one frame, arrays as in Snapshot."""

    pairs: np.ndarray
    force: np.ndarray
    point: np.ndarray
    overlap: np.ndarray


def positive_step(where, every):
    """`every` as a whole number of frames above 0; raises InputError."""
    number = checked(where, "every", every, at_least=1)
    if number != int(number):
        raise InputError(f"{where}: every = {every} must be a whole number")
    return int(number)


def mass_law(where, density, mass_of):
    """The function from radius to the mass of a sphere of `density` in kg/m3, or of a disc of `density` in kg/m2; raises InputError."""
    density = checked(where, "density", density, above=0, below=LARGEST, unit="kg/m3")
    if mass_of == "sphere":
        return lambda radius: density * 4 / 3 * np.pi * radius**3
    if mass_of == "disc":
        return lambda radius: density * np.pi * radius**2
    raise InputError(f"{where}: mass_of = {mass_of!r} must be 'sphere' or 'disc'")


def type_list(where, wall_types):
    """The types of wall grains as an array (k,); raises InputError."""
    try:
        return np.atleast_1d(np.asarray(wall_types, dtype=float))
    except (TypeError, ValueError):
        raise InputError(f"{where}: wall_types = {wall_types!r} must be numbers") from None


def edges_of(lines, low, high):
    """high - low (d,) of a box; raises InputError at the line read last if one of them is not above 0."""
    edges = np.asarray(high) - low
    if not np.all(edges > 1 / LARGEST):
        lines.refuse("the box has no volume: a low bound is not below the high one")
    return edges


def cell_of(lattice, periodic, position, radius):
    """The cell (d, d) of a box of which some directions are periodic; None if none is.

    A direction that is not periodic gets a lattice vector beyond every grain, so that the nearest image of a grain is the grain itself.
    """
    if not np.any(periodic):
        return None
    cell = np.array(lattice)
    for axis in np.flatnonzero(~np.asarray(periodic)):
        cell[axis] = 0
        cell[axis, axis] = 4 * (np.ptp(position[:, axis]) + 2 * radius.max())
    return cell


def nearest_image(cell, vectors):
    """The short vectors (C, d) among the periodic images; `cell` is None or lower triangular."""
    if cell is None:
        return vectors
    vectors = np.array(vectors)
    for axis in reversed(range(len(cell))):  # the last lattice vector has parts along all axes, the first along its own only
        vectors -= np.rint(vectors[:, axis] / cell[axis, axis])[:, None] * cell[axis]
    return vectors


def branches(table, grains, pairs, apart):
    """Of pairs of grains: the vector (C, d) from the first centre to the second and its length, from the positions.

    `apart` (C,): the distance by the file's own account. Raises InputError at the row of a pair for which the two do not agree, or that
    lies in one place.
    """
    branch = nearest_image(grains.cell, grains.position[pairs[:, 1]] - grains.position[pairs[:, 0]])
    length = np.sqrt(np.einsum("cd,cd->c", branch, branch))
    table.refuse((pairs[:, 0] == pairs[:, 1]) | (length == 0), "a grain in contact with itself, or two in one place")
    if apart is not None:
        off = np.abs(length - apart) > FINE * grains.radius[pairs].sum(axis=1)
        for row in np.flatnonzero(off)[:1]:
            table.refuse(off, f"the centres are {length[row]:g} apart by their positions, but {apart[row]:g} by the contact")
    return branch, length


def pair_points(grains, pairs, branch, length, overlap):
    """The contact points (C, d): on the line of centres, in the middle of the overlap, seen from the first grain."""
    first = pairs[:, 0]
    return grains.position[first] + branch * ((grains.radius[first] - 0.5 * overlap) / length)[:, None]


def snapshot_of(frame, grains, contacts, time):
    """The Snapshot of a frame: `contacts` is a list of Contacts. Raises InputError that names the frame."""
    d = grains.position.shape[1]
    none = Contacts(np.empty((0, 2), np.int64), np.empty((0, d)), np.empty((0, d)), np.empty(0))
    joined = Contacts(*(np.concatenate(parts) for parts in zip(none, *contacts, strict=True)))
    try:
        return Snapshot(**grains._asdict(), **joined._asdict(), time=time)
    except InputError as error:
        frame.refuse(str(error))
