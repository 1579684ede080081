"""The slides "Friction - no cohesion": biaxial tests over the contact friction mu, side pressure and seed.

    python data_generation/biaxial_friction.py biaxial_friction.h5 [--quick]

90 tests, about 30 minutes on two cores; it can be stopped and goes on. Each sample of biaxial.toml is pressed without friction by
the pressure of its test. "drag" adds, at mu = 0, a background damping of the grains to the loading, to see what that does to the peaks.
--quick makes a rough version in seconds. Read by fits/friction_angle.py and fits/evolution.py.
"""

import argparse
from pathlib import Path

from anisogran import read_scene, study

SCENE = Path(__file__).with_name("biaxial.toml")
DURATION = {100: 0.5, 500: 0.25}  # N/m: s of loading
FRICTION = [0.0, 0.1, 0.2, 0.3, 0.5, 1.0]
SEEDS = range(1, 7)
DRAG = [0.01, 0.02, 0.1]  # kg/s
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
        sweeps = {name: (scene, {"friction.mu": [0.0, 0.5], "seed": [1]}) for name, scene in scenes.items()}
    else:
        scenes = {f"p{p}": read_scene(SCENE, [f"pressure={p}", f"duration={s}"]) for p, s in DURATION.items()}
        sweeps = {name: (scene, {"friction.mu": FRICTION, "seed": SEEDS}) for name, scene in scenes.items()}
        for p, s in DURATION.items():
            smooth = read_scene(SCENE, [f"pressure={p}", f"duration={s}", "friction=none"])
            sweeps[f"p{p}-drag"] = smooth, {"drag": DRAG, "seed": FEWER_SEEDS}
    return study(options.file, sweeps, SERIES)


if __name__ == "__main__":
    main()
