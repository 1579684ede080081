"""Ring shear cells of grains against the continuum: calibrated on one cell, predicted for all others.

    python fits/ring_comparison.py [FOLDER [FIGURE.png]]

FOLDER (fits/data/ if none is named) holds ring_friction_law.h5, ring_reference.h5 and ring_paper.h5, which data_generation/ makes. mu_s and
b come from homogeneous shear. Amplitude, exchange of fluidity at the wall and both base lines come from the reference cell, and are fixed
before any other cell is looked at.
"""

import sys
from pathlib import Path

import numpy as np

import anisogran as ag
from anisogran import plots
from anisogran.comparison import RIVALS, fitted_amplitude, fitted_wall, frozen, homogeneous_friction, predictions, study_runs

DATA = Path(__file__).parent / "data"


def cells(folder):
    """{name of a cell: [Measured of each seed]}, the reference first."""
    found = {}
    for name in ("ring_reference", "ring_paper"):
        study = ag.open(folder / f"{name}.h5")
        found |= {group: list(study_runs(study, group).values()) for group in study.children}
    return found


def over_seeds(tables, name):
    """(rival, seed) of one figure of the predictions."""
    return np.stack([table[name].values for table in tables], axis=-1)


def told(values, digits=3):
    """Mean and scatter of one run over the seeds, as text."""
    if np.isnan(values).any():
        return f"{'-':>16}"
    scatter = f"{np.std(values, ddof=1):7.{digits}f}" if len(values) > 1 else f"{'?':>7}"
    return f"{np.mean(values):7.{digits}f} ~{scatter}"


def own_fits(name, runs, mu_s, b):
    """Prints what the nonlocal parameters of a cell would be if they were fitted on it."""
    for fit in (fitted_amplitude, fitted_wall):
        found = [fit(run, mu_s, b) for run in runs]
        values = {key: ag.fit.mean_and_error([one.values[key] for one in found]) for key in found[0].values}
        words = ", ".join(f"{key} = {mean:.3f} +- {error:.3f}" for key, (mean, error) in values.items())
        bound = "" if all(one.status.level == "ok" for one in found) else "; at a bound"
        print(f"{name:12} {words}; L2 = {np.mean([one.l2 for one in found]):.3f}{bound}")


def main(folder=DATA, figure=None):
    """Print the tables, save the profiles if a file is named; return the Frozen parameters and {cell: [Dataset of predictions]}."""
    folder = Path(folder)
    shear = ag.open(folder / "ring_friction_law.h5", holds="shear/steady")
    friction, runs = homogeneous_friction(shear["shear/steady"].to_dataset()), cells(folder)
    mu_s, b = friction.values["mu_s"], friction.values["b"]
    calibrated, *predicted = runs
    parameters = frozen(runs[calibrated], mu_s, b)
    errors = parameters.errors
    print(f"homogeneous shear: {friction}")
    print(f"fitted on the cell {calibrated}, {len(runs[calibrated])} seeds, and fixed from here on:")
    print(f"  nonlocal             A = {parameters.amplitude:.3f} +- {errors['amplitude']:.3f}")
    wall = f"kappa = {parameters.wall:.3f} +- {errors['wall']:.3f}"
    print(f"  nonlocal with wall   A = {parameters.amplitude_with_wall:.3f} +- {errors['amplitude_with_wall']:.3f}, {wall}")
    print("  exponential          v/V = {:.3f} exp(-depth/{:.3f} d)".format(*parameters.exponential))
    tables = {name: [predictions(parameters, run) for run in runs[name]] for name in runs}
    print("\nmean ~ scatter from seed to seed; the reference cell is fitted, all others are predicted")
    for title, name, digits in (
        ("relative L2 of v_phi, x < 8 d", "l2", 3),
        ("rms of the difference of ln v_phi", "log_rms", 2),
        ("shear over normal stress at the inner ring", "stress_ratio_wall", 3),
    ):
        print(f"\n{title}\n{'':12} " + " ".join(f"{rival[:16]:>16}" for rival in RIVALS) + "   grains")
        for cell, found in tables.items():
            row = " ".join(told(values, digits) for values in over_seeds(found, name))
            grains = {"l2": "l2_noise", "stress_ratio_wall": "stress_ratio_wall_dem"}.get(name)
            print(f"{cell:12} {row} " + (told(np.array([float(table[grains]) for table in found]), digits) if grains else ""))
    print("\nif the parameters were fitted on each cell itself:")
    for name in runs:
        own_fits(name, runs[name], mu_s, b)
    if figure is not None:
        plots.predictions_figure({name: found[0] for name, found in tables.items()}).savefig(figure, dpi=150)
    return parameters, {name: tables[name] for name in predicted}


if __name__ == "__main__":
    main(*sys.argv[1:3])
