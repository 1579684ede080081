"""What accuracy costs in time, for the time step of a contact and the mesh of the continuum ring: error beside seconds.

    python data_generation/accuracy_cost.py accuracy_cost.h5 [--quick]

The restitution error is the worst over phases of the first touch within a step, against the closed form; its seconds are those of the
time loop for 1,000 pairs. The flow is compared with itself on a mesh of 1,024 elements.
"""

import argparse
import math
import time
from dataclasses import replace

import numpy as np
import xarray as xr

import anisogran as ag
from anisogran.files import check_writable, save_results

STEPS_PER_COLLISION = (10, 20, 50, 100, 200)
ELEMENTS = (16, 32, 64, 128, 256)


def restitution(steps_per_collision, pairs=1000):
    """(error, seconds) of head-on impacts with restitution 0.80, the touch spread over all phases of a step."""
    law = ag.Linear(stiffness=1e4, damping=10.0)
    duration = ag.dem.collision_time(law, np.ones(2))
    dt = duration / steps_per_collision
    row = 3.0 * np.arange(pairs)
    gap = dt * np.arange(pairs) / pairs
    left, right = np.stack([0 * row, row], axis=1), np.stack([1.0 + gap, row], axis=1)
    velocity = np.repeat([[0.5, 0.0], [-0.5, 0.0]], pairs, axis=0)
    grains = ag.dem.Grains(np.concatenate([left, right]), np.full(2 * pairs, 0.5), mass=np.ones(2 * pairs), velocity=velocity)
    sim = ag.dem.Simulation(grains, law, dt=dt)
    sim.run(1)  # compiles
    clock = time.perf_counter()
    sim.run(3 * steps_per_collision)
    seconds = time.perf_counter() - clock
    speed = sim.velocity[pairs:, 0] - sim.velocity[:pairs, 0]
    exact = math.exp(-law.damping * duration / (2 * 0.5))
    return float(np.abs(speed - exact).max()), seconds


def ring_flow(elements, reference):
    """(relative L2 error of v_phi, seconds) of the nonlocal ring flow."""
    problem = replace(reference.problem, elements=elements)
    problem.solve()  # warm
    clock = time.perf_counter()
    flow = problem.solve()
    seconds = time.perf_counter() - clock
    r = np.linspace(13.0, 33.0, 4001)
    v, exact = flow.at(r).v_phi, reference.at(r).v_phi
    return float(np.sqrt(np.sum(r * (v - exact) ** 2) / np.sum(r * exact**2))), seconds


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("--quick", action="store_true", help="the coarser half only")
    options = parser.parse_args(arguments)
    check_writable(options.file)
    keep = slice(0, 3) if options.quick else slice(None)
    law = ag.continuum.Nonlocal(mu_s=0.26, b=1.0, amplitude=0.9)
    reference = ag.RingFlow(13.0, 33.0, law, 1e-3, 1.0, elements=1024).solve()
    tables = {
        "steps_per_collision": {n: restitution(n) for n in STEPS_PER_COLLISION[keep]},
        "elements": {n: ring_flow(n, reference) for n in ELEMENTS[keep]},
    }
    datasets = {}
    for knob, table in tables.items():
        print(f"{knob:>20}      error    seconds")
        for value, (error, seconds) in table.items():
            print(f"{value:20d} {error:10.1e} {seconds:10.4f}")
        errors, seconds = np.array(list(table.values())).T
        datasets[knob] = xr.Dataset({"error": (knob, errors), "seconds": (knob, seconds, {"units": "s"})}, coords={knob: list(table)})
    save_results(options.file, datasets, {})
    return tables


if __name__ == "__main__":
    main()
