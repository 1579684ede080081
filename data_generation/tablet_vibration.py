"""The slide "Vibration test": tablets pressed at p = 10 and 100 N/m on a floor that shakes; do they hold together?

    python data_generation/tablet_vibration.py tablet_vibration.h5 [--quick]

6 tests of 200 grains and ten periods of 50 Hz, a minute on two cores; it can be stopped and goes on. The scene is tablet.toml.
--quick makes a rough version in seconds. Read by fits/tablet_vibration.py.
"""

import argparse
from pathlib import Path

from anisogran import read_scene, study

SCENE = Path(__file__).with_name("tablet.toml")
SIZE = ["test=vibration", "n=200", "duration=0.2"]
PRESSING_PRESSURES = [10.0, 100.0]  # N/m
SEEDS = range(1, 4)
SERIES = ["time", "floor_height", "fragments", "largest_fragment", "mean_fragment_mass", "width", "kinetic_energy", "coordination_number"]


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args(arguments)
    scene, seeds = read_scene(SCENE, SIZE), SEEDS
    if options.quick:
        quick = ["test=vibration", "n=60", "pressure=2", "duration=0.06"]
        scene, seeds = read_scene(SCENE, quick, quick=True), [2]
    vary = {"pressing_pressure": PRESSING_PRESSURES, "seed": seeds}
    return study(options.file, {"tablets": (scene, vary)}, SERIES)


if __name__ == "__main__":
    main()
