"""How fast the averages are: every field on rings, on a grid and at points, and what they add to the run that makes the grains."""

import statistics
import time
from dataclasses import replace

import numpy as np

from anisogran.averaging import Rings, average, densities, extensive_needs, known_at, place_of
from anisogran.benchmark.shear import made_packing, sheared_packing

NODES = 100  # points along each side of the grid
INTERVAL = 1000  # steps between two averages of a run
RUN = 10_000  # grains of the run that is averaged


def seconds_of(work, repeats):
    """Median seconds of a piece of work, after one run that may compile."""
    work()
    times = []
    for _ in range(repeats):
        clock = time.perf_counter()
        work()
        times.append(time.perf_counter() - clock)
    return statistics.median(times)


def averaging_benchmark(grains=100_000, repeats=5):
    """Seconds of averages of a sheared packing with friction, a dict: all fields on rings of one mean diameter, on a grid of rectangles
    and at the points of a grid with the Gaussian kernel of one mean diameter; and the share of a run's time that goes into a snapshot and
    its ring averages every 1,000 steps."""
    snapshot = sheared_snapshot(grains)
    ring = replace(snapshot, cell=None, cell_velocity=None)  # seen as a disc-shaped sample: only the time matters
    side = float(snapshot.cell[0, 0])
    edges = (np.linspace(0.0, side, NODES + 1),) * 2
    options = {
        "rings": (ring, {"on": "rings", "width": "1.0d"}),
        "grid": (snapshot, {"on": "grid", "edges": edges}),
        "points": (snapshot, {"on": "grid", "edges": edges, "kernel": "gaussian", "width": "1.0d"}),
    }
    numbers = {"grains": len(snapshot.radius), "contacts": len(snapshot.pairs), "repeats": repeats}
    for name, (sample, where) in options.items():
        names = known_at(place_of(sample, **where))
        every = seconds_of(lambda sample=sample, where=where, names=names: average(sample, fields=names, **where), repeats)
        usual = seconds_of(lambda sample=sample, where=where: average(sample, **where), repeats)
        numbers |= {f"{name}_fields": len(names), f"{name}_all_s": every, f"{name}_default_s": usual}
    return numbers | share_of_run(repeats)


def sheared_snapshot(grains):
    """A Snapshot of a dense periodic packing with friction after 300 steps of pure shear."""
    simulation = sheared_packing(*made_packing(grains), "friction", 5.0)
    simulation.run(300)
    return simulation.snapshot()


def share_of_run(repeats):
    """What a snapshot and the ring averages of all fields of a profile, every 1,000 steps, add to a run of 10,000 grains; a dict."""
    position, radius, side = made_packing(RUN)
    simulation = sheared_packing(position, radius, side, "friction", 5.0)
    simulation.run(INTERVAL)
    step = seconds_of(lambda: simulation.run(INTERVAL), repeats)
    place = Rings(np.arange(0.0, 0.7 * side, 2e-3), np.empty(0))
    needs = extensive_needs(["velocity", "velocity_gradient", "spin", "stress", "fabric", "area_fraction"])
    cost = seconds_of(lambda: densities(simulation.snapshot(), place, needs), 10 * repeats)
    return {"run_grains": RUN, "run_interval_steps": INTERVAL, "run_interval_s": step, "run_average_s": cost, "share_of_run": cost / step}
