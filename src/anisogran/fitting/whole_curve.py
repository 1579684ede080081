"""E, A and B from a whole curve, with the evolution of A and of the softening known along it."""

from functools import partial

import numpy as np
from scipy.optimize import minimize_scalar

from anisogran.fitting.linear_moduli import between_points, coupling, estimate, finite_rows, undetermined
from anisogran.fitting.moduli_verdict import moduli_result
from anisogran.outcome import InputError, checked

_TRIED = 40  # values of s_max
_SOFTEST = 0.7  # the smallest s_max that is tried, over the largest |s_D| of the data


def path_moduli(eps_V, eps_D, sigma_V, sigma_D, s_max=None, structure=None):
    """Fit of the scalar law along a curve: `FitResult` with E, A_max (A if `structure` is None), B, sigma_V_0, sigma_D_0 and s_max.

        d sigma_V = E d eps_V + S A d eps_D        S = 1 - sgn(d eps_D) s_D/s_max
        d sigma_D = A d eps_V + S B d eps_D        A = A_max structure

    S stands on the whole eps_D column, as in the scalar law of `models`. Rows of shape (n,) in the order of loading, half/half, compression
    positive; moduli have the unit of stress. `structure`, shape (n,), is the known evolution of A/A_max, such as the anisotropy of the
    fabric over its largest value; None is a constant A. `s_max`, if given, is taken as exact. Give no points after the peak.
    The stresses are fitted, not their increments, in which neighbouring samples of noise drown the signal: the right-hand sides are
    summed along the path with values between the points (trapezoids). Noise in s_D enters S and adds up along the path, which the
    errors know of. At sigma_xx = const, A and E are told apart only as far as `structure` and S change on the way: see the
    correlations. Whether A is one, from d sigma_V and d sigma_D apart, is in `residuals` and the verdict, as for `probed_moduli`.
    `predict(eps_D)` is [sigma_V, sigma_D], shape (2, ...), between the points of a path whose eps_D only grows.
    Raises InputError for data that leave a modulus open, naming it, for sigma_V <= 0 or s_max outside (0, 1].
    """
    where, named = "path_moduli", {"eps_V": eps_V, "eps_D": eps_D, "sigma_V": sigma_V, "sigma_D": sigma_D}
    rows, dropped = finite_rows(where, **(named if structure is None else named | {"structure": structure}))
    if np.any(rows[2] <= 0.0):
        raise InputError(f"{where}: sigma_V = {rows[2].min():g} must be above 0 (no tension)")
    curve = _Curve(*rows[:4], None if structure is None else rows[4])
    given = s_max is not None
    s_max = checked(where, "s_max", s_max, above=0.0, at_most=1.0) if given else 1.0
    missing = undetermined(curve.columns(s_max))
    if missing:
        raise InputError(f"{where}: {', '.join(missing)} cannot be had from this path")
    if not given:
        s_max = curve.best_limit()
    columns = curve.columns(s_max)
    first = estimate(columns, curve.stress).values
    change = curve.change(first, s_max)
    felt = partial(_felt, stress=curve.stress, change=change)
    more = None if given else {"s_max": (s_max, _along(change * curve.s / s_max))}
    found = estimate(columns, curve.stress, series=True, felt=felt, more=more)
    fitted = sum(first[name] * column for name, column in columns.items())
    return moduli_result(
        "d sigma_V = E d eps_V + S A d eps_D, d sigma_D = A d eps_V + S B d eps_D", found, curve.stress,
        between_points(where, curve.eps_D, fitted), x_range=(float(curve.eps_D.min()), float(curve.eps_D.max())), dropped=dropped,
        series=True, symmetry=coupling(columns, curve.stress, series=True, felt=felt),
    )  # fmt: skip


class _Curve:
    """The stresses (2, n) of a curve, and what the law makes of its intervals, (n - 1,)."""

    def __init__(self, eps_V, eps_D, sigma_V, sigma_D, structure):
        self.eps_D, self.stress = eps_D, np.array([sigma_V, sigma_D])
        self.d_V, self.d_D, self.s = np.diff(eps_V), np.diff(eps_D), _middles(sigma_D / sigma_V)
        self.sense = np.where(self.d_D < 0.0, -1.0, 1.0)
        self.name = "A" if structure is None else "A_max"
        self.structure = np.ones_like(self.s) if structure is None else _middles(structure)

    def columns(self, s_max):
        """{name: d stress/d parameter (2, n)}."""
        # S may fall below 0, as in the law: noise about the plateau, cut off on one side, would add up along the path
        softened = (1.0 - self.sense * self.s / s_max) * self.d_D
        none, one = np.zeros_like(self.eps_D), np.ones_like(self.eps_D)
        return {
            "E": np.array([_along(self.d_V), none]),
            self.name: np.array([_along(self.structure * softened), _along(self.structure * self.d_V)]),
            "B": np.array([none, _along(softened)]),
            "sigma_V_0": np.array([one, none]),
            "sigma_D_0": np.array([none, one]),
        }

    def change(self, values, s_max):
        """What an interval adds to both stresses for a unit change of -s_D, (2, n - 1)."""
        moduli = np.array([values[self.name] * self.structure, np.full_like(self.s, values["B"])])
        return moduli * self.sense * self.d_D / s_max

    def best_limit(self):
        """The s_max of the least misfit: a scan, then a search in the best cell."""

        def misfit(logarithm):
            return float(np.sum(estimate(self.columns(np.exp(logarithm)), self.stress).residual ** 2))

        tried = np.linspace(np.log(min(0.9, _SOFTEST * np.max(np.abs(self.s)))), 0.0, _TRIED)
        best = int(np.argmin([misfit(one) for one in tried]))
        bounds = tried[max(best - 1, 0)], tried[min(best + 1, _TRIED - 1)]
        return float(np.exp(minimize_scalar(misfit, bounds=bounds, method="bounded", options={"xatol": 1e-12}).x))


def _felt(columns, stress, change):
    """The columns by which noise of the stresses moves the estimate: their own, and those of S, which moves all later stresses.

    `change` as of the `_Curve`.
    """
    entering = {}
    for name, column in columns.items():
        later = np.cumsum(column[:, :0:-1], axis=1)[:, ::-1]  # sum over the points after each interval
        of_interval = np.sum(change * later, axis=0)
        of_s = 0.5 * (np.append(of_interval, 0.0) + np.append(0.0, of_interval))
        entering[name] = column + of_s * np.array([-stress[1] / stress[0], np.ones_like(of_s)]) / stress[0]
    return entering


def _middles(row):
    return 0.5 * (row[1:] + row[:-1])


def _along(increments):
    """The running sum from 0 over the last axis, one longer than the increments."""
    return np.concatenate([np.zeros((*increments.shape[:-1], 1)), np.cumsum(increments, axis=-1)], axis=-1)
