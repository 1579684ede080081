"""Homogeneous simple shear over inertial numbers: the data of the friction law mu(I) and of the area fraction against I.

    python data_generation/friction_law.py friction_law.h5 [--quick]

Takes some minutes on one core; --quick makes a rough version in seconds. Read by fits/friction_law.py.
"""

import argparse

import numpy as np
import xarray as xr

from anisogran import SimpleShear
from anisogran.experiments.simple_shear import steady_state
from anisogran.files import check_writable, save_results

INERTIAL_NUMBERS = np.geomspace(1e-3, 0.15, 16)
GRAINS = 1000
STRAIN = 8.0
SEEDS = (1, 2)


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args(arguments)
    check_writable(options.file)
    numbers, grains, strain, seeds = INERTIAL_NUMBERS, GRAINS, STRAIN, SEEDS
    if options.quick:
        numbers, grains, strain, seeds = np.geomspace(0.02, 0.15, 10), 100, 3.0, (1,)
    states = []
    for seed in seeds:
        for inertial in numbers:
            run = SimpleShear(inertial_number=float(inertial), n=grains, strain=strain, seed=seed).run()
            run.status.require()
            state = steady_state(run)
            mu, error = float(state.stress_ratio), float(state.stress_ratio_error)
            print(f"seed {seed}  I = {inertial:.4g}  mu = {mu:.4f} +- {error:.4f}  {run.status}")
            states.append(state.assign(seed=seed))
    save_results(options.file, {"steady": xr.concat(states, "test")}, run.provenance)


if __name__ == "__main__":
    main()
