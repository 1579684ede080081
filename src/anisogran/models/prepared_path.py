"""A path of the element test, checked once and driven as often as there are parameters: what the test itself and fits stand on."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from anisogran.models.controls import planned
from anisogran.models.driver import drive
from anisogran.models.laws import LAWS
from anisogran.models.point import Point
from anisogran.models.update import NO_SHEAR, integrator_record
from anisogran.outcome import InputError, checked, closest

_TOLERANCE = 1e-11  # of the largest stress of path and start: rounding is some 1e-16 of it


class Driven(NamedTuple):
    """States (n, 5) and total strains (n, 3), as of `Point`, of the points that were reached; `outcome` is `point.OK` if these are all."""

    states: np.ndarray
    strains: np.ndarray
    outcome: int


class PreparedPath:
    """The path of `element_test(law, ..., control, start, steps, integrator)`, checked once; `size` is its number of points.

    Raises InputError as `element_test` does for these.
    """

    def __init__(self, law, control, start=None, steps=None, integrator="midpoint"):
        self.law, self.method, self.plan = law, integrator_record(integrator), planned(control, steps)
        if law == "scalar" and self.plan.sheared:
            raise InputError(f"element_test: {NO_SHEAR}")
        self.start = _start_point(law, start, self.plan)
        self.size = len(self.plan.goals) + 1
        self.steps = np.diff(self.plan.spin), np.diff(self.plan.time)
        stresses = [self.start[:3], *(self.plan.path[key] for key in self.plan.rows if key.startswith("sigma"))]
        self._tolerance = _TOLERANCE * max(float(np.max(np.abs(row))) for row in stresses)

    def driven(self, parameters):
        """The `Driven` of a record of parameters. Raises InputError if the law cannot stand the start with these."""
        LAWS[self.law].check_start(parameters, self.start)
        plan, states, strains = self.plan, np.empty((self.size, 5)), np.empty((self.size, 3))
        states[0], strains[0] = self.start, plan.first_strain
        done, outcome = drive(
            self.method, parameters, states[0], plan.goals, plan.of_strain, plan.of_stress, *self.steps,
            self._tolerance, states[1:], strains[1:],
        )  # fmt: skip
        strains[1:] += strains[0]
        return Driven(states[: done + 1], strains[: done + 1], outcome)


def _start_point(law, start, plan):
    """The `Point` at the start."""
    names = [name for name in LAWS[law].INTERNAL if name]
    stresses = ("sigma_xx", "sigma_zz", "sigma_xz")
    known = [*stresses, *names]
    if not isinstance(start, Mapping):
        start = {} if start is None else {"sigma_xx": start, "sigma_zz": start}
    for key in start:
        if key not in known:
            raise InputError(f"element_test: start has {key!r}, did you mean {closest(key, known)!r}? It has {', '.join(known)}")
    start = {key: checked("element_test: start", key, value) for key, value in start.items()}
    inner = [start.get(name, 0.0) if name else 0.0 for name in LAWS[law].INTERNAL]
    if not LAWS[law].STRESS_IS_STATE:
        if set(stresses) & set(start):
            raise InputError(f"element_test: the {law} law starts from {', '.join(names)}, its stress follows")
        return Point(0.0, 0.0, 0.0, *inner)
    prescribed = {key: float(plan.path[key][0]) for key in plan.rows if key.startswith("sigma")}
    pressure = prescribed.get("sigma_V", prescribed.get("sigma_xx", prescribed.get("sigma_zz", 0.0)))
    xx, zz = (start.get(key, prescribed.get(key, pressure)) for key in ("sigma_xx", "sigma_zz"))
    xz = start.get("sigma_xz", prescribed.get("sigma_xz", 0.0))
    found = {"sigma_xx": xx, "sigma_zz": zz, "sigma_xz": xz, "sigma_V": 0.5 * (xx + zz), "sigma_D": 0.5 * (zz - xx)}
    for key, value in prescribed.items():
        if abs(found[key] - value) > 1e-9 * max(abs(xx), abs(zz)):  # rounding of sums
            raise InputError(f"element_test: {key} is prescribed as {value:g} at the start, but the sample starts at {found[key]:g}")
    return Point(found["sigma_V"], -found["sigma_D"], xz, *inner)
