"""The compiled heart of the element test: one point along a path, each of three components controlled by strain or stress."""

import numpy as np

from anisogran.compiled import kernel, subkernel
from anisogran.models.integrators import advanced, tangent_at
from anisogran.models.point import NOT_FINITE, OK, RESOLUTION, Increment, Point

NOT_REACHABLE, LOST_CONTROL = 100, 101
MOST_ITERATIONS, MOST_HALVINGS = 10, 30


@subkernel
def solved(J, b, x):
    """Solves the 3 x 3 system J x = b by Cramer's rule; the determinant over the product of the lengths of the rows."""
    c0 = J[1, 1] * J[2, 2] - J[1, 2] * J[2, 1]
    c1 = J[1, 2] * J[2, 0] - J[1, 0] * J[2, 2]
    c2 = J[1, 0] * J[2, 1] - J[1, 1] * J[2, 0]
    determinant = J[0, 0] * c0 + J[0, 1] * c1 + J[0, 2] * c2
    lengths = 1.0
    for i in range(3):
        lengths *= np.sqrt(J[i, 0] ** 2 + J[i, 1] ** 2 + J[i, 2] ** 2)
    if not abs(determinant) > 1e-14 * lengths:  # rounding of the sum
        return 0.0
    x[0] = (b[0] * c0 + b[1] * (J[0, 2] * J[2, 1] - J[0, 1] * J[2, 2]) + b[2] * (J[0, 1] * J[1, 2] - J[0, 2] * J[1, 1])) / determinant
    x[1] = (b[0] * c1 + b[1] * (J[0, 0] * J[2, 2] - J[0, 2] * J[2, 0]) + b[2] * (J[0, 2] * J[1, 0] - J[0, 0] * J[1, 2])) / determinant
    x[2] = (b[0] * c2 + b[1] * (J[0, 1] * J[2, 0] - J[0, 0] * J[2, 1]) + b[2] * (J[0, 0] * J[1, 1] - J[0, 1] * J[1, 0])) / determinant
    return determinant / lengths


@subkernel
def _guessed(goal, strain, last, of_strain, of_stress, guess, work):
    """First guess of an increment: what strain controls is met, the rest goes on as `last` did; the sign of a stable determinant.

    The tangent of a stable material is positive definite, so with the unit matrix in its place the determinant has its sign.
    """
    J, b = work[0], work[1]
    for i in range(3):
        strained = False
        b[i] = 0.0
        for j in range(3):
            J[i, j] = of_strain[i, j] + of_stress[i, j]
            b[i] += of_stress[i, j] * last[j] - of_strain[i, j] * strain[j]
            strained = strained or of_strain[i, j] != 0.0
        if strained:
            b[i] += goal[i]
    return solved(J, b, guess)


@subkernel
def _step(method, p, point, strain, goal, of_strain, of_stress, guess, spin, time, tolerance, sign, going_on, work):
    """(state, outcome) of the increment that meets the three goals, left in `guess` (3,), which holds the first guess."""
    J, b, x, tangent, missed_before = work
    code, met, polished, worst_before = OK, OK, False, np.inf
    for iteration in range(MOST_ITERATIONS + 2):
        new, code = tangent_at(method, p, point, Increment(guess[0], guess[1], guess[2], spin, time), tangent)
        for _ in range(MOST_HALVINGS):
            if code == OK or iteration == 0:
                break
            if code == RESOLUTION:  # Newton runs off to where the stress no longer grows
                return new, NOT_REACHABLE
            met, worst_before = code, np.inf  # a secant needs whole steps
            for j in range(3):  # too far, into a state that the law does not know
                x[j] *= 0.5
                guess[j] -= x[j]
            new, code = tangent_at(method, p, point, Increment(guess[0], guess[1], guess[2], spin, time), tangent)
        if code != OK:
            return new, code
        worst = 0.0
        for i in range(3):
            b[i] = goal[i] - (of_stress[i, 0] * new.sigma_V + of_stress[i, 1] * new.sigma_1 + of_stress[i, 2] * new.sigma_2)
            scale = tolerance
            for j in range(3):
                b[i] -= of_strain[i, j] * (strain[j] + guess[j])
                J[i, j] = (
                    of_strain[i, j] + of_stress[i, 0] * tangent[0, j] + of_stress[i, 1] * tangent[1, j] + of_stress[i, 2] * tangent[2, j]
                )
                if of_strain[i, j] != 0.0:
                    scale = 1e-14 * max(1.0, abs(goal[i]))  # a strain is met to rounding
            worst = max(worst, abs(b[i]) / scale)
        if not np.isfinite(worst):
            return new, NOT_FINITE
        if worst > max(1.0, 0.5 * worst_before):  # slow: the tangent does not see a yield within the step, so take the secant along it
            squares = x[0] ** 2 + x[1] ** 2 + x[2] ** 2
            for i in range(3):
                change = (missed_before[i] - b[i] - J[i, 0] * x[0] - J[i, 1] * x[1] - J[i, 2] * x[2]) / squares
                for j in range(3):
                    J[i, j] += change * x[j]
        worst_before = worst
        missed_before[:] = b
        determinant = solved(J, b, x)
        if iteration == 0 and going_on and determinant * sign <= 0.0:
            return new, LOST_CONTROL  # another branch may be found, but the sample would jump to it
        if polished and worst <= 1.0:
            return new, OK if determinant * sign > 0.0 else LOST_CONTROL
        polished = worst <= 1.0  # one more round then reaches rounding, and small drifts of a stress do not add up
        if iteration == MOST_ITERATIONS and not polished:
            break
        if determinant == 0.0:
            return new, LOST_CONTROL
        for j in range(3):
            guess[j] += x[j]
    return new, met if met != OK else NOT_REACHABLE  # what stood in the way


@kernel
def drive(method, p, start, goals, of_strain, of_stress, spins, times, tolerance, states, strains):
    """Drives a point along goals (n, 3) from the state `start` at strain 0: (steps done, outcome).

    Row i of the control says: of_strain[i] . (eps_V, eps_1, eps_2) + of_stress[i] . (sigma_V, sigma_1, sigma_2) = goals[:, i].
    spins and times (n,) are increments. Fills states (n, 5) and strains (n, 3), total. `tolerance` is that of a stress.
    """
    point = Point(start[0], start[1], start[2], start[3], start[4])
    work = (np.empty((3, 3)), np.empty(3), np.empty(3), np.empty((3, 3)), np.empty(3))
    strain, last, guess, before = np.zeros(3), np.zeros(3), np.empty(3), goals[0].copy()
    by_strain = not np.any(of_stress)
    for n in range(goals.shape[0]):
        new, code, first = point, NOT_REACHABLE, OK
        on = n > 0
        for i in range(3):
            on = on and (goals[n, i] - goals[n - 1, i]) * (goals[n - 1, i] - before[i]) >= 0.0
        if by_strain:
            _guessed(goals[n], strain, last, of_strain, of_stress, guess, work)
            new, code = advanced(method, p, point, Increment(guess[0], guess[1], guess[2], spins[n], times[n]))
        else:
            for factor in (1.0, 0.0, -1.0) if on else (-1.0, 0.0, 1.0):  # as in the last step; none; turned round
                sign = _guessed(goals[n], strain, factor * last, of_strain, of_stress, guess, work)
                going_on = on and factor == 1.0
                new, code = _step(
                    method, p, point, strain, goals[n], of_strain, of_stress, guess, spins[n], times[n], tolerance, sign, going_on, work
                )  # fmt: skip
                if code == OK:
                    break
                first = first if first != OK else code  # the guesses after that are made to get round a corner, not to explain
                if code == LOST_CONTROL:
                    break
        if code != OK:
            return n, first if first != OK else code
        if n > 0:
            before[:] = goals[n - 1]
        last[:] = guess
        strain += guess
        point = new
        states[n, 0], states[n, 1], states[n, 2], states[n, 3], states[n, 4] = point
        strains[n] = strain
    return goals.shape[0], OK
