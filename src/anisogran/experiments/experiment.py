"""What all experiments share: a checked record of what the user asked for, and how it is run."""

import math
from typing import ClassVar

import xarray as xr
from pydantic import BaseModel, ConfigDict, ValidationError

from anisogran.glossary import CONVENTIONS, attributes
from anisogran.outcome import InputError, Status, shown
from anisogran.runs.folder import run_in_folder
from anisogran.runs.session import Session
from anisogran.scenes.keys import MANY, checked_values


class Experiment(BaseModel):
    """A frozen record: every field checked, unknown ones refused. Raises InputError with one line for the first thing that is wrong.

    `kind` is its name in a scene file, `quick` what makes a template's quick size of it.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)
    kind: ClassVar[str]
    quick: ClassVar[dict]
    output_keys: ClassVar[frozenset]  # what says only what is written down: it may differ when a run is taken up again

    def __init__(self, **values):
        try:
            super().__init__(**checked_values(type(self), values))
        except ValidationError as error:  # no case is known; whatever pydantic finds beyond our own checks is told in one line
            first = error.errors()[0]
            key = ".".join(str(part) for part in first["loc"])
            raise InputError(f"{type(self).__name__}: {key} = {shown(first['input'])}: {first['msg']}") from None
        self.check()

    def check(self):
        """Raises InputError where fields that are fine by themselves do not fit each other. Nothing to check here."""

    def tables(self, records):
        """{name: Dataset} of what is measured beside the series. Nothing here."""
        return {}

    def doubts(self, tables):
        """Warnings that follow from what is measured beside the series, as `tables` gives it, a list of sentences. None here."""
        return []

    def run(self, progress=None, folder=None, resume=False, force=False):
        """The Run. `progress(fraction)` is called several times a second.

        With `folder`, a path, the run keeps itself there (see runs/folder.py): results.h5, whole at any time, and a checkpoint, from which
        resume=True goes on bit for bit, while force=True begins anew; Ctrl-C and SIGTERM raise Interrupted after saving. Raises RunFailed
        naming the stage if a preparation finds no equilibrium or the simulation stops, InputError for a folder that cannot be used.
        """
        if folder is not None:
            return run_in_folder(self, folder, resume, force, progress and (lambda session: progress(session.fraction)))
        session = Session(self)
        session.go(progress and (lambda: progress(session.fraction)))
        return session.result()


def check_rows(scene, **factors):
    """Raises InputError if the product of the two factors, given by their keys, makes more rows of the series than MANY."""
    if math.prod(factors.values()) > MANY:
        told = " and ".join(f"{key} = {value:g}" for key, value in factors.items())
        raise InputError(f"{scene}: {told} make {math.prod(factors.values()):g} rows of the series; at most {MANY:g} are kept")


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
