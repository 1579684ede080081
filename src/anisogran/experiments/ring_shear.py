"""The reference ring shear cell: a rough inner ring turns, the outer ring is pressed inwards as a radial piston.

Both rings are wreaths of discs of the mean diameter with gaps in which grains nest; without that roughness the grains layer, roll and
slip, at the outer ring too, where the whole sample then creeps around. The radii of the cell are those of the circles through the tops
of the wreaths. The sample is pressed together from a random loose state, without friction unless a loose sample is wanted, and with
background damping; then friction is switched on, damping off, and the inner ring turns.
"""

import math
from dataclasses import replace
from typing import ClassVar

import numpy as np

from anisogran.dem import Pressure, Ring, Simulation
from anisogran.dem.packing import random_positions, uniform_radii
from anisogran.experiments.preparation import ATTEMPTS, LOOSE, background_drag, sphere_mass
from anisogran.experiments.ring_cell import RingCell, wreath
from anisogran.outcome import InputError
from anisogran.runs.stages import Stage, equilibrium
from anisogran.scenes.keys import LENGTH, scene_key

PRESSED = 0.82  # about that under pressure; it sets how many discs the outer ring carries
PISTON = 0.2  # mass of the outer ring by that of the sample


class RingShear(RingCell):
    """Ring shear cell of discs at constant outer pressure. Default units: mean diameter, outer pressure and density are 1.

    radii and diameters in m, pressure in N/m, wall_speed in m/s, mass of spheres. The inner ring travels `travel` mean diameters in
    all; `discard` of them are not averaged, and the rest is cut into blocks of `block` diameters for the error bars.
    """

    kind: ClassVar[str] = "ring_shear"
    quick: ClassVar[dict] = {"n": 250, "inner_radius": 4.0, "travel": 10.0, "discard": 2.0, "block": 1.0}
    pressure: float = scene_key("N/m", "pressure on the outer ring", 1.0, above=0)
    pressing_friction: float | None = scene_key(
        "1", "friction coefficient while the sample is pressed, which leaves it loose", None, above=0, at_most=10, example=0.5
    )
    n: int = scene_key("1", "number of free grains", 680, at_least=50, at_most=10_000_000)
    mean_diameter: float = scene_key("m", "mean diameter of the grains", 1.0, **LENGTH)
    size_ratio: float = scene_key("1", "largest over smallest radius", 2.0, at_least=1, at_most=2.9)
    density: float = scene_key("kg/m3", "density of the grains, which have the mass of spheres", 1.0, above=0)
    inner_radius: float = scene_key("m", "radius of the inner ring, over the tops of its discs", 8.0, **LENGTH)

    def check(self):
        super().check()
        if self.pressing_friction is not None and self.friction is None:
            raise InputError(
                f"RingShear: pressing_friction = {self.pressing_friction:g} needs the table friction, whose stiffness it takes"
            )
        # a disc of uniform radius with ratio q has the mean square (q^2 + q + 1) / (3 ((q + 1)/2)^2) of its mean radius
        q, d = self.size_ratio, self.mean_diameter
        area = self.n * np.pi * (0.5 * d) ** 2 * (q * q + q + 1) / (0.75 * (q + 1) ** 2)
        self.check_rings(d / (1 + q), math.sqrt(self.inner_radius**2 + area / (np.pi * PRESSED)) - self.inner_radius)

    def stages(self):
        """Relax: press together, damped, until the outer ring is in equilibrium; shear: turn the inner ring."""
        gate = equilibrium(self.contact.stiffest, self.stress_error)
        return (
            Stage("relax", 5000 * np.arange(1, ATTEMPTS + 1), begin=self.loose, gate=gate, expected=15),
            Stage("shear", self.shearing_marks(), begin=self.turned, look=self.look),
        )

    def radii(self):
        """Radii (N,) of the free grains, and the random numbers that come next."""
        rng = np.random.default_rng(self.seed)
        return uniform_radii(self.n, 0.5 * self.mean_diameter, self.size_ratio, rng), rng

    def mass(self):
        """Masses (N,) of the free grains in kg."""
        return sphere_mass(self.radii()[0], self.density)

    def loose(self, _):
        """The Simulation of a loose sample between the rings, the outer one pressed inwards."""
        radius, rng = self.radii()
        disc, spacing = 0.5 * self.wall_disc * self.mean_diameter, self.wall_spacing * self.mean_diameter
        outer, pressed = (math.sqrt(self.inner_radius**2 + np.sum(radius**2) / share) for share in (LOOSE, PRESSED))
        inner_ring = wreath(self.inner_radius - disc, spacing)
        # as many discs as fit the compressed cell: they come closer together as the ring is pressed inwards
        outer_ring = wreath(pressed + disc, spacing) * (outer + disc) / (pressed + disc)

        def draw(rng, number):
            r = np.sqrt(rng.uniform(self.inner_radius**2, outer**2, number))
            phi = rng.uniform(0, 2 * math.pi, number)
            return np.stack([r * np.cos(phi), r * np.sin(phi)], axis=1)

        def inside(points, r):
            distance = np.hypot(*points.T)
            return (distance > self.inner_radius + r) & (distance < outer - r)

        grains = self.grains(random_positions(radius, draw, inside, rng), np.concatenate([inner_ring, outer_ring]))
        mass = self.mass()
        piston = PISTON * float(mass.sum())
        # close to critical for the piston on the sample, whose stiffness against the radius is about 2 pi k
        damping = 2 * math.sqrt(2 * math.pi * self.contact.stiffest * piston)
        # the smooth wall lies behind the centres of the wreath, where no grain comes
        boundary = Ring(outer + disc, rim=Pressure(self.pressure, mass=piston, damping=damping), inner=len(inner_ring))
        friction = None
        if self.pressing_friction is not None:
            friction = replace(self.friction, mu=self.pressing_friction, mu_dynamic=None)
        drag = background_drag(self.contact, mass)
        return Simulation(grains, self.contact, friction=friction, boundary=boundary, drag=drag, dt=self.step())

    def stress_error(self, simulation):
        """How far the stress on the outer ring is from the pressure, relative."""
        return abs(self.measure(simulation)["outer_pressure"] / self.pressure - 1)

    def turned(self, prepared):
        """The Simulation of the prepared sample with friction, its inner ring about to turn."""
        radius = float(prepared.walls.position[0])
        boundary = replace(prepared.boundary, radius=radius, omega=self.wall_speed / self.inner_radius)
        return prepared.next_stage(boundary=boundary, friction=self.friction, drag=None)

    def outer_wall(self, radius):
        """Radius of the circle through the tops of the outer wreath; the smooth wall goes through the centres."""
        return radius - 0.5 * self.wall_disc * self.mean_diameter

    def nominal_pressure(self):
        """The one on the outer ring."""
        return self.pressure

    def judge(self, series, blocks, simulation):
        """Warnings of the cell, and whether the pressure was held."""
        status = super().judge(series, blocks, simulation)
        pressure = float(series.outer_pressure[len(series.time) // 2 :].mean())
        if abs(pressure / self.pressure - 1) > 0.05:
            status = status.warn(f"the mean outer pressure is {pressure / self.pressure:.2f} times the one asked for")
        return status
