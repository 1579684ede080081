"""The lecture's ring shear cell: two rigid rings at a constant distance, between them a given number of small and large discs.

The numbers are those of run B of the lecture's simulations of the experiment of Howell, Veje & Behringer, recalled from memory: 2545 small
and 394 large discs of 6 mm height, small half discs on both rings, one turn a minute. The distance of these half discs is not recalled;
5 mm, twice their diameter, is a choice that lets no grain touch the ring between them. Without friction at the bottom.

At constant volume the stress is an outcome: while the shear zone dilates the rest of the sample becomes denser, for many turns, and the
pressure changes by an order of magnitude with it. So stresses are told over the pressure on the inner ring in the same block, too.
"""

import math
from typing import ClassVar

import numpy as np
import xarray as xr

from anisogran.averaging import standard_error
from anisogran.dem import Friction, Linear, Luding, Ring, Simulation, relaxed
from anisogran.experiments.preparation import ATTEMPTS, background_drag
from anisogran.experiments.ring_cell import RingCell, wreath
from anisogran.glossary import attributes
from anisogran.outcome import InputError
from anisogran.runs.stages import Stage
from anisogran.scenes.keys import LENGTH, scene_key, scene_table

DENSEST = 0.9  # area fraction beyond which discs are no packing any more
SETTLING = 500  # steps between two looks whether the grains have come to rest
MOVED = 1.2  # ratio of the pressures of two blocks that is worth a warning
DISC = 0.5  # moment of inertia of a disc over mass times radius^2


class RingShearVolume(RingCell):
    """Ring shear cell of two sizes of discs at constant volume, in SI units: radii and diameters in m, wall_speed in m/s.

    The discs have the mass of cylinders of `height`; the centres of the half discs of the rings are at `inner_radius` and `outer_radius`.
    """

    kind: ClassVar[str] = "ring_shear_volume"
    quick: ClassVar[dict] = {
        "n": 207, "large": 27, "inner_radius": 0.04, "outer_radius": 0.076, "travel": 12.0, "discard": 2.0, "block": 2.0,
    }  # fmt: skip
    contact: Linear | Luding = scene_table("normal contact law", Linear(stiffness=352.1, damping=0.19))
    friction: Friction | None = scene_table(
        "sliding friction; without it grains do not turn", Friction(stiffness=176.05, mu=0.44, damping=0.15)
    )
    n: int = scene_key("1", "number of free discs", 2939, at_least=50, at_most=10_000_000)
    large: int = scene_key("1", "how many of them are large", 394, at_least=0, at_most=10_000_000)
    small_diameter: float = scene_key("m", "diameter of the small discs", 7.42e-3, **LENGTH)
    large_diameter: float = scene_key("m", "diameter of the large discs", 8.99e-3, **LENGTH)
    height: float = scene_key("m", "of the discs, for their mass", 6e-3, **LENGTH)
    density: float = scene_key("kg/m3", "density of the discs", 1060.0, above=0)
    inner_radius: float = scene_key("m", "radius of the inner ring, through the centres of its half discs", 0.1032, **LENGTH)
    outer_radius: float = scene_key("m", "radius of the outer ring, through the centres of its half discs", 0.2524, **LENGTH)
    wall_disc: float = scene_key("1", "diameter of the discs on the rings, in mean diameters of the grains", 0.3276, above=0, at_most=10)
    wall_spacing: float = scene_key("1", "from disc to disc along the rings, in mean diameters", 0.6553, at_least=0.05, at_most=10)
    wall_speed: float = scene_key("m/s", "speed of the inner ring at its radius", 0.010807, above=0)
    travel: float = scene_key("1", "wall travel in mean diameters", 255.0, above=0, at_most=1e9)
    discard: float = scene_key("1", "wall travel before averaging begins, in mean diameters", 85.0, at_least=0, at_most=1e9)
    block: float = scene_key("1", "wall travel of a block for the error bars, in mean diameters", 21.25, above=0, at_most=1e9)

    def check(self):
        if self.outer_radius <= self.inner_radius:
            raise InputError(
                f"RingShearVolume: outer_radius = {self.outer_radius:g} m must be above inner_radius = {self.inner_radius:g} m"
            )
        if self.large > self.n:
            raise InputError(f"RingShearVolume: large = {self.large} must be at most n = {self.n}")
        super().check()
        share = float(np.sum(self.radii()[0] ** 2)) / (self.outer_radius**2 - self.inner_radius**2)
        if share > DENSEST:
            raise InputError(f"RingShearVolume: n = {self.n} discs fill {share:.3f} of the cell; at most {DENSEST:g}")
        self.check_rings(0.5 * min(self.small_diameter, self.large_diameter), self.outer_radius - self.inner_radius)

    @property
    def mean_diameter(self):
        """Of the grains, in m."""
        return self.small_diameter + self.large / self.n * (self.large_diameter - self.small_diameter)

    def radii(self):
        """Radii (N,) of the free grains, and the random numbers that come next."""
        radius = np.repeat([0.5 * self.small_diameter, 0.5 * self.large_diameter], [self.n - self.large, self.large])
        return radius, np.random.default_rng(self.seed)

    def mass(self):
        """Masses (N,) of the free grains in kg."""
        return self.density * self.height * np.pi * self.radii()[0] ** 2

    def stages(self):
        """Settle: random discs moved apart come to rest, without friction and damped; shear: turn the inner ring."""
        return (
            Stage("settle", SETTLING * np.arange(1, ATTEMPTS + 1), begin=self.scattered, gate=self.calm, expected=4),
            Stage("shear", self.shearing_marks(), begin=self.turned, look=self.look),
        )

    def scattered(self, _):
        """The Simulation of discs at random in the cell, moved apart."""
        radius, rng = self.radii()
        disc, spacing = 0.5 * self.wall_disc * self.mean_diameter, self.wall_spacing * self.mean_diameter
        inner, outer = self.inner_radius + disc + radius, self.outer_radius - disc - radius
        r, phi = np.sqrt(rng.uniform(inner**2, outer**2)), rng.uniform(0, 2 * math.pi, len(radius))
        rings = [wreath(self.inner_radius, spacing), wreath(self.outer_radius, spacing)]
        grains = self.grains(r[:, None] * np.stack([np.cos(phi), np.sin(phi)], axis=1), np.concatenate(rings), inertia_factor=DISC)
        # in between the rings are walls, so that no grain is pushed through
        apart = relaxed(grains, Ring(self.outer_radius, inner_radius=self.inner_radius))
        boundary = Ring(self.outer_radius, inner=len(rings[0]))
        return Simulation(apart, self.contact, boundary=boundary, drag=background_drag(self.contact, self.mass()), dt=self.step())

    def calm(self, simulation):
        """A gate: the grains move less than a hundredth as fast as the inner ring will."""
        energy = 0.5e-4 * float(self.mass().sum()) * self.wall_speed**2
        kinetic = simulation.kinetic_energy()
        return "" if kinetic < energy else f"E_kin = {kinetic:.2g} J (wanted < {energy:.2g} J, that of a hundredth of the wall speed)"

    def turned(self, prepared):
        """The Simulation of the prepared sample with friction, its inner ring about to turn."""
        boundary = Ring(self.outer_radius, inner=prepared.boundary.inner, omega=self.wall_speed / self.inner_radius)
        return prepared.next_stage(boundary=boundary, friction=self.friction, drag=None)

    def nominal_pressure(self):
        """A thousandth of the stiffness: at constant volume it is an outcome."""
        return 1e-3 * self.contact.stiffest

    def fields(self, records, simulation):
        """Series, profiles and blocks; with the stress over the pressure on the inner ring, both of the same block."""
        series, profiles, blocks = super().fields(records, simulation)
        if blocks is None:
            return series, profiles, blocks
        pressure = xr.DataArray([sums["cut_pressure"][0] for sums in records.blocks.means()], dims="block")
        told = attributes("relative_stress")
        relative = (blocks.stress / pressure.where(pressure > 0)).transpose(*blocks.stress.dims)
        error, _ = standard_error(relative.values)
        profiles = profiles.assign(
            relative_stress=relative.mean("block").assign_attrs(told),
            relative_stress_error=(profiles.stress.dims, error, {**told, "long_name": f"standard error of: {told['long_name']}"}),
        )
        return series, profiles, blocks.assign(relative_stress=relative.assign_attrs(told))

    def judge(self, series, blocks, simulation):
        """Warnings of the cell, and by how much the pressure has changed."""
        status = super().judge(series, blocks, simulation)
        pressure = self.block_means(series, blocks.sizes["block"])["wall_pressure"]
        if pressure.max() > MOVED * pressure.min():
            told = f"from {pressure[0]:.3g} to {pressure[-1]:.3g} N/m, {pressure.min():.3g} to {pressure.max():.3g} in all"
            status = status.warn(f"at constant volume the pressure on the inner ring went {told}: take stresses relative to it")
        return status
