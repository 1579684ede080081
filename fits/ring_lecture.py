"""The lecture's ring shear cell at constant volume: `python fits/ring_lecture.py [FILE.h5 [FIGURE.png]]`.

FILE is made by data_generation/ring_lecture.py (default: fits/data/ring_lecture.h5). Its density is not steady: the inside dilates, the
outside is pressed together, and the pressure is an outcome that changes over all three turns. Stresses are therefore taken over the
pressure on the inner ring at the same time. Profiles are means over the last two turns and the seeds, with the errors of their blocks.
"""

import sys
from pathlib import Path

import numpy as np

import anisogran as ag
from anisogran import plots
from anisogran.comparison import study_runs
from anisogran.glossary import label

DATA = Path(__file__).parent / "data" / "ring_lecture.h5"
SMOOTHED = 0.05  # turns over which the pressure is averaged for the table and the picture


def smoothed(turns, values):
    """(turns, mean values) over intervals of SMOOTHED turns."""
    number = (turns / SMOOTHED).astype(int)
    count = np.bincount(number)
    known = count > 0
    return (np.bincount(number, turns)[known] / count[known], np.bincount(number, values)[known] / count[known])


def main(file=DATA, figure=None):
    """Print how pressure and density move, save the picture if a file is named; return {seed: (turns, pressure on the inner ring)}."""
    runs = study_runs(ag.open(file, holds="lecture/profiles"), "lecture")
    pressures = {name: smoothed(run.series.turns.values, run.series.wall_pressure.values) for name, run in runs.items()}
    print("pressure on the inner ring in N/m, means over 0.05 turns")
    for name, (turns, pressure) in pressures.items():
        low = int(np.argmin(pressure))
        ends = f"{pressure[0]:.3g} at first, {pressure[-1]:.3g} after {turns[-1]:.1f} turns"
        print(f"  {name}: {ends}; between {pressure.max():.3g} and {pressure[low]:.3g} (at {turns[low]:.1f} turns)")
    print(
        "depth [d]  area fraction       v_phi/V             sigma_rr/p_i  sigma_phiphi/p_i  r^2 sigma_rphi/(R_i^2 p_i)  (mean of the seeds)"
    )
    stack = {
        name: np.mean([run.profiles[name].values for run in runs.values()], axis=0)
        for name in ("area_fraction", "v_phi", "relative_stress")
    }
    one = next(iter(runs.values()))
    depth, r, inner = one.profiles.depth.values, one.profiles.r.values, one.scene.inner_radius
    stress = stack["relative_stress"]
    torque = (r / inner) ** 2 * 0.5 * (stress[0, 1] + stress[1, 0])
    for k, x in enumerate(depth):
        v = stack["v_phi"][k] / one.scene.wall_speed
        print(f"{x:9.1f}  {stack['area_fraction'][k]:13.4f}  {v:12.3g} {stress[0, 0, k]:19.3f} {stress[1, 1, k]:17.3f} {torque[k]:27.3f}")
    if figure is not None:
        draw(runs, pressures).savefig(figure, dpi=150)
    return pressures


def draw(runs, pressures):
    """Pressure over turns; density, velocity and relative stress over the depth."""
    where = f"depth {label('depth')}"

    def profile(name, scale=1.0):
        return {
            seed: (run.profiles.depth.values, scale * run.profiles[name].values, scale * run.profiles[f"{name}_error"].values)
            for seed, run in runs.items()
        }

    first = next(iter(runs.values()))
    profiles = first.profiles
    parts = {r"$\sigma_{rr}$": (0, 0), r"$\sigma_{\phi\phi}$": (1, 1), r"$\sigma_{r\phi}$": (0, 1), r"$\sigma_{\phi r}$": (1, 0)}
    stress, error = profiles.relative_stress.values, profiles.relative_stress_error.values
    relative = {name: (profiles.depth.values, stress[place], error[place]) for name, place in parts.items()}
    panels = [
        plots.Panel("turns", label("wall_pressure"), pressures, log="y"),
        plots.Panel(where, label("area_fraction"), {}, profile("area_fraction"), from_zero=False),
        plots.Panel(where, r"$v_\phi/V$", {}, profile("v_phi", 1 / first.scene.wall_speed), log="y"),
        plots.Panel(where, "stress / pressure on the inner ring", {}, relative, title=next(iter(runs))),
    ]
    return plots.panels_figure(panels, columns=2)


if __name__ == "__main__":
    main(*sys.argv[1:3])
