"""Moduli from probes beside those of the fabric: along the path, against pressure, against what else is varied, and against the fabric."""

import numpy as np

from anisogran.glossary import label
from anisogran.plots.style import SERIES, figure

COLOURS = dict(zip("EABG", (SERIES[0], SERIES[4], SERIES[1], SERIES[2]), strict=True))
KILO = 1e-3  # moduli are drawn in kN/m
UNIT = "modulus [kN/m]"


def moduli_figure(paths, pressures, varied, fabric):
    """A Figure with a panel for each of these, all {title: Dataset} with dimensions seed and source ("back" and "fabric" are drawn).

    paths: over `state`; pressures: over `pressure`; varied: {(title, dimension, label of the axis): Dataset}; fabric: any states, drawn as
    the shear modulus against the trace of the fabric. Bars are standard errors over the seeds.
    """
    fig, axes = figure(4, int(np.ceil((len(paths) + len(varied) + 2) / 4)), width=4.0)
    free = iter(axes.flat)
    for title, data in paths.items():
        draw(one := next(free), data.eps_zz.mean("seed"), data)
        one.set(title=title, xlabel=label("eps_zz"), ylabel=UNIT)
    draw_pressures(next(free), pressures)
    for (title, dim, words), data in varied.items():
        draw(one := next(free), data[dim], data, dim)
        one.set(title=title, xlabel=words, ylabel=UNIT)
    draw_fabric(next(free), fabric)
    for one in free:
        one.set_visible(False)
    fig.legend(*axes.flat[0].get_legend_handles_labels(), loc="outside lower center", ncols=8, frameon=False)
    return fig


def mean_and_error(data):
    """Mean and standard error over the seeds."""
    return data.mean("seed"), data.std("seed", ddof=1) / np.sqrt(data.sizes["seed"])


def draw(axes, x, data, dim="state"):
    """The four moduli against x: from probes as points with a line, from the fabric dashed. A wide range of x is drawn in logarithms."""
    for name, colour in COLOURS.items():
        mean, error = mean_and_error(data[name])
        axes.errorbar(x, KILO * mean.sel(source="back"), KILO * error.sel(source="back"), fmt="o-", ms=4, color=colour, label=f"${name}$")
        axes.plot(x, KILO * mean.sel(source="fabric"), "--", lw=1.2, color=colour, label=f"${name}$, fabric")
    axes.locator_params(axis="x", nbins=5)
    if x.min() > 0 and x.max() > 100 * x.min():
        axes.set_xscale("log")
    axes.axhline(0.0, lw=0.6, color="0.7")


def draw_pressures(axes, pressures):
    """E and G against the pressure, in logarithms."""
    for (title, data), marker in zip(pressures.items(), ("o", "s", "^", "v"), strict=False):
        for name in ("E", "G"):
            mean, error = mean_and_error(data[name])
            axes.errorbar(
                data.pressure, KILO * mean.sel(source="back"), KILO * error.sel(source="back"), fmt=f"{marker}-", ms=4,
                color=COLOURS[name], label=f"${name}$, {title}",
            )  # fmt: skip
            axes.plot(data.pressure, KILO * mean.sel(source="fabric"), "--", lw=1.2, color=COLOURS[name])
    axes.set(xscale="log", yscale="log", xlabel=label("pressure"), ylabel=UNIT, title="isotropic states")
    axes.legend(fontsize=8, frameon=False)


def draw_fabric(axes, fabric):
    """The shear modulus of every state against the trace of its fabric; hollow: that of the affine network."""
    for (title, data), colour in zip(fabric.items(), SERIES[:1] + SERIES[3:], strict=False):
        axes.plot(data.fabric_trace.values.ravel(), KILO * data.G.sel(source="back").values.ravel(), ".", color=colour, label=title)
        axes.plot(data.fabric_trace.values.ravel(), KILO * data.G.sel(source="fabric").values.ravel(), ".", mfc="none", color=colour)
    axes.set(xlabel=label("fabric_trace"), ylabel="$G$ [kN/m]", title="every state; hollow: from the fabric")
    axes.legend(fontsize=8, frameon=False)
