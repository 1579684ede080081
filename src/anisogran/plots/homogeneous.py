"""Curves of homogeneous samples with the laws fitted to them: biaxial compression and periodic shear."""

import numpy as np

from anisogran.glossary import label
from anisogran.plots.style import COLOURS, figure


def biaxial_curves(series, fits, element=None):
    """Four pictures of a biaxial run: stresses, stress ratio with its fit, dilatancy, anisotropy with its fit.

    `fits` maps "s_D" and "anisotropy" to FitResults over eps_D; `element` is an element test of the scalar law, drawn if given.
    """
    fig, ((stress, ratio), (volume, structure)) = figure(2, 2)
    eps = series.eps_D.values
    for name in ("sigma_zz", "sigma_xx"):
        stress.plot(series.eps_zz, series[name], label=f"{label(name)} walls", lw=1.6)
    stress.plot(series.eps_zz, series.sigma_zz_grains, "k:", lw=1.2, label="same averaged over the grains")
    stress.plot(series.eps_zz, series.sigma_xx_grains, "k:", lw=1.2)
    stress.set(xlabel=label("eps_zz"), ylabel="stress [N/m]", ylim=(0, None))
    for axes, name in ((ratio, "s_D"), (structure, "anisotropy")):
        axes.plot(eps, series[name], color=COLOURS["dem"], lw=1.2, label="DEM")
        fit = fits[name]
        x = np.linspace(*fit.x_range, 200)
        axes.plot(x, fit.predict(x), color=COLOURS["fit"], lw=2, label="exponential fit" + ("" if fit.verdict else " (not trustworthy)"))
        axes.axvline(fit.x_range[1], color="0.7", lw=0.8, ls="--")
        axes.set(xlabel=label("eps_D") + " (half/half)", ylabel=label(name))
    ratio.annotate("fit ends", (fits["s_D"].x_range[1], 0.02), xytext=(4, 0), textcoords="offset points", color="0.5", fontsize=8)
    volume.plot(eps, series.eps_V, color=COLOURS["dem"], lw=1.6, label="DEM")
    volume.axhline(0, color="0.7", lw=0.8)
    volume.set(xlabel=label("eps_D") + " (half/half)", ylabel=label("eps_V") + " (half of the trace)")
    if element is not None:
        style = {"color": COLOURS["exponential"], "lw": 1.6, "label": "scalar law E, A, B"}
        ratio.plot(element.eps_D, element.s_D, **style)
        volume.plot(element.eps_D, element.eps_V, **style)
    for axes in (stress, ratio, volume, structure):
        axes.legend(fontsize=8, frameon=False)
    return fig


def friction_law(points, fit):
    """mu(I) and area fraction against I of homogeneous shear, with the fitted law."""
    fig, ((law, density),) = figure(2)
    law.errorbar(
        points.inertial_number,
        points.stress_ratio,
        points.stress_ratio_error,
        fmt="o",
        ms=4,
        color=COLOURS["dem"],
        label="DEM, periodic shear",
    )
    x = np.geomspace(float(points.inertial_number.min()) / 2, float(points.inertial_number.max()) * 1.5, 100)
    law.plot(x, fit.predict(x), color=COLOURS["fit"], label=r"$\mu_s + b\,I$")
    density.errorbar(points.inertial_number, points.area_fraction, points.area_fraction_error, fmt="o", ms=4, color=COLOURS["dem"])
    for axes, name in ((law, "stress_ratio"), (density, "area_fraction")):
        axes.set(xscale="log", xlabel=label("inertial_number"), ylabel=label(name))
    law.legend(fontsize=8, frameon=False)
    return fig
