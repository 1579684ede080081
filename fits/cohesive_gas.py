"""How a free gas cools and clusters: `python fits/cohesive_gas.py [cohesive_gas.h5 [FIGURE.png]]`.

Slide "Attraction + Dissipation = Agglomeration". The file is made by data_generation/cohesive_gas.py; that of the full
run is in fits/data/.
Without attraction the kinetic energy of a dilute gas with constant restitution falls as E0/(1 + t/tau)^2 (Haff, J. Fluid Mech. 134, 401,
1983, from memory), so that (E0/E)^(1/2) - 1 is a straight line.
"""

import sys
from pathlib import Path

import numpy as np

import anisogran as ag
from anisogran import plots

DATA = Path(__file__).parent / "data" / "cohesive_gas.h5"
K2 = 1e5  # N/m


def haff_time(time, energy):
    """tau in s of sqrt(E0/E) - 1 = t/tau by least squares, and the root mean square of the residuals."""
    rise = np.sqrt(energy[0] / energy) - 1.0
    slope = float(time @ rise / (time @ time))
    return 1.0 / slope, float(np.sqrt(np.mean((rise - slope * time) ** 2)))


def main(file=DATA, figure=None):
    """Print the table, save the picture if a file is named; return {kc/k2: (fragments, largest) at the end, means over seeds}."""
    series = ag.open(file, holds="gases/series")["gases/series"].to_dataset()
    grains = float(series.fragments.isel(sample=0).max())
    print(f"{grains:g} grains, {series.sizes['seed']} seeds; at the end of {float(series.time.max()):.2g} s:")
    print("kc/k2   fragments   largest   mean size   contacts a grain   E_kin/E_0   Haff's tau [s] (rms of sqrt(E_0/E))")
    ends = {}
    for kc in series.contact_kc.values:
        mean = series.sel(contact_kc=kc).mean("seed")
        end = mean.isel(sample=-1)
        energy = mean.kinetic_energy.values.astype(float)
        tau, rest = haff_time(mean.time.values.astype(float), energy)
        ends[float(kc) / K2] = float(end.fragments), float(end.largest_fragment)
        print(
            f"{kc / K2:5.1f}   {float(end.fragments):9.1f}   {float(end.largest_fragment):7.3f}   {grains / float(end.fragments):9.1f}   "
            f"{float(end.coordination_number):16.2f}   {energy[-1] / energy[0]:9.4f}   {tau:.4f} ({rest:.2f})"
        )
    if figure is not None:
        draw(figure, series)
    return ends


def draw(path, series):
    """Energy, number of fragments and the largest of them in time, means over seeds."""
    panels = []
    for name, told, log in (
        ("kinetic_energy", "kinetic energy [J]", "y"),
        ("fragments", "number of fragments", ""),
        ("largest_fragment", "largest / mass of all", ""),
    ):
        curves = {}
        for kc in series.contact_kc.values:
            mean = series.sel(contact_kc=kc).mean("seed")
            curves[f"kc/k2 = {kc / K2:g}"] = mean.time.values, mean[name].values
        panels.append(plots.Panel("t [s]", told, curves, log=log))
    plots.panels_figure(panels).savefig(path, dpi=150)


if __name__ == "__main__":
    main(*sys.argv[1:3])
