"""Grains, their contact forces and force chains at one instant."""

import numpy as np
from matplotlib.collections import EllipseCollection, LineCollection

from anisogran.averaging.grain_sums import contact_ends
from anisogran.averaging.sample import contact_lines
from anisogran.plots.style import GRAIN, SERIES, WALL, figure

CHAIN = "#7a1f2b"


def draw_discs(axes, snapshot, mask, colour):
    """The grains of the mask (N,) as discs; `colour` is one, or one for each of them."""
    diameter = 2 * snapshot.radius[mask]
    axes.add_collection(
        EllipseCollection(
            diameter, diameter, np.zeros(len(diameter)), units="xy", offsets=snapshot.position[mask], transOffset=axes.transData,
            facecolors=colour, edgecolors="white", linewidths=0.2,
        )
    )  # fmt: skip


def contact_segments(snapshot):
    """Of the contacts of free grains: segments (n, 2, d) between centres or to the contact point at a wall, forces (n, d), pairs (n, 2).

    A contact across the border of a cell, or the seam of a sector, is drawn once, at its first grain.
    """
    ends = contact_ends(snapshot)
    start, branch, force, _ = contact_lines(snapshot, ends)
    return np.stack([start, start + branch], axis=1), force, snapshot.pairs[np.unique(ends.contact)]


def draw_packing(axes, snapshot, title="", colour=CHAIN):
    """Grains as discs and contact forces as lines between centres, or to the contact point at a wall, as wide as the force is strong."""
    for mask, body in ((snapshot.free, GRAIN), (snapshot.fixed, WALL)):
        if mask.any():
            draw_discs(axes, snapshot, mask, body)
    segments, force, _ = contact_segments(snapshot)
    strength = np.hypot(*force.T)
    if strength.any():
        strong = strength > 0.05 * strength.mean()
        widths = 0.75 * strength[strong] / strength.mean()
        axes.add_collection(LineCollection(segments[strong], linewidths=widths, colors=colour, capstyle="round"))
    border = 2 * snapshot.radius.max()
    low, high = snapshot.position.min(axis=0) - border, snapshot.position.max(axis=0) + border
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal", title=title)
    axes.set_axis_off()


def packings(snapshots, titles, size=4.4):
    """Force chains of several snapshots side by side."""
    fig, axes = figure(len(snapshots), width=size, height=size)
    for place, snapshot, title in zip(axes[0], snapshots, titles, strict=True):
        draw_packing(place, snapshot, title)
    return fig


def chain_figure(snapshot, chains, title=""):
    """The packing with its contact forces in grey, and on it the grains and links of the force chains, of `grain_chains`.

    Each chain has one colour; there are few colours, so chains apart may share one.
    """
    fig, axes = figure(1, width=6.0, height=6.0)
    draw_packing(axes[0, 0], snapshot, title, colour="0.6")
    chain, links = chains.chain_of.values, chains.links.values
    colour = np.array(SERIES)[chain % len(SERIES)]
    member = chain >= 0
    if member.any():
        draw_discs(axes[0, 0], snapshot, member, [(name, 0.45) for name in colour[member]])
        segments, _, pairs = contact_segments(snapshot)
        low, high = np.sort(pairs, axis=1).T  # walls are negative, and no link
        linked = np.isin(low * len(chain) + high, links.min(axis=1) * len(chain) + links.max(axis=1))
        axes[0, 0].add_collection(LineCollection(segments[linked], linewidths=2.5, colors=colour[high[linked]], capstyle="round"))
    return fig
