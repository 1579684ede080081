"""Mohr's circles of the peaks and the lines that touch them: `python fits/mohr_circles.py [FILE.h5 [FIGURE.png]]`.

Slides "Cohesion - no friction" and "Friction - no cohesion". FILE is made by data_generation/biaxial_cohesion.py (default, in fits/data/)
or biaxial_friction.py. A circle stands for the mean peak over seeds; a line is the fit to the peaks of all seeds.
"""

import sys
from pathlib import Path

import numpy as np

import anisogran as ag
from anisogran import plots

DATA = Path(__file__).parent / "data" / "biaxial_cohesion.h5"
VARIED = {"contact_kc": "kc [N/m]", "friction_mu": "mu"}
SHOWN = 5  # values whose circles are drawn; more would hide each other


def main(file=DATA, figure=None):
    """Print phi and c of each value that was varied, save the circles if a file is named; return {value: FitResult}."""
    data = ag.open(file, holds="p100/series")
    tests = {int(name[1:]): data[f"{name}/series"].to_dataset() for name in data.children if "-" not in name}
    varied = next(dim for dim in VARIED if dim in next(iter(tests.values())).dims)
    peaks = np.array([ag.fit.peak(series.eps_zz, series.sigma_zz).value for series in tests.values()])  # (pressure, value, seed)
    pressure = np.array(list(tests), dtype=float)
    values = next(iter(tests.values()))[varied].values
    fits = {float(value): ag.fit.mohr_coulomb(np.repeat(pressure, peaks.shape[2]), peaks[:, k].ravel()) for k, value in enumerate(values)}
    print(f"{VARIED[varied]:>9}    phi [deg]        c [N/m]     from circles at p = {', '.join(map(str, tests))} N/m")
    for value, fit in fits.items():
        phi, c = fit.values["phi"], fit.values["c"]
        print(f"{value:9g}  {np.degrees(phi):5.1f} +- {np.degrees(fit.errors['phi']):4.1f}  {c:7.1f} +- {fit.errors['c']:4.1f}")
    if figure is not None:
        shown = {
            f"{VARIED[varied].split()[0]} = {value:g}": (pressure, peaks[:, k].mean(axis=-1)) for k, value in enumerate(values[:SHOWN])
        }
        lines = {
            name: ag.models.YieldLine(*(fit.values[key] for key in ("phi", "c"))) for name, fit in zip(shown, fits.values(), strict=False)
        }
        plots.mohr_circles_figure(shown, lines).savefig(figure, dpi=150)
    return fits


if __name__ == "__main__":
    main(*sys.argv[1:3])
