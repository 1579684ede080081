"""E, A, B, G from probes and from the fabric: along the path, against pressure, adhesion, and against the size of the probe.

    python data_generation/stiffness.py stiffness.h5 [--quick] [--n 300]

Six sweeps, which are kept in the folder stiffness.cases, so that a run that was stopped goes on; takes 400 core seconds with 300 grains,
and three times as long with 1000; --quick half a minute. Read by fits/stiffness.py.
"""

import argparse
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np

import anisogran as ag
from anisogran.files import check_writable, save_results, software

ROUGH = ag.Friction(2e4, 0.5, damping=0.05)
STICKY = ag.Luding(k1=5e4, k2=1e5, kc=0.0, damping=0.1)
STATES, STRAIN = 4, 0.1
ROUGH_PATH, SMOOTH_PATH = [100.0, 500.0], [100.0]  # N/m
PRESSURES = [50.0, 200.0, 1000.0]  # N/m, of isotropic states; the first ones on the paths are more of them
ADHESIONS = [0.0, 0.5e5, 1e5, 2e5, 4e5]  # N/m: kc/k2 = 0 .. 4
PROBES = [1e-7, 1e-6, 1e-5, 1e-4, 1e-3]
SEEDS = [1, 2, 3, 4, 5, 6]


def sweeps(n, quick):
    """{name: (scene, what is varied)}."""
    path = {"n": n, "states": STATES, "strain": STRAIN}
    rough, smooth, pressures, adhesions, sizes, seeds = ROUGH_PATH, SMOOTH_PATH, PRESSURES, ADHESIONS, PROBES, SEEDS
    if quick:
        path = {"n": 60, "states": 2, "strain": 0.02, "inertial_number": 1e-2}
        rough, pressures, adhesions, sizes, seeds = SMOOTH_PATH, PRESSURES[1:], ADHESIONS[::4], PROBES[2:4], SEEDS[:2]
    first, short = {**path, "states": 1}, {**path, "n": max(50, path["n"] // 2), "states": 2, "strain": 0.02, "contact": STICKY}
    return {
        "rough_path": (ag.Stiffness(**path, friction=ROUGH), {"pressure": rough, "seed": seeds}),
        "smooth_path": (ag.Stiffness(**path), {"pressure": smooth, "seed": seeds}),
        "rough": (ag.Stiffness(**first, friction=ROUGH), {"pressure": pressures, "seed": seeds}),
        "smooth": (ag.Stiffness(**first), {"pressure": pressures, "seed": seeds}),
        "probe": (ag.Stiffness(**short, friction=ROUGH), {"probe": sizes, "seed": seeds[:2]}),
        "adhesion": (ag.Stiffness(**short), {"contact.kc": adhesions, "seed": seeds}),
    }


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--n", type=int, default=300, help="grains of a run; half as many with adhesion and where the probe varies")
    options = parser.parse_args(arguments)
    check_writable(options.file)
    cases, groups, attributes = Path(options.file).with_suffix(".cases"), {}, {}
    cases.mkdir(exist_ok=True)
    # quick runs are shorter than the start of a process
    executor = ThreadPoolExecutor(1) if options.quick else ProcessPoolExecutor(mp_context=get_context("spawn"))
    for name, (scene, vary) in sweeps(options.n, options.quick).items():
        states = ag.sweep(scene, vary, cases / name, executor=executor)
        collected = ag.collect_sweep(cases / name)
        groups[name] = collected["moduli"].to_dataset()
        attributes |= {f"{key}_{name}": collected.attrs[key] for key in ("scene", "vary")}
        work = collected["cases"].to_dataset()
        print(f"{name}: {len(states)} runs, {float(work.seconds.sum()):.0f} s; {'; '.join(np.unique(work.message.values))}")
    save_results(options.file, groups, {**software(), **attributes})


if __name__ == "__main__":
    main()
