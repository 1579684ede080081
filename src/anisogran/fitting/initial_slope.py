"""E and B from the start of a curve: the slopes there, with the bend of the curve fitted beside them."""

import numpy as np

from anisogran.fitting.linear_moduli import between_points, coupling, estimate, finite_rows, undetermined
from anisogran.fitting.moduli_verdict import moduli_result
from anisogran.outcome import InputError, checked

_LEAST = 15  # points of the shortest range that is tried
_RANGES = 24  # so many are tried, spaced evenly in the logarithm of their points
_GOOD = 0.001  # ranges that are as good as this are equally good, the longest is taken


def initial_moduli(eps_V, eps_D, sigma_V, sigma_D, A=0.0, strain=None):
    """Fit of the initial slopes of a curve: `FitResult` with E, B (and A, if A=None), and sigma_V_0, sigma_D_0, bend_V, bend_D.

        sigma_V = sigma_V_0 + E eps_V + A eps_D + bend_V (l/L)^2
        sigma_D = sigma_D_0 + A eps_V + B eps_D + bend_D (l/L)^2

    l is the length of the path in (eps_V, eps_D) from the first point and L the range used; the bends are what the end of the range
    lies off the initial straight line, in the unit of stress as all else. Rows of shape (n,) in the order of loading, half/half (eps_V
    is half the trace), compression positive; strains count from the first point. `A` is the anisotropy modulus at the start: 0 for a
    sample prepared isotropically. One straight path has two slopes only, so A=None is refused, or not trustworthy, unless it bends.
    `strain` gives L. By default it is chosen: a longer range holds more points, but a parabola no longer describes it. The bend over
    the slope, squared, is taken for this misfit and is part of the errors; L is where it and the noise are together smallest.
    `x_range` (in l), `cut` and a remark say what was used. The softening is that of the sample at the start, S = 1 if sigma_D is 0.
    `predict(eps_D)` is [sigma_V, sigma_D], shape (2, ...), between the points of a path whose eps_D only grows.
    Raises InputError for data that leave a modulus open, naming it (isochoric paths E, isotropic ones B), and for too few points.
    """
    where = "initial_moduli"
    rows, dropped = finite_rows(where, eps_V=eps_V, eps_D=eps_D, sigma_V=sigma_V, sigma_D=sigma_D)
    eps, stress = np.array([row - row[0] for row in rows[:2]]), np.array(rows[2:])
    A = None if A is None else checked(where, "A", A)
    length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(eps)))])
    if length[-1] == 0.0:
        raise InputError(f"{where}: the strains do not change")
    if strain is None:
        count = _best_range(eps, stress, length, A)
    else:
        strain = checked(where, "strain", strain, above=0.0)
        count = int(np.count_nonzero(length <= strain))
        if count < 4:
            raise InputError(
                f"{where}: strain = {strain:g} holds {count} points, 4 are needed; {length.size} points reach {length[-1]:.3g}"
            )
    columns, known = _columns(eps[:, :count], length[:count], A)
    missing = undetermined(columns)
    if missing:
        raise InputError(f"{where}: {', '.join(missing)} cannot be had from a path with these strains")
    found = estimate(columns, stress[:, :count] - known, series=True)
    misfits = _misfits(found.values, columns)
    end = float(length[count - 1])
    bends = ", ".join(f"{_bend(name, found.values, columns):.1%} of that of {name}" for name in misfits)
    used = f"strain range 0 .. {end:.3g} {'chosen' if strain is None else 'given'}, {count} points, bend there {bends}"
    return moduli_result(
        "sigma_V = sigma_V_0 + E eps_V + A eps_D + bend_V (l/L)^2, sigma_D = sigma_D_0 + A eps_V + B eps_D + bend_D (l/L)^2",
        found, stress[:, :count],
        between_points(where, rows[1][:count], known + sum(found.values[name] * column for name, column in columns.items())),
        x_range=(0.0, end), dropped=dropped, cut=length.size - count, series=True, bias=misfits, remarks=(used,),
        symmetry=coupling(columns, stress[:, :count], series=True) if A is None else None,
    )  # fmt: skip


def _columns(eps, length, A):
    """({name: d stress/d parameter (2, n)}, the known part of the stress (2, n))."""
    (V, D), none, one, bent = eps, np.zeros_like(length), np.ones_like(length), (length / length[-1]) ** 2
    columns = {"E": np.array([V, none]), "B": np.array([none, D])}
    if A is None:
        columns["A"] = np.array([D, V])
    columns |= {"sigma_V_0": np.array([one, none]), "sigma_D_0": np.array([none, one])}
    columns |= {"bend_V": np.array([bent, none]), "bend_D": np.array([none, bent])}
    return columns, np.zeros_like(eps) if A is None else A * eps[::-1]


def _bend(name, values, columns):
    """The bend at the end of the range over the stress of the straight line there."""
    row, bend = (0, "bend_V") if name == "E" else (1, "bend_D")
    line = abs(values[name]) * np.max(np.abs(columns[name][row]))
    return float(abs(values[bend]) / line) if line > 0.0 else float("inf")


def _misfits(values, columns):
    """{modulus: what the next term of the series would change it by}: a curve with one scale of strain has terms bend, bend^2, ..."""
    return {name: float(abs(values[name])) * _bend(name, values, columns) ** 2 for name in ("E", "B") if values[name] != 0.0}


def _best_range(eps, stress, length, A):
    """The number of points at which misfit and noise of the worse modulus are together smallest, over its value."""
    shortest = min(_LEAST, length.size)
    best, least = length.size, np.inf
    for count in np.unique(np.geomspace(shortest, length.size, _RANGES).astype(int))[::-1]:
        columns, known = _columns(eps[:, :count], length[:count], A)
        if undetermined(columns):
            continue
        found = estimate(columns, stress[:, :count] - known)
        noise = dict(zip(columns, np.sqrt(np.diag(found.covariance)), strict=True))
        doubts = [np.hypot(misfit, noise[name]) / abs(found.values[name]) for name, misfit in _misfits(found.values, columns).items()]
        doubt = max([_GOOD, *doubts]) if doubts else np.inf
        if doubt < least:
            best, least = int(count), doubt
    return best
