"""Load reversal and isobaric cycles against the scalar model: `python fits/cycles.py [biaxial_cycles.h5 [FIGURE.png]]`.

The model is fitted to the mean over seeds of one loading to 2 % of vertical strain and back, and is then run along ten cycles of 0.4 %,
which it has not seen. (Fitted to the loading alone, it may give an A that no stable material has when it is unloaded: E B <= A^2.)
Ratcheting is what the volume strain moves in one whole cycle. The file is made by data_generation/biaxial_cycles.py; that of the full
run is in fits/data/.
"""

import sys
import tomllib
from pathlib import Path

import numpy as np

import anisogran as ag
from anisogran import plots

DATA = Path(__file__).parent / "data" / "biaxial_cycles.h5"


def mean_over_seeds(data, name):
    """(scene as a dict, eps_zz, sigma_zz, eps_V) of a sweep, means over seeds; all seeds follow one path of the top."""
    series = data[f"{name}/series"].to_dataset()
    eps_V = 0.5 * (series.eps_zz + series.eps_xx)
    scene = tomllib.loads(data[f"{name}/cases"].attrs["scene"])
    return scene, *(row.mean("seed").values.astype(float) for row in (series.eps_zz, series.sigma_zz, eps_V - eps_V.isel(sample=0)))


def ratcheting(eps_V, samples):
    """What eps_V moves in each whole cycle, from the ends of unloading, without the first loading; shape (cycles - 1,)."""
    return np.diff(eps_V[2 * samples :: 2 * samples])


def main(file=DATA, figure=None):
    """Print the comparison, save the curves if a file is named; return (LawFit, {"grains", "model": eps_V a cycle})."""
    data = ag.open(file, holds="reversal/series")
    scene, strain, stress, volume = mean_over_seeds(data, "reversal")
    p, samples = float(scene["pressure"]), scene["samples"]
    start = {"sigma_xx": p, "sigma_zz": stress[0]}
    there_and_back = ag.fit.Curve(ag.models.biaxial(strain, p), {"sigma_zz": stress, "eps_V": volume}, start=start, label="there and back")
    fit = ag.fit.calibrate("scalar", [there_and_back])
    reversal = fit.tests["there and back"]
    print("fitted to loading and unloading: " + ", ".join(f"{name} = {value:.4g}" for name, value in fit.parameters().items()))
    print("\n".join(f"  {name}: {misfit}" for name, misfit in fit.columns["there and back"].items()))
    print(f"  {reversal.status}\n  eps_zz on the way back   sigma_zz grains   model")
    n = len(reversal.sigma_zz)
    for k in range(samples, n, max(1, samples // 5)):
        print(f"  {strain[k]:22.4f} {stress[k]:17.1f} {reversal.sigma_zz[k]:7.1f}")
    scene, around, cyclic_stress, cyclic_volume = mean_over_seeds(data, "cycles")
    cycles = fit.predict(ag.models.biaxial(around, p), {"sigma_xx": p, "sigma_zz": cyclic_stress[0]})
    moved = {name: ratcheting(row, scene["samples"]) for name, row in (("grains", cyclic_volume), ("model", cycles.eps_V))}
    print(f"cycles: {cycles.status}\neps_V a cycle (compaction positive)    grains       model")
    for k in range(min(map(len, moved.values()))):
        print(f"  cycle {k + 2:3d} {moved['grains'][k]:32.2e} {moved['model'][k]:11.2e}")
    if figure is not None:
        curves = {"there and back": (strain, stress), "cycles": (around, cyclic_stress)}
        law = {
            "there and back": (strain[:n], reversal.sigma_zz),
            "cycles": (around[: len(cycles.sigma_zz)], cycles.sigma_zz),
        }
        volumes = {"there and back": (strain, volume), "cycles": (around, cyclic_volume)}
        law_volumes = {
            "there and back": (strain[:n], reversal.eps_V),
            "cycles": (around[: len(cycles.eps_V)], cycles.eps_V),
        }
        axis = r"$\varepsilon_{zz}$"
        panels = [
            plots.Panel(axis, r"$\sigma_{zz}$ [N/m]", curves, dashed=law, title="grains (lines) and scalar model (dashed)"),
            plots.Panel(axis, r"$\varepsilon_V$ (half of the trace)", volumes, dashed=law_volumes),
        ]
        plots.panels_figure(panels).savefig(figure, dpi=150)
    return fit, moved


if __name__ == "__main__":
    main(*sys.argv[1:3])
