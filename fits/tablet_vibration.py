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
LAST = 0.1  # share of the time at its end over which the largest fragment is averaged; pieces that touch for a moment come and go
WHOLE = 0.8  # share of the mass in the largest fragment, above which a tablet has held together


def main(file=DATA, figure=None):
    """Print the table, save the picture if a file is named; return {pressure: largest fragment over all in the end, (seed,)}."""
    series = ag.open(file, holds="tablets/series")["tablets/series"].to_dataset()
    last = series.isel(sample=slice(int((1 - LAST) * series.sizes["sample"]), None)).mean("sample")
    print(f"{series.sizes['seed']} seeds; in the last {LAST:.0%} of {float(series.time.max()):.2g} s:")
    print("p [N/m]   held together   largest fragment / all   fragments   most fragments at any time   width / width at the start")
    shares = {}
    for p in series.pressing_pressure.values:
        one, end = series.sel(pressing_pressure=p), last.sel(pressing_pressure=p)
        share = shares[float(p)] = end.largest_fragment.values
        wider = float((end.width / one.width.isel(sample=0)).mean())
        print(
            f"{p:7g}   {np.sum(share > WHOLE):6d} of {len(share)}   {share.mean():8.2f} ({share.min():.2f} to {share.max():.2f})   "
            f"{float(end.fragments.mean()):9.1f}   {float(one.fragments.max('sample').mean()):26.1f}   {wider:26.2f}"
        )
    print(f"held together: the largest fragment has more than {WHOLE:.0%} of the mass")
    if figure is not None:
        draw(figure, series)
    return shares


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
