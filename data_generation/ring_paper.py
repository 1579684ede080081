"""The ring shear cell in paper quality: 3100 grains around an inner ring of 14 mean diameters, far enough for the tail of the flow.

    python data_generation/ring_paper.py ring_paper.h5 [--quick]

The cell of ring_reference.py, only larger: the gap is 20 mean diameters. The wall travels 200 of them; the first 100 are not averaged,
since the tail settles late. Two runs of some five minutes on one core; it can be stopped and goes on. The last snapshot of each is kept
for pictures. --quick makes a rough version in seconds.
"""

import argparse

from anisogran import RingShear, study

CELL = {"n": 3100, "inner_radius": 14.0, "travel": 200.0, "discard": 100.0, "samples_per_diameter": 20, "frames": 0}
SEEDS = range(1, 3)
SERIES = [
    "turns", "wall_shear_stress", "wall_pressure", "outer_radius", "outer_pressure", "outer_shear_stress", "kinetic_energy",
]  # fmt: skip
BESIDE = ["profiles", "blocks", "circles", "layers"]


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("--workers", type=int)
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args(arguments)
    sweeps = {"paper": (RingShear(**CELL), {"seed": SEEDS})}
    if options.quick:
        sweeps = {"paper": (RingShear(**RingShear.quick | {"frames": 0, "travel": 6.0}), {"seed": [1]})}
    return study(options.file, sweeps, SERIES, workers=options.workers, beside=BESIDE, snapshots=["end"])


if __name__ == "__main__":
    main()
