"""What `anisogran fit` can fit: for each KIND the columns it takes, where a results file has them, and the fit. A new one is one entry."""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from anisogran import fitting
from anisogran.outcome import InputError


class Kind(NamedTuple):
    """One KIND.

    `columns` are the rows the fit takes, each a tuple of names by which it may go, the first x and the last y; `optional` ones may be
    missing. `groups` of a results file are looked through in this order. `fit(rows)` makes the FitResult of {first name: row}, with
    "errors" of y if there are any; `together(sets, shared)` that of several data sets. Points of `pooled` kinds are runs of their own,
    and all files are one data set. `more(rows, result)` finds what stands beside the fit, {name: object that prints as one line}.
    `log` names the axes of the picture that are logarithmic, `panels` its pairs (x, y), default: x and y. Where the result has a data
    set for each value of a row, this is `split`. A kind that is `whole` is one fit of all files, with curves of its own, see `fit_law`.
    """

    columns: tuple
    groups: tuple
    fit: Callable
    together: Callable | None = None
    pooled: bool = False
    optional: tuple = ()
    more: Callable | None = None
    log: str = ""
    panels: tuple = ()
    split: str = ""
    whole: bool = False


# rows made of others, where a file has only these
DERIVED = {
    "sigma_V": (("sigma_zz", "sigma_xx"), lambda zz, xx: 0.5 * (zz + xx)),
    "sigma_D": (("sigma_zz", "sigma_xx"), lambda zz, xx: 0.5 * (zz - xx)),
    "s_D": (("sigma_D", "sigma_V"), lambda deviator, mean: deviator / mean),
    "omega": (("v_phi", "r"), lambda velocity, radius: velocity / radius),
    "omega_error": (("v_phi_error", "r"), lambda error, radius: error / radius),
}


def xy_fit(fit):
    """`fit(x, y, errors)` as a function of rows."""

    def of_rows(rows):
        return fit(*xy(rows))

    return of_rows


def joint_fit(fit):
    """`fit(DataSets, shared)` as a function of data sets from files."""

    def of_sets(sets, shared):
        return fit([fitting.DataSet(*xy(one.rows), label=one.label, conditions=one.conditions) for one in sets], shared=shared)

    return of_sets


def xy(rows):
    """(x, y, errors or None) of rows."""
    names = [name for name in rows if name != "errors"]
    return rows[names[0]], rows[names[-1]], rows.get("errors")


def initial_moduli(rows):
    """E and B from the start of a curve."""
    return fitting.initial_moduli(*(rows[name] for name in ("eps_V", "eps_D", "sigma_V", "sigma_D")))


def whole_curve(rows):
    """E, A_max and B from the curve up to its peak; A grows as the anisotropy of the fabric if the file has it."""
    _, used = relaxation(rows)
    structure = None
    if "anisotropy" in rows:
        structure = rows["anisotropy"][used] / fitting.relaxation(rows["eps_D"], rows["anisotropy"]).values["s_max"]
    return fitting.path_moduli(*(rows[name][used] for name in ("eps_V", "eps_D", "sigma_V", "sigma_D")), structure=structure)


def relaxation(rows):
    """(fit of s_D along a curve, the slice of its points up to the peak)."""
    evolution = fitting.relaxation(rows["eps_D"], rows["sigma_D"] / rows["sigma_V"])
    return evolution, slice(int(np.flatnonzero(rows["eps_D"] <= evolution.x_range[1])[-1]) + 1)


def implied(rows, result):
    """B as the evolution of s_D implies it."""
    evolution, used = relaxation(rows)
    return {"compared_B": fitting.compared_B(result, evolution, rows["sigma_V"][used])}


def with_peaks(columns):
    """The columns, and for a biaxial run the largest sigma_zz (of a running mean, so that it is not one lucky sample) as a row."""
    stress = columns.rows.get("series/sigma_zz")
    if stress is None:
        return columns
    window = max(3, stress.size // 40)
    peak = np.convolve(stress, np.full(window, 1.0 / window), mode="valid").max(keepdims=True)
    return replace(columns, rows={**columns.rows, "peaks/sigma_zz": peak})


def cohesion(rows):
    """c0 and phi of the lecture's formula."""
    for key in ("k1", "k2"):
        if np.ptp(rows[key]) > 0.0:
            raise InputError(f"cohesion: {key} must be the same in all data, runs from {rows[key].min():g} to {rows[key].max():g}")
    k1, k2 = float(rows["k1"][0]), float(rows["k2"][0])
    return fitting.cohesion(rows["p"], rows["kc"], rows["sigma_zz"], k1, k2, rows.get("errors"))


_CURVE = (("eps_V",), ("eps_D",), ("sigma_V",), ("sigma_D",))
_BOTH_STRESSES = (("eps_D", "sigma_V"), ("eps_D", "sigma_D"))
_I = ("inertial_number", "I")

KINDS = {
    "relaxation": Kind((("eps_D",), ("s_D", "s")), ("series",), xy_fit(fitting.relaxation), joint_fit(fitting.relaxations)),
    "mohr_coulomb": Kind(
        (("p",), ("sigma_zz",)), ("peaks",), xy_fit(fitting.mohr_coulomb), joint_fit(fitting.mohr_coulomb_lines), pooled=True
    ),
    "cohesion": Kind((("p",), ("kc",), ("k1",), ("k2",), ("sigma_zz",)), ("peaks",), cohesion, pooled=True, split="kc"),
    "mu_of_I": Kind((_I, ("stress_ratio", "mu")), ("steady",), xy_fit(fitting.mu_of_I), pooled=True, log="x"),
    "area_fraction": Kind((_I, ("area_fraction", "nu")), ("steady",), xy_fit(fitting.area_fraction), pooled=True, log="x"),
    "shear_band": Kind((("r",), ("omega",)), ("profiles",), xy_fit(fitting.shear_band)),
    "exponential_decay": Kind((("depth", "x", "r"), ("v_phi", "v")), ("profiles",), xy_fit(fitting.exponential_decay), log="y"),
    "moduli": Kind(_CURVE, ("series",), initial_moduli, more=implied, panels=_BOTH_STRESSES),
    "path_moduli": Kind(_CURVE, ("series",), whole_curve, optional=("anisotropy",), more=implied, panels=_BOTH_STRESSES),
    "law": Kind((("eps_zz",), ("sigma_zz",), ("eps_V",)), ("series",), None, whole=True),
}
