"""A free cohesive gas of grains that clusters: attraction + dissipation = agglomeration, as the lecture has it.

Discs fly about in a periodic cell, with nothing that drives them. Hysteretic contacts and dashpots take energy at each collision; with
adhesion a pair stays together if parting takes all that is left, and so do clusters. Without adhesion (kc = 0) the gas cools all the
same, but no contact lasts.
"""

import math
from typing import ClassVar

import numpy as np

from anisogran.averaging import average, fragments
from anisogran.dem import Friction, Grains, Linear, Luding, Periodic, Simulation
from anisogran.dem.packing import uniform_radii
from anisogran.experiments.experiment import Experiment, frame_name, labelled_series, spread_evenly
from anisogran.experiments.preparation import positions_in_cell, quasi_static_step, sphere_mass, time_steps
from anisogran.outcome import Status
from anisogran.runs.stages import Stage
from anisogran.scenes.keys import LARGEST_SEED, LENGTH, MANY, scene_key, scene_table


class CohesiveGas(Experiment):
    """A free gas of discs that lose energy and stick together. Units: m, kg, s; mass of spheres.

    Velocities are normally distributed at the start, without a mean, their root mean square being `speed`. The law being piecewise linear,
    whether a pair that meets head on sticks depends on its mass and not on its speed: it does if the work of parting, with the largest
    overlap d (1 - k1/k2)^2 k2 d^2/(2 (1 + k2/kc)), is more than unloading gives back, k1^2 d^2/(2 k2), less what the dashpot takes. At
    k1/k2 = 1/2 the first is 1/(1 + k2/kc) of the second, so it takes both, attraction and dissipation.
    """

    kind: ClassVar[str] = "cohesive_gas"
    output_keys: ClassVar[frozenset] = frozenset({"frames", "samples"})
    quick: ClassVar[dict] = {"n": 100, "duration": 0.05, "samples": 100}
    contact: Linear | Luding = scene_table("normal contact law", Luding(k1=5e4, k2=1e5, kc=2e5, damping=0.1))
    friction: Friction | None = scene_table("sliding friction; without it grains do not turn", None)
    n: int = scene_key("1", "number of grains", 500, at_least=20, at_most=10_000_000)
    mean_radius: float = scene_key("m", "mean radius of the grains", 1e-3, **LENGTH)
    size_ratio: float = scene_key("1", "largest over smallest radius", 3.0, at_least=1, at_most=20)
    density: float = scene_key("kg/m3", "density of the grains, which have the mass of spheres", 2000.0, above=0)
    area_fraction: float = scene_key("1", "of the gas", 0.2, above=0, at_most=0.45)
    speed: float = scene_key("m/s", "root mean square velocity at the start", 0.5, above=0)
    duration: float = scene_key("s", "time of free flight and collisions", 0.2, above=0)
    contact_steps: float = scene_key("1", "time steps in the shortest contact time", 20.0, at_least=5, at_most=1000)
    samples: int = scene_key("1", "rows of the series after the first", 400, at_least=10, at_most=MANY)
    frames: int = scene_key("1", "snapshots that are kept", 8, at_least=0, at_most=MANY)
    seed: int = scene_key("1", "of the random start", 0, at_least=0, at_most=LARGEST_SEED)

    def stages(self):
        """The gas is let go."""
        steps = time_steps(self.duration, self.step(self.start()[0]), f"CohesiveGas: duration = {self.duration:g} s")
        marks = np.linspace(0, steps, self.samples + 1).astype(int)
        return (Stage("cool", marks, begin=self.flying, look=self.look),)

    def start(self):
        """Radii (N,), the side of the square cell, and the random numbers that come next."""
        rng = np.random.default_rng(self.seed)
        radius = uniform_radii(self.n, self.mean_radius, self.size_ratio, rng)
        return radius, math.sqrt(np.sum(np.pi * radius**2) / self.area_fraction), rng

    def step(self, radius):
        """The time step in s."""
        return quasi_static_step(self.contact, self.friction, sphere_mass(radius, self.density), self.contact_steps)

    def flying(self, _):
        """The Simulation of the gas at its start."""
        radius, side, rng = self.start()
        position = positions_in_cell(radius, np.array([side, side]), rng)
        mass = sphere_mass(radius, self.density)
        velocity = rng.standard_normal((self.n, 2))
        velocity -= np.average(velocity, axis=0, weights=mass)
        velocity *= self.speed / math.sqrt(np.mean(np.sum(velocity**2, axis=1)))
        grains = Grains(position, radius, density=self.density, velocity=velocity)
        return Simulation(grains, self.contact, friction=self.friction, boundary=Periodic(side, side), dt=self.step(radius))

    def look(self, simulation, records, k):
        """Records a row and some snapshots."""
        snapshot = simulation.snapshot()
        records.rows.append(self.measure(simulation, snapshot))
        if k == 0:
            records.snapshots["start"] = snapshot
        elif self.frames and k in spread_evenly(self.frames, 0, self.samples):
            records.snapshots[frame_name(k)] = snapshot
        records.snapshots["end"] = snapshot

    def measure(self, simulation, snapshot):
        """One row of the series."""
        parts = fragments(snapshot)
        translation = 0.5 * float(snapshot.mass @ np.sum(snapshot.velocity**2, axis=1))
        return {
            "time": simulation.time,
            "kinetic_energy": simulation.kinetic_energy(),
            "elastic_energy": simulation.energy()["elastic"],
            "granular_temperature": translation / self.n,
            "fragments": int(parts.fragments),
            "largest_fragment": float(parts.largest_fragment),
            "mean_fragment_mass": float(parts.mean_fragment_mass),
            "coordination_number": float(average(snapshot, fields="coordination_number", least_contacts=0).coordination_number),
        }

    def fields(self, records, simulation):
        """The series; there are no profiles and blocks."""
        return labelled_series(records.rows, self.kind), None, None

    def nominal_inertial_number(self):
        """There is no flow."""
        return 0.0

    def judge(self, series, blocks, simulation):
        """Warnings a reader must see: stale neighbour lists."""
        late = simulation.counters["late_builds"]
        return Status().warn(f"{late} neighbour lists were built late") if late else Status()
