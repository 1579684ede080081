"""Initial slope and peak of the stress: `python fits/modulus_and_yield_stress.py [biaxial_cohesion.h5 [FIGURE.png]]`.

Slides "Bi-axial compression with p_x = const." and "Modulus and yield stress cohesion". The file is made by
data_generation/biaxial_cohesion.py (or biaxial_friction.py); that of the full run is in fits/data/. Errors are standard errors over seeds.
"""

import sys
from pathlib import Path

import numpy as np

import anisogran as ag
from anisogran import plots

DATA = Path(__file__).parent / "data" / "biaxial_cohesion.h5"
INITIAL = 1e-3  # vertical strain over which the slope is taken: the curves are straight to a few per cent so far
VARIED = {"contact_kc": "kc [N/m]", "friction_mu": "mu"}


def slopes(series):
    """d sigma_zz/d eps_zz of every case at the start, by least squares."""
    strain, stress = series.eps_zz.values, series.sigma_zz.values
    used = np.where(strain <= INITIAL, 1.0, np.nan)
    x, y = strain * used, stress * used
    x, y = x - np.nanmean(x, axis=-1, keepdims=True), y - np.nanmean(y, axis=-1, keepdims=True)
    return np.nansum(x * y, axis=-1) / np.nansum(x * x, axis=-1)


def mean_curve(series, points=300):
    """(eps_zz, mean sigma_zz over seeds) on an even grid."""
    grid = np.linspace(0.0, float(series.eps_zz.max()), points)
    curves = [np.interp(grid, *pair) for pair in zip(series.eps_zz.values, series.sigma_zz.values, strict=True)]
    return grid, np.mean(curves, axis=0)


def spread(values):
    """Mean and standard error over the last axis, as text."""
    mean, error = ag.fit.mean_and_error(values)
    return f"{mean:10.4g} +- {error:<7.2g}"


def main(file=DATA, figure=None):
    """Print the table, save the curves if a file is named; return {(sweep, value that was varied): (slopes, peaks)} over seeds."""
    data = ag.open(file, holds="p100/series")
    names = [name for name in data.children if "-" not in name]
    varied = next(dim for dim in VARIED if dim in data[f"{names[0]}/series"].dims)
    print(f"slope of sigma_zz up to {INITIAL:.1%} of vertical strain, and peak of its moving average over 0.4 % strain, in N/m")
    print(f"{'sweep':>6} {VARIED[varied]:>9} {'slope':>12} {'peak':>21} {'at eps_zz':>22}")
    found, panels = {}, []
    for name in names:
        series = data[f"{name}/series"].to_dataset()
        slope, peak, curves = slopes(series), ag.fit.peak(series.eps_zz, series.sigma_zz), {}
        for k, value in enumerate(series[varied].values):
            found[name, float(value)] = slope[k], peak.value[k]
            print(f"{name:>6} {value:9g} {spread(slope[k])} {spread(peak.value[k])} {spread(peak.strain[k])}")
            curves[f"{VARIED[varied].split()[0]} = {value:g}"] = mean_curve(series.isel({varied: k}))
        panels.append(plots.Panel(r"$\varepsilon_{zz}$", r"$\sigma_{zz}$ [N/m]", curves, title=name.replace("p", "p = ") + " N/m"))
    if figure is not None:
        plots.panels_figure(panels).savefig(figure, dpi=150)
    return found


if __name__ == "__main__":
    main(*sys.argv[1:3])
