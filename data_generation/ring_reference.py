"""The reference ring shear cell and its variations: wall speed, inner radius, stiffness, start density; some runs with each.

    python data_generation/ring_reference.py ring_reference.h5 [--quick]

"reference" is RingShear by default, only longer. In the other groups one thing differs: "slow" and "fast" the wall speed, "inner_4" and
"inner_6" the inner radius in mean diameters with the gap kept, "soft" and "stiff" the stiffness over the pressure with k_t = k_n/2 and the
same restitution, "loose" the start, pressed with friction. Of each: series, profiles with errors and their blocks, stress on circles, thin
layers. 15 runs, about half an hour on one core; it can be stopped and goes on. --quick makes a rough version in seconds.
"""

import argparse
import math

from anisogran import Friction, Linear, RingShear, study

TRAVEL = {"travel": 160.0, "discard": 40.0, "samples_per_diameter": 20, "frames": 0}
SEEDS = {"reference": [1, 2, 3], "stiff": [1], "slow": [1]}  # the others have two
SERIES = [
    "turns", "wall_shear_stress", "wall_pressure", "outer_radius", "outer_pressure", "outer_shear_stress", "kinetic_energy",
]  # fmt: skip
BESIDE = ["profiles", "blocks", "circles", "layers"]


def stiffness(ratio):
    """Contact and friction of that stiffness over the pressure of 1 N/m."""
    damping = 4.0 * math.sqrt(ratio / 1000.0)
    return {"contact": Linear(stiffness=ratio, damping=damping), "friction": Friction(stiffness=0.5 * ratio, mu=0.44)}


SHORTER = {"travel": 100.0}  # what takes more steps to the diameter
CELLS = {
    "reference": {},
    "fast": {"wall_speed": 0.16},
    "inner_4": {"inner_radius": 4.0, "n": 460},
    "inner_6": {"inner_radius": 6.0, "n": 570},
    "loose": {"pressing_friction": 0.44},
    "soft": stiffness(250.0),
    "stiff": stiffness(4000.0) | SHORTER,
    "slow": {"wall_speed": 0.01} | SHORTER,
}


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("--workers", type=int)
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args(arguments)
    sweeps = {name: (RingShear(**TRAVEL | changes), {"seed": SEEDS.get(name, [1, 2])}) for name, changes in CELLS.items()}
    if options.quick:
        small = RingShear.quick | {"frames": 0, "travel": 6.0}
        sweeps = {name: (RingShear(**small | CELLS[name]), {"seed": [1]}) for name in ("reference", "fast", "loose")}
    return study(options.file, sweeps, SERIES, workers=options.workers, beside=BESIDE)


if __name__ == "__main__":
    main()
