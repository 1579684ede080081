"""Loose and dense samples in the biaxial box: the data of beta_s(density, p, mu).

    python data_generation/biaxial_density.py biaxial_density.h5 [--quick]

Samples are pressed with friction, the more the looser; those that are pressed without it are in biaxial_friction.h5. 16 tests, about 8
minutes on two cores; it can be stopped and goes on. The scene is biaxial.toml. --quick makes a rough version in seconds. Read by
fits/evolution.py.
"""

import argparse
from pathlib import Path

from anisogran import read_scene, study

SCENE = Path(__file__).with_name("biaxial.toml")
DURATION = {100: 0.5, 500: 0.25}  # N/m: s of loading
FRICTION = [0.5]
PRESSING = [0.1, 0.5]  # friction while the sample is pressed
SEEDS = range(1, 5)
SERIES = [
    "eps_zz", "eps_xx", "sigma_zz", "sigma_xx", "s_D", "anisotropy", "fabric_trace", "area_fraction", "coordination_number",
]  # fmt: skip


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args(arguments)
    if options.quick:
        scene = read_scene(SCENE, quick=True)
        return study(options.file, {"p100": (scene, {"friction.mu": [0.5], "pressing_friction": [0.1, 0.5], "seed": [1]})}, SERIES)
    scenes = {p: read_scene(SCENE, [f"pressure={p}", f"duration={s}"]) for p, s in DURATION.items()}
    vary = {"friction.mu": FRICTION, "pressing_friction": PRESSING, "seed": SEEDS}
    return study(options.file, {f"p{p}": (scene, vary) for p, scene in scenes.items()}, SERIES)


if __name__ == "__main__":
    main()
