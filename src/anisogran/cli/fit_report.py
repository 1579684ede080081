"""What `anisogran fit` tells: text, numbers for JSON, curves for files and pictures."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from anisogran.cli.fit_law import drawn
from anisogran.outcome import InputError
from anisogran.plots.fits import FittedCurve


class Interval(NamedTuple):
    """One standard error (nan if there is none), the 95 % interval, and what is to be known of it."""

    error: float
    low: float
    high: float
    remark: str = ""


class Told(NamedTuple):
    """A fit, and the `Interval`s {name: interval} of its parameters by the way that was asked for."""

    fitted: object
    intervals: dict


def way_of(name):
    """The function of a FitResult that gives its `Interval`s. Raises InputError for another way than the three."""
    ways = {"covariance": by_covariance, "profile": by_profile, "bootstrap": by_bootstrap}
    if name not in ways:
        raise InputError(f"--errors {name}: must be one of {', '.join(ways)}")
    return ways[name]


def by_covariance(result):
    """Symmetric intervals."""
    return {name: Interval(result.errors[name], *result.interval(name)) for name in result.values}


def by_profile(result):
    """Limits where the misfit has risen; the standard errors stay those of the covariance."""
    profiles = {name: result.profile(name) for name in result.values}
    return {name: Interval(result.errors[name], one.low, one.high, one.outcome) for name, one in profiles.items()}


def by_bootstrap(result):
    """From repeated fits, with seed 0."""
    again = result.bootstrap()
    return {name: Interval(again.errors[name], *again.interval(name)) for name in result.values}


def text(told):
    """The values with errors, what was used, and the verdict with its reasons, as lines."""
    fitted, result = told.fitted, told.fitted.result
    lines = [*([str(result.table)] if len(result.table.labels) > 1 else []), f"{fitted.label}: {result.law}"]
    width = max(len(name) for name in result.values)
    for name, value in result.values.items():
        one = told.intervals[name]
        words = [f"+- {one.error:.2g}" if np.isfinite(one.error) else "not determined"]
        if not (np.isnan(one.low) or np.isnan(one.high)):
            words.append(f"(95 %: {one.low:.5g} .. {one.high:.5g})")
        lines.append(f"  {name:{width}} = {value:.6g}  {'  '.join(words)}" + (f"; {one.remark}" if one.remark else ""))
    whole = "law_figures" in fitted.more  # its abscissa is the number of the point, its residuals are in errors
    used = f"  {result.points} points" + ("" if whole else f", {result.x_range[0]:.4g} .. {result.x_range[1]:.4g}")
    rest = f"; rms residual {result.residuals['rms']:.3g}" + (" errors" if whole else "")
    lines.append(used + (f", {result.cut} left out after them" if result.cut else "") + rest)
    lines += [f"  {value}" for value in fitted.more.values()]
    lines.append("  trustworthy" if result.verdict else "  not trustworthy:")
    lines += [f"    {reason}" for reason in result.verdict.reasons]
    lines += [f"  note: {remark}" for remark in result.verdict.remarks]
    return "\n".join(lines)


def numbers(kind, files, done):
    """All of it as plain values: one fit at the top level, several in the list "fits"."""
    head = {"kind": kind, "files": [str(path) for path in files]}
    fits = [plain_result(one) for one in done]
    return {**head, **fits[0]} if len(fits) == 1 else {**head, "fits": fits}


def plain_result(told):
    """A fit as plain values; `verdict` is true or false, with `reasons` and `remarks` beside it."""
    fitted, result = told.fitted, told.fitted.result
    return {
        "label": fitted.label,
        "law": result.law,
        "values": result.values,
        "errors": {name: one.error for name, one in told.intervals.items()},
        "intervals_95": {name: [one.low, one.high] for name, one in told.intervals.items()},
        "correlations": {f"{a}, {b}": value for (a, b), value in result.correlations.items()},
        "verdict": bool(result.verdict),
        "reasons": list(result.verdict.reasons),
        "remarks": list(result.verdict.remarks),
        "points": result.points,
        "x_range": list(result.x_range),
        "dropped": result.dropped,
        "cut": result.cut,
        "free": result.free,
        "residuals": {key: float(value) for key, value in result.residuals.items()},
        **{key: value._asdict() for key, value in fitted.more.items()},
    }


def curves(kind, fitted):
    """The `FittedCurve`s of a fit: one for each data set and panel."""
    if kind.whole:
        return drawn(fitted)
    if kind.panels:
        return [curve for one in fitted.sets for curve in stress_curves(kind, fitted, one)]
    return [xy_curve(kind, fitted.result, part) for one in fitted.sets for part in parts(kind, one)]


def parts(kind, one):
    """The data set, or its parts if the fit has split it."""
    if not kind.split:
        return [one]
    of_part = one.rows[kind.split]
    masks = {f"{kind.split}={value:.12g}": of_part == value for value in np.unique(of_part)}
    return [replace(one, label=label, rows={key: row[mask] for key, row in one.rows.items()}) for label, mask in masks.items()]


def xy_curve(kind, result, one):
    """The curve of y over x."""
    keys = [names[0] for names in kind.columns]
    x, y = (np.asarray(one.rows[key], dtype=float) for key in (keys[0], keys[-1]))
    used = np.isfinite(x) & np.isfinite(y) & (x >= result.x_range[0]) & (x <= result.x_range[1])
    label = one.label if len(result.table.labels) > 1 else None
    fitted = np.full(x.shape, np.nan)
    fitted[used] = result.predict(x[used], label)
    low, high = x[used].min(), x[used].max()
    dense = np.geomspace(low, high, 300) if "x" in kind.log and low > 0.0 else np.linspace(low, high, 300)
    names, errors = (one.names[keys[0]], one.names[keys[-1]]), one.rows.get("errors")
    return FittedCurve(one.label, *names, x, y, errors, fitted, dense, result.predict(dense, label), bool(result.verdict))


def stress_curves(kind, fitted, one):
    """Both stresses over eps_D, at the points used: the first ones."""
    result = fitted.result
    used = np.flatnonzero(np.all([np.isfinite(one.rows[names[0]]) for names in kind.columns], axis=0))[: result.points // 2]
    found = []
    for k, (x_name, y_name) in enumerate(kind.panels):
        x, fitted_y = one.rows[x_name], np.full(one.rows[x_name].shape, np.nan)
        fitted_y[used] = result.predict(x[used])[k]
        found.append(
            FittedCurve(one.label, x_name, y_name, x, one.rows[y_name], None, fitted_y, x[used], fitted_y[used], bool(result.verdict))
        )
    return found


def save(path, kind, done, curves):
    """Writes data and fits as an HDF5 file: a group "curve-N" for each curve, the values as attributes of the root."""
    import json

    import xarray as xr

    from anisogran.files import json_text, save_results

    groups = {}
    for number, curve in enumerate(curves, start=1):
        rows = {"x": curve.x, "y": curve.y, "fitted": curve.fitted}
        if curve.errors is not None:
            rows["y_error"] = curve.errors
        attributes = {"source": curve.label, "x": curve.x_name, "y": curve.y_name, "trustworthy": int(curve.trustworthy)}
        groups[f"curve-{number}"] = xr.Dataset({name: ("point", np.asarray(row)) for name, row in rows.items()}, attrs=attributes)
    fits = [json.loads(json_text(plain_result(one))) for one in done]
    save_results(path, groups, {"kind": kind, "fits": json.dumps(fits)})
