"""What accuracy costs: error against seconds, a panel for each knob."""

import math
from itertools import groupby
from textwrap import fill

from matplotlib.ticker import NullLocator

from anisogran.plots.style import COLOURS, SERIES, figure

TITLE = 56  # letters in a line of a title


def cost_figure(rows):
    """A Figure of the rows of a cost table that have an error: error against seconds for each knob, values beside the points.

    The default is marked by a ring. Numbers are joined by a line; words, such as kernels, are points.
    """
    knobs = [(knob, list(block)) for knob, block in groupby(rows, key=lambda row: row["knob"])]
    knobs = [(knob, block) for knob, block in knobs if block[0]["error"] is not None]
    columns = math.ceil(math.sqrt(len(knobs)))
    fig, axes = figure(columns, math.ceil(len(knobs) / columns))
    for ax in axes.flat[len(knobs) :]:
        ax.set_axis_off()
    for ax, (knob, block) in zip(axes.flat, knobs, strict=False):
        name, _, meaning = knob.partition(": ")
        seconds, errors = [row["seconds"] for row in block], [row["error"] for row in block]
        words = isinstance(block[0]["value"], str)
        ax.loglog(seconds, errors, "o" if words else "o-", color=COLOURS["dem"])
        for k, row in enumerate(block):
            text = row["value"] if words else f"{row['value']:g}"
            ax.annotate(text, (row["seconds"], row["error"]), textcoords="offset points", xytext=(7, 5 - 14 * (k % 2)), fontsize=8)
            if row["default"]:
                ax.loglog(row["seconds"], row["error"], "o", ms=12, mfc="none", mec=COLOURS["fit"], mew=1.5)
        ax.set(xlabel="seconds", ylabel="relative error", xlim=decades(seconds), ylim=decades(errors))
        ax.set_title(f"{name}\n{fill(meaning, TITLE)}", fontsize=9)
        ax.grid(alpha=0.25)
        for axis in (ax.xaxis, ax.yaxis):
            axis.set_minor_locator(NullLocator())  # most of the time of a figure goes into ticks
    return fig


def rooms_figure(curves):
    """A Figure of chosen knobs, a panel a room, from {room: {name: rows}}: error against seconds, the defaults ringed.

    Knobs with numbers are lines, those with words points.
    """
    fig, axes = figure(2, math.ceil(len(curves) / 2), width=4.0, height=3.0)
    for ax in axes.flat[len(curves) :]:
        ax.set_axis_off()
    for ax, (room, knobs) in zip(axes.flat, curves.items(), strict=False):
        for colour, (name, block) in zip(SERIES, knobs.items(), strict=False):
            line = "o" if isinstance(block[0]["value"], str) else "o-"
            ax.loglog([row["seconds"] for row in block], [row["error"] for row in block], line, color=colour, ms=4, label=name)
            for row in block:
                if row["default"]:
                    ax.loglog(row["seconds"], row["error"], "o", ms=10, mfc="none", mec=colour, mew=1.5)
        every = [row for block in knobs.values() for row in block]
        seconds, errors = [row["seconds"] for row in every], [row["error"] for row in every]
        ax.set(title=room, xlabel="processor seconds", ylabel="relative error", xlim=half_decades(seconds), ylim=half_decades(errors))
        ax.grid(alpha=0.25)
        for axis in (ax.xaxis, ax.yaxis):
            axis.set_minor_locator(NullLocator())
        ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.22), ncols=2, fontsize=8, frameon=False, columnspacing=1.0, handlelength=1.5)
    return fig


def half_decades(values):
    """The half decades around the values, with room for a ring about the outermost."""
    low, high = math.floor(2 * math.log10(0.8 * min(values))), math.ceil(2 * math.log10(1.25 * max(values)))
    return 10.0 ** (low / 2), 10.0 ** (high / 2)


def decades(values):
    """The whole decades around the values, at least one, so that an axis has two labels, and room above for a text."""
    low, high = math.floor(math.log10(min(values))), math.ceil(math.log10(2.0 * max(values)))
    return 10.0**low, 10.0 ** max(high, low + 1)
