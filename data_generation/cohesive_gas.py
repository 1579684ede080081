"""A free gas that clusters, over adhesion kc/k2 and seed: attraction + dissipation = agglomeration; without attraction no cluster lasts.

    python data_generation/cohesive_gas.py cohesive_gas.h5 [--quick]

8 runs of 300 grains, a minute on two cores; it can be stopped and goes on. The scene is cohesive_gas.toml. --quick makes a rough
version in seconds. Read by fits/cohesive_gas.py.
"""

import argparse
from pathlib import Path

from anisogran import read_scene, study

SCENE = Path(__file__).with_name("cohesive_gas.toml")
ADHESION = [0.0, 1e5, 2e5, 4e5]  # kc in N/m: 0, 1, 2, 4 times k2
SEEDS = range(1, 3)
SERIES = ["time", "kinetic_energy", "elastic_energy", "fragments", "largest_fragment", "mean_fragment_mass", "coordination_number"]


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args(arguments)
    if options.quick:
        scene, vary = read_scene(SCENE, quick=True), {"contact.kc": [0.0, 4e5], "seed": [1]}
    else:
        scene, vary = read_scene(SCENE, ["n=300"]), {"contact.kc": ADHESION, "seed": SEEDS}
    return study(options.file, {"gases": (scene, vary)}, SERIES)


if __name__ == "__main__":
    main()
