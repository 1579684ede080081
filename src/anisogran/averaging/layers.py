"""Profiles finer than a grain: each grain counts whole at its centre, in thin rings about the origin.

Rings with the exact share of each grain smear out what is narrower than a grain; the layers at a smooth wall are.
"""

import numpy as np


def layer_sums(snapshot, edges):
    """Sums over the free grains whose centres lie between ascending `edges` (m) about the origin, each (layers,), in the plane.

    "layer_grains", and their "layer_v_phi" (m/s) and "layer_spin" (1/s).
    """
    free = snapshot.free
    (x, y), (u, v) = snapshot.position[free].T, snapshot.velocity[free].T
    r = np.hypot(x, y)
    layer = np.searchsorted(edges, r, side="right")  # 0 and len(edges) lie outside
    values = {"layer_grains": None, "layer_v_phi": (x * v - y * u) / r, "layer_spin": snapshot.spin[free]}
    return {name: np.bincount(layer, weights, len(edges) + 1)[1:-1] for name, weights in values.items()}


def layer_fields(sums, edges, width):
    """Fields (layers,) from the (mean) sums: number_density, v_phi, spin, continuum_spin and eigen_rotation; NaN where no grain has been.

    The slope of v_phi in a layer is that of the parabola that fits the layers within width/2 (m) best, each by its grains.
    """
    r, grains = 0.5 * (edges[1:] + edges[:-1]), sums["layer_grains"]
    seen = grains > 0
    v_phi, spin = (np.divide(sums[name], grains, where=seen, out=np.full(len(r), np.nan)) for name in ("layer_v_phi", "layer_spin"))
    slope = np.full(len(r), np.nan)
    for k in np.flatnonzero(seen):
        near = seen & (np.abs(r - r[k]) <= 0.5 * width)
        if np.count_nonzero(near) > 3:
            slope[k] = np.polyfit(r[near] - r[k], v_phi[near], 2, w=np.sqrt(grains[near]))[1]
    rotation = 0.5 * (slope + v_phi / r)
    return {
        "number_density": grains / (np.pi * np.diff(edges**2)),
        "v_phi": v_phi,
        "spin": spin,
        "continuum_spin": rotation,
        "eigen_rotation": spin - rotation,
    }
