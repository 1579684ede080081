"""What accuracy costs in steady simple shear: grains, seeds, inertial number and stiffness, against the best of each.

The reference is the mean over seeds of the largest, slowest or stiffest flow; its own error, from blocks of strain, is told beside.
"""

import math
from statistics import fmean
from typing import NamedTuple

import numpy as np

from anisogran.cost.tables import row
from anisogran.cost.timing import clocked
from anisogran.dem import Friction, Linear
from anisogran.experiments import SimpleShear
from anisogran.experiments.steady_shear import steady_state

QUICK = {"n": 100, "strain": 1.0, "discard": 0.4, "inertial_number": 0.1, "frames": 0, "samples_per_strain": 25}
WHOLE = {"n": 200, "strain": 4.0, "discard": 1.5, "inertial_number": 0.03, "frames": 0}
SIZES = (50, 100, 200, 400)
RATES = (0.1, 0.03, 0.01)
SLOWEST = 0.003
STIFFNESSES = (100.0, 250.0, 1000.0)
STIFFEST = 10_000.0
QUANTITIES = {"mu": "stress_ratio", "phi": "area_fraction"}


class Flows(NamedTuple):
    """Means of each quantity, (seeds,), their errors from blocks of strain, and seconds of one run."""

    mean: dict
    error: dict
    seconds: float

    def reference(self, name):
        """(mean over the seeds, its relative error)."""
        mean = fmean(self.mean[name])
        return mean, math.sqrt(sum(error**2 for error in self.error[name])) / len(self.error[name]) / abs(mean)


def steady_rows(quick):
    """Rows of error against seconds for steady simple shear; processor seconds of one run, preparation included."""
    scene = QUICK if quick else WHOLE
    sheared(scene | {"n": 50, "strain": 0.5, "discard": 0.0}, 1)  # compiles
    return size_rows(scene, quick) + rate_rows(scene, quick) + stiffness_rows(scene, quick)


def sheared(scene, seeds):
    """The Flows of a scene with so many seeds."""
    runs, seconds = clocked(lambda: [SimpleShear(**scene, seed=seed).run() for seed in range(seeds)])
    states = [steady_state(run) for run in runs]
    mean = {name: [float(state[key]) for state in states] for name, key in QUANTITIES.items()}
    error = {name: [float(state[f"{key}_error"]) for state in states] for name, key in QUANTITIES.items()}
    return Flows(mean, error, seconds / seeds)


def size_rows(scene, quick):
    """Root mean square error of one run against the number of grains, and of means over seeds, against all seeds of twice as many."""
    seeds, default = 4 if quick else 8, SimpleShear.model_fields["n"].default
    flows = {n: sheared(scene | {"n": n}, 2 if quick and n > SIZES[0] else seeds) for n in SIZES[:: 3 if quick else 1]}
    exact, own = sheared(scene | {"n": 2 * SIZES[-1]}, 1 if quick else seeds).reference("mu")
    told = f"mu at I {scene['inertial_number']:g}, reference {2 * SIZES[-1]} grains good to {own:.0e}"
    rows = [row(f"grains: {told}", n, rms(flow.mean["mu"], exact), flow.seconds, n == default) for n, flow in flows.items()]
    few = flows[SIZES[0]]
    for count in (1, 2, 4, 8):
        if 2 * count <= seeds:
            means = [fmean(few.mean["mu"][k : k + count]) for k in range(0, seeds, count)]
            rows.append(row(f"seeds of {SIZES[0]} grains: {told}", count, rms(means, exact), count * few.seconds, count == 1))
    return rows


def rms(values, exact):
    """Root mean square of the relative deviations."""
    return float(np.sqrt(np.mean((np.asarray(values) / exact - 1.0) ** 2)))


def rate_rows(scene, quick):
    """How far mu and phi are from those of slow flow, against the inertial number."""
    seeds = 1 if quick else 4
    slow = sheared(scene | {"inertial_number": SLOWEST}, seeds)
    flows = {rate: sheared(scene | {"inertial_number": rate}, seeds) for rate in RATES}
    return against(f"inertial number: %s, reference {SLOWEST:g}", flows, slow, 0.01)


def stiffness_rows(scene, quick):
    """How far mu and phi are from those of stiff grains, against p/k; the ratios of stiffnesses and the restitution stay."""
    seeds, usual = 1 if quick else 4, SimpleShear.model_fields["contact"].default

    def flow(stiffness):
        damping = usual.damping * math.sqrt(stiffness / usual.stiffness)
        return sheared(scene | {"contact": Linear(stiffness, damping), "friction": Friction(0.5 * stiffness, 0.44)}, seeds)

    flows = {1.0 / stiffness: flow(stiffness) for stiffness in STIFFNESSES}
    return against(f"p/k: %s, reference {1 / STIFFEST:g}", flows, flow(STIFFEST), 1.0 / usual.stiffness)


def against(knob, flows, best, default):
    """Rows of mu and of phi of flows {value: Flows}, means over the seeds, against the best one."""
    rows = []
    for name in QUANTITIES:
        exact, own = best.reference(name)
        told = f"{knob % name} good to {own:.0e}"
        rows += [
            row(told, value, abs(fmean(flow.mean[name]) / exact - 1.0), flow.seconds, value == default) for value, flow in flows.items()
        ]
    return rows
