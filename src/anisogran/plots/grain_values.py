"""Grains coloured by what each of them has: kinetic energy, spin. And the lecture's pictures of the biaxial box."""

import numpy as np
from matplotlib.collections import EllipseCollection
from matplotlib.colors import LogNorm, Normalize

from anisogran.plots.snapshots import draw_packing
from anisogran.plots.style import figure

DECADES = 4  # of a logarithmic scale, below its largest value


def kinetic_energies(snapshot):
    """(N,) of translation, in J."""
    return 0.5 * snapshot.mass * np.einsum("ij,ij->i", snapshot.velocity, snapshot.velocity)


def signed_scale(values):
    """Colours symmetric about 0; the few largest are cut off, or all others would be pale."""
    largest = float(np.quantile(np.abs(np.concatenate(values)), 0.99)) or 1.0
    return {"norm": Normalize(-largest, largest), "cmap": "RdBu_r"}


def decades_scale(values):
    """Logarithmic colours over the upper decades."""
    largest = float(np.concatenate(values).max()) or 1.0
    return {"norm": LogNorm(largest * 10.0**-DECADES, largest), "cmap": "magma_r"}


def draw_values(axes, snapshot, values, scale):
    """The grains as discs coloured by values (N,); returns what a colour bar needs."""
    diameter = 2 * snapshot.radius
    discs = EllipseCollection(
        diameter, diameter, np.zeros(len(diameter)), units="xy", offsets=snapshot.position, transOffset=axes.transData,
        array=np.clip(values, scale["norm"].vmin, scale["norm"].vmax), edgecolors="none", **scale,
    )  # fmt: skip
    axes.add_collection(discs)
    border = snapshot.radius.max()
    low, high = snapshot.position.min(axis=0) - border, snapshot.position.max(axis=0) + border
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    axes.set_axis_off()
    return discs


def biaxial_pictures(snapshots, titles, size=3.2):
    """Force chains, kinetic energy and rotations (rows) of several snapshots (columns), as on the lecture's slides of the biaxial box.

    There is no row of rotations if no grain turns.
    """
    rows = {
        "kinetic energy [J]": ([kinetic_energies(one) for one in snapshots], decades_scale),
        "spin [1/s], counter-clockwise positive": ([one.spin for one in snapshots], signed_scale),
    }
    rows = {meaning: row for meaning, row in rows.items() if any(values.any() for values in row[0])}
    fig, axes = figure(len(snapshots), 1 + len(rows), size, size)
    for place, snapshot, title in zip(axes[0], snapshots, titles, strict=True):
        draw_packing(place, snapshot, title)
    for line, (meaning, (values, scale_of)) in zip(axes[1:], rows.items(), strict=True):
        scale = scale_of(values)
        for place, snapshot, one in zip(line, snapshots, values, strict=True):
            discs = draw_values(place, snapshot, one, scale)
        fig.colorbar(discs, ax=line, label=meaning, shrink=0.8, pad=0.01)
    return fig
