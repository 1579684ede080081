"""Homogeneous simple shear in a periodic cell: steady flow at given vertical stress, or at given area fraction.

The cell is sheared by Lees-Edwards conditions, so no wall disturbs the flow. Under pressure control its height follows the vertical
stress; under volume control it is compressed to the area fraction without friction and keeps its height. The shear rate is given, or
chosen as I / sqrt(mean mass / pressure); the inertial number that results is measured with the mean pressure, half the trace of the
stress, at constant volume too, where the stress is an outcome.
"""

import math
from dataclasses import replace
from typing import ClassVar

import numpy as np

from anisogran import tensors
from anisogran.averaging import average, drift
from anisogran.dem import Friction, Grains, Linear, Luding, Periodic, Simulation
from anisogran.dem.packing import uniform_radii
from anisogran.experiments.experiment import Experiment, check_rows, frame_name, labelled_series, spread_evenly, squeezed
from anisogran.experiments.preparation import ATTEMPTS, LOOSE, background_drag, positions_in_cell, quasi_static_step, sphere_mass
from anisogran.experiments.steady_shear import BLOCK, blocks_of, state_of
from anisogran.outcome import InputError
from anisogran.runs.stages import Stage, equilibrium
from anisogran.scenes.keys import LARGEST_SEED, LENGTH, MANY, scene_key, scene_table

CLOSING = 0.02  # strain rate of the height while nothing resists, in units of sqrt(pressure/mean mass)
DENSE = 0.84  # about that under pressure; the cell is as much too high at the start


class SimpleShear(Experiment):
    """Simple shear of discs in a periodic cell under the vertical stress `pressure`. Default units as in the ring shear cell.

    The shear rate follows from `inertial_number` (0.01 if nothing is said) or is given as `rate`, not both. With `area_fraction` the
    volume is kept instead of the stress; `pressure` is then only the scale: of the inertial number asked for, and of the time in which
    the sample is compressed. The flow is as fast as under that pressure, whatever the stress turns out to be.
    The cell is about square when pressed. `strain` is the whole shear strain; the first `discard` of it is not averaged.
    """

    kind: ClassVar[str] = "simple_shear"
    output_keys: ClassVar[frozenset] = frozenset({"frames"})
    quick: ClassVar[dict] = {"inertial_number": 0.05, "n": 100, "strain": 3.0, "discard": 1.0}
    pressure: float = scene_key("N/m", "vertical stress; with area_fraction only the scale of the shear rate", 1.0, above=0)
    inertial_number: float | None = scene_key(
        "1", "inertial number; 0.01 unless rate is given", None, above=0, at_most=1, example=0.01
    )  # fmt: skip
    rate: float | None = scene_key("1/s", "shear rate, instead of inertial_number", None, above=0, example=0.01)
    area_fraction: float | None = scene_key(
        "1", "kept constant, instead of the vertical stress", None, above=LOOSE, at_most=0.95, example=0.82
    )  # fmt: skip
    contact: Linear | Luding = scene_table("normal contact law", Linear(stiffness=1000.0, damping=4.0))
    friction: Friction | None = scene_table("sliding friction; without it grains do not turn", Friction(stiffness=500.0, mu=0.44))
    n: int = scene_key("1", "number of grains", 400, at_least=50, at_most=10_000_000)
    mean_diameter: float = scene_key("m", "mean diameter of the grains", 1.0, **LENGTH)
    size_ratio: float = scene_key("1", "largest over smallest radius", 2.0, at_least=1, at_most=20)
    density: float = scene_key("kg/m3", "density of the grains, which have the mass of spheres", 1.0, above=0)
    strain: float = scene_key("1", "shear strain at the end", 5.0, above=0, at_most=1e9)
    discard: float = scene_key("1", "shear strain before averaging begins", 1.5, at_least=0, at_most=1e9)
    contact_steps: float = scene_key("1", "time steps in the shortest contact time", 20.0, at_least=5, at_most=1000)
    samples_per_strain: int = scene_key("1", "rows of the series per unit of shear strain", 50, at_least=5, at_most=MANY)
    frames: int = scene_key("1", "snapshots of the averaged part that are kept", 20, at_least=0, at_most=MANY)
    seed: int = scene_key("1", "of the random start", 0, at_least=0, at_most=LARGEST_SEED)

    def __init__(self, **values):
        if values.get("inertial_number") is None and values.get("rate") is None:
            values["inertial_number"] = 0.01
        super().__init__(**values)

    def check(self):
        if self.inertial_number is not None and self.rate is not None:
            raise InputError(f"SimpleShear: inertial_number = {self.inertial_number:g} and rate = {self.rate:g} 1/s: give one of them")
        if self.strain < self.discard + 0.5:
            raise InputError(f"SimpleShear: strain = {self.strain:g} must be at least discard + 0.5 = {self.discard + 0.5:g}")
        check_rows("SimpleShear", strain=self.strain, samples_per_strain=self.samples_per_strain)

    def stages(self):
        """Prepare: press together, without friction and damped, or compress to the area fraction; relax; shear."""
        radius, _, _ = self.loose_cell()
        dt = self.step(radius)
        rate, closing = self.shear_rate(radius), self.closing_rate(radius)
        samples = round(self.strain * self.samples_per_strain)
        shearing = max(1, round(1 / (rate * self.samples_per_strain * dt))) * np.arange(1, samples + 1)
        if self.area_fraction is None:
            steps = int(1.5 * math.log(DENSE / LOOSE) / closing / dt)
            gate = equilibrium(self.contact.stiffest, self.stress_error)
            prepare = Stage("prepare", steps // 10 * np.arange(1, 11), begin=self.pressed)
            relax = Stage("relax", max(1, steps // 10) * np.arange(1, ATTEMPTS + 1), gate=gate, expected=12)
        else:
            steps = self.compression_steps(radius, dt)
            prepare = Stage("prepare", np.array([steps]), begin=self.compressed)
            relax = Stage(
                "relax", max(1, steps // 10) * np.arange(1, ATTEMPTS + 1), begin=self.stopped, gate=self.calm, expected=4
            )  # fmt: skip
        return prepare, relax, Stage("shear", shearing, begin=self.sheared, look=self.look)

    def loose_cell(self):
        """Radii (N,), width and height of the cell in which they are loose, and the random numbers that come next."""
        dense = self.area_fraction or DENSE
        rng = np.random.default_rng(self.seed)
        radius = uniform_radii(self.n, 0.5 * self.mean_diameter, self.size_ratio, rng)
        width = math.sqrt(np.sum(np.pi * radius**2) / dense)
        return radius, (width, width * dense / LOOSE), rng

    def step(self, radius):
        """The time step in s."""
        return quasi_static_step(self.contact, self.friction, sphere_mass(radius, self.density), self.contact_steps)

    def rate_scale(self, radius):
        """sqrt(pressure/mean mass) in 1/s, in which rates are measured."""
        return 1 / math.sqrt(sphere_mass(radius, self.density).mean() / self.pressure)

    def shear_rate(self, radius):
        """In 1/s, as given or from the inertial number."""
        return self.rate or self.inertial_number * self.rate_scale(radius)

    def closing_rate(self, radius):
        """Strain rate of the height while the cell closes, in 1/s; when a volume is wanted, such that it is met after whole steps."""
        closing = CLOSING * self.rate_scale(radius)
        if self.area_fraction is None:
            return closing
        dt = self.step(radius)
        return math.log(self.area_fraction / LOOSE) / (self.compression_steps(radius, dt) * dt)

    def compression_steps(self, radius, dt):
        """Steps in which the cell is compressed to its area fraction."""
        return math.ceil(math.log(self.area_fraction / LOOSE) / (CLOSING * self.rate_scale(radius)) / dt)

    def loose_grains(self):
        """Grains in their random start, radii, width and height of their cell."""
        radius, size, rng = self.loose_cell()
        position = positions_in_cell(radius, np.array(size), rng)
        return Grains(position, radius, density=self.density), radius, size

    def pressed(self, _):
        """The Simulation of a loose sample whose height is pressed together."""
        grains, radius, size = self.loose_grains()
        cell = Periodic(*size, pressure=(None, self.pressure), viscosity=self.pressure / self.closing_rate(radius))
        return Simulation(grains, self.contact, boundary=cell, drag=background_drag(self.contact, grains.mass), dt=self.step(radius))

    def stress_error(self, simulation):
        """How far the vertical stress is from the pressure, relative."""
        return abs(float(average(simulation.snapshot(), fields=["stress"]).stress[1, 1]) / self.pressure - 1)

    def compressed(self, _):
        """The Simulation of a loose sample whose height shrinks at a steady rate.

        The grains begin in the affine flow of the cell, so that it is compressed evenly; drag would hold them back.
        """
        grains, radius, size = self.loose_grains()
        closing = self.closing_rate(radius)
        affine = np.stack([np.zeros(len(grains)), -closing * grains.position[:, 1]], axis=1)
        cell = Periodic(*size, stretch_rate=(0.0, -closing))
        return Simulation(replace(grains, velocity=affine), self.contact, boundary=cell, dt=self.step(radius))

    def stopped(self, compressed):
        """The Simulation of the compressed sample in a cell that rests, with background damping.

        Where grains hardly touch, dashpots alone would take for ever; and a common drift no contact would ever stop.
        """
        width, height = compressed.walls.lattice[:2]
        velocity = compressed.velocity
        velocity[:, 1] += self.closing_rate(compressed.grains.radius) * compressed.position[:, 1]
        drag = background_drag(self.contact, compressed.grains.mass)
        return compressed.next_stage(boundary=Periodic(width, height), velocity=velocity, drag=drag)

    def calm(self, simulation):
        """A gate: at a given volume the grains may have no contact, but they move less than the flow will move them over a diameter."""
        energy = 0.5 * float(simulation.grains.mass.sum()) * (self.shear_rate(simulation.grains.radius) * self.mean_diameter) ** 2
        kinetic = simulation.kinetic_energy()
        return "" if kinetic < energy else f"E_kin = {kinetic:.2g} J (wanted < {energy:.2g} J, that of the shear over one diameter)"

    def sheared(self, prepared):
        """The Simulation of the prepared sample with friction, in the linear profile of its flow."""
        width, height = prepared.walls.lattice[:2]
        radius = prepared.grains.radius
        rate = self.shear_rate(radius)
        control = {}
        if self.area_fraction is None:
            control = {"pressure": (None, self.pressure), "viscosity": self.pressure / max(CLOSING * self.rate_scale(radius), 0.5 * rate)}
        velocity = prepared.velocity
        velocity[:, 0] += rate * prepared.position[:, 1]
        cell = Periodic(width, height, shear_rate=rate, **control)
        return prepared.next_stage(boundary=cell, friction=self.friction, drag=None, velocity=velocity)

    def look(self, simulation, records, k):
        """Records a row and some snapshots."""
        discarded, samples = (round(strain * self.samples_per_strain) for strain in (self.discard, self.strain))
        snapshot = simulation.snapshot()
        records.rows.append(self.measure(simulation, snapshot, simulation.boundary.shear_rate))
        if k + 1 in spread_evenly(self.frames, discarded, samples):
            records.snapshots[frame_name(k + 1)] = snapshot
        records.snapshots["end"] = snapshot

    def fields(self, records, simulation):
        """The series; there are no profiles and blocks."""
        return labelled_series(records.rows, self.kind), None, None

    def tables(self, records):
        """Group "steady": the steady state as `steady_state` gives it, once there are two blocks of strain."""
        series = labelled_series(records.rows, self.kind)
        steady = self.steady(series)
        return {"steady": state_of(steady)} if steady.sizes["time"] and np.ptp(steady.strain.values) > 2 * BLOCK else {}

    def nominal_inertial_number(self):
        """Under the pressure that is given."""
        radius, _, _ = self.loose_cell()
        return self.shear_rate(radius) / self.rate_scale(radius)

    def judge(self, series, blocks, simulation):
        """Warnings a reader must see: pressure not held, drift, stale neighbour lists."""
        status, steady = squeezed(simulation), self.steady(series)
        moved, vertical = drift(blocks_of(steady).stress_ratio), float(steady.sigma_yy.mean())
        if self.area_fraction is None and abs(vertical / self.pressure - 1) > 0.05:
            status = status.warn(f"the mean vertical stress is {vertical / self.pressure:.2f} times the one asked for")
        if abs(moved) > 4:
            status = status.warn(f"not steady: the stress ratio drifts by {moved:.1f} standard errors")
        if simulation.counters["late_builds"]:
            status = status.warn(f"{simulation.counters['late_builds']} neighbour lists were built late")
        return status

    def steady(self, series):
        """The part of the series after the discarded strain."""
        return series.isel(time=np.flatnonzero(series.strain.values > self.discard))

    def measure(self, simulation, snapshot, rate):
        """One row of the series; the shear is along x with the gradient along y, so stress_ratio = -sigma_xy/p is positive."""
        box = average(snapshot, least_contacts=3 if self.friction is None else 2)
        stress, fabric = box.stress.values, box.fabric.values
        pressure = float(tensors.mean(stress))
        return {
            "time": simulation.time,
            "strain": rate * simulation.time,
            "pressure": pressure,
            "sigma_xx": float(stress[0, 0]),
            "sigma_yy": float(stress[1, 1]),
            "sigma_xy": float(0.5 * (stress[0, 1] + stress[1, 0])),
            "fabric_xx": float(fabric[0, 0]),
            "fabric_yy": float(fabric[1, 1]),
            "fabric_xy": float(fabric[0, 1]),
            "stress_ratio": float(-0.5 * (stress[0, 1] + stress[1, 0]) / pressure),
            "s_D": float(tensors.deviator_size(stress) / pressure),
            "inertial_number": rate * math.sqrt(simulation.grains.mass.mean() / pressure),
            "area_fraction": float(box.area_fraction),
            "anisotropy": float(box.anisotropy),
            "coordination_number": float(box.coordination_number),
        }
