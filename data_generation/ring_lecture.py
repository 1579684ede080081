"""The lecture's ring shear cell at constant volume over three turns, and beside it a cell with smooth rings.

    python data_generation/ring_lecture.py ring_lecture.h5 [--quick]

"lecture" is RingShearVolume as it is by default: pressure against turns in the series, profiles of the last two turns, snapshots before
the first turn and after the third. Its density is not steady, and with it the pressure; `relative_stress` in the profiles is over the
pressure on the inner ring in the same quarter of a turn. "smooth" is the cell of ring_reference.py with small touching discs on both
rings, at which grains roll in layers. Three runs, about ten minutes on one core; it can be stopped and goes on. --quick makes a rough
version in seconds.
"""

import argparse

from anisogran import RingShear, RingShearVolume, study

LECTURE = {"samples_per_diameter": 20, "frames": 0}
SMOOTH = {"wall_disc": 0.25, "wall_spacing": 0.25, "travel": 140.0, "discard": 40.0, "samples_per_diameter": 20, "frames": 0}
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
    sweeps = {
        "smooth": (RingShear(**SMOOTH), {"seed": [1, 2]}),
        "lecture": (RingShearVolume(**LECTURE), {"seed": [1]}),
    }
    if options.quick:
        sweeps = {
            "smooth": (RingShear(**SMOOTH | RingShear.quick | {"travel": 6.0}), {"seed": [1]}),
            "lecture": (RingShearVolume(**LECTURE | RingShearVolume.quick | {"travel": 8.0, "block": 1.0}), {"seed": [1]}),
        }
    return study(options.file, sweeps, SERIES, workers=options.workers, beside=BESIDE, snapshots=["start", "end"])


if __name__ == "__main__":
    main()
