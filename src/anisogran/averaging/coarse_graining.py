"""The weights of coarse graining as sparse matrices: which grains and contacts a field at a point hears of, and how much.

A density at the points is `weights @ what each body carries`. The search for the points near a body knows no kernel, and the kernels
know no search. Two dimensions are three with the last coordinate 0, so that one compiled code serves both.
"""

import math

import numpy as np
from scipy.sparse import csc_array

from anisogran.averaging.smoothing_kernels import HEAVISIDE, KERNELS, line_mean, phi, slope
from anisogran.compiled import kernel, subkernel
from anisogran.outcome import InputError

LARGEST = 2**31 - 1  # entries of one matrix, so that four bytes hold an index
POINTLIKE = 1e-12  # in reaches: a branch shorter than that is a point


def grain_weights(points, position, smoothing):
    """phi(|x_p - r_b|) in 1/m^d as csc_array (P, B), for points x (P, d) and bodies at position (B, d), both in m.

    A body exactly at the reach counts. The entries of a column are in no order. Raises InputError for arrays of another shape, numbers
    that are not finite, and more than 2^31 - 1 weights.
    """
    points, position = _vectors("points", points, smoothing), _vectors("position", position, smoothing)
    begin, near = _near(points, position, np.zeros_like(position), smoothing)
    return csc_array((grain_values(points, position, begin, near, smoothing), near, begin), shape=(len(points), len(position)))


def gradient_weights(points, position, smoothing):
    """d phi/d x_a at the points, in 1/m^(d + 1), as a tuple of d csc_arrays (P, B), a = 0 .. d - 1; else as grain_weights.

    Raises InputError also for the heaviside kernel, which has no gradient.
    """
    return grain_and_gradient_weights(points, position, smoothing)[1]


def grain_and_gradient_weights(points, position, smoothing):
    """(grain_weights, gradient_weights) from one search for the neighbours."""
    if smoothing.kind == HEAVISIDE:
        raise InputError(f"gradient_weights: kernel = {KERNELS[HEAVISIDE]!r} has no gradient; use gaussian or lucy")
    points, position = _vectors("points", points, smoothing), _vectors("position", position, smoothing)
    begin, near = _near(points, position, np.zeros_like(position), smoothing)
    shape = (len(points), len(position))
    weights = csc_array((grain_values(points, position, begin, near, smoothing), near, begin), shape=shape)
    slopes = gradient_values(points, position, begin, near, smoothing)
    return weights, tuple(csc_array((slopes[axis], near.copy(), begin.copy()), shape=shape) for axis in range(smoothing.dimension))


def line_weights(points, start, branch, smoothing):
    """integral_0^1 phi(|x_p - start_s - s' branch_s|) ds' in 1/m^d as csc_array (P, S): the mean of phi over each segment.

    Segments run from start (S, d) along branch (S, d), in m; a branch of no length gives phi(|x_p - start|). Exact also where the
    segment leaves the reach: the line is cut there, and the integral of each kernel is known in closed form. Else as grain_weights.
    """
    points, start, branch = (
        _vectors("points", points, smoothing),
        _vectors("start", start, smoothing),
        _vectors("branch", branch, smoothing),
    )
    if start.shape != branch.shape:
        raise InputError(f"coarse graining: branch has {len(branch)} rows, expected {len(start)} as in start")
    begin, near = _near(points, start, branch, smoothing)
    return csc_array((line_values(points, start, branch, begin, near, smoothing), near, begin), shape=(len(points), len(start)))


def _vectors(name, value, smoothing):
    """The vectors (N, d) as finite floats (N, 3)."""
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"coarse graining: {name} is no array of numbers") from None
    if array.size == 0:
        array = array.reshape(0, smoothing.dimension)
    if array.ndim != 2 or array.shape[1] != smoothing.dimension:
        raise InputError(f"coarse graining: {name} has shape {array.shape}, expected (N, {smoothing.dimension})")
    bad = np.flatnonzero(~np.isfinite(array).all(axis=1))
    if bad.size:
        raise InputError(f"coarse graining: {name}[{bad[0]}] is not finite")
    space = np.zeros((len(array), 3))
    space[:, : smoothing.dimension] = array
    return space


def _near(points, start, branch, smoothing):
    """begin (S + 1,) and near: near[begin[s] : begin[s + 1]] are the points no farther than the reach from segment s."""
    begin, near = near_points(points, start, branch, smoothing.reach, LARGEST)
    if begin[-1] > LARGEST:
        raise InputError(f"coarse graining: {begin[-1]} weights must be at most {LARGEST}; take fewer points or a smaller width")
    return begin.astype(np.int32), near


@subkernel
def cell_order(points, width):
    """Sort the points into cubic cells: low and high corner, side and number of cells, start of each cell, points in cell order.

    There are never many more cells than points, however far these are spread: an axis that would have too many is wound up, so that
    distant cells share a place.
    """
    low, high = points[0].copy(), points[0].copy()
    for p in range(points.shape[0]):
        for axis in range(3):
            low[axis] = min(low[axis], points[p, axis])
            high[axis] = max(high[axis], points[p, axis])
    side = width
    count = np.empty(3, np.int64)
    for axis in range(3):
        side = max(side, 1e-12 * (high[axis] - low[axis]))  # the number of a cell is a whole number that a float can hold
    for axis in range(3):
        count[axis] = int((high[axis] - low[axis]) / side) + 1
    while float(count[0]) * count[1] * count[2] > 2.0 * points.shape[0] + 8.0:
        longest = np.argmax(count)
        count[longest] = (count[longest] + 1) // 2
    cell = np.empty(points.shape[0], np.int64)
    begin = np.zeros(count[0] * count[1] * count[2] + 1, np.int64)
    for p in range(points.shape[0]):
        cell[p] = 0
        for axis in range(2, -1, -1):
            cell[p] = cell[p] * count[axis] + int((points[p, axis] - low[axis]) / side) % count[axis]
        begin[cell[p] + 1] += 1
    for c in range(begin.size - 1):
        begin[c + 1] += begin[c]
    order = np.empty(points.shape[0], np.int32)
    place = begin[:-1].copy()
    for p in range(points.shape[0]):
        order[place[cell[p]]] = p
        place[cell[p]] += 1
    return low, high, side, count, begin, order


@subkernel
def cells_around(start, branch, reach, low, high, side, count, first, cells):
    """Whether cells with points lie around a segment; if so, `first` and how many `cells` of them along each axis."""
    search = reach * (1.0 + 1e-9)  # rounding must not hide a point at the very reach
    for axis in range(3):
        end = start[axis] + branch[axis]
        lower = max(min(start[axis], end) - search, low[axis])
        upper = min(max(start[axis], end) + search, high[axis])
        if lower > upper:
            return False
        begin = int((lower - low[axis]) / side)
        cells[axis] = min(int((upper - low[axis]) / side) - begin + 1, count[axis])
        first[axis] = begin % count[axis]
    return True


@kernel
def near_points(points, start, branch, reach, largest):
    """begin (S + 1,) and near: near[begin[s] : begin[s + 1]] are the points no farther than `reach` from segment s.

    If there are more than `largest` of them, `near` is empty.
    """
    segments = start.shape[0]
    offset = np.zeros(segments + 1, np.int64)
    near = np.empty(1, np.int32)
    if points.shape[0] == 0:
        return offset, near[:0]
    low, high, side, count, begin, order = cell_order(points, 0.5 * reach)
    sorted_points = points[order]
    first, cells = np.empty(3, np.int64), np.empty(3, np.int64)
    for fill in range(2):  # count, then fill
        found = 0
        for s in range(segments):
            if cells_around(start[s], branch[s], reach, low, high, side, count, first, cells):
                x, y, z = start[s, 0], start[s, 1], start[s, 2]
                u, v, w = branch[s, 0], branch[s, 1], branch[s, 2]
                length2 = u * u + v * v + w * w
                inverse = 1.0 / length2 if length2 > (POINTLIKE * reach) ** 2 else 0.0
                for layer in range(cells[2]):
                    for row in range(cells[1]):
                        base = ((first[2] + layer) % count[2] * count[1] + (first[1] + row) % count[1]) * count[0]
                        column, left = first[0], cells[0]
                        while left > 0:  # one stretch of memory, or two where the axis is wound up
                            stop = min(column + left, count[0])
                            for k in range(begin[base + column], begin[base + stop]):
                                dx, dy, dz = sorted_points[k, 0] - x, sorted_points[k, 1] - y, sorted_points[k, 2] - z
                                along = min(max((dx * u + dy * v + dz * w) * inverse, 0.0), 1.0)
                                dx, dy, dz = dx - along * u, dy - along * v, dz - along * w
                                inside = dx * dx + dy * dy + dz * dz <= reach * reach
                                if fill == 1:
                                    near[found] = order[k]
                                found += inside
                            left -= stop - column
                            column = 0
            offset[s + 1] = found
        if found > largest:
            break
        if fill == 0:
            near = np.empty(found + 1, np.int32)  # a point out of reach is written and then overwritten, also the last one
    return offset, near[:-1]


@kernel
def grain_values(points, position, begin, near, s):
    """phi for each entry of the matrix whose columns are the bodies."""
    values = np.empty(near.size)
    for b in range(position.shape[0]):
        for k in range(begin[b], begin[b + 1]):
            x, y, z = points[near[k], 0] - position[b, 0], points[near[k], 1] - position[b, 1], points[near[k], 2] - position[b, 2]
            values[k] = phi(s, x * x + y * y + z * z)
    return values


@kernel
def gradient_values(points, position, begin, near, s):
    """The gradient of phi for each entry of the matrix whose columns are the bodies, shape (3, entries)."""
    values = np.empty((3, near.size))
    for b in range(position.shape[0]):
        for k in range(begin[b], begin[b + 1]):
            x, y, z = points[near[k], 0] - position[b, 0], points[near[k], 1] - position[b, 1], points[near[k], 2] - position[b, 2]
            factor = slope(s, x * x + y * y + z * z)
            values[0, k], values[1, k], values[2, k] = factor * x, factor * y, factor * z
    return values


@kernel
def line_values(points, start, branch, begin, near, s):
    """The mean of phi over the segment for each entry of the matrix whose columns are the segments."""
    values = np.empty(near.size)
    for c in range(start.shape[0]):
        u, v, w = branch[c, 0], branch[c, 1], branch[c, 2]
        length = math.sqrt(u * u + v * v + w * w)
        pointlike = length <= POINTLIKE * s.reach
        if not pointlike:
            u, v, w = u / length, v / length, w / length
        for k in range(begin[c], begin[c + 1]):
            x, y, z = points[near[k], 0] - start[c, 0], points[near[k], 1] - start[c, 1], points[near[k], 2] - start[c, 2]
            if pointlike:
                values[k] = phi(s, x * x + y * y + z * z)
                continue
            foot = x * u + y * v + z * w  # of the perpendicular from the point, from the start
            x, y, z = x - foot * u, y - foot * v, z - foot * w
            h2 = x * x + y * y + z * z
            chord = math.sqrt(max(s.reach * s.reach - h2, 0.0))  # half of it; rounding may leave a grazing line outside
            # in parts of the branch, so that a whole branch counts as 1 also where it is short and far from the foot
            low, high = max((foot - chord) / length, 0.0), min((foot + chord) / length, 1.0)
            values[k] = (high - low) * line_mean(s, h2, low * length - foot, high * length - foot) if high > low else 0.0
    return values
