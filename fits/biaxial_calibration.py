"""A whole law from biaxial runs: `python fits/biaxial_calibration.py LAW biaxial.h5 ...` (made by data_generation/biaxial.py)."""

import sys
import tomllib

import anisogran as ag


def curve(path):
    """sigma_zz and eps_V of a run up to its peak, under its constant side pressure."""
    run = ag.open(path, holds="series")
    series = run["series"].to_dataset()
    used = series.isel(time=slice(int(series.s_D.values.argmax()) + 1))
    control = ag.models.biaxial(used.eps_zz.values, tomllib.loads(run.attrs["scene"])["pressure"])
    return ag.fit.Curve(control, {name: used[name].values for name in ("sigma_zz", "eps_V")}, label=path)


def main(law, *paths):
    """Print and return the fit of the law to all runs at once."""
    fit = ag.fit.calibrate(law, [curve(path) for path in paths])
    print(fit)
    return fit


if __name__ == "__main__":
    main(*sys.argv[1:]) if len(sys.argv) > 2 else sys.exit(__doc__)
