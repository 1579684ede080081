"""The lecture's pictures of the ring shear cell: force chains, kinetic energy, rotations, and the stress as crosses."""

import numpy as np
from matplotlib.collections import LineCollection

from anisogran.plots.grain_values import decades_scale, draw_values, kinetic_energies, signed_scale
from anisogran.plots.snapshots import draw_discs, draw_packing
from anisogran.plots.style import GRAIN, WALL, figure


def stress_crosses(position, stress):
    """Segments (n, 2, 2): at each position (P, 2) two lines along the axes of the stress (2, 2, P), their lengths in proportion to the
    principal stresses, compressive ones only; the longest is as long as the positions are apart from their nearest."""
    known = np.isfinite(stress).all(axis=(0, 1))
    position, stress = position[known], np.moveaxis(stress[..., known], -1, 0)
    principal, axes = np.linalg.eigh(0.5 * (stress + stress.transpose(0, 2, 1)))
    distance = np.linalg.norm(position[:, None] - position, axis=2)
    spacing = np.min(distance, initial=np.inf, where=distance > 0)
    half = 0.5 * spacing * principal / principal.max()
    lines = np.einsum("pia,pa->pai", axes, half)  # of each axis a the vector
    segments = np.stack([position[:, None] - lines, position[:, None] + lines], axis=2)
    return segments[principal > 0]


def ring_pictures(snapshot, position, stress, size=4.6):
    """A Figure of one snapshot: force chains, kinetic energy, rotations (if grains turn), crosses of the stress (2, 2, P) at `position`."""
    parts = {"kinetic energy [J]": (kinetic_energies(snapshot), decades_scale)}
    if snapshot.spin[snapshot.free].any():
        parts["spin [1/s], counter-clockwise positive"] = (np.where(snapshot.free, snapshot.spin, 0.0), signed_scale)
    fig, axes = figure(2, (3 + len(parts)) // 2, size, size)
    first, *middle, last = axes.flat[: 2 + len(parts)]
    draw_packing(first, snapshot, "force chains")
    for place, (meaning, (values, scale_of)) in zip(middle, parts.items(), strict=True):
        discs = draw_values(place, snapshot, values, scale_of([values]))
        fig.colorbar(discs, ax=place, label=meaning, shrink=0.8, pad=0.01)
    for mask, body in ((snapshot.free, GRAIN), (snapshot.fixed, WALL)):
        draw_discs(last, snapshot, mask, body)
    last.add_collection(LineCollection(stress_crosses(position, stress), linewidths=0.9, colors="black"))
    last.set(xlim=first.get_xlim(), ylim=first.get_ylim(), aspect="equal", title="principal stresses")
    for place in axes.flat[1 + len(parts) :]:
        place.set_axis_off()
    return fig
