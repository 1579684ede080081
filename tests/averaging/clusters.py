"""Hand-made snapshots with known averages."""

import numpy as np

from anisogran.snapshot import Snapshot


def make(position, radius, pairs, force, **more):
    """A Snapshot of discs that touch as told; the contact point is the middle of the overlap, or the grain's surface at a wall."""
    position, radius = np.asarray(position, float), np.asarray(radius, float)
    pairs, force = np.asarray(pairs, int).reshape(-1, 2), np.asarray(force, float).reshape(-1, 2)
    n = len(radius)
    point = more.pop("point", None)
    overlap = np.zeros(len(pairs))
    if point is None:
        point = np.zeros((len(pairs), 2))
        for c, (i, j) in enumerate(pairs):
            branch = position[j] - position[i]
            distance = np.hypot(*branch)
            overlap[c] = radius[i] + radius[j] - distance
            point[c] = position[i] + branch * (radius[i] - overlap[c] / 2) / distance
    defaults = {"mass": np.ones(n), "velocity": np.zeros((n, 2)), "spin": np.zeros(n)}
    return Snapshot(position, radius, pairs=pairs, force=force, point=point, overlap=overlap, **{**defaults, **more})
