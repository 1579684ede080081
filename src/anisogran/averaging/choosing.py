"""From what a user says to the place where the average is taken."""

import math
import re

import numpy as np

from anisogran.averaging.places import Grid, Points, Rings, WholeBox, grid_points, middles
from anisogran.averaging.smoothing_kernels import smoothing
from anisogran.outcome import InputError, checked

PLACES = ("box", "rings", "grid", "points")
MOST_CELLS = 10_000_000  # more are a width in other units than the grains


def length_in_metres(width, snapshot):
    """A width in m, from a number in m or a text such as "1.5d", in mean diameters of the free grains. Raises InputError."""
    if isinstance(width, str):
        text = re.fullmatch(r"\s*([0-9.eE+-]+)\s*d\s*", width)
        try:
            share = float(text.group(1)) if text else float(width)
        except ValueError:
            raise InputError(f"average: width = {width!r} must be a number in m, or of mean diameters such as '1.0d'") from None
        width = share * snapshot.mean_diameter if text else share
    return checked("average", "width", width, above=0, unit="m")


def ascending(name, edges, least, at_least=-np.inf):
    """The edges as an array of at least `least` ascending numbers, none below `at_least`. Raises InputError."""
    edges = np.asarray(edges, dtype=float)
    if edges.ndim != 1 or edges.size < least or not np.all(np.diff(edges) > 0) or not np.isfinite(edges).all() or edges[0] < at_least:
        bound = f", none below {at_least:g}" if np.isfinite(at_least) else ""
        raise InputError(f"average: {name} must be at least {least} ascending numbers{bound}")
    return edges


def divided(width, *ranges):
    """For each range (low, high) the edges from low to high, as many as make the cells about `width` wide. Raises InputError."""
    counts = [max(1, round((high - low) / width)) for low, high in ranges]
    if math.prod(counts) > MOST_CELLS:
        raise InputError(f"average: width = {width:g} m makes {math.prod(counts)} cells, at most {MOST_CELLS} are possible")
    return [np.linspace(low, high, count + 1) for (low, high), count in zip(ranges, counts, strict=True)]


def place_of(snapshot, on, width=None, edges=None, points=None, kernel=None):
    """The place that `average` is asked for; its doc string says what each argument means. Raises InputError."""
    if on not in PLACES:
        raise InputError(f"average: on = {on!r} must be one of {', '.join(map(repr, PLACES))}")
    if points is not None and on != "points":
        raise InputError(f"average on={on!r}: points are for on='points'")
    if kernel is not None and on not in ("points", "grid"):
        raise InputError(f"average on={on!r}: a kernel is for on='points' and on='grid'; here the shares of the grains are exact")
    if edges is not None and on in ("box", "points"):
        raise InputError(f"average on={on!r}: edges are for on='rings' and on='grid'")
    return {"box": whole_box, "rings": rings, "grid": grid, "points": at_points}[on](snapshot, width, edges, points, kernel)


def whole_box(snapshot, width, edges, points, kernel):
    if width is not None:
        raise InputError("average on='box': the whole sample has no width")
    # the moments are taken about it; any point near the grains will do
    return WholeBox(snapshot.dimension, snapshot.position.mean(axis=0, keepdims=True))


def extent(snapshot, values):
    """Lowest and highest point that a free grain reaches along `values` (N,), its coordinates."""
    free = snapshot.free if snapshot.free.any() else np.ones(len(values), bool)
    return float((values - snapshot.radius)[free].min()), float((values + snapshot.radius)[free].max())


def rings(snapshot, width, edges, points, kernel):
    if snapshot.cell is not None:
        raise InputError("average on='rings': the snapshot is periodic in a cell, which has no axis to lay rings about")
    space = snapshot.dimension == 3
    r_edges, levels = (edges if space else (edges, None)) if edges is not None else (None, None)
    if r_edges is None or (space and levels is None):
        width = length_in_metres("1.0d" if width is None else width, snapshot)
    if r_edges is None:
        inner, outer = extent(snapshot, np.hypot(snapshot.position[:, 0], snapshot.position[:, 1]))
        (r_edges,) = divided(width, (max(inner, 0.0), outer))
    if space and levels is None:
        (levels,) = divided(width, extent(snapshot, snapshot.position[:, 2]))
    return Rings(ascending("edges of the rings", r_edges, 2, 0.0), ascending("levels", levels, 2) if space else np.empty(0))


def grid_bounds(snapshot):
    """(low, high) of the default grid along each axis: one period of the cell, or the extent of the grains if that is less.

    A tilted cell is taken whole, since its images come in at the side.
    """
    bounds = [extent(snapshot, column) for column in snapshot.position.T]
    if snapshot.cell is None:
        return bounds
    sides = np.diag(snapshot.cell)
    tilted = np.tril(snapshot.cell, -1).any()
    return [(0.0, side) if tilted or high - low >= side else (low, high) for (low, high), side in zip(bounds, sides, strict=True)]


def grid(snapshot, width, edges, points, kernel):
    if edges is None or kernel is not None:
        width = length_in_metres("1.0d" if width is None else width, snapshot)
    if edges is None:
        edges = divided(width, *grid_bounds(snapshot))
    if len(edges) != snapshot.dimension:
        raise InputError(f"average on='grid': edges must be given for each of the {snapshot.dimension} axes")
    edges = [ascending(f"edges along {axis}", given, 2) for axis, given in zip("xyz", edges, strict=False)]
    if kernel is not None:
        axes = [middles(one) for one in edges]
        shape, dims = tuple(map(len, axes)), tuple("xyz"[: len(axes)])
        return Points(grid_points(*axes), smoothing(kernel, width, snapshot.dimension), shape, dims)
    if snapshot.dimension == 3:
        raise InputError("average on='grid': boxes in space have no exact shares of spheres; give kernel='lucy' to smooth at their middles")
    return Grid(*edges)


def at_points(snapshot, width, edges, points, kernel):
    width = length_in_metres("1.0d" if width is None else width, snapshot)
    d = snapshot.dimension
    if points is None:
        raise InputError(f"average on='points': the points are missing; give points=, an array (P, {d}) in m")
    try:
        centre = np.atleast_2d(np.asarray(points, dtype=float))
    except (TypeError, ValueError):
        raise InputError("average on='points': points are no array of numbers") from None
    if centre.ndim != 2 or centre.shape[1] != d or not len(centre) or not np.isfinite(centre).all():
        raise InputError(f"average on='points': points must be finite numbers of the shape (P, {d}) with P > 0, not {centre.shape}")
    return Points(np.ascontiguousarray(centre), smoothing(kernel or "gaussian", width, d), (len(centre),), ("point",))
