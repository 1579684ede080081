"""A whole law from files: `anisogran fit law`. Which rows are the path, which were measured, and what the picture shows."""

from dataclasses import asdict, dataclass

import numpy as np

from anisogran import fitting
from anisogran.models import LAWS
from anisogran.models.controls import biaxial, simple_shear
from anisogran.outcome import InputError
from anisogran.plots.fits import FittedCurve

_GROUPS = ("series",)


@dataclass(frozen=True)
class LawFigures:
    """All parameters of each curve, and how far the law lies from each column; prints as lines."""

    parameters: dict
    columns: dict

    def __str__(self):
        return "\n  ".join(f"{label}: {name}: {misfit}" for label, of in self.columns.items() for name, misfit in of.items())

    def _asdict(self):
        """Plain values for JSON."""
        columns = {label: {name: asdict(misfit) for name, misfit in of.items()} for label, of in self.columns.items()}
        return {"parameters": self.parameters, "columns": columns}


def path_rows(columns):
    """(rows, names) of a file: a biaxial run has eps_zz, a simple shear the shear strain, p the stress that was kept, the rest is measured.

    In simple shear the results have z as y, and tell the volume by the area fraction. Raises InputError naming file and column.
    """
    if columns.has("strain", _GROUPS) and columns.has("sigma_yy", _GROUPS):
        pressure = columns.row("pressure", _GROUPS)
        rows = {"strain": columns.row("strain", _GROUPS), "sigma_xz": -columns.row("stress_ratio", _GROUPS) * pressure}
        fraction = columns.row("area_fraction", _GROUPS)
        rows |= {"sigma_V": pressure, "eps_V": 0.5 * np.log(fraction / fraction[0])}
        if np.ptp(fraction) == 0.0:
            rows = {**rows, "sigma_zz": columns.row("sigma_yy", _GROUPS)}
            del rows["eps_V"]
        return rows, {}
    rows = {name: columns.row(name, _GROUPS) for name in ("eps_zz", "sigma_zz", "eps_V")}
    if not isinstance(columns.conditions.get("p"), float):
        raise InputError(f"{columns.path}: the side pressure is not known, it must be stated by a line # p = NUMBER")
    return rows, {}


def curve_of(one, chosen=None):
    """The `Curve` of the rows of a file; `chosen` are the measured columns that count, all if None."""
    moved = "strain" if "strain" in one.rows else "eps_zz"
    observed = {name: row for name, row in one.rows.items() if name != moved}
    for name in chosen or ():
        if name not in observed:
            raise InputError(f"{one.path}: --y {name}: must be among {', '.join(observed)}")
    observed = {name: observed[name] for name in chosen or observed}
    if moved == "eps_zz":
        return fitting.Curve(biaxial(one.rows["eps_zz"], one.conditions["p"]), observed, label=one.label, conditions=one.conditions)
    isochoric = "eps_V" not in one.rows
    pressure = float(one.rows["sigma_V"][0]) if isochoric else float(one.conditions["p"])
    control = simple_shear(one.rows["strain"], None if isochoric else pressure)
    return fitting.Curve(control, observed, start=pressure, label=one.label, conditions=one.conditions)


def calibrated(sets, law, shared, fixed, chosen):
    """(LawFit of all files, LawFigures). What `shared` does not name is shared by all."""
    if law is None:
        raise InputError(f"fit law: --law must be one of {', '.join(LAWS)}")
    result = fitting.calibrate(law, [curve_of(one, chosen) for one in sets], shared=shared, fixed=fixed)
    return result, LawFigures({one.label: result.parameters(one.label) for one in sets}, result.columns)


def drawn(fitted):
    """The `FittedCurve`s: each measured column over the strain that was prescribed."""
    found = []
    for one in fitted.sets:
        moved = "strain" if "strain" in one.rows else "eps_zz"
        test, x = fitted.result.tests[one.label], one.rows[moved]
        law = test.dataset()
        for name in fitted.result.columns[one.label]:
            y, values = one.rows[name], np.full(x.size, np.nan)
            values[: law[name].size] = law[name].values
            reached = np.isfinite(values)
            found.append(
                FittedCurve(
                    one.label, moved, name, x, y, None, values, x[reached], values[reached], bool(fitted.result.verdict)
                )
            )  # fmt: skip
    return found


def numbers_of(text):
    """{name: value} of "beta_F=40,E=2e4", or None. Raises InputError for what is not of this form."""
    if text is None:
        return None
    found = {}
    for part in text.split(","):
        name, equals, value = (word.strip() for word in part.partition("="))
        try:
            found[name] = float(value)
        except ValueError:
            equals = ""
        if not (name and equals):
            raise InputError(f"--fixed {text}: {part.strip()!r} must be PARAMETER=NUMBER, as beta_F=40,E=2e4")
    return found
