"""E, A, B, G from probes and from the fabric: along the path, against pressure, adhesion, and against the size of the probe.

    python data_generation/stiffness.py stiffness.h5 [--quick]

Six sweeps, which are kept in the folder stiffness.cases, so that a run that was stopped goes on; takes 1000 core seconds; --quick half
a minute. Read by fits/stiffness.py.
"""

import argparse
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

import anisogran as ag
from anisogran.files import check_writable, save_results, software

ROUGH = ag.Friction(2e4, 0.5, damping=0.05)
STICKY = ag.Luding(k1=5e4, k2=1e5, kc=0.0, damping=0.1)
PATH, PRESSURES = [100.0, 500.0], [50.0, 200.0, 1000.0]  # N/m; the first states on the paths are isotropic ones too
ADHESIONS = [0.0, 0.5e5, 1e5, 2e5, 4e5]  # N/m: kc/k2 = 0 .. 4
PROBES = [1e-7, 1e-6, 1e-5, 1e-4, 1e-3]
SEEDS = range(1, 7)


def sweeps(quick):
    """{name: (scene, what is varied)}."""
    n, few, path, pressures, adhesions, probes, seeds = 600, 400, PATH, PRESSURES, ADHESIONS, PROBES, list(SEEDS)
    states, hurry = 5, {}
    if quick:
        n, few, path, pressures, adhesions, probes, seeds = 60, 60, [100.0], [200.0, 500.0], [0.0, 4e5], probes[2:4], [1, 2]
        states, hurry = 2, {"inertial_number": 1e-2, "strain": 0.02}
    one_state = {"n": n, "states": 1, **hurry}
    return {
        "smooth_path": (ag.Stiffness(n=n, states=states, **hurry), {"pressure": path, "seed": seeds}),
        "rough_path": (ag.Stiffness(n=n, states=states, friction=ROUGH, **hurry), {"pressure": path, "seed": seeds}),
        "smooth": (ag.Stiffness(**one_state), {"pressure": pressures, "seed": seeds}),
        "rough": (ag.Stiffness(**one_state, friction=ROUGH), {"pressure": pressures, "seed": seeds}),
        "adhesion": (ag.Stiffness(n=few, states=2, contact=STICKY, **{"strain": 0.03, **hurry}), {"contact.kc": adhesions, "seed": seeds}),
        "probe": (
            ag.Stiffness(n=few, states=2, contact=STICKY, friction=ROUGH, **{**hurry, "strain": 0.02}),
            {"probe": probes, "seed": seeds[:2]},
        ),
    }  # fmt: skip


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args(arguments)
    check_writable(options.file)
    cases, groups, attributes = Path(options.file).with_suffix(".cases"), {}, {}
    cases.mkdir(exist_ok=True)
    executor = ThreadPoolExecutor(1) if options.quick else None  # processes take longer to start than quick runs
    for name, (scene, vary) in sweeps(options.quick).items():
        states = ag.sweep(scene, vary, cases / name, executor=executor)
        collected = ag.collect_sweep(cases / name)
        groups[name] = collected["moduli"].to_dataset()
        attributes |= {f"{key}_{name}": collected.attrs[key] for key in ("scene", "vary")}
        work = collected["cases"].to_dataset()
        print(f"{name}: {len(states)} runs, {float(work.seconds.sum()):.0f} s; {'; '.join(np.unique(work.message.values))}")
    save_results(options.file, groups, {**software(), **attributes})


if __name__ == "__main__":
    main()
