"""The lecture's biaxial box: isotropic preparation, then a strain-controlled top against a side wall under constant pressure.

The top follows z(t) = z_f + (z_0 - z_f)/2 (1 + cos(pi t/duration)). Walls are smooth. The sample starts from a random loose packing
without friction, is pressed to equilibrium under the pressure on both movable walls, and only then friction is switched on and loading
begins; no background damping acts while loading.
"""

import math
from typing import ClassVar

import numpy as np

from anisogran.averaging import average
from anisogran.dem import Box, Cosine, Friction, Grains, Linear, Luding, Pressure, Simulation
from anisogran.dem.packing import random_positions, uniform_radii
from anisogran.experiments.experiment import Experiment, labelled_series, squeezed
from anisogran.experiments.preparation import ATTEMPTS, LOOSE, background_drag, quasi_static_step, sphere_mass
from anisogran.runs.stages import Stage, equilibrium
from anisogran.scenes.keys import LARGEST_SEED, LENGTH, MANY, scene_key, scene_table


class Biaxial(Experiment):
    """Biaxial compression of discs at constant side pressure. Units: m, kg, s; pressure in N/m; mass of spheres.

    Radii are uniform with the given mean and ratio of largest to smallest; `strain` is the vertical strain at the end as
    ln(z0/z), reached after `duration` s.
    """

    kind: ClassVar[str] = "biaxial"
    output_keys: ClassVar[frozenset] = frozenset({"samples"})
    quick: ClassVar[dict] = {"grains": 150, "strain": 0.06, "duration": 0.02, "samples": 100}
    pressure: float = scene_key("N/m", "constant pressure on the side wall", 100.0, above=0)
    contact: Linear | Luding = scene_table("normal contact law", Luding(k1=5e4, k2=1e5, kc=0.0, damping=0.1))
    friction: Friction | None = scene_table("sliding friction, switched on when loading begins; without it grains do not turn", None)
    grains: int = scene_key("1", "number of grains", 1950, at_least=20, at_most=10_000_000)
    mean_radius: float = scene_key("m", "mean radius of the grains", 1e-3, **LENGTH)
    size_ratio: float = scene_key("1", "largest over smallest radius", 3.0, at_least=1, at_most=20)
    density: float = scene_key("kg/m3", "density of the grains, which have the mass of spheres", 2000.0, above=0)
    strain: float = scene_key("1", "vertical strain at the end, ln(z0/z)", 0.1, above=0, below=1)
    duration: float = scene_key("s", "time of loading", 1.0, above=0)
    samples: int = scene_key("1", "rows of the series after the first", 200, at_least=10, at_most=MANY)
    seed: int = scene_key("1", "of the random start", 0, at_least=0, at_most=LARGEST_SEED)

    def stages(self):
        """Prepare and relax under the pressure, without friction and damped; load."""
        radius, side, _ = self.loose_box()
        mass = sphere_mass(radius, self.density)
        dt = quasi_static_step(self.contact, self.friction, mass)
        closing = int(0.25 * side / self.wall_speed(side, mass) / dt)
        relaxing = max(1000, closing // 20) * np.arange(1, ATTEMPTS + 1)
        loading = np.linspace(0, math.ceil(self.duration / dt), self.samples + 1).astype(int)
        gate = equilibrium(self.contact.stiffest, self.stress_error)
        return (
            Stage("prepare", closing // 10 * np.arange(1, 11), begin=self.loose),
            Stage("relax", relaxing, gate=gate, expected=60),
            Stage("load", loading, begin=self.loaded, look=self.look),
        )

    def loose_box(self):
        """Radii (N,), the side of the square box in which they are loose, and the random numbers that come next."""
        rng = np.random.default_rng(self.seed)
        radius = uniform_radii(self.grains, self.mean_radius, self.size_ratio, rng)
        return radius, math.sqrt(np.sum(np.pi * radius**2) / LOOSE), rng

    def wall_speed(self, side, mass):
        """Of walls that come in at I about 2e-3, in m/s."""
        return 2e-3 * side / math.sqrt(mass.mean() / self.pressure)

    def loose(self, _):
        """The Simulation of a loose sample in a box whose side and top are pressed inwards."""
        radius, side, rng = self.loose_box()

        def inside(points, r):
            return np.all((points > r) & (points < side - r), axis=1)

        position = random_positions(radius, lambda rng, count: rng.uniform(0, side, (count, 2)), inside, rng)
        grains = Grains(position, radius, density=self.density)
        # the dashpot alone sets the speed of the walls, since force and mass are far from balance until they meet resistance
        dashpot = self.pressure * side / self.wall_speed(side, grains.mass)
        wall = Pressure(self.pressure, mass=0.05 * float(grains.mass.sum()), damping=dashpot)
        drag, dt = background_drag(self.contact, grains.mass), quasi_static_step(self.contact, self.friction, grains.mass)
        return Simulation(grains, self.contact, boundary=Box(side, side, right=wall, top=wall), drag=drag, dt=dt)

    def stress_error(self, simulation):
        """How far the stress on the movable walls is from the pressure, relative."""
        _, right, _, top = simulation.walls.position
        stress = simulation.walls.force[1] / top, simulation.walls.force[3] / right
        return max(abs(s / self.pressure - 1) for s in stress)

    def loaded(self, prepared):
        """The Simulation of the prepared sample with friction, its top about to come down."""
        _, width, _, height = prepared.walls.position
        lowest = height * math.exp(-self.strain)
        # the side wall lags its pressure by damping * speed: half a per cent at the fastest moment
        fastest = width * self.strain * 0.5 * math.pi / self.duration
        side = Pressure(self.pressure, mass=0.01 * float(prepared.grains.mass.sum()), damping=0.005 * self.pressure * height / fastest)
        box = Box(width, height, right=side, top=Cosine(height, lowest, self.duration))
        return prepared.next_stage(boundary=box, friction=self.friction, drag=None)

    def look(self, simulation, records, k):
        """Records a row, and the snapshots "start", "peak" (of s_D) and "end"."""
        snapshot = simulation.snapshot()
        highest = max((row["s_D"] for row in records.rows), default=-1.0)
        row = self.measure(simulation, snapshot)
        records.rows.append(row)
        if k == 0:
            records.snapshots["start"] = snapshot
        if row["s_D"] > highest:
            records.snapshots["peak"] = snapshot
        records.snapshots["end"] = snapshot

    def measure(self, simulation, snapshot):
        """One row of the series."""
        width, height = simulation.boundary.width, simulation.boundary.height  # at the start of this stage
        least_contacts = 3 if self.friction is None else 2
        box = average(snapshot, least_contacts=least_contacts)
        _, x, _, z = simulation.walls.position
        force = simulation.walls.force
        eps_zz, eps_xx = math.log(height / z), math.log(width / x)
        sigma_xx, sigma_zz = float(box.stress[0, 0]), float(box.stress[1, 1])
        return {
            "time": simulation.time,
            "eps_zz": eps_zz,
            "eps_xx": eps_xx,
            "eps_V": 0.5 * (eps_zz + eps_xx),
            "eps_D": 0.5 * (eps_zz - eps_xx),
            "sigma_xx": sigma_xx,
            "sigma_zz": sigma_zz,
            "sigma_xx_wall": force[1] / z,
            "sigma_zz_wall": force[3] / x,
            "s_D": (sigma_zz - sigma_xx) / (sigma_zz + sigma_xx),
            "area_fraction": float(box.area_fraction),
            "fabric_trace": float(box.fabric_trace),
            "fabric_deviator": 0.5 * float(box.fabric[1, 1] - box.fabric[0, 0]),
            "anisotropy": 2.0 * float((box.fabric[1, 1] - box.fabric[0, 0]) / box.fabric_trace),
            "coordination_number": float(box.coordination_number),
            "kinetic_energy": simulation.kinetic_energy(),
        }

    def fields(self, records, simulation):
        """The series; there are no profiles and blocks."""
        return labelled_series(records.rows, self.kind), None, None

    def nominal_inertial_number(self):
        """At the fastest moment."""
        mass = float(sphere_mass(self.loose_box()[0], self.density).mean())
        return 2 * self.strain * 0.5 * math.pi / self.duration * math.sqrt(mass / self.pressure)

    def judge(self, series, blocks, simulation):
        """Warnings a reader must see: pressure not held, flow not quasi-static, stale neighbour lists."""
        status = squeezed(simulation)
        held = float(abs(series.sigma_xx_wall / self.pressure - 1).median())
        if held > 0.02:
            status = status.warn(f"the side wall holds its pressure only to {held:.1%} (median)")
        inertial = self.nominal_inertial_number()
        if inertial > 1e-2:
            status = status.warn(f"inertial number up to {inertial:.2g}: not quasi-static")
        if simulation.counters["late_builds"]:
            status = status.warn(f"{simulation.counters['late_builds']} neighbour lists were built late")
        return status
