"""The lecture's biaxial box with friction, N = 1950: stress, volume and fabric against strain.

    python data_generation/biaxial.py biaxial.h5 [--quick]

Takes some minutes on one core; --quick makes a rough version in seconds. Read by fits/biaxial_evolution.py.
"""

import argparse

import anisogran as ag
from anisogran.files import check_writable

SCENE = {
    "pressure": 100.0,
    "contact": ag.Luding(k1=5e4, k2=1e5, kc=0.0, damping=0.1),
    "friction": ag.Friction(stiffness=2e4, mu=0.5),
    "grains": 1950,
    "strain": 0.12,
    "duration": 1.0,
    "samples": 300,
    "seed": 1,
}
QUICK = {"grains": 150, "strain": 0.06, "duration": 0.02, "samples": 100}


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args(arguments)
    check_writable(options.file)
    run = ag.Biaxial(**(SCENE | QUICK if options.quick else SCENE)).run()
    print(f"peak s_D = {float(run.series.s_D.max()):.3f}; {run.status}")
    run.save(options.file)


if __name__ == "__main__":
    main()
