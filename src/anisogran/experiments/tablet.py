"""The lecture's tablet: cohesive grains pressed together, released, and then crushed, torn or shaken.

Four stages as on the slide "compression-tension": a loose sample is pressed at a low pressure, without adhesion; a
high pressure, with adhesion, deepens its contacts, and they remember their largest overlap, which is what sinters them; the walls yield
to the low pressure again and are then taken away; the tablet, free and at rest, is tested, with friction. What is not implemented, being
only a heading of the lecture, is sintering in time: contacts whose stiffness grows with temperature or time.
"""

from dataclasses import replace
from typing import ClassVar, Literal

import numpy as np

from anisogran.dem import Box, Friction, Linear, Luding, Open
from anisogran.experiments.biaxial import Biaxial
from anisogran.experiments.experiment import Experiment, labelled_series, squeezed
from anisogran.experiments.preparation import background_drag, sphere_mass, time_steps
from anisogran.experiments.tablet_tests import TESTS, check_path
from anisogran.outcome import InputError
from anisogran.runs.stages import Stage
from anisogran.scenes.keys import LARGEST_SEED, LENGTH, MANY, scene_key, scene_table

AT_REST = 1e-5  # kinetic energy of a free tablet over the elastic one, or over that of the sample under the low pressure
SHOWN = 8  # snapshots of the test beside those of its start, its peak and its end


class Tablet(Experiment):
    """A tablet of discs, pressed, released and tested. Units: m, kg, s; pressures in N/m; mass of spheres.

    Radii, density and contacts as in the biaxial box. `test` is uniaxial "compression" between smooth platens, "tension" between platens
    to which the end layers are glued, both with free sides, or "vibration" on a floor that shakes under gravity. Compression is positive:
    in tension strain and stress are negative. Stresses are forces over the width that the tablet has when the test begins. Its strength
    is the peak of a moving average, `ag.fit.peak(eps_zz, sigma_zz, width=5e-4)`, of tension with the opposite of both; it is torn within
    1e-3 of strain, and the 4e-3 of the biaxial box would see no peak.
    Without friction there is hardly any strength: with its walls a tablet loses contacts that it needs to be rigid.
    """

    kind: ClassVar[str] = "tablet"
    output_keys: ClassVar[frozenset] = frozenset({"samples"})
    quick: ClassVar[dict] = {"n": 100, "pressure": 10.0, "duration": 0.02, "samples": 100}
    test: Literal["compression", "tension", "vibration"] = scene_key("1", "what is done to the free tablet", "compression")
    pressing_pressure: float = scene_key("N/m", "high pressure that makes the tablet", 100.0, above=0)
    pressure: float = scene_key("N/m", "low pressure of the preparation, and of the walls before they are taken away", 2.0, above=0)
    contact: Linear | Luding = scene_table("normal contact law", Luding(k1=5e4, k2=1e5, kc=1e5, damping=0.1))
    friction: Friction | None = scene_table("sliding friction, switched on when the test begins", Friction(stiffness=2e4, mu=0.5))
    n: int = scene_key("1", "number of grains", 400, at_least=20, at_most=10_000_000)
    mean_radius: float = scene_key("m", "mean radius of the grains", 1e-3, **LENGTH)
    size_ratio: float = scene_key("1", "largest over smallest radius", 3.0, at_least=1, at_most=20)
    density: float = scene_key("kg/m3", "density of the grains, which have the mass of spheres", 2000.0, above=0)
    strain: float = scene_key("1", "size of the strain ln(z0/z) at the end of compression or tension", 0.02, above=0, below=1)
    duration: float = scene_key("s", "time of the test; of platens half a period of their cosine", 0.1, above=0)
    amplitude: float = scene_key("m", "of the vibration", 5e-4, at_least=0, at_most=1e6)
    frequency: float = scene_key("1/s", "of the vibration", 50.0, above=0)
    gravity: float = scene_key("m/s2", "acceleration towards the floor that vibrates", 9.81, at_least=0)
    contact_steps: float = scene_key("1", "time steps in the shortest contact time", 10.0, at_least=5, at_most=1000)
    samples: int = scene_key("1", "rows of the series after the first", 400, at_least=10, at_most=MANY)
    seed: int = scene_key("1", "of the random start", 0, at_least=0, at_most=LARGEST_SEED)

    def check(self):
        if self.pressing_pressure <= self.pressure:
            raise InputError(f"Tablet: pressing_pressure = {self.pressing_pressure:g} must be above the pressure, {self.pressure:g} N/m")
        if self.test == "vibration":
            check_path(self)

    def stages(self):
        """Prepare (press and relax), press at high pressure, release, take the walls away, test."""
        loose, high = self.box(self.pressure), self.box(self.pressing_pressure)
        press, relax = loose.stages()[:2]
        waiting = high.stages()[1].marks
        steps = time_steps(self.duration, self.step(), f"Tablet: duration = {self.duration:g} s")
        testing = np.linspace(0, steps, self.samples + 1).astype(int)
        return (
            replace(press, begin=self.loose),
            replace(relax, expected=30),
            Stage("compact", waiting, begin=self.compacted, gate=high.at_rest(self.pressing_pressure), expected=10),
            Stage("release", waiting, begin=self.released, gate=high.at_rest(self.pressure), expected=5),
            Stage("free", waiting, begin=self.freed, gate=self.free_and_at_rest, expected=4),
            Stage("test", testing, begin=self.tested, look=self.look),
        )

    def box(self, pressure):
        """The biaxial box in which the grains are pressed under that pressure; it knows the friction of the test only for the time step."""
        keys = ("contact", "friction", "n", "mean_radius", "size_ratio", "density", "contact_steps", "seed")
        return Biaxial(pressure=pressure, **{name: getattr(self, name) for name in keys})

    def step(self):
        """The time step in s."""
        box = self.box(self.pressure)
        return box.step(sphere_mass(box.loose_box()[0], self.density))

    def loose(self, _):
        """The Simulation of the loose sample of the box, with damping that takes at most a tenth of the low pressure off its walls."""
        box = self.box(self.pressure)
        sample, side = box.loose(None), box.loose_box()[1]
        resisted = 0.1 * self.pressure * side / (self.n * box.wall_speed(side, sample.grains.mass))
        return sample.next_stage(boundary=sample.boundary, drag=min(resisted, sample.effects["drag"]))

    def compacted(self, prepared):
        """The Simulation of the prepared sample under the high pressure, with adhesion."""
        drag = background_drag(self.contact, prepared.grains.mass)
        return self.walled(prepared, self.pressing_pressure, normal=self.contact, drag=drag)

    def released(self, compact):
        """The Simulation of the pressed sample under the low pressure again."""
        return self.walled(compact, self.pressure)

    def walled(self, sample, pressure, **changes):
        """The next stage of a sample between walls that press so."""
        _, width, _, height = sample.walls.position
        high = self.box(self.pressing_pressure)
        walls = dict.fromkeys(("right", "top"), high.pressed_wall(pressure, high.loose_box()[1], sample.grains.mass))
        return sample.next_stage(boundary=Box(width, height, **walls), **changes)

    def freed(self, released):
        """The Simulation of the tablet without walls."""
        return released.next_stage(boundary=Open())

    def free_and_at_rest(self, simulation):
        """A gate: grains without adhesion may have no contact, and no energy but that of motion, so there is a scale from outside."""
        volume = float(np.pi * np.sum(simulation.grains.radius**2))
        scale = max(simulation.energy()["elastic"], self.pressure**2 * volume / self.contact.stiffest)
        kinetic = simulation.kinetic_energy(rotation=False)
        return "" if kinetic < AT_REST * scale else f"E_kin = {kinetic:.2g} J (wanted < {AT_REST * scale:.2g} J)"

    def tested(self, free):
        """The Simulation of the test, without background damping."""
        return TESTS[self.test].begin(self, free)

    def look(self, simulation, records, k):
        """Records a row, and the snapshots "start", "peak" (of the size of the stress), "end" and some between."""
        snapshot = simulation.snapshot()
        row = TESTS[self.test].row(self, simulation, snapshot)
        if k == 0:
            records.snapshots["start"] = snapshot
        if abs(row["sigma_zz"]) > max((abs(other["sigma_zz"]) for other in records.rows), default=-1.0):
            records.snapshots["peak"] = snapshot
        if k and k % max(1, self.samples // SHOWN) == 0:
            records.snapshots[f"sample-{k:08d}"] = snapshot
        records.snapshots["end"] = snapshot
        records.rows.append(row)

    def fields(self, records, simulation):
        """The series; there are no profiles and blocks."""
        return labelled_series(records.rows, self.kind), None, None

    def nominal_inertial_number(self):
        """Of platens at their fastest, under the high pressure; a floor that shakes strains nothing by itself."""
        if self.test == "vibration":
            return 0.0
        mass = float(sphere_mass(self.box(self.pressure).loose_box()[0], self.density).mean())
        return self.strain * np.pi / self.duration * np.sqrt(mass / self.pressing_pressure)

    def judge(self, series, blocks, simulation):
        """Warnings a reader must see: soft grains, a test that is not quasi-static, a tablet that was none, stale neighbour lists."""
        status = squeezed(simulation)
        inertial = self.nominal_inertial_number()
        if inertial > 1e-2:
            status = status.warn(f"inertial number up to {inertial:.2g}: not quasi-static")
        whole = float(series.largest_fragment[0])
        if getattr(self.contact, "kc", 0.0) > 0 and whole < 0.9:
            status = status.warn(f"the test began with {int(series.fragments[0])} fragments, the largest with {whole:.0%} of the mass")
        if simulation.counters["late_builds"]:
            status = status.warn(f"{simulation.counters['late_builds']} neighbour lists were built late")
        return status
