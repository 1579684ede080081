"""How fast stress and fabric follow the strain at different pressures: the data of beta_s(p) and beta_F(p).

    python data_generation/biaxial_pressure.py biaxial_pressure.h5 [--quick]

Biaxial tests with friction over side pressure and seed, all at the same inertial number; the pressures 100 and 500 N/m are in
biaxial_friction.h5. 12 tests, about 5 minutes on two cores; it can be stopped and goes on. The scene is biaxial.toml. --quick makes a rough
version in seconds. Read by fits/evolution.py.
"""

import argparse
import math
from pathlib import Path

from anisogran import read_scene, study

SCENE = Path(__file__).with_name("biaxial.toml")
PRESSURE = 200, 1000  # N/m; at 1000 overlaps are 7 % of the radius, and at 2000 the runs stop: grains are too soft for that
DURATION = 0.5  # s at 100 N/m
SEEDS = range(1, 7)
SERIES = [
    "eps_zz", "eps_xx", "sigma_zz", "sigma_xx", "s_D", "anisotropy", "fabric_trace", "area_fraction", "coordination_number",
]  # fmt: skip


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args(arguments)
    if options.quick:
        scenes = {p: read_scene(SCENE, [f"pressure={p}"], quick=True) for p in (100, 1000)}
        return study(options.file, {f"p{p}": (scene, {"seed": [1]}) for p, scene in scenes.items()}, SERIES)
    durations = {p: DURATION * math.sqrt(100 / p) for p in PRESSURE}
    scenes = {p: read_scene(SCENE, [f"pressure={p}", f"duration={s:.3g}"]) for p, s in durations.items()}
    return study(options.file, {f"p{p}": (scene, {"seed": SEEDS}) for p, scene in scenes.items()}, SERIES)


if __name__ == "__main__":
    main()
