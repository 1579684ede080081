"""The slide "compression-tension": strengths of tablets over adhesion kc/k2, pressing pressure and seed, crushed and torn.

    python data_generation/tablet_strength.py tablet_strength.h5 [--quick]

48 tests of 200 grains, about 5 minutes on two cores; it can be stopped and goes on. The scene is tablet.toml. --quick makes a rough
version in seconds. Read by fits/tablet_strength.py.
"""

import argparse
from pathlib import Path

from anisogran import read_scene, study

SCENE = Path(__file__).with_name("tablet.toml")
SIZE = ["n=200", "pressure=5", "strain=0.01", "duration=0.06", "samples=200"]
TESTS = ["compression", "tension"]
ADHESION = [5e4, 1e5, 2e5, 4e5]  # kc in N/m: 1/2, 1, 2, 4 times k2
PRESSING_PRESSURES = [50.0, 100.0, 200.0]  # N/m
SEEDS = range(1, 3)
SERIES = ["time", "eps_zz", "sigma_zz", "fragments", "largest_fragment", "coordination_number"]


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args(arguments)
    if options.quick:
        scene, vary = read_scene(SCENE, ["n=60"], quick=True), {"contact.kc": [5e4, 4e5], "pressing_pressure": [50.0, 200.0], "seed": [2]}
    else:
        scene, vary = read_scene(SCENE, SIZE), {"contact.kc": ADHESION, "pressing_pressure": PRESSING_PRESSURES, "seed": SEEDS}
    return study(options.file, {"tablets": (scene, {"test": TESTS, **vary})}, SERIES)


if __name__ == "__main__":
    main()
