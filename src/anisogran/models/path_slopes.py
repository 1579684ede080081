"""A path of the element test that is driven again and again with other parameters, and the exact slopes of its curves by them.

Fits need both. The slopes follow the path step by step: with f the update of the law, new = f(p, old, increment), and the increment held
to what is prescribed, their chain rule is a linear system of three unknowns for each step, whose coefficients are derivatives of f by
complex steps. Sub-steps stay as they are, so that these are the slopes of what is computed, to rounding.
"""

from typing import NamedTuple

import numpy as np

from anisogran.compiled import kernel
from anisogran.models.controls import planned
from anisogran.models.driver import drive, solved
from anisogran.models.element import start_point, stress_tolerance
from anisogran.models.first_order import STEP
from anisogran.models.integrators import advanced
from anisogran.models.laws import LAWS
from anisogran.models.point import Increment, Point
from anisogran.models.update import NO_SHEAR, integrator_record
from anisogran.outcome import InputError


class Driven(NamedTuple):
    """States (n, 5) and total strains (n, 3), as of `Point`, of the points that were reached; `outcome` is `point.OK` if these are all."""

    states: np.ndarray
    strains: np.ndarray
    outcome: int


class PreparedPath:
    """The path of `element_test(law, ..., control, start)`, checked once; `size` is its number of points, start included.

    Raises InputError as `element_test` does for control and start.
    """

    def __init__(self, law, control, start=None):
        self.law, self.plan, self.method = law, planned(control, None), integrator_record("midpoint")
        if law == "scalar" and self.plan.sheared:
            raise InputError(f"element_test: {NO_SHEAR}")
        self.start = start_point(law, start, self.plan)
        self.size = len(self.plan.goals) + 1
        self._steps = np.diff(self.plan.spin), np.diff(self.plan.time)
        self._tolerance = stress_tolerance(self.plan, self.start)

    def driven(self, parameters):
        """The `Driven` of a record of parameters. Raises InputError if the law cannot stand the start with these."""
        LAWS[self.law].check_start(parameters, self.start)
        plan, states, strains = self.plan, np.empty((self.size, 5)), np.empty((self.size, 3))
        states[0], strains[0] = self.start, plan.first_strain
        done, outcome = drive(
            self.method, parameters, states[0], plan.goals, plan.of_strain, plan.of_stress, *self._steps,
            self._tolerance, states[1:], strains[1:],
        )  # fmt: skip
        strains[1:] += strains[0]
        return Driven(states[: done + 1], strains[: done + 1], outcome)

    def slopes(self, parameters, directions, driven):
        """(d states (p, n, 5), d strains (p, n, 3)) of what was driven, for each row of directions (p, m), changes of the m numbers of
        the record."""
        n = len(driven.states)
        d_states, d_strains = np.zeros((len(directions), n, 5)), np.zeros((len(directions), n, 3))
        spins, times = (row[: n - 1] for row in self._steps)
        along = driven.states, np.diff(driven.strains, axis=0), spins, times
        tangents = np.empty((n - 1, 5, 3))
        path_tangents(self.method, _moved(parameters, np.zeros(len(parameters))), *along, tangents)
        for row_of_states, row_of_strains, direction in zip(d_states, d_strains, directions, strict=True):
            controls = self.plan.of_strain, self.plan.of_stress
            path_slope(self.method, _moved(parameters, direction), *along, *controls, tangents, row_of_states, row_of_strains)
        return d_states, d_strains


def _moved(parameters, direction):
    """The record, a complex step off along the direction."""
    return type(parameters)(*(complex(value, STEP * step) for value, step in zip(parameters, direction, strict=True)))


@kernel
def path_tangents(method, p, states, increments, spins, times, tangents):
    """Fills tangents (n - 1, 5, 3), the derivatives of each state by the increment that leads to it; p must be complex."""
    for n in range(increments.shape[0]):
        start = Point(states[n, 0] + 0j, states[n, 1] + 0j, states[n, 2] + 0j, states[n, 3] + 0j, states[n, 4] + 0j)
        for j in range(3):
            eps_V, eps_1, eps_2 = increments[n, 0] + 0j, increments[n, 1] + 0j, increments[n, 2] + 0j
            if j == 0:
                eps_V += STEP * 1j
            elif j == 1:
                eps_1 += STEP * 1j
            else:
                eps_2 += STEP * 1j
            new, _ = advanced(method, p, start, Increment(eps_V, eps_1, eps_2, spins[n] + 0j, times[n] + 0j))
            for i in range(5):
                tangents[n, i, j] = new[i].imag / STEP


@kernel
def path_slope(method, p, states, increments, spins, times, of_strain, of_stress, tangents, d_states, d_strains):
    """Fills d_states (n, 5) and d_strains (n, 3), zero at the start, for the imaginary part of the parameters p."""
    J, b, x, partial = np.empty((3, 3)), np.empty(3), np.empty(3), np.empty(5)
    for n in range(increments.shape[0]):
        d = STEP * 1j * d_states[n]
        start = Point(states[n, 0] + d[0], states[n, 1] + d[1], states[n, 2] + d[2], states[n, 3] + d[3], states[n, 4] + d[4])
        step = Increment(increments[n, 0] + 0j, increments[n, 1] + 0j, increments[n, 2] + 0j, spins[n] + 0j, times[n] + 0j)
        new, _ = advanced(method, p, start, step)
        for i in range(5):
            partial[i] = new[i].imag / STEP
        for i in range(3):  # what is prescribed does not change with the parameters, the strains so far included
            b[i] = 0.0
            for j in range(3):
                b[i] -= of_stress[i, j] * partial[j]
                J[i, j] = of_strain[i, j]
                for k in range(3):
                    J[i, j] += of_stress[i, k] * tangents[n, k, j]
        solved(J, b, x)
        for j in range(3):
            d_strains[n + 1, j] = d_strains[n, j] + x[j]
        for i in range(5):
            d_states[n + 1, i] = partial[i]
            for j in range(3):
                d_states[n + 1, i] += tangents[n, i, j] * x[j]
