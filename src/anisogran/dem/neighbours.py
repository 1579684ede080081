"""The neighbour list: all pairs closer than the skin, each once, grouped by the lower index; contact memory survives a rebuild.

Grains are sorted into cells as wide as the widest possible contact; candidates of three neighbouring cells lie contiguously in memory
and are appended without a branch. A periodic cell adds ghost images before the sort, so the search itself knows no boundary.
"""

import math
from typing import NamedTuple

import numpy as np

from anisogran.compiled import subkernel
from anisogran.dem.rows import aligned_zeros


class PairList(NamedTuple):
    """Pairs (first[k] < second[k]); start[i] .. start[i + 1] are those of grain i. The arrays have spare room; start[-1] is in use."""

    first: np.ndarray  # (capacity,) uint32
    second: np.ndarray  # (capacity,) uint32
    reach: np.ndarray  # (capacity,) sum of the radii; 0 in the spare room
    start: np.ndarray  # (N + 1,) int64


def empty_pair_list(grains, capacity):
    """A list without pairs, with room for at least `capacity` of them; a multiple of eight, and every entry the number of a grain."""
    capacity = -(-capacity // 8) * 8
    indices = (aligned_zeros(capacity, np.uint32) for _ in range(2))
    return PairList(*indices, aligned_zeros(capacity), np.zeros(grains + 1, np.int64))


@subkernel
def overwrite(target, source):
    """target[:] = source, element by element: the statement would compile a page of error messages along with it, for seconds."""
    for k in range(source.shape[0]):
        target[k] = source[k]


@subkernel
def images(x, y, cell, reach):
    """Positions and owners of all grains, followed by their periodic images within `reach` of the cell (grains lie inside the cell)."""
    n = x.size
    if cell is None:
        return x, y, np.arange(n)
    total = 0
    px = x
    py = y
    owner = np.arange(n)
    for fill in range(2):  # count, then fill
        if fill == 1:
            px = np.empty(total)
            py = np.empty(total)
            owner = np.empty(total, np.int64)
            for i in range(n):
                px[i] = x[i]
                py[i] = y[i]
                owner[i] = i
        total = n
        for row in range(-1, 2):
            for i in range(n):
                qy = y[i] + row * cell.height
                if qy < -reach or qy > cell.height + reach:
                    continue
                shifted = x[i] + row * cell.offset
                shifted -= math.floor(shifted / cell.width) * cell.width
                for column in range(-1, 2):
                    qx = shifted + column * cell.width
                    if qx < -reach or qx > cell.width + reach or (row == 0 and column == 0):
                        continue
                    if fill == 1:
                        px[total] = qx
                        py[total] = qy
                        owner[total] = i
                    total += 1
    return px, py, owner


@subkernel
def cell_order(px, py, width):
    """Sort into square cells at least `width` wide: cells a row, cell of each point, start of each cell, points in cell order."""
    low_x = high_x = px[0]
    low_y = high_y = py[0]
    for k in range(px.size):
        low_x = min(low_x, px[k])
        high_x = max(high_x, px[k])
        low_y = min(low_y, py[k])
        high_y = max(high_y, py[k])
    extent_x = high_x - low_x
    extent_y = high_y - low_y
    side = max(width, math.sqrt(extent_x * extent_y / px.size))  # never many more cells than grains, however far one has flown
    columns = int(extent_x / side) + 3  # one empty cell around, so that three neighbours in a row always exist
    rows = int(extent_y / side) + 3
    cell_of = np.empty(px.size, np.int64)
    start = np.zeros(columns * rows + 1, np.int64)
    for k in range(px.size):
        c = (int((py[k] - low_y) / side) + 1) * columns + int((px[k] - low_x) / side) + 1
        cell_of[k] = c
        start[c + 1] += 1
    for c in range(columns * rows):
        start[c + 1] += start[c]
    order = np.empty(px.size, np.int64)
    place = start[:-1].copy()
    for k in range(px.size):
        order[place[cell_of[k]]] = k
        place[cell_of[k]] += 1
    return columns, cell_of, start, order


@subkernel
def find_pairs(x, y, radius, movable, cell, skin, pairs):
    """Fills the list with all pairs closer than radii + skin, at least one of them movable (index < movable).

    Returns the number of pairs; if it exceeds the capacity the list is unusable and the caller has to make room and search again.
    Returns -1 for a periodic cell narrower than twice the reach, where a pair could be found with two of its images.
    """
    n = x.size
    largest = 0.0
    for i in range(n):
        largest = max(largest, radius[i])
    reach = 2.0 * largest + skin
    if cell is not None and min(cell.width, cell.height) < 2.0 * reach:
        return -1
    px, py, owner = images(x, y, cell, reach)
    columns, cell_of, start, order = cell_order(px, py, reach)
    m = order.size
    sx = np.empty(m)
    sy = np.empty(m)
    sr = np.empty(m)
    so = np.empty(m, np.int64)
    for k in range(m):
        q = order[k]
        sx[k] = px[q]
        sy[k] = py[q]
        so[k] = owner[q]
        sr[k] = radius[owner[q]] + skin
    capacity = pairs.first.size
    found = 0
    candidate = np.empty(m, np.int64)
    for i in range(n):
        pairs.start[i] = min(found, capacity)
        if i >= movable:  # both grains of any later pair are driven
            continue
        near = 0
        for row in range(-1, 2):
            c = cell_of[i] + row * columns
            for k in range(start[c - 1], start[c + 2]):
                dx = sx[k] - x[i]
                dy = sy[k] - y[i]
                cut = sr[k] + radius[i]
                candidate[near] = so[k]
                near += (dx * dx + dy * dy < cut * cut) and (so[k] > i)
        if found + near <= capacity:
            for k in range(near):
                pairs.first[found + k] = i
                pairs.second[found + k] = candidate[k]
                pairs.reach[found + k] = radius[i] + radius[candidate[k]]
        found += near
    pairs.start[n] = min(found, capacity)
    return found


@subkernel
def carry_over(old, new, memory):
    """Memory (of any contact effect) of the pairs in the old list, in the order of the new one; zero for new pairs."""
    if memory is None:
        return
    kept = memory.copy()
    for i in range(new.start.size - 1):
        for k in range(new.start[i], new.start[i + 1]):
            memory[k] = 0.0
            for q in range(old.start[i], old.start[i + 1]):
                if old.second[q] == new.second[k]:
                    memory[k] = kept[q]
