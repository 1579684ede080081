"""The particle runs of the main job, as the demo does them and the error budget measures them: boxes, a ring, and homogeneous shear."""

from dataclasses import dataclass, replace

import numpy as np

from anisogran.dem import Friction, Luding
from anisogran.experiments import Biaxial, RingShear, SimpleShear
from anisogran.runs.estimates import estimate

STATIONS = "ring", "biaxial", "shear"
RUBBING = {"friction": Friction(stiffness=2e4, mu=0.5), "contact": Luding(k1=5e4, k2=1e5, damping=0.1)}
BOX = Biaxial(n=1000, wall_mass=1e-3, **RUBBING)
RING = RingShear(travel=160.0, contact_steps=10.0)  # finer steps change nothing that could be seen, see cost/whole_way.py
SHEAR = SimpleShear(n=400, strain=4.0, contact_steps=15.0)


@dataclass(frozen=True)
class MainJob:
    """A biaxial test that is repeated with `boxes` seeds, a ring shear cell, and a shear test at each of the inertial numbers.

    The seeds are `seed` and those that follow. `elements` are those of the continuum along the radius.
    """

    seed: int = 1
    biaxial: Biaxial = BOX
    ring: RingShear = RING
    shear: SimpleShear = SHEAR
    inertial_numbers: tuple = tuple(np.geomspace(0.008, 0.12, 10).round(5).tolist())
    boxes: int = 1
    elements: int = 64

    @classmethod
    def small(cls, seed=1):
        """Every stage for real, on few grains and for a short time: the numbers are rough."""
        return cls(
            seed,
            Biaxial(n=150, strain=0.06, duration=0.02, wall_mass=2e-5, wall_damping=0.02, samples=100, **RUBBING),
            RingShear(n=250, inner_radius=4.0, travel=26.0, discard=2.0, block=3.0, contact_steps=10.0),
            SimpleShear(n=100, strain=2.5, contact_steps=15.0),
            tuple(np.geomspace(0.03, 0.1, 10).tolist()),
        )

    def experiments(self):
        """All particle runs, the ring first."""
        boxes = [self.biaxial.model_copy(update={"seed": self.seed + k}) for k in range(self.boxes)]
        return [self.ring.model_copy(update={"seed": self.seed}), *boxes, *self.tests()]

    def tests(self):
        """The shear tests."""
        return [self.shear.model_copy(update={"inertial_number": value, "seed": self.seed}) for value in self.inertial_numbers]

    def knobs(self, names):
        """{name: its value} of KEYs of the job, or STATION.KEYs of its scenes."""
        values = {}
        for name in names:
            station, _, key = name.rpartition(".")
            values[name] = getattr(getattr(self, station) if station else self, key)
        return values

    def turned(self, choice):
        """The job with its knobs at a choice {name: value}."""
        own = {name: value for name, value in choice.items() if "." not in name}
        for station in STATIONS:
            keys = {name.partition(".")[2]: value for name, value in choice.items() if name.startswith(f"{station}.")}
            own[station] = getattr(self, station).model_copy(update=keys)
        return replace(self, **own)


class Price:
    """Processor seconds of a job at a choice of its knobs, from {kind: seconds for a grain and a step} and seconds for an element."""

    def __init__(self, job, paces, per_element=0.0):
        self.job, self.paces, self.per_element = job, paces, per_element
        self._known = {}

    def __call__(self, choice):
        """Those of the particle runs and of the continuum."""
        ring, box, tests = (self.of(station, choice) for station in STATIONS)
        return ring + choice["boxes"] * box + tests + self.per_element * choice["elements"]

    def of(self, station, choice):
        """Those of a ring, a box, or all the shear tests."""
        own = {name: value for name, value in choice.items() if name.startswith(f"{station}.")}
        key = tuple(own.items())
        if key not in self._known:
            job = self.job.turned(own)
            runs = job.tests() if station == "shear" else [getattr(job, station)]
            self._known[key] = sum(map(self.of_run, runs))
        return self._known[key]

    def of_run(self, experiment):
        """Those of one run."""
        return self.paces[experiment.kind] * estimate(experiment).grain_steps
