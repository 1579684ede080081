"""The lecture's two-dimensional ring shear cell: a rough inner ring turns, the outer ring is pressed inwards as a radial piston.

Both rings are wreaths of discs of the mean diameter with gaps in which grains nest; without that roughness the grains layer, roll and
slip, at the outer ring too, where the whole sample then creeps around. The radii of the cell are those of the circles through the tops
of the wreaths. The sample is pressed together from a random loose state without friction and with background damping; then friction
is switched on, damping off, and the inner ring turns.
"""

import math
from dataclasses import replace
from typing import ClassVar

import numpy as np

from anisogran.averaging import Rings, densities, drift, extensive_needs, field_profiles
from anisogran.dem import Friction, Grains, Linear, Luding, Pressure, Ring, Simulation
from anisogran.dem.packing import random_positions, uniform_radii
from anisogran.experiments.experiment import Experiment, check_rows, frame_name, labelled_series, spread_evenly, squeezed
from anisogran.experiments.preparation import ATTEMPTS, LOOSE, background_drag, quasi_static_step, sphere_mass
from anisogran.glossary import attributes
from anisogran.outcome import InputError
from anisogran.runs.stages import Stage, equilibrium
from anisogran.scenes.keys import LARGEST_SEED, LENGTH, MANY, scene_key, scene_table

PRESSED = 0.82  # about that under pressure; it sets how many discs the outer ring carries
PROFILES = (
    "area_fraction", "velocity", "v_phi", "shear_rate", "spin", "continuum_spin", "eigen_rotation", "stress", "pressure", "stress_ratio",
    "s_D", "fabric", "fabric_trace", "fabric_deviator", "inertial_number",
)  # fmt: skip
SPACING = 1.5  # distance of the discs on a ring in mean diameters: their gap of d/2 holds a grain but lets none through


def wreath(radius, diameter):
    """Centres (n, 2) of discs on a circle, SPACING diameters apart."""
    count = round(2 * math.pi * radius / (SPACING * diameter))
    angle = 2 * math.pi * np.arange(count) / count
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


class RingShear(Experiment):
    """Ring shear cell of discs at constant outer pressure. Default units: mean diameter, outer pressure and density are 1.

    radii and diameters in m, pressure in N/m, wall_speed in m/s, mass of spheres. The inner ring travels `travel` mean diameters in
    all; `discard` of them are not averaged, and the rest is cut into blocks of `block` diameters for the error bars.
    """

    kind: ClassVar[str] = "ring_shear"
    output_keys: ClassVar[frozenset] = frozenset({"frames"})
    quick: ClassVar[dict] = {"n": 250, "inner_radius": 4.0, "travel": 10.0, "discard": 2.0, "block": 1.0}
    pressure: float = scene_key("N/m", "pressure on the outer ring", 1.0, above=0)
    contact: Linear | Luding = scene_table("normal contact law", Linear(stiffness=1000.0, damping=4.0))
    friction: Friction | None = scene_table("sliding friction; without it grains do not turn", Friction(stiffness=500.0, mu=0.44))
    n: int = scene_key("1", "number of free grains", 600, at_least=50, at_most=10_000_000)
    mean_diameter: float = scene_key("m", "mean diameter of the grains, and that of the discs on the rings", 1.0, **LENGTH)
    size_ratio: float = scene_key("1", "largest over smallest radius", 2.0, at_least=1, at_most=2.9)
    density: float = scene_key("kg/m3", "density of the grains, which have the mass of spheres", 1.0, above=0)
    inner_radius: float = scene_key("m", "radius of the inner ring, over the tops of its discs", 6.0, **LENGTH)
    wall_speed: float = scene_key("m/s", "speed of the inner ring at its radius", 0.04, above=0)
    travel: float = scene_key("1", "wall travel in mean diameters", 200.0, above=0, at_most=1e9)
    discard: float = scene_key("1", "wall travel before averaging begins, in mean diameters", 40.0, at_least=0, at_most=1e9)
    block: float = scene_key("1", "wall travel of a block for the error bars, in mean diameters", 20.0, above=0, at_most=1e9)
    samples_per_diameter: int = scene_key("1", "rows of the series per mean diameter of wall travel", 20, at_least=1, at_most=MANY)
    frames: int = scene_key("1", "snapshots of the averaged part that are kept", 20, at_least=0, at_most=MANY)
    seed: int = scene_key("1", "of the random start", 0, at_least=0, at_most=LARGEST_SEED)

    def check(self):
        if self.travel < self.discard + self.block:
            need = f"discard + block = {self.discard:g} + {self.block:g}"
            raise InputError(f"RingShear: travel = {self.travel:g} must be at least {need}, or there is nothing to average")
        if self.inner_radius < 2 * self.mean_diameter:
            raise InputError(f"RingShear: inner_radius = {self.inner_radius:g} m must be at least two mean diameters to carry a rough ring")
        if round(self.block * self.samples_per_diameter) < 1:
            raise InputError(f"RingShear: block = {self.block:g} holds no sample; there are {self.samples_per_diameter} in a diameter")
        check_rows("RingShear", travel=self.travel, samples_per_diameter=self.samples_per_diameter)
        discarded, samples, a_block = self.counts()
        if samples - discarded < a_block:  # travel, discard and block are rounded each
            raise InputError(
                f"RingShear: travel = {self.travel:g} less discard = {self.discard:g} leaves {samples - discarded} samples, "
                f"fewer than the {a_block} of a block"
            )
        # a disc of uniform radius with ratio q has the mean square (q^2 + q + 1) / (3 ((q + 1)/2)^2) of its mean radius
        q, d = self.size_ratio, self.mean_diameter
        area = self.n * np.pi * (0.5 * d) ** 2 * (q * q + q + 1) / (0.75 * (q + 1) ** 2)
        gap = math.sqrt(self.inner_radius**2 + area / (np.pi * PRESSED)) - self.inner_radius
        if gap < 4.5 * d:
            raise InputError(f"RingShear: n = {self.n} grains fill a gap of {gap / d:.1f} mean diameters; 4.5 are needed for profiles")

    def counts(self):
        """Samples that are not averaged, samples in all, and samples of a block."""
        return tuple(round(travel * self.samples_per_diameter) for travel in (self.discard, self.travel, self.block))

    def stages(self):
        """Relax: press together without friction, damped, until the outer ring is in equilibrium; shear: turn the inner ring."""
        radius, _ = self.radii()
        dt = quasi_static_step(self.contact, self.friction, sphere_mass(radius, self.density))
        between = max(1, round(self.mean_diameter / self.wall_speed / self.samples_per_diameter / dt))
        _, samples, _ = self.counts()
        gate = equilibrium(self.contact.stiffest, self.stress_error)
        return (
            Stage("relax", 5000 * np.arange(1, ATTEMPTS + 1), begin=self.loose, gate=gate, expected=15),
            Stage("shear", between * np.arange(samples + 1), begin=self.turned, look=self.look),
        )

    def radii(self):
        """Radii (N,) of the free grains, and the random numbers that come next."""
        rng = np.random.default_rng(self.seed)
        return uniform_radii(self.n, 0.5 * self.mean_diameter, self.size_ratio, rng), rng

    def loose(self, _):
        """The Simulation of a loose sample between the rings, the outer one pressed inwards."""
        d = self.mean_diameter
        radius, rng = self.radii()
        outer = math.sqrt(self.inner_radius**2 + np.sum(radius**2) / LOOSE)
        inner_ring = wreath(self.inner_radius - 0.5 * d, d)
        # as many discs as fit the compressed cell: they come closer together as the ring is pressed inwards
        pressed = math.sqrt(self.inner_radius**2 + np.sum(radius**2) / PRESSED)
        outer_ring = wreath(pressed + 0.5 * d, d)
        outer_ring *= (outer + 0.5 * d) / (pressed + 0.5 * d)

        def draw(rng, number):
            r = np.sqrt(rng.uniform(self.inner_radius**2, outer**2, number))
            phi = rng.uniform(0, 2 * math.pi, number)
            return np.stack([r * np.cos(phi), r * np.sin(phi)], axis=1)

        def inside(points, r):
            distance = np.hypot(*points.T)
            return (distance > self.inner_radius + r) & (distance < outer - r)

        rings = np.concatenate([inner_ring, outer_ring])
        position = random_positions(radius, draw, inside, rng)
        grains = Grains(
            np.concatenate([position, rings]),
            np.concatenate([radius, np.full(len(rings), 0.5 * d)]),
            density=self.density,
            driven=len(rings),
        )
        mass = float(grains.mass[: self.n].sum())
        piston = 0.2 * mass
        # close to critical for the piston on the sample, whose stiffness against the radius is about 2 pi k
        damping = 2 * math.sqrt(2 * math.pi * self.contact.stiffest * piston)
        # the smooth wall lies behind the centres of the wreath, where no grain comes
        boundary = Ring(outer + 0.5 * d, rim=Pressure(self.pressure, mass=piston, damping=damping), inner=len(inner_ring))
        free = grains.mass[: self.n]
        drag, dt = background_drag(self.contact, free), quasi_static_step(self.contact, self.friction, free)
        return Simulation(grains, self.contact, boundary=boundary, drag=drag, dt=dt)

    def stress_error(self, simulation):
        """How far the stress on the outer ring is from the pressure, relative."""
        return abs(self.measure(simulation)["outer_pressure"] / self.pressure - 1)

    def turned(self, prepared):
        """The Simulation of the prepared sample with friction, its inner ring about to turn."""
        outer = self.outer_radius(prepared)
        boundary = replace(prepared.boundary, radius=outer + 0.5 * self.mean_diameter, omega=self.wall_speed / self.inner_radius)
        return prepared.next_stage(boundary=boundary, friction=self.friction, drag=None)

    def place(self, simulation):
        """The Rings that are averaged over: one mean diameter wide, up to where the outer ring was at the start of the shear."""
        d = self.mean_diameter
        outer = simulation.boundary.radius - 0.5 * d
        return Rings(self.inner_radius + d * np.arange(math.floor((outer - self.inner_radius) / d) + 1), np.empty(0))

    def look(self, simulation, records, k):
        """Records a row, some snapshots, and after the discarded travel the sums for the profiles; before the first step a snapshot."""
        snapshot = simulation.snapshot()
        if k == 0:
            records.snapshots["start"] = snapshot
            return
        discarded, samples, a_block = self.counts()
        records.rows.append(self.measure(simulation))
        if k > discarded:
            records.add_to_blocks(densities(snapshot, self.place(simulation), extensive_needs(PROFILES)), a_block)
        if k in spread_evenly(self.frames, discarded, samples):
            records.snapshots[frame_name(k)] = snapshot
        records.snapshots["end"] = snapshot

    def fields(self, records, simulation):
        """Series; profiles and blocks, once there is a block."""
        series = labelled_series(records.rows, self.kind)
        if records.blocks is None or not records.blocks.means():
            return series, None, None
        profiles, blocks = field_profiles(records.blocks, self.place(simulation), PROFILES)
        depth = (profiles.r.values - self.inner_radius) / self.mean_diameter
        profiles = profiles.assign_coords(depth=("r", depth, attributes("depth")))
        return series, profiles, blocks

    def nominal_inertial_number(self):
        """Next to the inner ring, if the flow were one mean diameter wide."""
        return self.wall_speed / self.mean_diameter * math.sqrt(self.mean_mass() / self.pressure)

    def mean_mass(self):
        """Of a free grain, kg."""
        return float(sphere_mass(self.radii()[0], self.density).mean())

    def outer_radius(self, simulation):
        """Radius of the circle through the tops of the outer wreath."""
        return float(simulation.walls.position[0]) - 0.5 * self.mean_diameter

    def measure(self, simulation):
        """One row of the series, from the forces on the discs of both rings."""
        x, y = simulation.position[self.n :].T
        fx, fy = simulation.net_force[self.n :].T
        distance = np.hypot(x, y)
        radial = (x * fx + y * fy) / distance
        torque = x * fy - y * fx + simulation.torque[self.n :]
        inner, outer = np.split(np.arange(len(x)), [simulation.boundary.inner])
        walls, outer_radius = simulation.walls, self.outer_radius(simulation)
        length = 2 * math.pi * np.array([self.inner_radius, outer_radius])
        return {
            "time": simulation.time,
            "wall_shear_stress": float(-torque[inner].sum() / (self.inner_radius * length[0])),
            "wall_pressure": float(-radial[inner].sum() / length[0]),
            "outer_radius": outer_radius,
            "outer_pressure": float(radial[outer].sum() + walls.force[0]) / (2 * math.pi * float(walls.position[0])),
            "outer_shear_stress": float(torque[outer].sum() / (outer_radius * length[1])),
            "kinetic_energy": simulation.kinetic_energy(),
        }

    def steady(self, series):
        """The part of the series after the discarded travel."""
        return series.isel(time=series.time.values > self.discard * self.mean_diameter / self.wall_speed)

    def judge(self, series, blocks, simulation):
        """Warnings a reader must see: too few blocks, drift, stale neighbour lists."""
        status = squeezed(simulation)
        inertial = float(blocks.inertial_number.max())
        if inertial > 0.2:
            status = status.warn(f"inertial number up to {inertial:.2g}: far from quasi-static")
        pressure = float(series.outer_pressure[len(series.time) // 2 :].mean())
        if abs(pressure / self.pressure - 1) > 0.05:
            status = status.warn(f"the mean outer pressure is {pressure / self.pressure:.2f} times the one asked for")
        if blocks.sizes["block"] == 1:
            status = status.warn("one block only: no error bars")
        elif blocks.sizes["block"] < 5:
            status = status.warn(f"only {blocks.sizes['block']} blocks: the error bars are rough")
        else:
            moved = drift(blocks.v_phi.isel(r=1))
            if abs(moved) > 3:
                status = status.warn(f"not steady: the velocity in the second ring drifts by {moved:.1f} standard errors")
        if simulation.counters["late_builds"]:
            status = status.warn(f"{simulation.counters['late_builds']} neighbour lists were built late")
        return status
