"""Mohr's picture: stress circles of tests, and the lines that touch them."""

import numpy as np

from anisogran.glossary import label
from anisogran.models import mohr_coulomb_line, stress_circles
from anisogran.outcome import InputError
from anisogran.plots.style import SERIES, figure


def mohr_circles_figure(tests, lines=None, title=""):
    """Shear against normal stress: the circles of `tests` {label: (sigma_min, sigma_max)}, each of shape (n,), a colour for each label.

    `lines` {label: YieldLine} are drawn in the colour of the label, with phi and c in the legend and dots at the touching points;
    without them the common tangent of the circles of a label is found by `mohr_coulomb_line`. Raises InputError as this one does,
    or if there is nothing to draw.
    """
    if not tests:
        raise InputError("mohr_circles_figure: tests is empty")
    if lines is None:
        lines = {name: mohr_coulomb_line(*stresses) for name, stresses in tests.items()}
    circles = {name: stress_circles(*np.atleast_1d(*stresses)) for name, stresses in tests.items()}
    centre, radius = (np.concatenate([getattr(circle, name) for circle in circles.values()]) for name in ("centre", "radius"))
    left, right = min(0.0, float(np.min(centre - radius))), float(np.max(centre + radius))
    fig, ((axes,),) = figure(1, width=7.5, height=3.2)
    for k, (name, circle) in enumerate(circles.items()):
        colour = SERIES[k % len(SERIES)]
        axes.plot(*circle.points(), color=colour, lw=1.2)
        if name in lines:
            line = lines[name]
            ends = np.array([line_start(line, left - 0.35 * right), right])
            text = rf"{name}: $\phi$ = {np.degrees(line.phi):.1f}°, $c$ = {line.c:.3g} N/m"
            axes.plot(ends, line.shear_stress(ends), color=colour, lw=1.8, label=text)
            axes.plot(*line.touching_points(circle), "o", color=colour, ms=4)
    axes.axhline(0.0, color="0.75", lw=0.8, zorder=0)
    axes.axvline(0.0, color="0.75", lw=0.8, zorder=0)
    axes.set(xlabel=f"normal stress {label('normal_stress')}", ylabel=f"shear stress {label('shear_stress')}", title=title, aspect="equal")
    axes.set_ylim(0.0, None)
    if lines:
        axes.legend(fontsize=8, edgecolor="none", framealpha=1.0, loc="upper left")  # hides the axis behind it
    return fig


def line_start(line, leftmost):
    """Where the line begins to be drawn: at no shear stress, but no further left than told."""
    return leftmost if line.phi <= 0.0 else max(-line.c / np.tan(line.phi), leftmost)
