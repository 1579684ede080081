"""Data for a fit: checked, filtered and sorted once."""

from typing import NamedTuple

import numpy as np

from anisogran.outcome import InputError


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
