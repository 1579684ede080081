"""Stiffness along a biaxial test: E, A, B and G of states at rest, from small probes of them and from their fabric.

The cell is periodic, so that the sample can be sheared across the axes of the test too. It is pressed together under equal pressures
without friction and adhesion; then its height shrinks at a steady rate while the width follows the pressure. At some strains the height is
stopped, the grains come to rest, and copies of the state are probed (probing.py); the state itself goes on as if nothing had happened.
"""

import math
from dataclasses import replace
from typing import ClassVar

import numpy as np

from anisogran.averaging import average
from anisogran.averaging.directions import contact_network
from anisogran.dem import Friction, Grains, Linear, Luding, Periodic, Simulation
from anisogran.dem.packing import uniform_radii
from anisogran.experiments.biaxial import BEARING
from anisogran.experiments.experiment import Experiment, frame_name, labelled_series, squeezed
from anisogran.experiments.preparation import (
    ATTEMPTS,
    LOOSE,
    background_drag,
    positions_in_cell,
    quasi_static_step,
    sphere_mass,
    time_steps,
)
from anisogran.experiments.probed_state import moduli_row, probe_row, tables_of
from anisogran.experiments.probing import contact_stress, imbalance, in_cell, probes
from anisogran.models import network_moduli
from anisogran.outcome import InputError
from anisogran.runs.stages import Stage, equilibrium
from anisogran.scenes.keys import LARGEST_SEED, LENGTH, scene_key, scene_table

VERTICAL = 0.5 * math.pi  # angle of the axis of the test, and of the structure
CLOSING = 0.01  # strain rate of the sides while nothing resists, in units of sqrt(pressure/mean mass)
LAG = 0.01  # of the pressure: how far the horizontal stress stays behind it, while the width grows as fast as the height shrinks
WAYS, LENGTHS = 12, 7  # of the probes of a state, and how many times as long as its strain one takes: 4 with friction, 12 without
CALM = 1e-4  # net forces of a state at rest, as a part of the forces that a probe makes


class Stiffness(Experiment):
    """Moduli E, A, B, G along biaxial compression of discs in a periodic cell. Units: m, kg, s; pressure in N/m; mass of spheres.

    `states` states are probed, the first before loading, the last at the vertical strain `strain` as ln(z0/z); they are closest together
    at the start, where the structure changes fastest: strain (k/(states - 1))^2. `probe` is the half/half strain of a probe. The results
    have a table "moduli" over the states and their source: the probes on their way "forth" (first loading) and "back" (elastic), and the
    "fabric", the affine network of the same contacts (its k_n is the stiffness of unloading); and a table "probes" of all of them.
    """

    kind: ClassVar[str] = "stiffness"
    output_keys: ClassVar[frozenset] = frozenset()
    quick: ClassVar[dict] = {"n": 150, "strain": 0.04, "states": 3, "inertial_number": 5e-3, "samples": 60}
    pressure: float = scene_key("N/m", "constant horizontal stress", 100.0, above=0)
    contact: Linear | Luding = scene_table("normal contact law", Linear(stiffness=1e5, damping=0.1))
    friction: Friction | None = scene_table("sliding friction, from the first state on; without it grains do not turn", None)
    n: int = scene_key("1", "number of grains", 1000, at_least=50, at_most=10_000_000)
    mean_radius: float = scene_key("m", "mean radius of the grains", 1e-3, **LENGTH)
    size_ratio: float = scene_key("1", "largest over smallest radius", 3.0, at_least=1, at_most=20)
    density: float = scene_key("kg/m3", "density of the grains, which have the mass of spheres", 2000.0, above=0)
    strain: float = scene_key("1", "vertical strain of the last state, ln(z0/z)", 0.1, above=0, below=1)
    states: int = scene_key("1", "number of states that are probed; 1: only the first", 8, at_least=1, at_most=1000)
    inertial_number: float = scene_key("1", "of the loading", 1e-3, above=0, at_most=0.1)
    probe: float = scene_key("1", "half/half strain of a probe", 1e-5, at_least=1e-9, at_most=1e-2)
    probe_steps: int = scene_key("1", "time steps in which a probe is strained", 400, at_least=10, at_most=1_000_000)
    contact_steps: float = scene_key("1", "time steps in the shortest contact time", 10.0, at_least=5, at_most=1000)
    samples: int = scene_key("1", "rows of the series after the first, about", 100, at_least=10, at_most=1_000_000)
    seed: int = scene_key("1", "of the random start", 0, at_least=0, at_most=LARGEST_SEED)

    def check(self):
        if getattr(self.contact, "plastic_depth", None) is not None:
            raise InputError("Stiffness: contact.plastic_depth must be left out: the network moduli need one stiffness of all contacts")

    def stages(self):
        """Press and relax, without friction and adhesion, damped; then settle and probe, load, settle and probe, and so on."""
        radius, _, _ = self.loose_cell()
        dt = self.step(radius)
        closing = int(0.75 * math.log(1 / LOOSE) / (CLOSING * self.rate_scale(radius)) / dt)
        relaxing = max(1000, closing // 20) * np.arange(1, ATTEMPTS + 1)
        settling = max(1000, self.probe_steps) * np.arange(1, ATTEMPTS + 1)
        stages = [
            Stage("press", closing // 10 * np.arange(1, 11), begin=self.loose),
            Stage("relax", relaxing, gate=equilibrium(self.contact.stiffest, self.stress_error), expected=20),
        ]
        for k in range(self.states):
            if k:
                steps = self.steps_to(k, dt)
                rows = max(1, math.ceil(self.samples / (self.states - 1)))
                marks = np.unique(np.linspace(0, steps, rows + 1)[1:].astype(int))
                stages.append(Stage(f"load-{k}", marks, begin=self.loading(k, steps), look=self.look))
            stages.append(Stage(f"settle-{k}", settling, begin=self.settling(k), gate=self.calm, expected=5))
            stages.append(Stage(f"probe-{k}", np.array([0]), look=self.probed, beside=WAYS * LENGTHS * self.probe_steps))
        return stages

    @property
    def strains(self):
        """(states,) vertical strains of the states."""
        return self.strain * np.linspace(0.0, 1.0, self.states) ** 2

    def steps_to(self, k, dt):
        """Time steps of loading from the state before to the state k."""
        time = (self.strains[k] - self.strains[k - 1]) / self.strain_rate()
        return time_steps(time, dt, f"Stiffness: inertial_number = {self.inertial_number:g}")

    def strain_rate(self):
        """Vertical strain rate of the loading in 1/s; the inertial number counts twice its deviator."""
        return 0.5 * self.inertial_number * self.rate_scale(self.loose_cell()[0])

    def rate_scale(self, radius):
        """sqrt(pressure/mean mass) in 1/s."""
        return math.sqrt(self.pressure / sphere_mass(radius, self.density).mean())

    def step(self, radius):
        """The time step in s."""
        return quasi_static_step(self.contact, self.friction, sphere_mass(radius, self.density), self.contact_steps)

    def loose_cell(self):
        """Radii (N,), the side of the square cell in which they are loose, and the random numbers that come next."""
        rng = np.random.default_rng(self.seed)
        radius = uniform_radii(self.n, self.mean_radius, self.size_ratio, rng)
        return radius, math.sqrt(np.sum(np.pi * radius**2) / LOOSE), rng

    @property
    def unloading_stiffness(self):
        """Of a contact, in N/m."""
        return self.contact.k2 if isinstance(self.contact, Luding) else self.contact.stiffness

    def loose(self, _):
        """The Simulation of a loose sample whose sides are pressed together."""
        radius, side, rng = self.loose_cell()
        grains = Grains(positions_in_cell(radius, np.array([side, side]), rng), radius, density=self.density)
        law = replace(self.contact, kc=0.0) if isinstance(self.contact, Luding) else self.contact
        cell = Periodic(side, side, pressure=self.pressure, viscosity=self.viscosity(radius))
        return Simulation(grains, law, boundary=cell, drag=background_drag(self.contact, grains.mass), dt=self.step(radius))

    def viscosity(self, radius):
        """Of a side under pressure, in N s/m: how fast it closes until grains resist."""
        return self.pressure / (CLOSING * self.rate_scale(radius))

    def stress_error(self, simulation):
        """How far the stress along both sides is from the pressure, relative."""
        return float(np.max(np.abs(np.diag(contact_stress(simulation)) / self.pressure - 1)))

    def loading(self, k, steps):
        """Function of the Simulation of the state before: the one that is loaded to state k in so many steps."""

        def begin(rested):
            rate = (self.strains[k] - self.strains[k - 1]) / (steps * rested.dt)
            return in_cell(rested, {"stretch_rate": (0.0, -rate), **self.held(rested.dt)}, drag=None)

        return begin

    def held(self, dt, both=False):
        """What holds the stress along the width, or along both sides, in a Periodic cell."""
        viscosity = max(LAG * self.pressure / self.strain_rate(), 5.0 * self.contact.stiffest * dt)  # less would not be stable
        return {"pressure": self.pressure if both else (self.pressure, None), "viscosity": viscosity}

    def settling(self, k):
        """Function of the Simulation at the strain of state k: the one that comes to rest there, damped, with friction and adhesion.

        The width still follows the pressure: in a cell that rests, a sample near failure would lose its stress.
        """

        def begin(loaded):
            drag = self.probe_drag(loaded.grains.mass)
            return in_cell(loaded, self.held(loaded.dt, both=k == 0), drag=drag, normal=self.contact, friction=self.friction)

        return begin

    def probe_drag(self, mass):
        """Background damping in kg/s under which the longest shear waves of the cell die fastest.

        Their frequency is about 0.7/sqrt(N) of sqrt(k/m): grains are some ten times softer in shear than an affine network (2.4/sqrt(N)).
        """
        return 1.5 / math.sqrt(self.n) * math.sqrt(self.unloading_stiffness * float(mass.mean()))

    @property
    def rest(self):
        """Net forces over contact forces of a state at rest: CALM of what a probe changes, strain times stiffness over pressure."""
        return CALM * self.probe * self.unloading_stiffness / self.pressure

    def calm(self, simulation):
        """A gate: net forces are small against those that the probe makes."""
        if not len(simulation.snapshot().pairs):
            return "no grains touch"
        net = imbalance(simulation)
        return "" if net < self.rest else f"mean net force/mean contact force = {net:.2g} (wanted < {self.rest:.2g})"

    def look(self, simulation, records, k):
        """Records a row."""
        records.rows.append(self.measure(simulation, simulation.snapshot(), records))

    def probed(self, simulation, records, k):
        """Probes copies of the state, and records its moduli, its snapshot and, of the first, a row."""
        state = len(records.tables.get("moduli", ()))
        if not records.rows:
            self.look(simulation, records, k)
        snapshot = simulation.snapshot()
        records.snapshots[frame_name(state)] = snapshot
        ways = probes(simulation, self.probe, self.probe_steps, self.rest, self.probe_drag(simulation.grains.mass))
        row = self.measure(simulation, snapshot, records)
        row |= moduli_row(ways, self.fabric_moduli(snapshot), self.probe, VERTICAL)
        records.tables.setdefault("moduli", []).append(row)
        records.tables.setdefault("probes", []).extend(probe_row(way, state) for way in ways)

    def fabric_moduli(self, snapshot):
        """{name: modulus} of the affine network of the contacts that bear forces."""
        network = contact_network(snapshot.bearing(BEARING), VERTICAL)
        k_t = 0.0 if self.friction is None else self.friction.stiffness
        moduli = network_moduli(network.a2, network.a4, self.unloading_stiffness, k_t, network.scale)
        return moduli._asdict()

    def measure(self, simulation, snapshot, records):
        """One row of the series; the time is that of loading, without the pauses."""
        width, height = (float(side) for side in simulation.walls.lattice[:2])
        first = records.rows[0] if records.rows else {"cell_width": width, "cell_height": height}
        eps_xx, eps_zz = math.log(first["cell_width"] / width), math.log(first["cell_height"] / height)
        bearing = snapshot.bearing(BEARING)
        box = average(bearing, least_contacts=3 if self.friction is None else 2)
        network = contact_network(bearing, VERTICAL)
        sigma_xx, sigma_zz = (float(sigma) for sigma in np.diag(contact_stress(simulation)))
        return {
            "time": eps_zz / self.strain_rate(),
            "cell_width": width,
            "cell_height": height,
            "eps_zz": eps_zz,
            "eps_xx": eps_xx,
            "eps_V": 0.5 * (eps_zz + eps_xx),
            "eps_D": 0.5 * (eps_zz - eps_xx),
            "sigma_xx": sigma_xx,
            "sigma_zz": sigma_zz,
            "sigma_V": 0.5 * (sigma_zz + sigma_xx),
            "s_D": (sigma_zz - sigma_xx) / (sigma_zz + sigma_xx),
            "area_fraction": float(box.area_fraction),
            "fabric_trace": float(box.fabric_trace),
            "fabric_deviator": 0.5 * float(box.fabric[1, 1] - box.fabric[0, 0]),
            "a2": float(network.a2),
            "a4": float(network.a4),
            "coordination_number": float(box.coordination_number),
        }

    def fields(self, records, simulation):
        """The series; there are no profiles and blocks."""
        return labelled_series(records.rows, self.kind), None, None

    def tables(self, records):
        """The moduli over (state, source), with what else is known of the states; and all probes."""
        return tables_of(records)

    def doubts(self, tables):
        """Probes that did not come to rest, whose moduli contain what was still in motion."""
        moving = (tables["probes"].imbalance >= self.rest).groupby(tables["probes"].probed_state).sum()
        return [
            f"state {int(k)}: ways of its probes that did not come to rest: {int(count)}"
            for k, count in zip(moving.probed_state, moving, strict=True)
            if count
        ]

    def nominal_inertial_number(self):
        """Of the loading."""
        return self.inertial_number

    def judge(self, series, blocks, simulation):
        """Warnings a reader must see: pressure not held, loading not quasi-static, stale neighbour lists."""
        status = squeezed(simulation)
        if self.inertial_number > 1e-2:
            status = status.warn(f"inertial number of the loading {self.inertial_number:g}: not quasi-static")
        held = float(abs(series.sigma_xx / self.pressure - 1).median())
        if held > 0.1:  # the states themselves have come to rest under it
            status = status.warn(f"while loading the width holds its pressure only to {held:.1%} (median)")
        if simulation.counters["late_builds"]:
            status = status.warn(f"{simulation.counters['late_builds']} neighbour lists were built late")
        return status
