"""The law of force of one contact: its path over the overlap, with the branches and marks of the lecture."""

import numpy as np
from matplotlib.lines import Line2D

from anisogran.plots.style import SERIES, figure

BRANCHES = {  # of a contact: colour and label
    "loading": ("#1b4965", "loading"),
    "elastic": ("#2a9d8f", "elastic un- and reloading"),
    "limit": ("#d1495b", "adhesive limit"),
    "open": ("#8d99ae", "open"),
}
OVERLAP, FORCE = r"overlap $\delta/\delta_\mathrm{max}$", r"force $f/(k\,\delta_\mathrm{max})$"


def contact_law_figure(path, families):
    """One ContactPath with its branches and marks, and beside it `families` {title: {label: ContactPath}}, a panel each.

    The paths of a panel share their units, those of the last one; a dot is where un- and reloading meets the adhesive limit.
    """
    fig, axes = figure(1 + len(families), width=4.6, height=4.0)
    draw_contact_path(axes[0, 0], path, "branches of one contact")
    for place, (title, paths) in zip(axes[0, 1:], families.items(), strict=True):
        last = list(paths.values())[-1]
        length, scale = last.delta_max, last.stiffness * last.delta_max
        place.axhline(0, color="0.75", lw=0.8, zorder=0)
        for k, (name, member) in enumerate(paths.items()):
            colour = SERIES[k % len(SERIES)]
            place.plot(member.overlap / length, member.force / scale, color=colour, lw=1.6, label=name, zorder=2 - 0.01 * k)
            place.plot(member.delta_min / length, member.f_min / scale, "o", color=colour, ms=4)
        place.set(xlabel=OVERLAP, ylabel=FORCE, title=title)
        place.legend(fontsize=8, frameon=False, loc="upper left")
    return fig


def draw_contact_path(axes, path, title=""):
    """The branches of one contact with their directions and marks, in units of its largest overlap and the force k delta_max there.

    k is the stiffness of un- and reloading; the ticks are the marks, with their values.
    """
    unit = np.array([path.delta_max, path.stiffness * path.delta_max])
    points = np.stack([path.overlap, path.force], axis=1) / unit
    axes.axhline(0, color="0.75", lw=0.8, zorder=0)
    # a point was reached on its branch, and so was the step that leads to it; a new run begins where branch or direction change
    ways = np.sign(np.diff(path.overlap, prepend=path.overlap[0]))
    begins = np.flatnonzero(np.append(True, (path.branch[1:] != path.branch[:-1]) | (ways[1:] != ways[:-1])))
    for begin, end in zip(begins, np.append(begins[1:], len(points)), strict=True):
        colour, _ = BRANCHES[path.branch[begin]]
        run = points[max(begin - 1, 0) : end]
        axes.plot(*run.T, color=colour, lw=2, solid_capstyle="round")
        half = 2 * len(run) // 5  # not in the middle, where the way back has its own
        if half > 0 and abs(run[-1, 0] - run[0, 0]) > 0.05:
            arrow = {"arrowstyle": "-|>", "color": colour, "mutation_scale": 14}
            axes.annotate("", run[half], xytext=run[half - 1], arrowprops=arrow)
    strongest = points[path.overlap.argmax()]
    zero, weakest = np.array([path.delta_0, 0.0]) / unit, np.array([path.delta_min, path.f_min]) / unit
    low, high = min(points[:, 1].min(), weakest[1]), strongest[1]
    left, bottom = points[:, 0].min() - 0.04, low - 0.12 * (high - low)
    for x, y in (strongest, zero, weakest):
        axes.plot([x, x, left], [bottom, y, y], color="0.6", lw=0.8, ls=":", zorder=0)
        axes.plot(x, y, "o", color="black", ms=4, zorder=5)
    axes.set_xticks(*marks({"0": 0.0, r"$\delta_0$": zero[0], r"$\delta_\mathrm{min}$": weakest[0], r"$\delta_\mathrm{max}$": 1.0}))
    axes.set_yticks(*marks({"0": 0.0, r"$f_\mathrm{min}$": weakest[1], r"$f_\mathrm{max}$": high}))
    axes.set(xlim=(left, 1.08), ylim=(bottom, high + 0.1 * (high - low)), xlabel=OVERLAP, ylabel=FORCE, title=title)
    handles = [Line2D([], [], color=colour, lw=2, label=text) for name, (colour, text) in BRANCHES.items() if name in path.branch]
    axes.legend(handles=handles, fontsize=8, frameon=False, loc="upper left")


def marks(places):
    """Places and labels of ticks, of {name: place}: the value below each name, one tick where several are at one place."""
    names = {}
    for name, place in places.items():
        names.setdefault(round(float(place), 9), []).append(name)
    return list(names), [" = ".join(found) + (f"\n{place:.3g}" if place else "") for place, found in names.items()]
