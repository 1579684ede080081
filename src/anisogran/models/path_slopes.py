"""The exact slopes of the curves along a path by the parameters of the law, for fits.

They follow the path step by step: with f the update of the law, new = f(p, old, increment), and the increment held
to what is prescribed, their chain rule is a linear system of three unknowns for each step, whose coefficients are derivatives of f by
complex steps. Sub-steps stay as they are, so that these are the slopes of what is computed, to rounding.
"""

import numpy as np

from anisogran.compiled import kernel
from anisogran.models.driver import solved
from anisogran.models.first_order import STEP
from anisogran.models.integrators import advanced, stepped
from anisogran.models.point import Increment, Point


def slopes_along(path, parameters, directions, driven):
    """(d states (p, n, 5), d strains (p, n, 3)) of what was `driven` along a `PreparedPath`, for each row of directions (p, m), changes of
    the m numbers of the record."""
    n = len(driven.states)
    d_states, d_strains = np.zeros((len(directions), n, 5)), np.zeros((len(directions), n, 3))
    spins, times = (row[: n - 1] for row in path.steps)
    along = driven.states, np.diff(driven.strains, axis=0), spins, times
    tangents = np.empty((n - 1, 5, 3))
    path_tangents(path.method, _moved(parameters, np.zeros(len(parameters))), *along, tangents)
    for row_of_states, row_of_strains, direction in zip(d_states, d_strains, directions, strict=True):
        controls = path.plan.of_strain, path.plan.of_stress
        path_slope(path.method, _moved(parameters, direction), *along, *controls, tangents, row_of_states, row_of_strains)
    return d_states, d_strains


def _moved(parameters, direction):
    """The record, a complex step off along the direction."""
    return type(parameters)(*(complex(value, STEP * step) for value, step in zip(parameters, direction, strict=True)))


@kernel
def path_tangents(method, p, states, increments, spins, times, tangents):
    """Fills tangents (n - 1, 5, 3), the derivatives of each state by the increment that leads to it; p must be complex."""
    for n in range(increments.shape[0]):
        start = Point(states[n, 0] + 0j, states[n, 1] + 0j, states[n, 2] + 0j, states[n, 3] + 0j, states[n, 4] + 0j)
        step = Increment(increments[n, 0], increments[n, 1], increments[n, 2], spins[n], times[n])
        for j in range(3):
            new, _ = advanced(method, p, start, stepped(step, j))
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
