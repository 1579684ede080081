"""A law along all measured paths as one function of the parameters, for the least-squares engine."""

import numpy as np

from anisogran.fitting.law_curves import column, column_slopes
from anisogran.models.laws import law_parameters
from anisogran.models.path_slopes import slopes_along
from anisogran.models.point import OK
from anisogran.outcome import InputError

_STEP = 1e-5  # of a parameter, in the formulas that make the numbers of the law from it: error some 1e-10
_MISSED = 1.0  # ranges of a column by which a point counts as missed that the law does not reach


class _Drive:
    """One curve with the scaled variables it was driven with."""

    def __init__(self, theta, driven):
        self.theta, self.driven, self.values, self.slopes = theta, driven, None, None


class LawPaths:
    """The law `law` with free parameters `names`, the rest fixed or tied, along the paths of `Measured` curves.

    Scaled variables times `units` are the values of the parameters. Along a path that the law cannot follow to its end with some
    parameters, the points that it does not reach count as missed by what the last state misses them by, and by one range of their column
    more: so the minimiser is driven out of such parameters, and what is fitted up to there still counts.
    """

    def __init__(self, law, names, fixed, ties, curves, units, scale):
        self.law, self.names, self.fixed, self.ties = law, names, fixed, ties
        self.curves, self.units, self.scale = curves, units, scale
        self._last, self._turned = [None] * len(curves), (None, None)

    def parameters(self, values):
        """{name: value} of all parameters of the law from those of the free ones."""
        found = dict(zip(self.names, values, strict=True)) | self.fixed
        for name, tie in self.ties.items():
            found[name] = tie(dict(found))
        return found

    def record(self, values):
        """The checked record of the law. Raises InputError for parameters that the law does not know."""
        return law_parameters(self.law, **self.parameters(values))

    def curve(self, x, path, **scaled):
        """The values of curve number `path` at the places x (from its `Measured`), over `scale`; complex parameters give derivatives.

        nan where the law has no curve at all.
        """
        theta, x = np.array([scaled[name] for name in self.names]), x.astype(int)
        last = self._last[path]
        if last is None or not np.array_equal(last.theta, theta.real):  # the engine asks for each derivative by itself
            last = self._last[path] = _Drive(theta.real.copy(), self.driven(path, theta.real * self.units))
            last.values = self._values(path, last.driven)
        if not np.iscomplexobj(theta):
            return last.values[x]
        if last.slopes is None:
            last.slopes = self._slopes(path, last.theta, last.driven)
        return last.values[x] + 1j * (theta.imag @ last.slopes[:, x])

    def rows(self, path, driven):
        """Columns (c, n) of curve number `path`, nan where the law does not reach."""
        one = self.curves[path]
        rows = np.full(one.rows.shape, np.nan)
        rows[:, : len(driven.states)] = [column(self.law, name, driven.states, driven.strains) for name in one.names]
        return rows

    def driven(self, path, values):
        """The `Driven` of curve number `path` for values of the free parameters, or None where the law knows them not."""
        try:
            return self.curves[path].path.driven(self.record(values))
        except InputError:  # of the trial parameters: all else was checked before
            return None

    def _values(self, path, driven):
        one = self.curves[path]
        if driven is None:
            return np.full(one.rows.size, np.nan)
        rows = self.rows(path, driven)
        if driven.outcome != OK:
            n = len(driven.states)
            held = np.broadcast_to(rows[:, n - 1 : n], rows[:, n:].shape)
            rows[:, n:] = held + np.where(held < one.rows[:, n:], -_MISSED, _MISSED) * one.ranges[:, None]
        return one.scaled(rows) / self.scale

    def _slopes(self, path, theta, driven):
        """(p, places)."""
        one, values = self.curves[path], theta * self.units
        if driven is None:
            return np.full((theta.size, one.rows.size), np.nan)
        if not np.array_equal(self._turned[0], values):  # the same for all curves that share the parameters
            self._turned = values, self._directions(values)
        d_states, d_strains = slopes_along(one.path, self.record(values), self._turned[1], driven)
        n, slopes = len(driven.states), np.zeros((theta.size, *one.rows.shape))
        for k, name in enumerate(one.names):
            slopes[:, k, :n] = column_slopes(self.law, name, driven, d_states, d_strains)
        slopes[:, :, n:] = slopes[:, :, n - 1 : n]
        return (slopes / one.errors).reshape(theta.size, -1) / self.scale

    def _directions(self, values):
        """d record/d (scaled variable), (p, numbers of the record); from one side at the end of what the law knows."""
        here, directions = np.array(self.record(values)), []
        for j, unit in enumerate(self.units):
            step = np.zeros(len(values))
            step[j] = _STEP * (abs(values[j]) or abs(unit))
            sides = [self._numbers(values + sign * step) for sign in (1.0, -1.0)]
            ends = [here if one is None else one for one in sides]
            width = step[j] * sum(one is not None for one in sides)
            directions.append((ends[0] - ends[1]) / width * unit if width > 0.0 else np.full(here.size, np.nan))
        return np.array(directions)

    def _numbers(self, values):
        try:
            return np.array(self.record(values))
        except InputError:
            return None
