"""Where moduli are fitted: stresses that are linear in them, by least squares, with errors that know of correlated noise."""

from typing import NamedTuple

import numpy as np

from anisogran.fitting.residuals import correlation_time
from anisogran.outcome import InputError

_DEPENDENT = 1e-10  # singular values below this part of the largest are rounding of the strains
_NO_NOISE = 1e-5  # residuals below this part of the stresses are rounding, or the error of sums along a path


class LinearEstimate(NamedTuple):
    """Least squares of stress[k, n] by columns {name: (k, n)}: values, their covariance (p, p), and what it rests on."""

    values: dict
    covariance: np.ndarray
    design: np.ndarray  # (p, p), the covariance if the noise were 1 and of every stress its own: what the columns alone tell
    residual: np.ndarray  # (k, n), weighted
    condition: float
    tau: float
    effective: float  # stresses that count, after the correlation between rows
    free: float


def finite_rows(where, **rows):
    """([each row as floats, shape (n,), all finite], number of points dropped); InputError if they are no rows of one length."""
    try:
        values = [np.ma.filled(np.ma.asarray(row, dtype=float), np.nan) for row in rows.values()]
    except (TypeError, ValueError):
        raise InputError(f"{where}: {', '.join(rows)} must be rows of real numbers") from None
    if any(value.ndim != 1 or value.shape != values[0].shape for value in values):
        shapes = ", ".join(f"{name} {value.shape}" for name, value in zip(rows, values, strict=True))
        raise InputError(f"{where}: the data must be rows of one length, are {shapes}")
    finite = np.all(np.isfinite(values), axis=0)
    if finite.sum() < 3:
        raise InputError(f"{where}: {finite.sum()} finite points (of {finite.size}) are too few, 3 are needed")
    return [value[finite] for value in values], int(finite.size - finite.sum())


def between_points(where, x, fitted):
    """A function of x that runs straight through the fitted stresses (k, n); shape (k, ...)."""

    def curve(at, **_):
        if np.any(np.diff(x) <= 0.0):
            raise InputError(f"{where}: predict needs a path along which eps_D only grows")
        return np.array([np.interp(at, x, row) for row in fitted])

    return curve


def undetermined(columns):
    """The names whose values these columns leave open, in order; empty if the data determine all."""
    matrix = np.array([column.ravel() for column in columns.values()]).T
    length = np.linalg.norm(matrix, axis=0)
    square = np.linalg.qr(matrix / np.where(length > 0.0, length, 1.0), mode="r")
    _, singular, axes = np.linalg.svd(square, full_matrices=True)
    singular = np.concatenate([singular, np.zeros(len(axes) - singular.size)])
    free = axes[singular <= _DEPENDENT * singular[0]]
    return [name for name, part in zip(columns, free.T, strict=True) if np.any(np.abs(part) > 1e-6)]


def estimate(columns, stress, weight=1.0, known_noise=False, series=False, more=None, felt=None):
    """The `LinearEstimate`; `more` are parameters that were found otherwise, {name: (value, column)}, and only widen the errors.

    `known_noise`: the weights are 1/error; errors grow if the scatter is larger. `series`: points are neighbours in one run, so that
    residuals remember each other along a row and, where a wall holds one stress, from row to row. `felt` makes of the columns those
    by which noise of the stresses enters, where the columns hold it too. The condition is that of columns of unit length.
    """
    k, n = stress.shape
    matrix = np.array([(column * weight).ravel() for column in columns.values()]).T
    length = np.linalg.norm(matrix, axis=0)
    solution = np.linalg.lstsq(matrix / length, (stress * weight).ravel(), rcond=None)[0] / length
    values = dict(zip(columns, solution.tolist(), strict=True))
    residual = stress * weight - (matrix @ solution).reshape(k, n)
    if more:
        columns = columns | {name: column for name, (_, column) in more.items()}
        matrix = np.array([(column * weight).ravel() for column in columns.values()]).T
        values |= {name: value for name, (value, _) in more.items()}
    p, noise = matrix.shape[1], float(np.sqrt(np.mean(residual**2)))
    tau, effective, between = 1.0, float(k * n), np.eye(k) * noise**2
    if series and noise > _NO_NOISE * np.max(np.abs(stress * weight)):
        tau = max(correlation_time(row, _independent(part)) for row, part in zip(residual, matrix.reshape(k, n, p), strict=True))
        between = residual @ residual.T / n
        effective = n * np.trace(between) ** 2 / np.sum(between**2)
    free = effective / tau - p
    if known_noise:
        between = np.eye(k) * max(noise**2, free / effective)
    length = np.linalg.norm(matrix, axis=0)
    length = np.where(length > 0.0, length, 1.0)
    _, singular, axes = np.linalg.svd(matrix / length, full_matrices=False)
    if free <= 0.0 or singular[-1] <= _DEPENDENT * singular[0]:
        return LinearEstimate(values, *np.full((2, p, p), np.nan), residual, float("inf"), tau, effective, free)
    scaled = (matrix / length).reshape(k, n, p)
    inverse = (axes.T / singular**2) @ axes
    entering = scaled if felt is None else np.stack([column * weight for column in felt(columns).values()], axis=-1) / length
    spread = np.einsum("iap,ij,jaq->pq", entering, between, entering) * effective / free
    units = np.outer(length, length)
    return LinearEstimate(
        values, inverse @ spread @ inverse / units, inverse / units, residual, float(singular[0] / singular[-1]), tau, effective, free
    )


def _independent(columns):
    """An orthonormal basis (n, r) of what the columns (n, p) span: a row of stresses may not know of all moduli."""
    basis, singular, _ = np.linalg.svd(columns / np.max(np.abs(columns)), full_matrices=False)
    return basis[:, singular > _DEPENDENT * singular[0]]


def coupling(columns, stress, **how):
    """(A in d sigma_V, A in d sigma_D, standard error of their difference) when the two are fitted apart; the law wants them equal.

    None where the data cannot tell them apart. `columns` hold one of A or A_max, as for `estimate`.
    """
    name = "A" if "A" in columns else "A_max"
    one, other = columns[name].copy(), columns[name].copy()
    one[1:], other[:1] = 0.0, 0.0
    apart = {**{key: column for key, column in columns.items() if key != name}, "A_V": one, "A_D": other}
    if undetermined(apart):
        return None
    found = estimate(apart, stress, **how)
    at = [list(apart).index("A_V"), list(apart).index("A_D")]
    (v, c), (_, d) = found.covariance[np.ix_(at, at)]
    return found.values["A_V"], found.values["A_D"], float(np.sqrt(max(v + d - 2.0 * c, 0.0))) if v == v else float("nan")
