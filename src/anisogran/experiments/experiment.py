"""What all experiments share: a checked record of what the user asked for, and the result of running it."""

import platform
import sys
import time
from dataclasses import dataclass, field
from importlib.metadata import version

import xarray as xr
from pydantic import BaseModel, ConfigDict, ValidationError

import anisogran
from anisogran.files import save_results, snapshot_dataset
from anisogran.glossary import CONVENTIONS, attributes
from anisogran.outcome import InputError, Status
from anisogran.snapshot import frames

PACKAGES = ("numpy", "numba", "scipy", "lmfit", "scikit-fem", "xarray")


class Experiment(BaseModel):
    """A frozen record: every field checked, unknown ones refused. Raises InputError with one line for the first thing that is wrong."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    def __init__(self, **values):
        try:
            super().__init__(**values)
        except ValidationError as error:
            first = error.errors()[0]
            key = ".".join(str(part) for part in first["loc"])
            raise InputError(f"{type(self).__name__}: {key} = {first['input']!r}: {first['msg']}") from None
        self.check()

    def check(self):
        """Raises InputError where fields that are fine by themselves do not fit each other. Nothing to check here."""


@dataclass(frozen=True, eq=False)
class Run:
    """What an experiment left: the scene, time series, snapshots by name, status and provenance.

    Experiments with a field also have `profiles` (mean and error over the blocks) and `blocks` (dimension "block").
    """

    scene: Experiment
    series: xr.Dataset
    profiles: xr.Dataset | None = None
    blocks: xr.Dataset | None = None
    snapshots: dict = field(default_factory=dict)
    status: Status = Status()
    provenance: dict = field(default_factory=dict)

    @property
    def frames(self):
        """The snapshots of the steady state in order of time, for averages afterwards; without any, the last snapshot."""
        return frames(self.snapshots)

    def datasets(self):
        """All of it as datasets by group name; "" holds provenance and status as attributes."""
        groups = {"": xr.Dataset(attrs={**self.provenance, "status": str(self.status)}), "series": self.series}
        groups |= {name: data for name, data in (("profiles", self.profiles), ("blocks", self.blocks)) if data is not None}
        return groups | {f"snapshots/{name}": snapshot_dataset(snapshot) for name, snapshot in self.snapshots.items()}

    def save(self, path):
        """Writes one HDF5 file that `anisogran.open` and `xarray.open_datatree(path, engine="h5netcdf")` read."""
        groups = self.datasets()
        save_results(path, groups, groups.pop("").attrs)


class Watch:
    """Counts the work of a run (grain-steps, seconds in the time loop) and tells a listener how far it is."""

    def __init__(self, progress=None):
        self.progress = progress or (lambda fraction: None)
        self.seconds = 0.0
        self.grain_steps = 0
        self._warm = None  # the simulation whose kernels are compiled

    def run(self, simulation, steps):
        """Advances the simulation and counts; the first call of a simulation may compile, and is not counted as speed."""
        clock = time.perf_counter()
        simulation.run(steps)
        if simulation is self._warm:
            self.seconds += time.perf_counter() - clock
            self.grain_steps += steps * len(simulation.grains)
        self._warm = simulation


def spread_evenly(frames, discarded, samples):
    """The numbers of `frames` samples (fewer if there are not so many), evenly spread over discarded + 1 .. samples, a set."""
    count = min(frames, samples - discarded)
    return {samples - (k * (samples - discarded)) // count for k in range(count)}


def frame_name(sample):
    """The name of a kept snapshot; names sort in the order of time."""
    return f"frame-{sample:08d}"


def labelled_series(rows, experiment):
    """The rows (dicts with the same keys, one of them "time") as a Dataset over time, with units and meanings from the glossary."""
    columns = {name: ("time", [row[name] for row in rows], attributes(name)) for name in rows[0]}
    return xr.Dataset(columns, attrs={"conventions": CONVENTIONS, "experiment": experiment}).set_coords("time")


def squeezed(simulation, most=0.05):
    """A Status that warns if the mean overlap exceeds `most` of the mean radius: such soft grains are no model of a packing."""
    snapshot = simulation.snapshot()
    share = float(snapshot.overlap.mean() / snapshot.radius.mean()) if len(snapshot.overlap) else 0.0
    return Status().warn(f"the mean overlap is {share:.1%} of the mean radius: too soft for this load") if share > most else Status()


def provenance(scene, watch, simulation):
    """Where a result comes from: scene, versions, effects, counters and the measured speed, as a flat dict of plain values."""
    active, absent = simulation.active_effects()
    return {
        "scene": scene.model_dump_json(),
        "anisogran": anisogran.__version__,
        "python": platform.python_version(),
        "platform": sys.platform,
        **{name: version(name) for name in PACKAGES},
        "dt": simulation.dt,
        "active_effects": "; ".join(active),
        "absent_effects": ", ".join(absent),
        **simulation.counters,
        "grain_steps": watch.grain_steps,
        "seconds": watch.seconds,
        "particle_steps_per_s": watch.grain_steps / watch.seconds if watch.seconds else 0.0,
    }
