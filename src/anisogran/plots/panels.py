"""Panels side by side with curves and points of several series, each series in its own colour: what most studies need."""

from typing import NamedTuple

import numpy as np

from anisogran.outcome import InputError
from anisogran.plots.style import SERIES, figure


class Panel(NamedTuple):
    """Axes with `curves` {label: (x, y)}, drawn as lines, `points` {label: (x, y, error or None)} and `dashed` {label: (x, y)}.

    The same label has the same colour in all three and stands once in the legend.
    """

    xlabel: str
    ylabel: str
    curves: dict
    points: dict = {}  # noqa: RUF012
    dashed: dict = {}  # noqa: RUF012
    title: str = ""
    log: str = ""  # the logarithmic axes, "x", "y" or "xy"
    from_zero: bool = True  # whether a linear y begins at 0


def panels_figure(panels, columns=None, width=4.6, height=3.6):
    """A Figure of Panels, `columns` in a row (default: all). Raises InputError if there is none."""
    if not panels:
        raise InputError("panels_figure: there is no panel")
    columns = columns or len(panels)
    fig, axes = figure(columns, -(-len(panels) // columns), width, height)
    for place, panel in zip(axes.flat, panels, strict=False):
        draw_panel(place, panel)
    for place in axes.flat[len(panels) :]:
        place.set_axis_off()
    return fig


def draw_panel(axes, panel):
    """Draws one Panel on the axes."""
    labels = list(dict.fromkeys([*panel.curves, *panel.points, *panel.dashed]))
    colour = {name: SERIES[k % len(SERIES)] for k, name in enumerate(labels)}
    named = set()

    def first(name):
        """The label of the first mark of that name; later ones have none."""
        told = None if name in named else name
        named.add(name)
        return told

    for name, (x, y) in panel.curves.items():
        axes.plot(x, y, color=colour[name], lw=1.5, label=first(name))
    for name, (x, y, error) in panel.points.items():
        axes.errorbar(x, y, error, fmt="o", ms=4, capsize=2, color=colour[name], label=first(name))
    for name, (x, y) in panel.dashed.items():
        axes.plot(x, y, color=colour[name], lw=1.3, ls="--", label=first(name))
    axes.set(xlabel=panel.xlabel, ylabel=panel.ylabel, title=panel.title)
    axes.set_xscale("log" if "x" in panel.log else "linear")
    if "x" not in panel.log:
        axes.locator_params(axis="x", nbins=6)
    axes.set_yscale("log" if "y" in panel.log else "linear")
    shown = np.concatenate([[], *(np.ravel(y) for _, y, *_ in (*panel.curves.values(), *panel.points.values(), *panel.dashed.values()))])
    if panel.from_zero and "y" not in panel.log and np.min(shown, initial=0.0, where=np.isfinite(shown)) >= 0:
        axes.set_ylim(0.0, None)
    axes.legend(fontsize=8, frameon=False)
