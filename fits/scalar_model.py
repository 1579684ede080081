"""The scalar model on top of the grains, also at pressures that were not fitted: `python fits/scalar_model.py [FOLDER [FIGURE.png]]`.

Slide "Constitutive model - scalar". E, B, s_max, A_max and beta_F are fitted to the mean curves of sigma_zz and eps_V over seeds at p = 100
and 500 N/m (mu = 0.5, biaxial_friction.h5), each pressure by itself, up to a strain of 7/beta_s: about the peak, and far enough to see the
sample dilate. At other pressures E, B, A_max and beta_F are powers of p through these two, and s_max is their mean; so the model is run at
the pressures of biaxial_pressure.h5, which it has not seen. The folder is fits/data/ if none is named.
"""

import sys
from pathlib import Path

import numpy as np

import anisogran as ag
from anisogran import plots

DATA = Path(__file__).parent / "data"
FITTED = 100, 500  # N/m
MU = 0.5
FOLLOWED = "sigma_zz", "eps_V"
STRAINS = 7  # in units of 1/beta_s: the law has no softening, but dilation tells its A
RATES_END = 0.08  # the structure takes longer than the stress
POINTS = 80


def mean_curves(series, end):
    """(eps_zz, {name: (mean, standard deviation over seeds)}) of what is followed, s_D and the anisotropy on an even grid."""
    grid = np.linspace(0.0, min(end, float(series.eps_zz.max())), POINTS)
    series = series.assign(eps_V=0.5 * (series.eps_zz + series.eps_xx)).transpose("seed", "sample")
    found = {}
    for name in (*FOLLOWED, "s_D", "anisotropy"):
        rows = np.array([np.interp(grid, *pair) for pair in zip(series.eps_zz.values, series[name].values, strict=True)])
        found[name] = rows.mean(axis=0), rows.std(axis=0, ddof=1) if len(rows) > 1 else np.full(len(grid), 0.02 * np.ptp(rows))
    return grid, found


def rates(series):
    """(beta_s, beta_F) of the mean s_D and anisotropy over seeds, as fits/evolution.py has them."""
    grid, found = mean_curves(series, RATES_END)
    eps_D = grid - found["eps_V"][0]
    return tuple(ag.fit.relaxation(eps_D, found[name][0]).values["beta"] for name in ("s_D", "anisotropy"))


def curve(p, series):
    """What is fitted at a pressure: a point counts by the typical scatter of its column from seed to seed."""
    grid, found = mean_curves(series, STRAINS / rates(series)[0])
    errors = {name: float(np.sqrt(np.mean(found[name][1] ** 2))) for name in FOLLOWED}
    observed = {name: found[name][0] for name in FOLLOWED}
    start = {"sigma_xx": float(p), "sigma_zz": float(observed["sigma_zz"][0])}
    observed["eps_V"] = observed["eps_V"] - observed["eps_V"][0]
    return ag.fit.Curve(ag.models.biaxial(grid, float(p)), observed, start=start, errors=errors, label=f"p = {p} N/m")


def between(p, fits):
    """Parameters at a pressure: powers of p through the fitted ones, s_max their mean."""
    low, high = (fits[q].parameters() for q in FITTED)
    share = np.log(p / FITTED[0]) / np.log(FITTED[1] / FITTED[0])
    power = {name: low[name] * (high[name] / low[name]) ** share for name in ("E", "B", "A_max", "beta_F")}
    return {**power, "s_max": 0.5 * (low["s_max"] + high["s_max"])}


def main(folder=DATA, figure=None):
    """Print parameters and misfits, save the curves if a file is named; return ({p: LawFit}, {unseen p: {column: relative rms}})."""
    friction = ag.open(Path(folder) / "biaxial_friction.h5", holds="p100/series")
    seen = {p: friction[f"p{p}/series"].to_dataset().sel(friction_mu=MU) for p in FITTED}
    curves = {p: curve(p, series) for p, series in seen.items()}
    fits = {p: ag.fit.calibrate("scalar", [one]) for p, one in curves.items()}
    for p, fit in fits.items():
        beta_s, beta_F = rates(seen[p])
        print(
            f"p = {p} N/m (beta_s = {beta_s:.0f}, beta_F = {beta_F:.0f} of the fabric): "
            + ", ".join(f"{name} = {value:.4g}" for name, value in fit.parameters().items())
        )
        print(f"  {'trustworthy' if fit.verdict else 'not trustworthy: ' + '; '.join(fit.verdict.reasons)}")
        print("\n".join(f"  {name}: {misfit}" for name, misfit in fit.columns[f"p = {p} N/m"].items()))
    tests = {p: fit.tests[f"p = {p} N/m"] for p, fit in fits.items()}
    unseen, path = {}, Path(folder) / "biaxial_pressure.h5"
    if path.exists():
        data = ag.open(path)
        for name in data.children:
            p = int(name[1:])
            one = curves[p] = curve(p, data[f"{name}/series"].to_dataset())
            tests[p] = ag.element_test("scalar", between(p, fits), one.control, one.start)
            unseen[p] = {name: misfit(tests[p], one, name) for name in one.observed}
            told = ", ".join(f"{name} off by {value:.1%} of its range (rms)" for name, value in unseen[p].items())
            print(f"p = {p} N/m, not fitted: {told}; {tests[p].status}")
    if figure is not None:
        draw(figure, curves, tests)
    return fits, unseen


def misfit(test, one, name):
    """Root mean square distance of the law from a column over the range of the column."""
    row = getattr(test, name)
    return float(np.sqrt(np.mean((row - one.observed[name][: len(row)]) ** 2)) / np.ptp(one.observed[name]))


def draw(figure, curves, tests):
    """Grains as lines, the law dashed."""
    order = sorted(curves)
    stress = {f"p = {p} N/m": (curves[p].control["eps_zz"], curves[p].observed["sigma_zz"] / p) for p in order}
    volume = {f"p = {p} N/m": (curves[p].control["eps_zz"], curves[p].observed["eps_V"]) for p in order}
    law = {f"p = {p} N/m": (tests[p].eps_zz, tests[p].sigma_zz / p) for p in order}
    law_volume = {f"p = {p} N/m": (tests[p].eps_zz, tests[p].eps_V) for p in order}
    strain = r"$\varepsilon_{zz}$"
    panels = [
        plots.Panel(strain, r"$\sigma_{zz}/p$", stress, dashed=law, title="grains (lines) and scalar model (dashed)"),
        plots.Panel(strain, r"$\varepsilon_V$ (half of the trace)", volume, dashed=law_volume),
    ]
    plots.panels_figure(panels).savefig(figure, dpi=150)


if __name__ == "__main__":
    main(*sys.argv[1:3])
