"""The finished runs of a sweep, one by one, and the errors that they show."""

from itertools import groupby
from typing import NamedTuple

import numpy as np
import xarray as xr

from anisogran.cost.budget import Source
from anisogran.cost.sources import CHANCE, size, slope
from anisogran.experiments.scene_file import scene_from
from anisogran.files import open as open_results
from anisogran.scenes.writing import scene_text
from anisogran.sweeps.cases import case_scenes
from anisogran.sweeps.folder import read_sweep


class Case(NamedTuple):
    """A finished run: its scene, its results as `open` gives them, and the grains times steps that it took."""

    scene: object
    results: object
    grain_steps: float

    def group(self, name):
        """A group of the results, such as "series"."""
        return self.results[name].to_dataset()


class Curve(NamedTuple):
    """Measured errors of an answer against a knob: points (value, error, grain-steps of a `kind` of experiment)."""

    answer: str
    cause: str
    knob: str
    kind: str
    points: list


def cases_of(folder):
    """The Cases of the sweep in a folder."""
    found = read_sweep(folder)
    trees = [(state, open_results(found.path / state["case"] / "results.h5")) for state in found.states()]
    return [Case(scene_from(tree.attrs["scene"], state["case"]), tree, float(state["grain_steps"])) for state, tree in trees]


def done_cases(scene, vary):
    """The Cases of a sweep that is run here and now: most small runs take less time than a process needs to start."""
    found = []
    for one in case_scenes(scene, vary)[1].values():
        run = one.run()
        groups = run.datasets()
        results = xr.DataTree.from_dict({"/": groups.pop("").assign_attrs(scene=scene_text(one)), **groups})
        found.append(Case(one, results, float(run.provenance["grain_steps"])))
    return found


def by_value(cases, key):
    """{value of the key: the cases with it, by seed}, the seeds that all values have."""
    ordered = sorted(cases, key=lambda case: (getattr(case.scene, key), case.scene.seed))
    groups = {value: list(some) for value, some in groupby(ordered, key=lambda case: getattr(case.scene, key))}
    seeds = set.intersection(*({case.scene.seed for case in some} for some in groups.values()))
    return {value: [case for case in some if case.scene.seed in seeds] for value, some in groups.items()}


def work_of(cases):
    """Grain-steps of all cases with one seed, on average: of shear, those are the tests at all inertial numbers."""
    return sum(case.grain_steps for case in cases) / len({case.scene.seed for case in cases})


def turned(answer, cause, knob, order, groups, values, usual, weights=1.0):
    """(Source, Curve) of what a knob does to the mean of an answer: values (knob, seeds, ...) of the groups of `by_value`."""
    found = slope([(at / usual) ** -order for at in groups], values, weights)
    means = np.asarray(values, float).mean(axis=1)
    errors = [size(mean - found.limit, found.limit, weights) for mean in means]
    points = [(at, error, work_of(cases)) for (at, cases), error in zip(groups.items(), errors, strict=True)]
    kind = next(iter(groups.values()))[0].scene.kind
    return Source(answer, cause, found.error, found.uncertainty, (knob,), order), Curve(answer, cause, knob, kind, points)


def left_out(answer, cause, values, fewer, knobs, weights=1.0):
    """Source of what half of the points do not tell: values (repetitions, ...) from all and from `fewer`; the other half makes no more.

    It goes as chance does, and is a part of it that is told by itself: as squares they add to a few per cent too much.
    """
    difference = np.sqrt(np.mean((np.asarray(fewer, float) - values) ** 2, axis=0))
    error = size(difference, np.mean(values, axis=0), weights)
    return Source(answer, cause, error, error / np.sqrt(2.0 * len(values)), knobs, CHANCE)
