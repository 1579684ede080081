"""Homogeneous simple shear of the grains of the ring shear cell, over inertial numbers: friction law, area fraction, angles.

    python data_generation/ring_friction_law.py ring_friction_law.h5 [--quick]

The same contacts, friction, sizes and pressure as in ring_reference.py, in a periodic cell where nothing is a wall: the only source of
mu_s and b for the continuum of the ring. 27 tests, about ten minutes on one core; it can be stopped and goes on. "shear/steady" holds the
steady states with their errors: stress_ratio, area_fraction, inertial_number, angles. --quick makes a rough version in seconds. Read by
fits/friction_law.py.
"""

import argparse

import numpy as np

from anisogran import RingShear, SimpleShear, study

INERTIAL_NUMBERS = [float(f"{inertial:.3g}") for inertial in np.geomspace(1e-3, 0.1, 9)]
SEEDS = range(1, 4)
SIZE = {"n": 700, "strain": 7.0, "discard": 1.5, "frames": 0}
QUICK = {"n": 100, "strain": 3.0, "discard": 1.5, "frames": 0}
GRAINS = ("pressure", "contact", "friction", "mean_diameter", "size_ratio", "density")
SERIES = ["strain", "stress_ratio", "s_D", "area_fraction", "inertial_number", "sigma_yy"]


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("--workers", type=int)
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args(arguments)
    ring, size = RingShear(), QUICK if options.quick else SIZE
    scene = SimpleShear(**{key: getattr(ring, key) for key in GRAINS}, **size)
    vary = {"inertial_number": INERTIAL_NUMBERS, "seed": SEEDS}
    if options.quick:
        vary = {"inertial_number": [0.02, 0.025, 0.03, 0.04, 0.05, 0.06, 0.08, 0.1, 0.12, 0.15], "seed": [1]}
    return study(options.file, {"shear": (scene, vary)}, SERIES, workers=options.workers, beside=["steady"])


if __name__ == "__main__":
    main()
