"""Strengths of tablets against adhesion and pressing pressure: `python fits/tablet_strength.py [tablet_strength.h5 [FIGURE.png]]`.

Slide "compression-tension", which shows curves at k1/k2 = 1/2 without numbers. The file is made by data_generation/tablet_strength.py; that
of the full run is in fits/data/. A contact that was pressed by a force f bears (1 - k1/k2)/(1 + k2/kc) k2/k1 f in tension, and f is p times
a diameter or so; so the strengths are compared with a p F, F = (1 - k1/k2)/(1 + k2/kc).
"""

import sys
from pathlib import Path

import numpy as np

import anisogran as ag
from anisogran import plots
from anisogran.models import macro_cohesion

DATA = Path(__file__).parent / "data" / "tablet_strength.h5"
K1, K2 = 5e4, 1e5  # N/m
WIDTH = 5e-4  # of strain, of the moving average: 2e-4 gives 5 % more, and the 4e-3 of the biaxial box half of it, as tablets tear at 1e-3


def strengths(data):
    """Strength in N/m, positive, a DataArray over test, contact_kc, pressing_pressure and seed."""
    series = data["tablets/series"].to_dataset()

    def strength(strain, stress):
        sense = np.sign(strain[np.isfinite(strain)][-1])
        return ag.fit.peak(sense * strain, sense * stress, width=WIDTH).value

    found = np.vectorize(strength, signature="(n),(n)->()")(series.eps_zz.values, series.sigma_zz.values)
    return series.sigma_zz.isel(sample=0).copy(data=found)


def proportional(x, y):
    """Slope of y = a x by least squares, its standard error, and the root mean square of the residuals over that of y."""
    a = float(x @ y / (x @ x))
    rest = y - a * x
    return a, float(np.sqrt(rest @ rest / (len(x) - 1) / (x @ x))), float(np.sqrt(rest @ rest / (y @ y)))


def main(file=DATA, figure=None):
    """Print tables and fits, save the picture if a file is named; return the strengths and {test: (a, error)}."""
    found = strengths(ag.open(file, holds="tablets/series"))
    mean, error = (found.isel(seed=0).copy(data=values) for values in ag.fit.mean_and_error(found, found.get_axis_num("seed")))
    factor = np.array([macro_cohesion(1.0, K1, K2, float(kc)) for kc in found.contact_kc])
    scale = factor[:, None] * found.pressing_pressure.values
    laws = {}
    for test in found.test.values:
        print(f"{test}: strength in N/m, mean +- standard error over {found.sizes['seed']} seeds; in brackets over p F")
        print("kc/k2     F  " + "".join(f"p = {float(p):<22g}" for p in found.pressing_pressure))
        for k, kc in enumerate(found.contact_kc.values):
            cells = []
            for p in found.pressing_pressure.values:
                value, seeds = float(mean.loc[test, kc, p]), float(error.loc[test, kc, p])
                cells.append(f"{value:6.1f} +- {seeds:4.1f} ({value / (factor[k] * p):4.2f})")
            print(f"{kc / K2:5.1f}  {factor[k]:5.3f}  " + "".join(f"{cell:26}" for cell in cells))
        a, a_error, rest = proportional(scale.ravel(), mean.sel(test=test).values.ravel())
        laws[str(test)] = a, a_error
        print(f"  strength = a p F: a = {a:.2f} +- {a_error:.2f}, residuals {rest:.0%} of the strengths")
        for k, kc in enumerate(found.contact_kc.values):
            each, each_error, _ = proportional(scale[k], mean.sel(test=test, contact_kc=kc).values)
            print(f"    kc/k2 = {kc / K2:g} alone: a = {each:.2f} +- {each_error:.2f}")
        print()
    if len(laws) == 2:
        print(f"crushed over torn: {laws['compression'][0] / laws['tension'][0]:.2f}")
    if figure is not None:
        draw(figure, mean, error, factor, laws)
    return found, laws


def draw(path, mean, error, factor, laws):
    """Strength against F and against p, with the law."""
    panels = []
    for test, (a, _) in laws.items():
        points = {}
        for p in mean.pressing_pressure.values:
            here = {"test": test, "pressing_pressure": p}
            points[f"p = {p:g} N/m"] = factor, mean.sel(here).values, error.sel(here).values
        dashed = {f"p = {float(p):g} N/m": (np.append(0, factor), a * float(p) * np.append(0, factor)) for p in mean.pressing_pressure}
        law = f"dashed: a p F, a = {a:.2f}"
        panels.append(plots.Panel("F = (1 - k1/k2)/(1 + k2/kc)", f"strength in {test} [N/m]", {}, points, dashed, title=law))
    plots.panels_figure(panels).savefig(path, dpi=150)


if __name__ == "__main__":
    main(*sys.argv[1:3])
