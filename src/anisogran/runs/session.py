"""A scene on its way through its stages: it can be left between any two steps, saved, and taken up again bit for bit."""

import time

import numpy as np

from anisogran.dem import Simulation
from anisogran.files import software
from anisogran.outcome import InputError, Status
from anisogran.runs.records import Records
from anisogran.runs.run import Run
from anisogran.scenes.writing import scene_text


class Session:
    """Where a scene is: the number of its stage, the marks of it that are done, the simulation, and the records so far.

    `begun`: the step of the simulation at which the stage began, None before it has; then the simulation is that of the stage before.
    """

    def __init__(self, scene):
        self.scene, self.stages = scene, scene.stages()
        self.stage, self.begun, self.marks = 0, None, 0
        self.simulation = None
        self.records = Records()
        self.grain_steps, self.seconds = 0, 0.0  # in the time loop, compilation left out
        self.saving = 0.0  # seconds that went into files, in this process
        self.beginning = True  # before the first step, and while a stage begins: nothing is half done, an interrupt may come at any moment
        self._clock = None  # when the time loop was entered or last listened to, and the step

    def go(self, listen=None):
        """Runs to the end. `listen()` is called several times a second, between whole steps; if it raises, `go` can be called again.

        Raises RunFailed if a stage ends out of equilibrium or the simulation has to stop.
        """
        while not self.is_over:
            stage = self.stages[self.stage]
            if self.begun is None:
                self._begin(stage, listen)
            elif self.beginning:  # taken up in the midst of it
                self.simulation.compile()
            self.beginning = False
            while self.marks < len(stage.marks):
                self._run_to(self.begun + int(stage.marks[self.marks]), listen)
                if stage.look is not None:
                    stage.look(self.simulation, self.records, self.marks)
                self.marks += 1
                if stage.is_over(self.simulation, self.marks):
                    break
            self.stage, self.begun, self.marks = self.stage + 1, None, 0
            if listen is not None:
                listen()

    @property
    def is_over(self):
        """Whether all stages are done."""
        return self.stage == len(self.stages)

    @property
    def stage_name(self):
        """Name of the present stage."""
        return "end" if self.is_over else self.stages[self.stage].name

    def _begin(self, stage, listen):
        self.beginning = True
        simulation = self.simulation if stage.begin is None else stage.begin(self.simulation)
        simulation.compile()
        self.beginning = False
        self.simulation, self.begun, self.marks = simulation, simulation.step, 0
        if listen is not None:
            listen()

    def _run_to(self, step, listen):
        """Runs the simulation to that step and counts the work."""
        self._clock = time.perf_counter(), self.simulation.step

        def heard():
            begin, before = self._clock
            self._clock = time.perf_counter(), self.simulation.step
            self.seconds += self._clock[0] - begin
            self.grain_steps += (self._clock[1] - before) * len(self.simulation.grains)
            if listen is not None:
                listen()
                self._clock = time.perf_counter(), self.simulation.step  # what the listener does is not the time loop

        self.simulation.run(step - self.simulation.step, listen=heard)

    @property
    def steps_done(self):
        """Steps of this and the stages before, as expected."""
        before = sum(stage.steps for stage in self.stages[: self.stage])
        return before if self.begun is None else before + min(self.simulation.step - self.begun, self.stages[self.stage].steps)

    @property
    def steps_expected(self):
        """Steps of all stages; those of a stage with a gate are a guess."""
        return sum(stage.steps for stage in self.stages)

    @property
    def fraction(self):
        """Share of the work that is done, between 0 and 1."""
        return self.steps_done / self.steps_expected

    @property
    def speed(self):
        """Grain-steps a second in the time loop; 0 before it has run."""
        return self.grain_steps / self.seconds if self.seconds else 0.0

    def result(self):
        """The Run so far; None before anything is recorded. Its status says if it is unfinished."""
        if not self.records.rows:
            return None
        series, profiles, blocks = self.scene.fields(self.records, self.simulation)
        tables = self.scene.tables(self.records)
        if self.is_over:
            status = self.scene.judge(series, blocks, self.simulation)
            for doubt in self.scene.doubts(tables):
                status = status.warn(doubt)
        else:
            status = Status().warn(f"unfinished: in stage {self.stage_name}, {self.fraction:.0%} done")
        return Run(self.scene, series, profiles, blocks, self.records.snapshots, status, self.provenance(), tables)

    def provenance(self):
        """Where the result comes from: scene, versions, effects, counters and the measured speed, as a flat dict of plain values."""
        active, absent = self.simulation.active_effects()
        return {
            "scene": scene_text(self.scene),
            **software(),
            "dt": self.simulation.dt,
            "active_effects": "; ".join(active),
            "absent_effects": ", ".join(absent),
            **self.simulation.counters,
            "grain_steps": self.grain_steps,
            "seconds": self.seconds,
            "saving_seconds": self.saving,
            "particle_steps_per_s": self.speed,
        }

    def save(self, path):
        """Writes all of it to one checkpoint, see Simulation.save; nothing before there is a simulation."""
        if self.simulation is None:
            return
        place = {name: getattr(self, name) for name in ("stage", "begun", "marks", "grain_steps", "seconds")}
        attached = {"kind": self.scene.kind, "scene": self.scene.model_dump(mode="json"), "place": place, "records": self.records.packed()}
        self.simulation.save(path, attached)

    @classmethod
    def load(cls, path, scene):
        """The Session of a checkpoint, or of the one before it if that is damaged.

        Raises InputError, one line, if there is none that can be read, or if its scene is not this one, with the keys that differ; keys
        that only say what is written down (scene.output_keys) may differ, and hold from here on.
        """
        simulation = Simulation.load(path)
        session = cls(scene)
        try:
            stored, simulation.attached = simulation.attached, None
            unlike = dict(differing("", plain_scene(scene), {"kind": stored["kind"], **stored["scene"]}))
            physical = [text for key, text in unlike.items() if key not in scene.output_keys]
            if physical:
                raise InputError(f"{path}: is of another scene: {'; '.join(physical)}")
            session.simulation, session.records = simulation, Records.unpacked(stored["records"])
            session._go_to(**stored["place"], recount=bool(unlike))
        except InputError:
            raise
        except (LookupError, TypeError, ValueError, AttributeError) as error:  # a forged one: its seal is good
            raise InputError(f"{path}: is no checkpoint of a run ({error!r})") from None
        return session

    def _go_to(self, stage, begun, marks, grain_steps, seconds, recount):
        """Takes up the place of a stored session; where other marks are asked for now, they are counted anew.

        Raises LookupError if there is no such place.
        """
        last = stage == len(self.stages)
        steps = np.zeros(1) if last else self.stages[stage].marks
        if begun is not None and recount:  # a mark at this very step is done if there is a row of it
            looked = bool(self.records.rows) and self.records.rows[-1]["time"] == self.simulation.time
            marks = int(np.searchsorted(steps, self.simulation.step - begun, side="right" if looked else "left"))
        if stage < 0 or (begun is not None and (last or not 0 <= begun <= self.simulation.step or not 0 <= marks <= len(steps))):
            raise LookupError(f"stage {stage}, begun at {begun}, mark {marks}")
        self.stage, self.begun, self.marks, self.grain_steps, self.seconds = stage, begun, marks, grain_steps, seconds


def plain_scene(scene):
    """A scene as nested dicts of plain values, with its kind."""
    return {"kind": scene.kind, **scene.model_dump(mode="json")}


def differing(name, asked, stored):
    """(key, what differs in words) of two dicts of plain values."""
    if isinstance(asked, dict) and isinstance(stored, dict):
        for key in asked | stored:
            yield from differing(f"{name}.{key}" if name else key, asked.get(key), stored.get(key))
    elif asked != stored:
        yield name, f"{name} = {asked!r}, in the file {stored!r}"
