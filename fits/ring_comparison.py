"""Ring shear cells of grains against the continuum: calibrated on one cell, predicted for all others.

    python fits/ring_comparison.py [FOLDER [FIGURE.png]]

FOLDER (fits/data/ if none is named) holds ring_friction_law.h5, ring_reference.h5 and, if it is there, ring_paper.h5, which
data_generation/ makes. mu_s and b come from homogeneous shear. Amplitude, exchange of fluidity at the wall and both base lines come from
the reference cell, and are fixed before any other cell is looked at.
"""

import sys
from pathlib import Path

import numpy as np

import anisogran as ag
from anisogran import plots
from anisogran.comparison import (
    RIVALS,
    fitted_amplitude,
    fitted_wall,
    frozen,
    homogeneous_friction,
    near_angle,
    packing,
    predictions,
    ring_flow,
    study_runs,
)

DATA = Path(__file__).parent / "data"


def cells(folder):
    """{name of a cell: [Measured of each seed]}, the reference first."""
    found = {}
    for name in ("ring_reference.h5", "ring_paper.h5"):
        if name == "ring_paper.h5" and not (folder / name).exists():
            continue
        study = ag.open(folder / name)
        found |= {group: list(study_runs(study, group).values()) for group in study.children}
    return found


def over_seeds(tables, name):
    """(rival, seed) of one figure of the predictions."""
    return np.stack([table[name].values for table in tables], axis=-1)


def told(values, digits=3):
    """Mean and scatter of one run over the seeds, as text."""
    if np.isnan(values).any():
        return f"{'-':>18}"
    scatter = f"{np.std(values, ddof=1):7.{digits}f}" if len(values) > 1 else f"{'?':>7}"
    return f"{np.mean(values):7.{digits}f} ~{scatter}  "


def own_fits(name, runs, mu_s, b):
    """Prints what the nonlocal parameters of a cell would be if they were fitted on it."""
    for fit in (fitted_amplitude, fitted_wall):
        found = [fit(run, mu_s, b) for run in runs]
        values = {key: ag.fit.mean_and_error([one.values[key] for one in found]) for key in found[0].values}
        words = ", ".join(f"{key} = {mean:.3f} +- {error:.3f}" for key, (mean, error) in values.items())
        bound = "" if all(one.status.level == "ok" for one in found) else "; at a bound"
        print(f"{name:12} {words}; L2 = {np.mean([one.l2 for one in found]):.3f}{bound}")


def print_structure(runs, law, steady):
    """Prints what the homogeneous laws say of density and angles, beside the grains."""
    inertial, nu, error = (steady[name].values.ravel() for name in ("inertial_number", "area_fraction", "area_fraction_error"))
    used = inertial < ag.models.LINEAR_LIMIT
    dense = ag.fit.area_fraction(inertial[used], nu[used], error[used])
    print(f"\nhomogeneous shear: {dense}")
    print("area fraction, x < 8 d but for the first ring: rms difference; outer radius (predicted - grains)/d; angles in degrees from the")
    print("strain rate over x < 8 d, which are 0 in the continuum; mean ~ scatter from seed to seed")
    for name, cell in runs.items():
        found = [packing(run, ring_flow(run, law).solve(), **dense.values) for run in cell]
        radius = [(one.outer_radius - one.outer_radius_dem) / run.scene.mean_diameter for one, run in zip(found, cell, strict=True)]
        words = f"{name:12} {told([one.rms for one in found], 4)} R_o {told(radius, 2)}"
        for angle in ("stress", "fabric"):
            words += f" {angle} {told([near_angle(run.profiles, f'rate_to_{angle}_angle')[0] for run in cell], 1)}"
        print(words)


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
        print(f"\n{title}\n{'':12} " + " ".join(f"{rival:>18}" for rival in RIVALS) + f"{'grains':>19}")
        for cell, found in tables.items():
            row = " ".join(told(values, digits) for values in over_seeds(found, name))
            grains = {"l2": "l2_noise", "stress_ratio_wall": "stress_ratio_wall_dem"}.get(name)
            print(f"{cell:12} {row} " + (told(np.array([float(table[grains]) for table in found]), digits) if grains else ""))
    print("\nif the parameters were fitted on each cell itself:")
    for name in runs:
        own_fits(name, runs[name], mu_s, b)
    print_structure(runs, parameters.laws()["nonlocal"], shear["shear/steady"])
    if figure is not None:
        plots.predictions_figure({name: found[0] for name, found in tables.items()}).savefig(figure, dpi=150)
    return parameters, {name: tables[name] for name in predicted}


if __name__ == "__main__":
    main(*sys.argv[1:3])
