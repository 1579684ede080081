"""The lecture's biaxial box with friction, N = 1950: stress, volume and fabric against strain.

    python data_generation/biaxial.py biaxial.h5 [--quick]

The scene is biaxial.toml. Takes some minutes on one core; --quick makes a rough version in seconds. Read by fits/biaxial_evolution.py.
"""

import argparse
from pathlib import Path

from anisogran.experiments import read_scene
from anisogran.files import check_writable

SCENE = Path(__file__).with_name("biaxial.toml")


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args(arguments)
    check_writable(options.file)
    run = read_scene(SCENE, quick=options.quick).run()
    print(f"peak s_D = {float(run.series.s_D.max()):.3f}; {run.status}")
    run.save(options.file)


if __name__ == "__main__":
    main()
