"""The lecture's two-dimensional ring shear cell: a rough inner ring turns, the outer ring is pressed inwards as a radial piston.

Both rings are wreaths of discs of the mean diameter with gaps in which grains nest; without that roughness the grains layer, roll and
slip, at the outer ring too, where the whole sample then creeps around. The radii of the cell are those of the circles through the tops
of the wreaths. The sample is pressed together from a random loose state without friction and with background damping; then friction
is switched on, damping off, and the inner ring turns.
"""

import math
from dataclasses import replace

import numpy as np
from pydantic import Field

from anisogran.averaging import Rings, TimeBlocks, densities, drift, extensive_needs, field_profiles
from anisogran.dem import Friction, Grains, Linear, Luding, Pressure, Ring, Simulation
from anisogran.dem.packing import random_positions, uniform_radii
from anisogran.experiments.experiment import Experiment, Run, Watch, frame_name, labelled_series, provenance, spread_evenly, squeezed
from anisogran.experiments.preparation import LOOSE, background_drag, quasi_static_step, relax
from anisogran.glossary import attributes
from anisogran.outcome import InputError

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

    pressure: float = Field(1.0, gt=0, description="outer pressure, N/m")
    contact: Linear | Luding = Linear(stiffness=1000.0, damping=4.0)
    friction: Friction | None = Friction(stiffness=500.0, mu=0.44)
    grains: int = Field(600, ge=50, le=10_000_000, description="free grains")
    mean_diameter: float = Field(1.0, gt=0, description="m")
    size_ratio: float = Field(2.0, ge=1, le=2.9)
    density: float = Field(1.0, gt=0, description="kg/m3")
    inner_radius: float = Field(6.0, gt=0, description="m")
    wall_speed: float = Field(0.04, gt=0, description="m/s at the inner radius")
    travel: float = Field(200.0, gt=0, description="mean diameters of wall travel")
    discard: float = Field(40.0, ge=0, description="mean diameters of wall travel")
    block: float = Field(20.0, gt=0, description="mean diameters of wall travel")
    samples_per_diameter: int = Field(20, ge=1)
    frames: int = Field(20, ge=0, description="snapshots of the averaged part that are kept")
    seed: int = Field(0, ge=0)

    def check(self):
        if self.travel < self.discard + self.block:
            need = f"discard + block = {self.discard:g} + {self.block:g}"
            raise InputError(f"RingShear: travel = {self.travel:g} must be at least {need}, or there is nothing to average")
        if self.inner_radius < 2 * self.mean_diameter:
            raise InputError(f"RingShear: inner_radius = {self.inner_radius:g} m must be at least two mean diameters to carry a rough ring")
        if round(self.block * self.samples_per_diameter) < 1:
            raise InputError(f"RingShear: block = {self.block:g} holds no sample; there are {self.samples_per_diameter} in a diameter")
        # a disc of uniform radius with ratio q has the mean square (q^2 + q + 1) / (3 ((q + 1)/2)^2) of its mean radius
        q, d = self.size_ratio, self.mean_diameter
        area = self.grains * np.pi * (0.5 * d) ** 2 * (q * q + q + 1) / (0.75 * (q + 1) ** 2)
        gap = math.sqrt(self.inner_radius**2 + area / (np.pi * PRESSED)) - self.inner_radius
        if gap < 4.5 * d:
            raise InputError(f"RingShear: grains = {self.grains} fill a gap of {gap / d:.1f} mean diameters; 4.5 are needed for profiles")

    def run(self, progress=None):
        """The Run: series over time, profiles over r with errors, snapshots "start" and "end". Raises RunFailed without equilibrium."""
        watch = Watch(progress)
        return self.shear(self.prepare(watch), watch)

    def prepare(self, watch):
        """A Simulation in equilibrium under the outer pressure, frictionless, with the inner ring at rest."""
        rng = np.random.default_rng(self.seed)
        d = self.mean_diameter
        radius = uniform_radii(self.grains, 0.5 * d, self.size_ratio, rng)
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
        mass = float(grains.mass[: self.grains].sum())
        piston = 0.2 * mass
        # close to critical for the piston on the sample, whose stiffness against the radius is about 2 pi k
        damping = 2 * math.sqrt(2 * math.pi * self.contact.stiffest * piston)
        # the smooth wall lies behind the centres of the wreath, where no grain comes
        boundary = Ring(outer + 0.5 * d, rim=Pressure(self.pressure, mass=piston, damping=damping), inner=len(inner_ring))
        free = grains.mass[: self.grains]
        drag, dt = background_drag(self.contact, free), quasi_static_step(self.contact, self.friction, free)
        simulation = Simulation(grains, self.contact, boundary=boundary, drag=drag, dt=dt)

        def stress_error():
            return abs(self.measure(simulation)["outer_pressure"] / self.pressure - 1)

        relax(simulation, watch, self.contact.stiffest, stress_error, chunk=5000)
        watch.progress(0.05)
        return simulation

    def shear(self, prepared, watch):
        """Turns the inner ring and averages."""
        d = self.mean_diameter
        outer = self.outer_radius(prepared)
        boundary = replace(prepared.boundary, radius=outer + 0.5 * d, omega=self.wall_speed / self.inner_radius)
        simulation = prepared.next_stage(boundary=boundary, friction=self.friction, drag=None)
        edges = self.inner_radius + d * np.arange(math.floor((outer - self.inner_radius) / d) + 1)
        between = max(1, round(d / self.wall_speed / self.samples_per_diameter / simulation.dt))
        samples = round(self.travel * self.samples_per_diameter)
        a_block = round(self.block * self.samples_per_diameter)
        discarded = round(self.discard * self.samples_per_diameter)
        place, needs = Rings(edges, np.empty(0)), extensive_needs(PROFILES)
        rows, blocks = [], TimeBlocks(a_block)
        snapshots = {"start": simulation.snapshot()}
        kept = spread_evenly(self.frames, discarded, samples)
        for k in range(1, samples + 1):
            watch.run(simulation, between)
            snapshot = simulation.snapshot()
            rows.append(self.measure(simulation))
            if k > discarded:
                blocks.add(densities(snapshot, place, needs))
            if k in kept:
                snapshots[frame_name(k)] = snapshot
            watch.progress(0.05 + 0.95 * k / samples)
        snapshots["end"] = snapshot
        profiles, blocks = field_profiles(blocks, place, PROFILES)
        profiles = profiles.assign_coords(depth=("r", (profiles.r.values - self.inner_radius) / d, attributes("depth")))
        series = labelled_series(rows, "ring_shear")
        status = self.judge(blocks, series, simulation)
        return Run(self, series, profiles, blocks, snapshots, status, provenance(self, watch, simulation))

    def outer_radius(self, simulation):
        """Radius of the circle through the tops of the outer wreath."""
        return float(simulation.walls.position[0]) - 0.5 * self.mean_diameter

    def measure(self, simulation):
        """One row of the series, from the forces on the discs of both rings."""
        x, y = simulation.position[self.grains :].T
        fx, fy = simulation.net_force[self.grains :].T
        distance = np.hypot(x, y)
        radial = (x * fx + y * fy) / distance
        torque = x * fy - y * fx + simulation.torque[self.grains :]
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

    def judge(self, blocks, series, simulation):
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
