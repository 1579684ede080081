"""Homogeneous simple shear in a periodic cell: steady flow at given vertical stress, or at given area fraction.

The cell is sheared by Lees-Edwards conditions, so no wall disturbs the flow. Under pressure control its height follows the vertical
stress; under volume control it is compressed to the area fraction without friction and keeps its height. The shear rate is given, or
chosen as I / sqrt(mean mass / pressure); the inertial number that results is measured with the mean pressure, half the trace of the
stress, at constant volume too, where the stress is an outcome.
"""

import math
from dataclasses import replace

import numpy as np
import xarray as xr
from pydantic import Field

from anisogran import tensors
from anisogran.averaging import average, drift, mean_and_error
from anisogran.dem import Friction, Grains, Linear, Luding, Periodic, Simulation
from anisogran.dem.packing import random_positions, uniform_radii
from anisogran.experiments.experiment import Experiment, Run, Watch, frame_name, labelled_series, provenance, spread_evenly, squeezed
from anisogran.experiments.preparation import LOOSE, background_drag, quasi_static_step
from anisogran.outcome import InputError

CLOSING = 0.02  # strain rate of the height while nothing resists, in units of sqrt(pressure/mean mass)
DENSE = 0.84  # about that under pressure; the cell is as much too high at the start


class SimpleShear(Experiment):
    """Simple shear of discs in a periodic cell under the vertical stress `pressure`. Default units as in the ring shear cell.

    The shear rate follows from `inertial_number` (0.01 if nothing is said) or is given as `rate`, not both. With `area_fraction` the
    volume is kept instead of the stress; `pressure` is then only the scale: of the inertial number asked for, and of the time in which
    the sample is compressed. The flow is as fast as under that pressure, whatever the stress turns out to be.
    The cell is about square when pressed. `strain` is the whole shear strain; the first `discard` of it is not averaged.
    """

    pressure: float = Field(1.0, gt=0, description="vertical stress, N/m; with area_fraction only the scale of the shear rate")
    inertial_number: float | None = Field(None, gt=0, le=1, description="0.01 unless rate is given")
    rate: float | None = Field(None, gt=0, description="shear rate instead of inertial_number, 1/s")
    area_fraction: float | None = Field(None, gt=LOOSE, le=0.95, description="kept constant, instead of the vertical stress")
    contact: Linear | Luding = Linear(stiffness=1000.0, damping=4.0)
    friction: Friction | None = Friction(stiffness=500.0, mu=0.44)
    grains: int = Field(400, ge=50, le=10_000_000)
    mean_diameter: float = Field(1.0, gt=0, description="m")
    size_ratio: float = Field(2.0, ge=1, le=20)
    density: float = Field(1.0, gt=0, description="kg/m3")
    strain: float = Field(5.0, gt=0)
    discard: float = Field(1.5, ge=0)
    samples_per_strain: int = Field(50, ge=5)
    frames: int = Field(20, ge=0, description="snapshots of the averaged part that are kept")
    seed: int = Field(0, ge=0)

    def __init__(self, **values):
        if values.get("inertial_number") is None and values.get("rate") is None:
            values["inertial_number"] = 0.01
        super().__init__(**values)

    def check(self):
        if self.inertial_number is not None and self.rate is not None:
            raise InputError(f"SimpleShear: inertial_number = {self.inertial_number:g} and rate = {self.rate:g} 1/s: give one of them")
        if self.strain < self.discard + 0.5:
            raise InputError(f"SimpleShear: strain = {self.strain:g} must be at least discard + 0.5 = {self.discard + 0.5:g}")

    def run(self, progress=None):
        """The Run: series over time with strain, stress, s_D, stress_ratio, area_fraction, fabric. Raises RunFailed if it blows up."""
        watch = Watch(progress)
        return self.shear(self.prepare(watch), watch)

    def prepare(self, watch):
        """A Simulation pressed together in the periodic cell, frictionless and damped, or compressed to the area fraction."""
        dense = self.area_fraction or DENSE
        rng = np.random.default_rng(self.seed)
        radius = uniform_radii(self.grains, 0.5 * self.mean_diameter, self.size_ratio, rng)
        width = math.sqrt(np.sum(np.pi * radius**2) / dense)
        height = width * dense / LOOSE
        period = np.array([width, height])

        def anywhere(points, r):
            return np.ones(len(points), bool)

        position = random_positions(radius, lambda rng, count: rng.uniform(0, period, (count, 2)), anywhere, rng, period=period)
        grains = Grains(position, radius, density=self.density)
        closing = CLOSING / math.sqrt(grains.mass.mean() / self.pressure)
        drag, dt = background_drag(self.contact, grains.mass), quasi_static_step(self.contact, self.friction, grains.mass)
        if self.area_fraction is not None:
            steps = math.ceil(math.log(dense / LOOSE) / closing / dt)
            closing = math.log(dense / LOOSE) / (steps * dt)
            return self.compress(grains, (width, height), closing, steps, dt, watch)
        cell = Periodic(width, height, pressure=(None, self.pressure), viscosity=self.pressure / closing)
        simulation = Simulation(grains, self.contact, boundary=cell, drag=drag, dt=dt)
        steps = int(1.5 * math.log(dense / LOOSE) / closing / simulation.dt)
        for _ in range(10):
            watch.run(simulation, steps // 10)
        return simulation

    def compress(self, grains, size, closing, steps, dt, watch):
        """A Simulation brought to its area fraction in that many steps at the strain rate `closing`, and then left to its dashpots.

        The grains begin in the affine flow of the cell, so that it is compressed evenly; drag would hold them back.
        """
        affine = np.stack([np.zeros(len(grains)), -closing * grains.position[:, 1]], axis=1)
        cell = Periodic(*size, stretch_rate=(0.0, -closing))
        simulation = Simulation(replace(grains, velocity=affine), self.contact, boundary=cell, dt=dt)
        watch.run(simulation, steps)
        width, height = simulation.walls.lattice[:2]
        velocity = simulation.velocity
        velocity[:, 1] += closing * simulation.position[:, 1]
        simulation = simulation.next_stage(boundary=Periodic(width, height), velocity=velocity)
        watch.run(simulation, steps // 2)
        return simulation

    def shear(self, prepared, watch):
        """Shears the prepared sample and records it."""
        width, height = prepared.walls.lattice[:2]
        scale = 1 / math.sqrt(prepared.grains.mass.mean() / self.pressure)
        rate = self.rate or self.inertial_number * scale
        control = {}
        if self.area_fraction is None:
            control = {"pressure": (None, self.pressure), "viscosity": self.pressure / max(CLOSING * scale, 0.5 * rate)}
        cell = Periodic(width, height, shear_rate=rate, **control)
        position, velocity = prepared.position, prepared.velocity
        velocity[:, 0] += rate * position[:, 1]
        simulation = prepared.next_stage(boundary=cell, friction=self.friction, drag=None, velocity=velocity)
        samples = round(self.strain * self.samples_per_strain)
        between = max(1, round(1 / (rate * self.samples_per_strain * simulation.dt)))
        rows, snapshots = [], {}
        kept = spread_evenly(self.frames, round(self.discard * self.samples_per_strain), samples)
        for k in range(1, samples + 1):
            watch.run(simulation, between)
            snapshot = simulation.snapshot()
            rows.append(self.measure(simulation, snapshot, rate))
            if k in kept:
                snapshots[frame_name(k)] = snapshot
            watch.progress(k / samples)
        snapshots["end"] = snapshot
        series = labelled_series(rows, "simple_shear")
        moved = drift(blocks_of(self.steady(series)).stress_ratio)
        status = squeezed(simulation)
        vertical = float(self.steady(series).sigma_yy.mean())
        if self.area_fraction is None and abs(vertical / self.pressure - 1) > 0.05:
            status = status.warn(f"the mean vertical stress is {vertical / self.pressure:.2f} times the one asked for")
        if abs(moved) > 4:
            status = status.warn(f"not steady: the stress ratio drifts by {moved:.1f} standard errors")
        if simulation.counters["late_builds"]:
            status = status.warn(f"{simulation.counters['late_builds']} neighbour lists were built late")
        return Run(self, series, None, None, snapshots, status, provenance(self, watch, simulation))

    def steady(self, series):
        """The part of the series after the discarded strain."""
        return series.isel(time=np.flatnonzero(series.strain.values > self.discard))

    def measure(self, simulation, snapshot, rate):
        """One row of the series; the shear is along x with the gradient along y, so stress_ratio = -sigma_xy/p is positive."""
        box = average(snapshot, least_contacts=3 if self.friction is None else 2)
        stress = box.stress.values
        pressure = float(tensors.mean(stress))
        return {
            "time": simulation.time,
            "strain": rate * simulation.time,
            "pressure": pressure,
            "sigma_yy": float(stress[1, 1]),
            "stress_ratio": float(-0.5 * (stress[0, 1] + stress[1, 0]) / pressure),
            "s_D": float(tensors.deviator_size(stress) / pressure),
            "inertial_number": rate * math.sqrt(simulation.grains.mass.mean() / pressure),
            "area_fraction": float(box.area_fraction),
            "anisotropy": float(box.anisotropy),
            "coordination_number": float(box.coordination_number),
        }


def blocks_of(steady, size=0.25):
    """Means over blocks of `size` shear strain, dimension "block": longer than the memory of the stress, about a tenth of strain.

    Ratios to the pressure are ratios of the means: at constant volume the pressure may all but vanish for a moment.
    """
    count = max(2, int((steady.strain.values[-1] - steady.strain.values[0]) / size))
    parts = [steady.isel(time=part) for part in np.array_split(np.arange(steady.sizes["time"]), count)]
    blocks = xr.concat([part.mean("time", keep_attrs=True) for part in parts], "block")
    for name in ("stress_ratio", "s_D"):
        blocks[name].values[:] = [float((part[name] * part.pressure).mean() / part.pressure.mean()) for part in parts]
    return blocks


def steady_state(run):
    """Mean and standard error (`name_error`) of every series of a SimpleShear run after its transient, from blocks of strain.

    The inertial number is that of the mean pressure.
    """
    steady = run.scene.steady(run.series)
    state = mean_and_error(blocks_of(steady))
    inertial = float(steady.inertial_number[0]) * np.sqrt(float(steady.pressure[0]) / state.pressure)
    state["inertial_number"].values[...] = inertial
    state["inertial_number_error"].values[...] = 0.5 * inertial * state.pressure_error / state.pressure
    return state
