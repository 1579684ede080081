"""Rotations in the ring shear cell: whether the stress is symmetric, and whether the grains' eigen-rotation has a length.

    python fits/ring_rotations.py [FILE [FIGURE.png]]

FILE (fits/data/ring_reference.h5 if none is named) is a study of ring cells, which data_generation/ makes, or the results of one run. If
sigma_rphi = sigma_phir within its error, no couple stress acts on the flow. The length is that of l^2 lap omega = 2 (omega - W).
"""

import sys
from pathlib import Path

import anisogran as ag
from anisogran import plots
from anisogran.comparison import asymmetry, measured, spin_length, study_runs
from anisogran.glossary import label

DATA = Path(__file__).parent / "data" / "ring_reference.h5"


def cells(path):
    """{name: Measured} of a run, or of every run of a study."""
    results = ag.open(path)
    if "series" in results.children:
        return {Path(path).stem: measured(results, "ring_rotations")}
    return {f"{group}, {case}": run for group in results.children for case, run in study_runs(results, group).items()}


def main(path=DATA, figure=None):
    """Print the table, save the profiles of the first run of each cell if a file is named; return {name: (Asymmetry, FitResult)}."""
    found, shown = {}, {}
    print(f"{'run':22} {'asymmetry / shear stress':>26} {'largest':>9}   length of the eigen-rotation [m]")
    for name, run in cells(path).items():
        stress, fit = asymmetry(run), spin_length(run)
        found[name] = stress, fit
        length = f"{fit.values['length']:.3g} +- {fit.errors['length']:.2g}" if fit.verdict else f"not determined: {fit.verdict.reasons[0]}"
        print(f"{name:22} {stress.share:26.1e} {stress.largest:6.1f} se   {length}")
        shown.setdefault(name.partition(",")[0], (run, stress, fit))
    if figure is not None:
        save(shown, figure)
    return found


def save(shown, figure):
    """Draws asymmetry and eigen-rotation over the depth, one run of each cell."""
    differences, rotations, fitted = {}, {}, {}
    for name, (run, stress, fit) in shown.items():
        profiles, speed = run.profiles, run.scene.wall_speed / run.scene.inner_radius
        depth = profiles.depth.values
        differences[name] = depth, stress.difference / stress.shear_stress, stress.error / stress.shear_stress
        rotations[name] = depth, profiles.eigen_rotation.values / speed, profiles.eigen_rotation_error.values / speed
        fitted[name] = depth, fit.predict(profiles.r.values) / speed
    plots.panels_figure(
        [
            plots.Panel(label("depth"), r"$(\sigma_{r\phi} - \sigma_{\phi r})/\sigma_{r\phi}$", {}, differences, from_zero=False),
            plots.Panel(label("depth"), r"$\omega^*$ / spin of the ring", {}, rotations, fitted, "dashed: couple stress", from_zero=False),
        ]
    ).savefig(figure, dpi=150)


if __name__ == "__main__":
    main(*sys.argv[1:])
