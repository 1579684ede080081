"""Measured curves for the calibration of a law: what was prescribed, what was measured along it, and how well."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from anisogran.fitting.sharing import words
from anisogran.models.controls import ROWS
from anisogran.models.laws import LAWS
from anisogran.models.prepared_path import PreparedPath
from anisogran.outcome import InputError, closest

_WINDOW = 0.1  # of the points, under one parabola of the smooth curve
_FLOOR = 0.01  # of the range of a column: no law is asked to be nearer than this, and no smooth column outvotes the others
_STEP = 1e-30  # of complex numbers


@dataclass(frozen=True)
class Curve:
    """One measured curve.

    control     what was prescribed, as for `element_test`: numbers, or rows (n,) of the points of the path
    observed    {column: row (n,)}: eps_ or sigma_ with xx, zz, xz, V, D, stress_ratio, s_D, internal variables; nan where nothing is known
    start       as for `element_test`; not fitted
    errors      {column: one standard error, a number or a row}, in the unit of the column. Default: the scatter about a smooth curve
    label       default: the conditions, or the number of the curve
    weight      2.0 counts as if the curve had been measured twice, but does not make errors smaller
    conditions  such as {"mu": 0.5}: curves can share a parameter where these are equal
    """

    control: dict
    observed: dict
    start: object = None
    errors: dict | None = None
    label: str = ""
    weight: float = 1.0
    conditions: dict = field(default_factory=dict)


class Measured(NamedTuple):
    """A checked `Curve`: its columns `names` as rows, and the places of all m finite values in these rows laid end to end."""

    label: str
    curve: Curve
    path: PreparedPath
    names: tuple
    rows: np.ndarray  # (c, n), in the units of the data, nan where nothing is known
    errors: np.ndarray  # (c, n)
    at: np.ndarray  # (m,)
    given: bool  # whether errors were given
    remarks: tuple

    @property
    def values(self):
        """(m,): what was measured, from the mean of its column, in units of the errors."""
        return self.scaled(self.rows)[self.at]

    def scaled(self, rows):
        """Rows (c, n) as `values`, but at all places (c n,); the mean is that of the measured column."""
        return ((rows - self._means) / self.errors).ravel()

    @property
    def ranges(self):
        """(c,): largest less smallest of each column."""
        return np.nanmax(self.rows, axis=1) - np.nanmin(self.rows, axis=1)

    @property
    def _means(self):
        return np.nanmean(self.rows, axis=1)[:, None]


def measured(law, curves):
    """The `Measured` of each `Curve`. Raises InputError naming curve, column and value for whatever makes no sense."""
    if isinstance(curves, Curve):
        curves = [curves]
    if not len(curves):
        raise InputError("calibrate: needs one curve or more, has none")
    for one in curves:
        if not isinstance(one, Curve):
            raise InputError(f"calibrate: curves must be Curve(control, observed, ...), one is {type(one).__name__}")
    named = [one.label or words(one.conditions) or str(number) for number, one in enumerate(curves, start=1)]
    for label in named:
        if named.count(label) > 1:
            raise InputError(f"calibrate: {named.count(label)} curves have the label {label!r}; each needs its own")
    found = [_measured(law, label, one) for label, one in zip(named, curves, strict=True)]
    if len({one.given for one in found}) > 1:
        raise InputError("calibrate: errors must be given for all curves or for none")
    return found


def _measured(law, label, curve):
    where = f"calibrate: curve {label!r}"
    if not (isinstance(curve.weight, int | float) and 0.0 < curve.weight < float("inf")):
        raise InputError(f"{where}: weight = {curve.weight!r} must be a finite number above 0")
    if not isinstance(curve.observed, Mapping) or not curve.observed:
        raise InputError(f"{where}: observed must be a dict of columns, is {curve.observed!r}")
    try:
        path = PreparedPath(law, curve.control, curve.start)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
    known = known_columns(law)
    for name in curve.observed:
        if name not in known:
            raise InputError(f"{where}: unknown column {name!r}, did you mean {closest(name, known)!r}? There are {', '.join(known)}")
        if name in path.plan.rows:
            raise InputError(f"{where}: {name} is prescribed, it cannot be fitted as well")
    rows = np.array([_row(where, name, row, path.size) for name, row in curve.observed.items()])
    errors, remarks = np.empty(rows.shape), []
    if curve.errors is not None and set(curve.errors) != set(curve.observed):
        raise InputError(f"{where}: errors must be given for {', '.join(curve.observed)}, are for {', '.join(curve.errors) or 'none'}")
    for k, name in enumerate(curve.observed):
        if curve.errors is None:
            errors[k], how = _scatter(where, name, rows[k])
            remarks.append(f"{label}: {name} is weighted by {errors[k, 0]:.3g}, {how}")
            continue
        errors[k] = np.asarray(curve.errors[name], dtype=float)
        if not np.all(errors[k] > 0.0) or not np.all(np.isfinite(errors[k])):
            raise InputError(f"{where}: errors of {name} must be finite and above 0, the smallest is {np.min(errors[k]):g}")
    at = np.flatnonzero(np.isfinite(rows))
    return Measured(label, curve, path, tuple(curve.observed), rows, errors, at, curve.errors is not None, tuple(remarks))


def _row(where, name, row, size):
    try:
        row = np.ma.filled(np.ma.asarray(row, dtype=float), np.nan)
    except (TypeError, ValueError):
        raise InputError(f"{where}: {name} must be a row of real numbers") from None
    if row.shape != (size,):
        raise InputError(f"{where}: {name} has shape {row.shape}, the path has {size} points")
    if np.isfinite(row).sum() < 3 or np.any(np.isinf(row)):
        raise InputError(f"{where}: {name} must have 3 finite values or more, and none that is infinite")
    return row


def _scatter(where, name, row):
    """(standard error of a point, how it was found): the scatter about parabolas through neighbouring points, as its median tells it."""
    row = row[np.isfinite(row)]
    extent = float(np.ptp(row))
    if extent == 0.0:
        raise InputError(f"{where}: {name} is {row[0]:g} all along; leave it out, or give errors")
    window = max(5, 2 * round(0.5 * _WINDOW * row.size) + 1)
    if row.size < 2 * window:
        return _FLOOR * extent, f"{_FLOOR:.0%} of its range (too few points to tell its scatter)"
    x = np.arange(window) - window // 2
    weights = np.linalg.pinv(np.vander(x, 3))[2]  # the parabola at the middle of the window
    left = row[window // 2 : -(window // 2)] - np.convolve(row, weights[::-1], mode="valid")
    scatter = 1.4826 * float(np.median(np.abs(left))) / np.sqrt(1.0 - weights[window // 2])
    if scatter < _FLOOR * extent:
        return _FLOOR * extent, f"{_FLOOR:.0%} of its range (its scatter about a smooth curve is {scatter:.2g})"
    return scatter, "its scatter about a smooth curve"


def known_columns(law):
    """Names that a curve of this law can have."""
    linear = [f"{kind}_{part}" for kind in ("eps", "sigma") for part in ROWS]
    return [*linear, "s_D", "stress_ratio", *(name for name in LAWS[law].INTERNAL if name)]


def column(law, name, states, strains):
    """A column (...) of states (..., 5) and strains (..., 3) as of `Point`; analytic, so that a complex step passes."""
    kind, _, part = name.partition("_")
    if kind == "eps":
        return strains @ ROWS[part]
    if kind == "sigma":
        return states[..., :3] @ ROWS[part]
    if name == "s_D":
        return -states[..., 1] / states[..., 0]
    if name == "stress_ratio":
        return np.sqrt(states[..., 1] ** 2 + states[..., 2] ** 2) / states[..., 0]
    return states[..., 3 + LAWS[law].INTERNAL.index(name)]


def column_slopes(law, name, driven, d_states, d_strains):
    """(p, n): the derivatives of a column."""
    return column(law, name, driven.states + 1j * _STEP * d_states, driven.strains + 1j * _STEP * d_strains).imag / _STEP
