"""The slides "Cohesion - no friction": biaxial tests over adhesion kc/k2, side pressure and seed, all pressed by one pressure before.

    python data_generation/biaxial_cohesion.py biaxial_cohesion.h5 [--quick]

108 tests, about 30 minutes on two cores; it can be stopped and goes on. Also, at kc = k2, what that first pressure does. The scene is
biaxial_cohesion.toml. --quick makes a rough version in seconds. Read by fits/cohesion.py.
"""

import argparse
from pathlib import Path

from anisogran import read_scene, study

SCENE = Path(__file__).with_name("biaxial_cohesion.toml")
DURATION = {100: 0.5, 300: 0.25, 500: 0.25}  # N/m: s of loading, such that slower changes the peaks by less than seeds do
ADHESION = [0.0, 5e4, 1e5, 2e5, 4e5]  # kc in N/m: 0, 1/2, 1, 2, 4 times k2
SEEDS = range(1, 7)
FIRST_PRESSURE = [None, 600.0, 1000.0]  # N/m; None presses each sample by the pressure of its test
FEWER_SEEDS = range(1, 4)
SERIES = [
    "eps_zz", "eps_xx", "sigma_zz", "sigma_xx", "s_D", "anisotropy", "fabric_trace", "area_fraction", "coordination_number",
]  # fmt: skip


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args(arguments)
    if options.quick:
        scenes = {f"p{p}": read_scene(SCENE, [f"pressure={p}", "n=300"], quick=True) for p in (100, 500)}
        sweeps = {name: (scene, {"contact.kc": [0.0, 1e5], "seed": [1]}) for name, scene in scenes.items()}
    else:
        scenes = {f"p{p}": read_scene(SCENE, [f"pressure={p}", f"duration={s}"]) for p, s in DURATION.items()}
        sweeps = {name: (scene, {"contact.kc": ADHESION, "seed": SEEDS}) for name, scene in scenes.items()}
        for name in ("p100", "p500"):
            sweeps[f"{name}-pressed"] = scenes[name], {"overconsolidation": FIRST_PRESSURE, "seed": FEWER_SEEDS}
    return study(options.file, sweeps, SERIES)


if __name__ == "__main__":
    main()
