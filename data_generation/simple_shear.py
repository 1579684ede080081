"""Simple shear from an isotropic start to the critical state, over friction and inertial number.

    python data_generation/simple_shear.py simple_shear.h5 [--quick]

Stress, fabric and volume against strain in a periodic cell, where nothing is a wall. 32 tests, some minutes on two cores; it can be
stopped and goes on. The scene is simple_shear.toml. --quick makes a rough version in seconds. Read by fits/evolution.py.
"""

import argparse
from pathlib import Path

from anisogran import read_scene, study

SCENE = Path(__file__).with_name("simple_shear.toml")
FRICTION = [0.0, 0.2, 0.44, 1.0]
INERTIAL = [1e-3, 1e-2]
SEEDS = range(1, 5)
SERIES = ["strain", "s_D", "stress_ratio", "anisotropy", "area_fraction", "coordination_number", "sigma_yy", "pressure"]


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args(arguments)
    scene = read_scene(SCENE, quick=True) if options.quick else read_scene(SCENE, ["strain=1", "discard=0.5", "samples_per_strain=400"])
    vary = {"friction.mu": FRICTION, "inertial_number": INERTIAL, "seed": SEEDS}
    if options.quick:
        vary = {"friction.mu": [0.0, 0.44], "inertial_number": [0.05], "seed": [1]}
    return study(options.file, {"shear": (scene, vary)}, SERIES)


if __name__ == "__main__":
    main()
