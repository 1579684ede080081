"""Load reversal and isobaric cycles in the biaxial box: what the scalar model says of unloading, and ratcheting.

    python data_generation/biaxial_cycles.py biaxial_cycles.h5 [--quick]

One loading to 2 % and back, and ten cycles of 0.4 %, at constant side pressure, with friction; 12 tests, about 4 minutes on two cores;
it can be stopped and goes on. The scene is biaxial.toml. --quick makes a rough version in seconds. Read by fits/cycles.py.
"""

import argparse
from pathlib import Path

from anisogran import read_scene, study

SCENE = Path(__file__).with_name("biaxial.toml")
REVERSAL = ["strain=0.02", "duration=0.1", "half_periods=2"]
CYCLES = ["strain=0.004", "duration=0.02", "half_periods=20", "samples=40"]
SEEDS = range(1, 7)
SERIES = ["eps_zz", "eps_xx", "sigma_zz", "sigma_xx", "s_D", "anisotropy", "fabric_trace", "area_fraction"]


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args(arguments)
    changes = {"reversal": REVERSAL, "cycles": CYCLES}
    if options.quick:
        changes = {"reversal": ["strain=0.02", "half_periods=2"], "cycles": ["strain=0.005", "duration=0.005", "half_periods=6"]}
    sweeps = {
        name: (read_scene(SCENE, values, quick=options.quick), {"seed": [1] if options.quick else SEEDS})
        for name, values in changes.items()
    }
    return study(options.file, sweeps, SERIES)


if __name__ == "__main__":
    main()
