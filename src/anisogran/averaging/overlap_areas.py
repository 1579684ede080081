"""Which part of a disc lies in a ring or a rectangle, and which part of a sphere in a ring or a box: the weights w_V^p of the lecture.

Areas are closed forms, exact to rounding. A sphere is cut into slices, discs again; along the axis they are summed with Gauss points
between the heights where a slice begins to touch an edge, placed so that the roots there do no harm. Volumes are then good to 1e-9 of
the sphere, and the parts of one sphere add up to rounding, whatever the edges.
"""

import math

import numpy as np

from anisogran.compiled import kernel, subkernel

TOUCH = 1 - 1e-10  # in radii: what a disc or a sphere holds beyond is less than the rounding of its shares, and counts as nothing
GAUSS, GAUSS_WEIGHT = (np.ascontiguousarray(values) for values in np.polynomial.legendre.leggauss(12))


@kernel
def disc_in_circle(distance, radius, circle):
    """Area of a disc that lies inside a circle of radius `circle`, their centres `distance` apart: the lens of two circles."""
    if circle <= 0 or distance >= radius + circle:
        return 0.0
    if distance <= circle - radius:
        return math.pi * radius * radius
    if distance <= radius - circle:
        return math.pi * circle * circle
    # signed distance of the common chord from the disc's centre, and half its length (Heron); each factor is exact where it vanishes
    height = (distance * distance + radius * radius - circle * circle) / (2 * distance)
    product = (radius + circle - distance) * (distance - (circle - radius)) * (distance - (radius - circle)) * (radius + circle + distance)
    chord = math.sqrt(product) / (2 * distance)
    other = distance - height
    return (
        radius * radius * math.atan2(chord, height) - height * chord + circle * circle * math.atan2(chord, other) - other * chord
    )  # fmt: skip


@subkernel
def beside_line(x):
    """Area of the unit disc to the left of the line at x, -1 <= x <= 1."""
    rise = math.sqrt((1 - x) * (1 + x))
    return 0.5 * math.pi + x * rise + math.atan2(x, rise)


@kernel
def disc_in_corner(x, y):
    """Area of the unit disc in the quarter plane to the left of x and below y."""
    if x <= -1 or y <= -1:
        return 0.0
    x, y = min(x, 1.0), min(y, 1.0)
    if x * x + y * y >= 1:  # the corner lies outside the disc
        if x < 0 and y < 0:
            return 0.0
        if x < 0:
            return beside_line(x)
        if y < 0:
            return beside_line(y)
        return beside_line(x) + beside_line(y) - math.pi
    # between the end of the chord at y and the corner, the disc reaches from below up to y; above 0 the part beside the chord is whole
    half, rise = math.sqrt((1 - y) * (1 + y)), math.sqrt((1 - x) * (1 + x))
    area = y * (x + half) + 0.5 * (x * rise + math.atan2(x, rise))
    part = 0.5 * (half * abs(y) + math.atan2(half, abs(y)))
    return area + part if y <= 0 else area - part + 0.5 * math.pi


@subkernel
def disc_in_rectangle(x0, x1, y0, y1, radius):
    """Area of a disc about the origin between the lines x0, x1 and y0, y1."""
    a = 1 / radius
    corners = (disc_in_corner(a * x1, a * y1) - disc_in_corner(a * x0, a * y1)) - (
        disc_in_corner(a * x1, a * y0) - disc_in_corner(a * x0, a * y0)
    )
    return radius * radius * corners


@subkernel
def interval_of(edges, value):
    """Index k of the interval edges[k] <= value < edges[k + 1]; -1 below all, len(edges) - 1 above all."""
    low, high = -1, len(edges)
    while high - low > 1:
        middle = (low + high) // 2
        if edges[middle] <= value:
            low = middle
        else:
            high = middle
    return low


@subkernel
def slab_of_sphere(radius, low, high):
    """Volume of a sphere about the origin between the heights low and high, -radius <= low <= high <= radius."""
    return math.pi * (radius * radius * (high - low) - (high**3 - low**3) / 3)


@kernel
def sphere_in_cylinder(distance, radius, cylinder, low, high):
    """Volume of a sphere inside a cylinder, between heights low <= high above its centre; their axes are `distance` apart."""
    low, high = max(low, -radius), min(high, radius)
    if low >= high:
        return 0.0
    widest = TOUCH * math.sqrt(radius * radius - max(low, -high, 0.0) ** 2)  # of the slices
    if distance - cylinder >= widest:
        return 0.0
    if distance + widest <= cylinder:
        return slab_of_sphere(radius, low, high)
    # a slice of radius sqrt(a^2 - z^2) begins to reach the cylinder, or to surround it, where it touches it; 0 for one that never does
    touching = math.sqrt(max(radius * radius - (cylinder - distance) ** 2, 0.0))
    around = math.sqrt(max(radius * radius - (cylinder + distance) ** 2, 0.0))
    breaks = np.empty(6)
    breaks[0] = low
    used = 1
    for height in (-touching, -around, around, touching):  # ascending
        if low < height < high:
            breaks[used] = height
            used += 1
    breaks[used] = high
    volume = 0.0
    for piece in range(used):
        begin, length = breaks[piece], breaks[piece + 1] - breaks[piece]
        for g in range(len(GAUSS)):
            # z = begin + length sin^2(angle): powers of 1/2 at both ends become smooth
            angle = 0.25 * math.pi * (GAUSS[g] + 1)
            z = begin + length * math.sin(angle) ** 2
            measure = 0.25 * math.pi * GAUSS_WEIGHT[g] * length * math.sin(2 * angle)
            volume += measure * disc_in_circle(distance, math.sqrt(max(radius * radius - z * z, 0.0)), cylinder)
    return volume


@kernel
def ring_shares(position, radius, free, edges, levels):
    """Share of each free disc in each ring edges[k] .. edges[k + 1] about the origin, or of each sphere in each ring and level.

    Returns (indptr, indices, shares): those of grain p stand from indptr[p] to indptr[p + 1], each with its cell, a ring in the plane
    (`levels` None, and nothing of spheres is compiled) or ring * (number of levels - 1) + level in space.
    """
    n, rings, storeys = len(radius), len(edges) - 1, 1
    if levels is not None:
        storeys = len(levels) - 1
    span = np.empty((n, 4), np.int64)  # first and last ring, first and last level
    indptr = np.zeros(n + 1, np.int64)
    for p in range(n):
        distance = math.sqrt(position[p, 0] ** 2 + position[p, 1] ** 2)
        reach = TOUCH * radius[p]
        span[p, 0] = max(interval_of(edges, distance - reach), 0)
        span[p, 1] = min(interval_of(edges, distance + reach), rings - 1)
        span[p, 2], span[p, 3] = 0, 0
        if levels is not None:
            span[p, 2] = max(interval_of(levels, position[p, 2] - reach), 0)
            span[p, 3] = min(interval_of(levels, position[p, 2] + reach), storeys - 1)
        size = max(span[p, 1] - span[p, 0] + 1, 0) * max(span[p, 3] - span[p, 2] + 1, 0) if free[p] else 0
        indptr[p + 1] = indptr[p] + size
    indices, shares = np.empty(indptr[n], np.int64), np.empty(indptr[n])
    for p in range(n):
        if indptr[p + 1] == indptr[p]:
            continue
        e, a = indptr[p], radius[p]
        distance = math.sqrt(position[p, 0] ** 2 + position[p, 1] ** 2)
        whole = math.pi * a * a
        if levels is not None:
            whole *= 4 / 3 * a
        for level in range(span[p, 2], span[p, 3] + 1):
            before = 0.0
            for k in range(span[p, 0], span[p, 1] + 2):  # edges
                if levels is not None:
                    low, high = levels[level] - position[p, 2], levels[level + 1] - position[p, 2]
                    inside = sphere_in_cylinder(distance, a, edges[k], low, high)
                else:
                    inside = disc_in_circle(distance, a, edges[k])
                inside = max(inside, before)  # but for rounding it is: no share is negative
                if k > span[p, 0]:
                    indices[e] = (k - 1) * storeys + level
                    shares[e] = (inside - before) / whole
                    e += 1
                before = inside
    return indptr, indices, shares


@kernel
def grid_shares(position, radius, x_edges, y_edges):
    """Share of each disc in each rectangle of a grid, as (indptr, indices, shares) like ring_shares; cell = column * rows + row."""
    n, columns, rows = len(radius), len(x_edges) - 1, len(y_edges) - 1
    span = np.empty((n, 4), np.int64)
    indptr = np.zeros(n + 1, np.int64)
    for p in range(n):
        x, y, a = position[p, 0], position[p, 1], TOUCH * radius[p]
        span[p, 0], span[p, 1] = max(interval_of(x_edges, x - a), 0), min(interval_of(x_edges, x + a), columns - 1)
        span[p, 2], span[p, 3] = max(interval_of(y_edges, y - a), 0), min(interval_of(y_edges, y + a), rows - 1)
        indptr[p + 1] = indptr[p] + max(span[p, 1] - span[p, 0] + 1, 0) * max(span[p, 3] - span[p, 2] + 1, 0)
    indices, shares = np.empty(indptr[n], np.int64), np.empty(indptr[n])
    for p in range(n):
        e, x, y, a = indptr[p], position[p, 0], position[p, 1], radius[p]
        for i in range(span[p, 0], span[p, 1] + 1):
            for j in range(span[p, 2], span[p, 3] + 1):
                if e == indptr[p + 1]:
                    break  # outside the grid
                x0, x1, y0, y1 = x_edges[i] - x, x_edges[i + 1] - x, y_edges[j] - y, y_edges[j + 1] - y
                away_x, away_y = max(x0, -x1, 0.0), max(y0, -y1, 0.0)  # to the nearest point of the rectangle
                seen = away_x * away_x + away_y * away_y < (TOUCH * a) ** 2
                area = max(disc_in_rectangle(x0, x1, y0, y1, a), 0.0) if seen else 0.0
                indices[e] = i * rows + j
                shares[e] = area / (math.pi * a * a)
                e += 1
    return indptr, indices, shares
