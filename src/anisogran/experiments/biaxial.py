"""The lecture's biaxial box: isotropic preparation, then a strain-controlled top against a side wall under constant pressure.

The top follows z(t) = z_f + (z_0 - z_f)/2 (1 + cos(pi t/duration)). Walls are smooth. The sample starts from a random loose packing
without friction and adhesion, is pressed to equilibrium on both movable walls, under its own pressure or first under a larger one that
several tests have in common (over-consolidation); then adhesion acts, and with the loading friction, while background damping ends.
With friction while pressing the sample stays loose.
"""

import math
from dataclasses import replace
from typing import ClassVar

import numpy as np

from anisogran.averaging import average, contact_directions
from anisogran.dem import Box, Cosine, Friction, Grains, Linear, Luding, Pressure, Simulation
from anisogran.dem.packing import random_positions, uniform_radii
from anisogran.experiments.experiment import Experiment, check_rows, labelled_series, squeezed
from anisogran.experiments.preparation import ATTEMPTS, LOOSE, background_drag, quasi_static_step, sphere_mass, time_steps
from anisogran.outcome import InputError
from anisogran.runs.stages import Stage, equilibrium
from anisogran.scenes.keys import LARGEST_SEED, LENGTH, MANY, scene_key, scene_table

SHOWN = (0.011, 0.042, 0.091)  # vertical strains of the snapshots on the lecture's slides
BEARING = 1e-3  # of the mean force: contacts with less are open but for their dashpot, as hysteretic ones that have unloaded


class Biaxial(Experiment):
    """Biaxial compression of discs at constant side pressure. Units: m, kg, s; pressure in N/m; mass of spheres.

    Radii are uniform with the given mean and ratio of largest to smallest; `strain` is the vertical strain at the end as
    ln(z0/z), reached after `duration` s, from where the top goes back and forth for further `half_periods`. Adhesion is absent while the
    sample is pressed, so that it does not clot.
    """

    kind: ClassVar[str] = "biaxial"
    output_keys: ClassVar[frozenset] = frozenset({"samples"})
    quick: ClassVar[dict] = {
        "n": 150, "strain": 0.06, "duration": 0.02, "wall_mass": 2e-5, "wall_damping": 0.02, "samples": 100,
    }  # fmt: skip
    pressure: float = scene_key("N/m", "constant pressure on the side wall", 100.0, above=0)
    contact: Linear | Luding = scene_table("normal contact law", Luding(k1=5e4, k2=1e5, kc=0.0, damping=0.1))
    friction: Friction | None = scene_table("sliding friction, switched on when loading begins; without it grains do not turn", None)
    overconsolidation: float | None = scene_key(
        "N/m", "larger pressure under which the sample is pressed first", None, above=0, example=500.0
    )
    pressing_friction: float | None = scene_key(
        "1", "friction coefficient while the sample is pressed, which leaves it loose", None, above=0, at_most=10, example=0.5
    )
    n: int = scene_key("1", "number of grains", 1950, at_least=20, at_most=10_000_000)
    mean_radius: float = scene_key("m", "mean radius of the grains", 1e-3, **LENGTH)
    size_ratio: float = scene_key("1", "largest over smallest radius", 3.0, at_least=1, at_most=20)
    density: float = scene_key("kg/m3", "density of the grains, which have the mass of spheres", 2000.0, above=0)
    strain: float = scene_key("1", "largest vertical strain, ln(z0/z)", 0.12, above=0, below=1)
    duration: float = scene_key("s", "time of loading, half a period of the cosine", 0.25, above=0)
    half_periods: int = scene_key("1", "of the cosine: 1 loads, 2 loads and unloads, more are cycles", 1, at_least=1, at_most=10_000)
    wall_mass: float = scene_key("kg", "of the side wall while loading", 0.02, above=0)
    wall_damping: float = scene_key("kg/s", "of the side wall while loading", 1.0, at_least=0)
    drag: float | None = scene_key(
        "kg/s", "background damping of every grain while loading, which adds to the stress of the top", None, above=0, example=0.01
    )
    contact_steps: float = scene_key("1", "time steps in the shortest contact time", 10.0, at_least=5, at_most=1000)
    samples: int = scene_key("1", "rows of the series in each half period, after the first", 400, at_least=10, at_most=MANY)
    seed: int = scene_key("1", "of the random start", 0, at_least=0, at_most=LARGEST_SEED)

    def check(self):
        if self.overconsolidation is not None and self.overconsolidation <= self.pressure:
            raise InputError(
                f"Biaxial: overconsolidation = {self.overconsolidation:g} must be above the pressure, {self.pressure:g} N/m, or left out"
            )
        if self.pressing_friction is not None and self.friction is None:
            raise InputError(f"Biaxial: pressing_friction = {self.pressing_friction:g} needs the table friction, whose stiffness it takes")
        check_rows("Biaxial", samples=self.samples, half_periods=self.half_periods)

    @property
    def first_pressure(self):
        """Under which the sample is pressed together, in N/m."""
        return self.pressure if self.overconsolidation is None else self.overconsolidation

    def stages(self):
        """Press and relax, without friction and adhesion, damped; release to the pressure of the test, with adhesion; load."""
        radius, side, _ = self.loose_box()
        mass = sphere_mass(radius, self.density)
        dt = self.step(mass)
        closing = int(0.25 * side / self.wall_speed(side, mass) / dt)
        relaxing = max(1000, closing // 20) * np.arange(1, ATTEMPTS + 1)
        half = time_steps(self.duration, dt, f"Biaxial: duration = {self.duration:g} s")
        loading = np.linspace(0, self.half_periods * half, self.half_periods * self.samples + 1).astype(int)
        stages = [
            Stage("press", closing // 10 * np.arange(1, 11), begin=self.loose),
            Stage("relax", relaxing, gate=self.at_rest(self.first_pressure), expected=60),
        ]
        if self.overconsolidation is not None or self.contact != self.cohesionless():
            stages.append(Stage("release", relaxing, begin=self.released, gate=self.at_rest(self.pressure), expected=20))
        return (*stages, Stage("load", loading, begin=self.loaded, look=self.look))

    def step(self, mass):
        """The time step in s."""
        return quasi_static_step(self.contact, self.friction, mass, self.contact_steps, self.drag)

    def cohesionless(self):
        """The contact law without its adhesion."""
        return replace(self.contact, kc=0.0) if hasattr(self.contact, "kc") else self.contact

    def rubbing(self):
        """The friction while pressing, or None."""
        return None if self.pressing_friction is None else replace(self.friction, mu=self.pressing_friction, mu_dynamic=None)

    def loose_box(self):
        """Radii (N,), the side of the square box in which they are loose, and the random numbers that come next."""
        rng = np.random.default_rng(self.seed)
        radius = uniform_radii(self.n, self.mean_radius, self.size_ratio, rng)
        return radius, math.sqrt(np.sum(np.pi * radius**2) / LOOSE), rng

    def wall_speed(self, side, mass):
        """Of walls that come in at I about 2e-3, in m/s."""
        return 2e-3 * side / math.sqrt(mass.mean() / self.first_pressure)

    def pressed_wall(self, pressure, side, mass):
        """A wall that presses while preparing: its dashpot sets its speed until it meets grains."""
        return Pressure(pressure, mass=0.05 * float(mass.sum()), damping=self.first_pressure * side / self.wall_speed(side, mass))

    def loose(self, _):
        """The Simulation of a loose sample in a box whose side and top are pressed inwards."""
        radius, side, rng = self.loose_box()

        def inside(points, r):
            return np.all((points > r) & (points < side - r), axis=1)

        position = random_positions(radius, lambda rng, count: rng.uniform(0, side, (count, 2)), inside, rng)
        grains = Grains(position, radius, density=self.density)
        wall, drag = self.pressed_wall(self.first_pressure, side, grains.mass), background_drag(self.contact, grains.mass)
        box = Box(side, side, right=wall, top=wall)
        return Simulation(grains, self.cohesionless(), self.rubbing(), boundary=box, drag=drag, dt=self.step(grains.mass))

    def released(self, pressed):
        """The Simulation of the pressed sample under the pressure of the test, with its adhesion."""
        _, width, _, height = pressed.walls.position
        wall = self.pressed_wall(self.pressure, self.loose_box()[1], pressed.grains.mass)
        return pressed.next_stage(boundary=Box(width, height, right=wall, top=wall), normal=self.contact)

    def at_rest(self, pressure):
        """The gate of a sample at rest under that pressure on both movable walls."""

        def stress_error(simulation):
            _, right, _, top = simulation.walls.position
            stress = simulation.walls.force[1] / top, simulation.walls.force[3] / right
            return max(abs(s / pressure - 1) for s in stress)

        return equilibrium(self.contact.stiffest, stress_error)

    def loaded(self, prepared):
        """The Simulation of the prepared sample with its friction and the background damping of loading, its top about to come down."""
        _, width, _, height = prepared.walls.position
        side = Pressure(self.pressure, mass=self.wall_mass, damping=self.wall_damping)
        top = Cosine(height, height * math.exp(-self.strain), self.duration, half_periods=self.half_periods)
        return prepared.next_stage(boundary=Box(width, height, right=side, top=top), friction=self.friction, drag=self.drag)

    def look(self, simulation, records, k):
        """Records a row, and the snapshots "start", "peak" (of s_D), "end" and those at the strains of the lecture's slides."""
        snapshot = simulation.snapshot()
        before = records.rows[-1]["eps_zz"] if records.rows else -1.0
        highest = max((row["s_D"] for row in records.rows), default=-1.0)
        row = self.measure(simulation, snapshot)
        records.rows.append(row)
        if k == 0:
            records.snapshots["start"] = snapshot
        if row["s_D"] > highest:
            records.snapshots["peak"] = snapshot
        for strain in SHOWN:
            if before < strain <= row["eps_zz"]:
                records.snapshots.setdefault(f"eps_zz-{strain:.3f}", snapshot)  # of several cycles, the first
        records.snapshots["end"] = snapshot

    def measure(self, simulation, snapshot):
        """One row of the series."""
        width, height = simulation.boundary.width, simulation.boundary.height  # at the start of this stage
        bearing = snapshot.bearing(BEARING)
        box = average(bearing, least_contacts=3 if self.friction is None else 2)
        directions = contact_directions(bearing)
        _, x, _, z = simulation.walls.position
        force = simulation.walls.force
        eps_zz, eps_xx = math.log(height / z), math.log(width / x)
        sigma_xx, sigma_zz = force[1] / z, force[3] / x
        return {
            "time": simulation.time,
            "eps_zz": eps_zz,
            "eps_xx": eps_xx,
            "eps_V": 0.5 * (eps_zz + eps_xx),
            "eps_D": 0.5 * (eps_zz - eps_xx),
            "sigma_xx": sigma_xx,
            "sigma_zz": sigma_zz,
            "sigma_xx_grains": float(box.stress[0, 0]),
            "sigma_zz_grains": float(box.stress[1, 1]),
            "s_D": (sigma_zz - sigma_xx) / (sigma_zz + sigma_xx),
            "area_fraction": float(box.area_fraction),
            "fabric_trace": float(box.fabric_trace),
            "fabric_deviator": 0.5 * float(box.fabric[1, 1] - box.fabric[0, 0]),
            "anisotropy": 2.0 * float((box.fabric[1, 1] - box.fabric[0, 0]) / box.fabric_trace),
            "a2": float(directions.a2),
            "a4": float(directions.a4),
            "coordination_number": float(box.coordination_number),
            "kinetic_energy": simulation.kinetic_energy(),
            "elastic_energy": simulation.energy()["elastic"],
            "spin_rms": float(np.sqrt(np.mean(simulation.spin**2))),
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
        held = float(abs(series.sigma_xx / self.pressure - 1).median())
        if held > 0.02:
            status = status.warn(f"the side wall holds its pressure only to {held:.1%} (median)")
        inertial = self.nominal_inertial_number()
        if inertial > 1e-2:
            status = status.warn(f"inertial number up to {inertial:.2g}: not quasi-static")
        if simulation.counters["late_builds"]:
            status = status.warn(f"{simulation.counters['late_builds']} neighbour lists were built late")
        return status
