"""What every two-dimensional ring shear cell shares: two rings that carry discs, the inner one turning, and how the flow is averaged.

How the outer ring is held (under a pressure, at a given radius) and of which grains the sample is made is up to each experiment.
"""

import math
from functools import cached_property
from typing import ClassVar

import numpy as np

from anisogran.averaging import (
    Rings,
    chance_drift,
    circle_sums,
    densities,
    drift,
    extensive_needs,
    field_profiles,
    layer_fields,
    layer_sums,
    with_errors,
)  # fmt: skip
from anisogran.dem import Friction, Grains, Linear, Luding
from anisogran.experiments.experiment import Experiment, check_rows, frame_name, labelled_series, spread_evenly, squeezed
from anisogran.experiments.preparation import quasi_static_step
from anisogran.glossary import attributes
from anisogran.outcome import InputError
from anisogran.scenes.keys import LARGEST_SEED, MANY, scene_key, scene_table

PROFILES = (
    "area_fraction", "velocity", "v_phi", "shear_rate", "spin", "continuum_spin", "eigen_rotation", "stress", "pressure", "stress_ratio",
    "s_D", "fabric", "fabric_trace", "fabric_deviator", "inertial_number", "bulk_modulus", "shear_modulus", "stress_angle", "fabric_angle",
    "elastic_strain_angle", "strain_rate_angle", "fabric_to_stress_angle", "strain_to_stress_angle", "rate_to_stress_angle",
    "rate_to_fabric_angle",
)  # fmt: skip
COUPLES = ("couple_stress", "curvature", "torque_stiffness")  # without friction nothing turns the grains
CUTS = ("cut_pressure", "cut_shear_stress")
LAYER = 0.1  # width of the layers in mean diameters


def wreath(radius, spacing):
    """Centres (n, 2) of discs on a circle, as nearly `spacing` apart as goes around."""
    angle = 2 * math.pi * np.arange(count := round(2 * math.pi * radius / spacing)) / count
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


class RingCell(Experiment):
    """A ring shear cell in the plane: radii in m, wall_speed in m/s; travel, discard and block of the inner ring in mean diameters.

    Both rings carry discs of `wall_disc` mean diameters, `wall_spacing` from centre to centre: discs as large as the grains with gaps in
    which these nest make them rough; small discs that touch make them smooth. `discard` of the travel is not averaged, and the rest is
    cut into blocks of `block` diameters for the error bars. A subclass has `inner_radius`, `mean_diameter`, `radii()` and `mass()`.
    """

    output_keys: ClassVar[frozenset] = frozenset({"frames"})
    contact: Linear | Luding = scene_table("normal contact law", Linear(stiffness=1000.0, damping=4.0))
    friction: Friction | None = scene_table("sliding friction; without it grains do not turn", Friction(stiffness=500.0, mu=0.44))
    wall_disc: float = scene_key("1", "diameter of the discs on the rings, in mean diameters of the grains", 1.0, above=0, at_most=10)
    wall_spacing: float = scene_key("1", "from disc to disc along the rings, in mean diameters", 1.5, at_least=0.05, at_most=10)
    wall_speed: float = scene_key("m/s", "speed of the inner ring at its radius", 0.04, above=0)
    travel: float = scene_key("1", "wall travel in mean diameters", 120.0, above=0, at_most=1e9)
    discard: float = scene_key("1", "wall travel before averaging begins, in mean diameters", 20.0, at_least=0, at_most=1e9)
    block: float = scene_key("1", "wall travel of a block for the error bars, in mean diameters", 20.0, above=0, at_most=1e9)
    contact_steps: float = scene_key("1", "time steps in the shortest contact time", 20.0, at_least=5, at_most=1000)
    samples_per_diameter: int = scene_key("1", "rows of the series per mean diameter of wall travel", 10, at_least=1, at_most=MANY)
    frames: int = scene_key("1", "snapshots of the averaged part that are kept", 20, at_least=0, at_most=MANY)
    seed: int = scene_key("1", "of the random start", 0, at_least=0, at_most=LARGEST_SEED)

    def check(self):
        name, d = type(self).__name__, self.mean_diameter
        if self.travel < self.discard + self.block:
            need = f"discard + block = {self.discard:g} + {self.block:g}"
            raise InputError(f"{name}: travel = {self.travel:g} must be at least {need}, or there is nothing to average")
        if self.inner_radius < 2 * d:
            raise InputError(f"{name}: inner_radius = {self.inner_radius:g} m must be at least two mean diameters to carry a rough ring")
        if round(self.block * self.samples_per_diameter) < 1:
            raise InputError(f"{name}: block = {self.block:g} holds no sample; there are {self.samples_per_diameter} in a diameter")
        check_rows(name, travel=self.travel, samples_per_diameter=self.samples_per_diameter)
        discarded, samples, a_block = self.counts()
        if samples - discarded < a_block:  # travel, discard and block are rounded each
            raise InputError(
                f"{name}: travel = {self.travel:g} less discard = {self.discard:g} leaves {samples - discarded} samples, "
                f"fewer than the {a_block} of a block"
            )

    def check_rings(self, smallest, gap):
        """Raises InputError if grains of the smallest radius fit through the rings, or the gap between these (both in m) is too narrow."""
        name, d = type(self).__name__, self.mean_diameter
        reach, half = smallest + 0.5 * self.wall_disc * d, 0.5 * self.wall_spacing * d
        if reach**2 - half**2 < smallest**2:
            widest = 2 * math.sqrt(reach**2 - smallest**2) / d
            raise InputError(
                f"{name}: wall_spacing = {self.wall_spacing:g} must be at most {widest:.3g} with wall_disc = {self.wall_disc:g}, or the "
                f"smallest grains touch what is behind the discs"
            )
        if gap < 4.5 * d:
            raise InputError(f"{name}: the grains fill a gap of {gap / d:.1f} mean diameters; 4.5 are needed for profiles")

    def counts(self):
        """Samples that are not averaged, samples in all, and samples of a block."""
        return tuple(round(travel * self.samples_per_diameter) for travel in (self.discard, self.travel, self.block))

    def step(self):
        """The time step in s."""
        return quasi_static_step(self.contact, self.friction, self.mass(), self.contact_steps)

    def shearing_marks(self):
        """The steps of the shear at which it is looked at."""
        between = max(1, round(self.mean_diameter / self.wall_speed / self.samples_per_diameter / self.step()))
        return between * np.arange(self.counts()[1] + 1)

    def grains(self, position, rings, **more):
        """The Grains at these positions, and the discs at `rings` (n, 2) on the rings, as heavy as a mean grain."""
        radius, mass = self.radii()[0], self.mass()
        discs = np.full(len(rings), 0.5 * self.wall_disc * self.mean_diameter)
        masses = np.concatenate([mass, np.full(len(rings), mass.mean())])
        return Grains(np.concatenate([position, rings]), np.concatenate([radius, discs]), mass=masses, driven=len(rings), **more)

    # what is measured

    def edges(self, count):
        """Those of `count` rings, one mean diameter wide from the inner ring outwards, in m."""
        return self.inner_radius + self.mean_diameter * np.arange(count + 1)

    def circles(self, count):
        """The circles on which the stress is measured: those edges, the innermost just outside of the centres of discs that lie on it."""
        return self.edges(count) + self.mean_diameter * np.concatenate([[1e-6], np.zeros(count)])

    def layer_edges(self, count):
        """Those of the layers of `count` rings, from a radius inside the inner ring on, for grains that nest between its discs."""
        thin = LAYER * self.mean_diameter
        return self.inner_radius + thin * np.arange(-round(0.5 / LAYER), round(count / LAYER) + 1)

    @property
    def profile_names(self):
        """The fields of the profiles."""
        return PROFILES if self.friction is None else PROFILES + COUPLES

    @cached_property
    def profile_needs(self):
        """What is summed for them."""
        return extensive_needs(self.profile_names)

    def look(self, simulation, records, k):
        """Records a row, some snapshots, and after the discarded travel the sums for the profiles; before the first step a snapshot."""
        snapshot = simulation.snapshot()
        if k == 0:
            records.snapshots["start"] = snapshot
            return
        discarded, samples, a_block = self.counts()
        # up to where the outer ring was at the start of the shear
        count = math.floor((self.outer_wall(simulation.boundary.radius) - self.inner_radius) / self.mean_diameter)
        edges = self.edges(count)
        cuts = circle_sums(snapshot, self.circles(count))
        records.rows.append(self.measure(simulation) | {"wall_pressure": float(cuts["cut_pressure"][0])})
        if k > discarded:
            rings = densities(snapshot, Rings(edges, np.empty(0)), self.profile_needs)
            records.add_to_blocks(rings | cuts | layer_sums(snapshot, self.layer_edges(count)), a_block)
        if k in spread_evenly(self.frames, discarded, samples):
            records.snapshots[frame_name(k)] = snapshot
        records.snapshots["end"] = snapshot

    def fields(self, records, simulation):
        """Series; profiles and blocks, once there is a block."""
        series = labelled_series(records.rows, self.kind)
        if records.blocks is None or not records.blocks.means():
            return series, None, None
        count = len(records.blocks.mean()["cut_pressure"]) - 1
        profiles, blocks = field_profiles(records.blocks, Rings(self.edges(count), np.empty(0)), self.profile_names)
        return series, profiles.assign_coords(depth=self.depth(profiles.r.values)), blocks

    def depth(self, r):
        """The coordinate of that name at the radii r."""
        return "r", (r - self.inner_radius) / self.mean_diameter, attributes("depth")

    def tables(self, records):
        """Group "circles", the stress on the edges of the rings, and "layers", the motion of the grains by the places of their centres.

        Of the mean over time with errors from the blocks, as the profiles; nothing before there is a block.
        """
        if records.blocks is None or not records.blocks.means():
            return {}
        count = len(records.blocks.mean()["cut_pressure"]) - 1
        edges = self.layer_edges(count)

        def motion(sums):
            return layer_fields(sums, edges, self.mean_diameter)

        return {
            "circles": self.on_circles(records.blocks, self.circles(count), lambda sums: {name: sums[name] for name in CUTS}),
            "layers": self.on_circles(records.blocks, 0.5 * (edges[1:] + edges[:-1]), motion),
        }

    def on_circles(self, blocks, r, fields):
        """The Dataset of what `fields` makes of the sums at the radii r, with errors from the blocks."""
        coords = {"r": ("r", r, attributes("r")), "depth": self.depth(r)}
        return with_errors(blocks, fields, coords).assign_attrs(frame="(r, phi)")

    def outer_wall(self, radius):
        """Radius of the circle of the outer ring that bounds the sample, from that of the smooth wall behind it; both in m."""
        return radius

    def present_radius(self, simulation):
        """Present radius of the outer ring in m."""
        return self.outer_wall(float(simulation.walls.position[0]))

    def measure(self, simulation):
        """A row of the series but for the pressure on the inner ring, from the forces on the discs of both rings."""
        free = len(simulation.grains) - simulation.grains.driven
        x, y = simulation.position[free:].T
        fx, fy = simulation.net_force[free:].T
        radial = (x * fx + y * fy) / np.hypot(x, y)
        torque = x * fy - y * fx + simulation.torque[free:]
        inner, outer = np.split(np.arange(len(x)), [simulation.boundary.inner])
        walls, outer_radius = simulation.walls, self.present_radius(simulation)
        length = 2 * math.pi * np.array([self.inner_radius, outer_radius])
        return {
            "time": simulation.time,
            "turns": simulation.time * simulation.boundary.omega / (2 * math.pi),
            "wall_shear_stress": float(-torque[inner].sum() / (self.inner_radius * length[0])),
            "outer_radius": outer_radius,
            "outer_pressure": float(radial[outer].sum() + walls.force[0]) / (2 * math.pi * float(walls.position[0])),
            "outer_shear_stress": float(torque[outer].sum() / (outer_radius * length[1])),
            "kinetic_energy": simulation.kinetic_energy(),
        }

    def steady(self, series):
        """The part of the series after the discarded travel."""
        return series.isel(time=series.time.values > self.discard * self.mean_diameter / self.wall_speed)

    def nominal_pressure(self):
        """What the inertial number is estimated with beforehand, in N/m."""
        raise NotImplementedError

    def nominal_inertial_number(self):
        """Next to the inner ring, if the flow were one mean diameter wide."""
        return self.wall_speed / self.mean_diameter * math.sqrt(float(self.mass().mean()) / self.nominal_pressure())

    def judge(self, series, blocks, simulation):
        """Warnings a reader must see: too few blocks, drift, stale neighbour lists."""
        status = squeezed(simulation)
        inertial = float(blocks.inertial_number.max())
        if inertial > 0.2:
            status = status.warn(f"inertial number up to {inertial:.2g}: far from quasi-static")
        count = blocks.sizes["block"]
        if count == 1:
            status = status.warn("one block only: no error bars")
        elif count < 5:
            status = status.warn(f"only {count} blocks: the error bars are rough")
        watched = self.watched(series, blocks) if count > 1 else {}
        for name, values in watched.items():
            if abs(moved := drift(values)) > chance_drift(count):
                status = status.warn(f"not steady: the {name} drifts by {moved:.1f} standard errors")
        if simulation.counters["late_builds"]:
            status = status.warn(f"{simulation.counters['late_builds']} neighbour lists were built late")
        return status

    def watched(self, series, blocks):
        """{name: its means over the blocks} of what has to be steady."""
        means = self.block_means(series, blocks.sizes["block"])
        return {
            "stress ratio of the inner ring": means["wall_shear_stress"] / means["wall_pressure"],
            "outer radius": means["outer_radius"],
            "velocity in the second ring": blocks.v_phi.isel(r=1).values,
            "area fraction of the five innermost rings": blocks.area_fraction.isel(r=slice(0, 5)).mean("r").values,
            "stress ratio of the outermost ring": blocks.stress_ratio.isel(r=-1).values,
        }

    def block_means(self, series, count):
        """{name: its means over each of the `count` blocks of the profiles} of the variables of the series."""
        discarded, _, a_block = self.counts()
        rows = series.isel(time=slice(discarded, discarded + count * a_block))
        return {name: values.values.reshape(count, a_block).mean(axis=1) for name, values in rows.data_vars.items()}
