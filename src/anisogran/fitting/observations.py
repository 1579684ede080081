"""Data for a fit: checked, filtered and sorted once."""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from anisogran.fitting.sharing import words
from anisogran.outcome import InputError


@dataclass(frozen=True)
class DataSet:
    """One series for a fit of several: x and y, shape (n,), errors of y or None.

    `conditions` say what was kept constant, such as {"p": 100.0, "mu": 0.5}; data sets can share a parameter where these are equal.
    `label` names the data set in the result (default: the conditions, or its number). Every point counts by its error, times
    `weight`: 2.0 counts as if each point had been measured twice, but does not make the errors smaller.
    """

    x: object
    y: object
    errors: object = None
    label: str = ""
    conditions: dict = field(default_factory=dict)
    weight: float = 1.0


def labels(where, sets):
    """The label of each `DataSet`. Raises InputError if there is none, if one is not a `DataSet`, and if two bear one label."""
    if not len(sets):
        raise InputError(f"{where}: needs one data set or more, has none")
    for one in sets:
        if not isinstance(one, DataSet):
            raise InputError(f"{where}: data sets must be DataSet(x, y, ...), one is {type(one).__name__}")
        if not (isinstance(one.weight, int | float) and 0.0 < one.weight < float("inf")):
            raise InputError(f"{where}: weight = {one.weight!r} must be a finite number above 0")
    named = [one.label or words(one.conditions) or str(number) for number, one in enumerate(sets, start=1)]
    for label in named:
        if named.count(label) > 1:
            raise InputError(f"{where}: {named.count(label)} data sets have the label {label!r}; each needs its own")
    return named


class Observations(NamedTuple):
    """Points sorted by x, all finite, each of shape (n,); errors is None or > 0; `dropped` counts points not finite."""

    x: np.ndarray
    y: np.ndarray
    errors: np.ndarray | None
    dropped: int

    def part(self, chosen):
        """The points of the mask or slice `chosen`."""
        errors = None if self.errors is None else self.errors[chosen]
        return self._replace(x=self.x[chosen], y=self.y[chosen], errors=errors)

    @property
    def distinct(self):
        """False for points that repeat an earlier one in x and y, which are no new information; shape (n,)."""
        first = np.ones(self.x.size, dtype=bool)
        again = np.flatnonzero(self.x[1:] == self.x[:-1])
        if again.size:
            inside = np.unique(np.concatenate([again, again + 1]))
            first[inside] = False
            first[inside[np.unique(np.stack([self.x[inside], self.y[inside]]), axis=1, return_index=True)[1]]] = True
        return first


def observations(where, x, y, errors, parameters):
    """The `Observations` in x, y (any sequence of numbers: integers, masked arrays, labelled arrays); masked points drop out.

    Raises InputError, naming `where`, for shapes that are not one row of equal length, for errors that are not positive, and for
    fewer finite points or different x than needed for this number of parameters.
    """
    columns = [_column(where, key, value) for key, value in (("x", x), ("y", y), ("errors", errors)) if value is not None]
    if any(column.ndim != 1 or column.shape != columns[0].shape for column in columns):
        raise InputError(f"{where}: the data must be rows of one length, have shapes {', '.join(str(c.shape) for c in columns)}")
    finite = np.all(np.isfinite(columns), axis=0)
    dropped = int(finite.size - finite.sum())
    columns = [column[finite] for column in columns]
    count = columns[0].size
    if count < parameters:
        raise InputError(f"{where}: {count} finite points (of {finite.size}) cannot determine {parameters} parameters")
    if columns[0].max() == columns[0].min():
        raise InputError(f"{where}: all points have the same abscissa {columns[0][0]:g}")
    if errors is not None and np.any(columns[2] <= 0.0):
        raise InputError(f"{where}: errors must be above 0, the smallest is {columns[2].min():g}")
    order = np.argsort(columns[0], kind="stable")
    columns = [column[order] for column in columns]
    return Observations(columns[0], columns[1], columns[2] if errors is not None else None, dropped)


def _column(where, key, values):
    try:
        values = np.ma.asarray(values)
        if values.dtype.kind not in "biuf":
            values = values.astype("U").astype(float) if values.dtype.kind == "O" else None
        return np.ma.filled(values.astype(float), np.nan)
    except (TypeError, ValueError, AttributeError):
        raise InputError(f"{where}: {key} must be a row of real numbers") from None
