"""Exponential evolution of stress ratio and anisotropy: `python fits/biaxial_evolution.py biaxial.h5` (made by data_generation)."""

import sys

import anisogran as ag


def main(path):
    """Print and return the fits of s_D and of the anisotropy over the half/half eps_D."""
    series = ag.open(path, holds="series")["series"].to_dataset()
    fits = {name: ag.fit.relaxation(series.eps_D.values, series[name].values) for name in ("s_D", "anisotropy")}
    for name, fit in fits.items():
        print(f"{name}: {fit}")
    return fits


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) == 2 else sys.exit(__doc__))
