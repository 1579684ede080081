"""The weights w_V^p of the lecture: which part of a disc lies in an averaging area, exactly."""

import numpy as np


def area_inside_circle(distance, radius, circle):
    """Area of a disc that lies inside a circle about the origin, m2; arrays broadcast.

    `distance` of the disc's centre from the origin, `radius` of the disc, `circle` the radius of the circle. The lens of two circles;
    exact to rounding, also for tangent and concentric circles.
    """
    distance, radius, circle = np.broadcast_arrays(*(np.asarray(a, dtype=float) for a in (distance, radius, circle)))
    area = np.zeros(distance.shape)
    inside = distance <= circle - radius
    around = distance <= radius - circle  # the circle lies within the disc
    area[inside] = np.pi * radius[inside] ** 2
    area[around & ~inside] = np.pi * circle[around & ~inside] ** 2
    cut = ~inside & ~around & (distance < radius + circle)
    d, a, c = distance[cut], radius[cut], circle[cut]
    # signed distances of the common chord from the two centres, and half its length (Heron); each factor is exact where it vanishes
    from_disc = (d * d + a * a - c * c) / (2 * d)
    chord = np.sqrt((a + c - d) * (d - (c - a)) * (d - (a - c)) * (a + c + d)) / (2 * d)

    def segment(height, r):
        return r * r * np.arctan2(chord, height) - height * chord

    area[cut] = segment(from_disc, a) + segment(d - from_disc, c)
    return area


def ring_weights(position, radius, edges):
    """Share of each disc in each ring edges[k] .. edges[k + 1] about the origin, shape (rings, N); a disc's shares add up to 1 at most."""
    distance = np.hypot(*np.asarray(position).T)
    inside = area_inside_circle(distance[None, :], radius[None, :], np.asarray(edges)[:, None])
    return np.diff(inside, axis=0) / (np.pi * radius**2)
