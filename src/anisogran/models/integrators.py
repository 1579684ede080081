"""How an increment becomes a new state: explicit Euler, Runge-Kutta 4(5) with error control, or the implicit midpoint of each law.

Explicit              first order; one evaluation; unstable where an increment relaxes the stress ratio more than twice
RungeKutta45(...)     fifth order, as fine as the tolerance asks: the reference (Dormand & Prince, J. Comput. Appl. Math. 6, 19 (1980))
Midpoint              second order, anisotropy and rotation exact, stable at any size: the default
"""

from typing import NamedTuple

import numpy as np

from anisogran.compiled import kernel, specialised, subkernel
from anisogran.models.first_order import STEP
from anisogran.models.laws import midpoint, rate, stressed, trouble
from anisogran.models.point import NOT_FINITE, OK, RESOLUTION, Increment, Point


class Explicit(NamedTuple):
    """Explicit Euler."""

    order: float = 1.0


class RungeKutta45(NamedTuple):
    """Error of each sub-step relative to the largest stress and internal variable; the most sub-steps in an increment."""

    tolerance: float = 1e-9
    most: float = 1e4


class Midpoint(NamedTuple):
    """The implicit midpoint of each law, with exact evolution of its structure."""

    order: float = 2.0


INTEGRATORS = {"midpoint": Midpoint(), "rk45": RungeKutta45(), "explicit": Explicit()}

# Dormand & Prince: rows of the tableau, and the difference of the two solutions
_ROWS = np.array([
    [1 / 5, 0, 0, 0, 0, 0],
    [3 / 40, 9 / 40, 0, 0, 0, 0],
    [44 / 45, -56 / 15, 32 / 9, 0, 0, 0],
    [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0, 0],
    [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0],
    [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
])  # fmt: skip
_DIFFERENCE = np.array([71 / 57600, 0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40])


def _explicit(method, p, point, increment):
    change = rate(p, point, increment)
    return Point(
        point.sigma_V + change.sigma_V, point.sigma_1 + change.sigma_1, point.sigma_2 + change.sigma_2,
        point.x + change.x, point.y + change.y,
    ), OK  # fmt: skip


@subkernel
def _evaluate(p, y, increment, row):
    """Writes the rate at the state y (5,) to row (5,)."""
    change = rate(p, Point(y[0], y[1], y[2], y[3], y[4]), increment)
    row[0], row[1], row[2], row[3], row[4] = change.sigma_V, change.sigma_1, change.sigma_2, change.x, change.y


@subkernel
def _error(change, y, new, last, tolerance):
    """The error of a step in units of what is tolerated: stresses share one scale, internal variables another.

    An internal variable that starts from zero is measured against its change in the whole increment, at the rate `last`.
    """
    stress = max(abs(change[0].real), np.hypot(change[1].real, change[2].real))  # lengths of deviators: no axis is preferred
    inner = np.hypot(change[3].real, change[4].real)
    scale_s = max(abs(y[0].real), abs(new[0].real), np.hypot(y[1].real, y[2].real), np.hypot(new[1].real, new[2].real))
    scale_i = max(np.hypot(y[3].real, y[4].real), np.hypot(new[3].real, new[4].real), np.hypot(last[3].real, last[4].real))
    return max(stress / (tolerance * scale_s) if scale_s > 0.0 else 0.0, inner / (tolerance * scale_i) if scale_i > 0.0 else 0.0)


def _runge_kutta(method, p, point, increment):
    y = np.full(5, point.sigma_V)
    y[1], y[2], y[3], y[4] = point.sigma_1, point.sigma_2, point.x, point.y
    k, new, change = np.full((7, 5), point.sigma_V), y.copy(), y.copy()
    done, h, steps, doubt = 0.0, 1.0, 0.0, OK
    _evaluate(p, y, increment, k[0])
    while done < 1.0:
        steps += 1.0
        if steps > method.most:
            return point, RESOLUTION
        if h < 1e-14:
            return point, doubt if doubt != OK else RESOLUTION
        for stage in range(6):
            for i in range(5):
                value = 0.0 * y[i]
                for j in range(stage + 1):
                    value += _ROWS[stage, j] * k[j, i]
                new[i] = y[i] + h * value
            _evaluate(p, new, increment, k[stage + 1])
        for i in range(5):
            value = 0.0 * y[i]
            for j in range(7):
                value += _DIFFERENCE[j] * k[j, i]
            change[i] = h * value
        error = _error(change, y, new, k[6], method.tolerance)
        code = trouble(p, Point(new[0], new[1], new[2], new[3], new[4]))
        if not (np.isfinite(error) and code == OK):  # the end may lie in between
            doubt = code
            h *= 0.2
            continue
        if error <= 1.0:
            done = 1.0 if done + h >= 1.0 - 1e-15 else done + h
            y[:], doubt = new, OK
            k[0] = k[6]  # the last stage is the first of the next step
        h = min(h * min(5.0, max(0.2, 0.9 * error**-0.2 if error > 0.0 else 5.0)), 1.0 - done)
    return Point(y[0], y[1], y[2], y[3], y[4]), OK


def _midpoint(method, p, point, increment):
    return midpoint(p, point, increment)


integrate = specialised({Explicit: _explicit, RungeKutta45: _runge_kutta, Midpoint: _midpoint})


@subkernel
def advanced(method, p, point, increment):
    """(state, outcome) after an increment of strain; a state that failed is returned for what it tells, never as a result."""
    new, code = point, trouble(p, point)
    if code != OK:
        return new, code
    new, code = integrate(method, p, point, increment)
    if code != OK:
        return new, code
    new, code = stressed(p, new, increment)
    if code != OK:
        return new, code
    if not np.isfinite((new.sigma_V + new.sigma_1 + new.sigma_2 + new.x + new.y).real):
        return new, NOT_FINITE
    return new, trouble(p, new)


@kernel
def advance_all(method, p, states, increments, outcomes):
    """Advances states (5, n) in place by increments (5, n); outcomes (n,)."""
    for n in range(states.shape[1]):
        point = Point(states[0, n], states[1, n], states[2, n], states[3, n], states[4, n])
        step = Increment(increments[0, n], increments[1, n], increments[2, n], increments[3, n], increments[4, n])
        new, outcomes[n] = advanced(method, p, point, step)
        states[0, n], states[1, n], states[2, n], states[3, n], states[4, n] = new


@subkernel
def stepped(increment, j):
    """The increment, complex, a step off in component j of its strain."""
    step = STEP * 1j
    return Increment(
        increment.eps_V + (step if j == 0 else 0j), increment.eps_1 + (step if j == 1 else 0j), increment.eps_2 + (step if j == 2 else 0j),
        increment.spin + 0j, increment.time + 0j,
    )  # fmt: skip


@subkernel
def tangent_at(method, p, point, increment, out):
    """(state, outcome), and d(sigma_V, sigma_1, sigma_2)/d(eps_V, eps_1, eps_2) in out (3, 3): exact, by a complex step.

    Where the deviator of the increment is zero the derivative is that of loading.
    """
    start = Point(point.sigma_V + 0j, point.sigma_1 + 0j, point.sigma_2 + 0j, point.x + 0j, point.y + 0j)
    new, code = start, OK
    for j in range(3):
        new, code = advanced(method, p, start, stepped(increment, j))
        out[0, j], out[1, j], out[2, j] = new.sigma_V.imag / STEP, new.sigma_1.imag / STEP, new.sigma_2.imag / STEP
    return Point(new.sigma_V.real, new.sigma_1.real, new.sigma_2.real, new.x.real, new.y.real), code


@kernel
def advance_all_with_tangent(method, p, states, increments, outcomes, tangents):
    """As `advance_all`, with the tangents (3, 3, n)."""
    out = np.empty((3, 3))
    for n in range(states.shape[1]):
        point = Point(states[0, n], states[1, n], states[2, n], states[3, n], states[4, n])
        step = Increment(increments[0, n], increments[1, n], increments[2, n], increments[3, n], increments[4, n])
        new, outcomes[n] = tangent_at(method, p, point, step, out)
        states[0, n], states[1, n], states[2, n], states[3, n], states[4, n] = new
        tangents[:, :, n] = out
