"""Do tablets hold together on a floor that shakes? `python fits/tablet_vibration.py [tablet_vibration.h5 [FIGURE.png]]`.

Slide "Vibration test", which shows tablets pressed at p = 10 and p = 100 without numbers. The file is made by
data_generation/tablet_vibration.py; that of the full run is in fits/data/.
"""

import sys
from pathlib import Path

import numpy as np

import anisogran as ag
from anisogran import plots

DATA = Path(__file__).parent / "data" / "tablet_vibration.h5"
WHOLE = 0.8  # share of the mass in the largest fragment, above which a tablet has held together


def main(file=DATA, figure=None):
    """Print the table, save the picture if a file is named; return {pressure: least share of the mass in the largest fragment, (seed,)}."""
    series = ag.open(file)["tablets/series"].to_dataset()
    print(
        f"p [N/m]   held together   least largest fragment   most fragments   at the end: fragments, largest ({series.sizes['seed']} seeds)"
    )
    least = {}
    for p in series.pressing_pressure.values:
        one = series.sel(pressing_pressure=p)
        share = one.largest_fragment.min("sample").values
        least[float(p)] = share
        most, end = one.fragments.max("sample").mean(), one.isel(sample=-1)
        print(
            f"{p:7g}   {np.sum(share > WHOLE):6d} of {len(share)}   {share.mean():12.2f} ({share.min():.2f} to {share.max():.2f})   "
            f"{float(most):14.1f}   {float(end.fragments.mean()):10.1f}, {float(end.largest_fragment.mean()):.2f}"
        )
    print(f"held together: the largest fragment never has less than {WHOLE:.0%} of the mass")
    if figure is not None:
        draw(figure, series)
    return least


def draw(path, series):
    """Size and number of fragments in time, means over seeds."""
    time = series.time.isel(pressing_pressure=0, seed=0).values
    mean = series.mean("seed")
    panels = []
    for name, told in (("largest_fragment", "largest fragment / mass of all"), ("fragments", "number of fragments")):
        curves = {f"pressed at {p:g} N/m": (time, mean[name].sel(pressing_pressure=p).values) for p in series.pressing_pressure.values}
        panels.append(plots.Panel("t [s]", told, curves))
    plots.panels_figure(panels).savefig(path, dpi=150)


if __name__ == "__main__":
    main(*sys.argv[1:3])
