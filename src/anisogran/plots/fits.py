"""Pictures of fits: data with the fitted curve, and below it what is left."""

from typing import NamedTuple

import numpy as np

from anisogran.glossary import GLOSSARY, label
from anisogran.plots.style import COLOURS, SERIES, figure


class FittedCurve(NamedTuple):
    """One data set with its fit: rows x, y, errors (or None) of all points, the curve over the points that were used, and `fitted`,
    the fit at each x or nan where a point was not used. Names are those of the glossary, or any."""

    label: str
    x_name: str
    y_name: str
    x: np.ndarray
    y: np.ndarray
    errors: np.ndarray | None
    fitted: np.ndarray
    curve_x: np.ndarray
    curve_y: np.ndarray
    trustworthy: bool


def fit_figure(curves, log=""):
    """A Figure of `FittedCurve`s: a column for each pair of x and y, data and curves above, residuals below.

    Points that the fit left out are pale, as far as they lie near. `log` names the logarithmic axes, "x", "y" or "xy"; on a logarithmic
    y the residuals are those of ln y, without points of the other sign.
    """
    panels = list(dict.fromkeys((curve.x_name, curve.y_name) for curve in curves))
    fig, axes = figure(len(panels), 2, width=5.2, height=2.9)
    for (above, below), panel in zip(axes.T, panels, strict=True):
        shown = [curve for curve in curves if (curve.x_name, curve.y_name) == panel]
        for k, curve in enumerate(shown):
            alone = len(shown) == 1
            data_colour, fit_colour = (COLOURS["dem"], COLOURS["fit"]) if alone else (SERIES[k % len(SERIES)],) * 2
            draw_fit(above, below, curve, data_colour, fit_colour, alone, log)
        above.set(ylabel=name_on_axis(panel[1]))
        rest = f"ln {plain(panel[1])} - ln fit" if "y" in log else f"{plain(panel[1])} - fit"
        below.set(xlabel=name_on_axis(panel[0]), ylabel=rest)
        below.axhline(0.0, color="0.4", lw=0.8)
        for ax in (above, below):
            ax.set_xscale("log" if "x" in log else "linear")
        above.set_yscale("log" if "y" in log else "linear")
        above.tick_params(labelbottom=False)
        below.sharex(above)
        above.legend(fontsize=8, frameon=False)
    return fig


def draw_fit(above, below, curve, data_colour, fit_colour, alone, log):
    """Draws one data set and its fit on the two axes."""
    used = np.isfinite(curve.fitted)
    few = used.sum() <= 60
    style = {"fmt": "o" if few else ".", "ms": 4 if few else 2, "color": data_colour, "lw": 0.8}
    errors = np.full(curve.x.size, np.nan) if curve.errors is None else curve.errors
    bars = None if curve.errors is None else errors[used]
    above.errorbar(curve.x[used], curve.y[used], bars, label="data" if alone else curve.label, **style)
    low, high = np.min(curve.x[used]), np.max(curve.x[used])
    near = ~used & (curve.x >= low - (high - low)) & (curve.x <= high + (high - low))  # what lies far off would hide the fit
    if np.any(near):
        above.plot(curve.x[near], curve.y[near], style["fmt"], ms=style["ms"], color="0.75", label="left out" if alone else None)
    words = ("fit" if alone else "") + ("" if curve.trustworthy else " (not trustworthy)")
    above.plot(curve.curve_x, curve.curve_y, color=fit_colour, lw=1.6, label=words.strip() or None)
    x, y, fitted = curve.x[used], curve.y[used], curve.fitted[used]
    if "y" in log:
        same = y * fitted > 0.0
        below.errorbar(x[same], np.log(y[same] / fitted[same]), **style)
    else:
        below.errorbar(x, y - fitted, bars, **style)


def plain(name):
    """The symbol of a name, without its unit."""
    return f"${GLOSSARY[name].symbol}$" if name in GLOSSARY else name


def name_on_axis(name):
    """The label of an axis, with the unit if the glossary knows it."""
    return label(name) if name in GLOSSARY else name
