"""A whole law fitted to whole curves at once: biaxial ones at several pressures, simple shear, compression, cycles."""

from collections.abc import Mapping
from inspect import signature

import numpy as np

from anisogran.fitting.calibrated import LawFit, misfits
from anisogran.fitting.gate import Verdict
from anisogran.fitting.law_curves import measured
from anisogran.fitting.law_paths import LawPaths
from anisogran.fitting.law_starts import bounded, first_guess, spread_guesses
from anisogran.fitting.least_squares import Parameter, Part, fit_together
from anisogran.fitting.observations import Observations
from anisogran.fitting.sharing import nearest
from anisogran.models.element import element_test
from anisogran.models.laws import LAWS
from anisogran.outcome import InputError, checked

MISFIT = 2.0  # errors; a law that leaves more than this does not follow a curve
_FAR = 10.0  # moduli stay within this factor of the first guess: where a law is wrong they would run away, and stiffness costs time
_FAR_RATE = 1e3  # rates likewise
_LEAST = 0.2  # of the first guess, the smallest limit of a stress ratio
_MODEST = 0.2  # of sqrt(E B): A_max is compared with this, since it may be zero


def calibrate(law, curves, *, free=(), fixed=None, ties=None, own=(), shared=None, start=None):
    """The `LawFit` of a law to one or more `Curve`s by least squares: values, errors, correlations, a verdict, the element tests.

    law      a name of `LAWS`; all its parameters without a default are free
    free     further ones, such as G of the tensorial law (default: the lecture's 2G = E - B)
    fixed    {name: value}, such as {"beta_F": 40.0}
    ties     {name: function of the dict of all others}, such as {"G": lambda p: 0.5 * p["B"]} for B = 2G
    own      names of parameters of which each curve has its own; shared: {name: conditions}, those that curves with equal conditions
             share; all others are shared by all
    start    {name: value} of some or all free parameters, to begin with; else from relaxation and initial slopes of the curves

    Every point counts by its error. By default a column has one error, its scatter about a smooth curve, at least 1 % of its range; the
    remarks say which. A law that leaves more than `MISFIT` errors on a column does not follow it: the verdict is false and there are no
    error bars, since what is left is no noise. Give larger errors to say how near a law needs to be.
    Trial parameters with which the law cannot follow a path to its end are penalised, see `LawPaths`; if the best fit itself is such, the
    verdict is false and says where it ends. Noise in what is prescribed is not known of; above all strains that go back and forth in a
    measured control are taken as reversals. Moduli stay within 10 times the first guess, rates within 1000 times.
    The points of a curve are taken as a series, with correlated residuals.
    Raises InputError for what makes no sense, naming curve, parameter or column; NotConverged if no start gives a curve.
    """
    where = "calibrate"
    if law not in LAWS:
        raise InputError(f"{where}: law = {law!r}; {nearest(law, LAWS)}")
    fixed, ties, start = dict(fixed or {}), dict(ties or {}), dict(start or {})
    names = _free_names(where, law, free, fixed, ties)
    data = measured(law, curves)
    shared = _shared(where, names, own, shared)
    _known(where, "start", start, names)
    first = first_guess(law, names, data) | {name: checked(f"{where}: start", name, value) for name, value in start.items()}
    parameters = tuple(_parameter(name, first) for name in names)
    units = np.array([parameter.unit for parameter in parameters])
    scale = max(float(np.ptp(one.values)) for one in data)
    paths = LawPaths(law, names, fixed, ties, data, units, scale)
    if start:  # to name what is wrong with it
        paths.record([first[name] for name in names])

    def inside(guess):
        scaled = np.array([guess[name] for name in names]) / units
        within = all(q.lower < value < q.upper for q, value in zip(parameters, scaled, strict=True))
        return within and all(paths.driven(k, scaled * units) is not None for k in range(len(data)))

    guesses = [first, *spread_guesses(names, first, inside)]
    starts = np.array([[guess[name] for name in names] for guess in guesses]) / units
    parts = []
    for k, one in enumerate(data):
        values = one.values
        errors = np.ones(values.size) if one.given else None
        rows = Observations(one.at.astype(float), values, errors, one.rows.size - one.at.size)
        parts.append(Part(rows, starts, one.label, {**one.curve.conditions}, one.curve.weight, {"path": k}))
    result = fit_together(
        f"{law} law along {len(data)} {'path' if len(data) == 1 else 'paths'}", paths.curve, parameters, parts, scales=(1.0, scale),
        series=True, shared=shared, together_first=True, where=where,
    )  # fmt: skip
    return _judged(result, paths)


def _judged(result, paths):
    """The `LawFit`, with what the law itself has to say against it."""
    columns, tests, reasons = {}, {}, []
    for one in paths.curves:
        values = result.of(one.label)
        parameters = paths.parameters([values[name] for name in paths.names])
        tests[one.label] = element_test(paths.law, parameters, one.curve.control, one.curve.start)
        columns[one.label] = misfits(paths.law, one, parameters)
        if not tests[one.label].status:
            reasons.append(f"{one.label}: the law cannot follow the path with these values: {tests[one.label].status}")
        for name, misfit in columns[one.label].items():
            if misfit.in_errors > MISFIT:
                reasons.append(f"{one.label}: the law does not follow {name}: {misfit}")
    remarks = [remark for one in paths.curves for remark in one.remarks]
    verdict = Verdict((*result.verdict.reasons, *reasons), (*remarks, *result.verdict.remarks))
    facts = dict(vars(result)) | {"verdict": verdict}
    if reasons:
        facts["errors"] = dict.fromkeys(result.errors, float("nan"))
    return LawFit(**facts, columns=columns, tests=tests, _paths=paths)


def _free_names(where, law, free, fixed, ties):
    """The names of the free parameters, in the order of the law."""
    known = signature(LAWS[law].checked_parameters).parameters
    free = (free,) if isinstance(free, str) else tuple(free)
    for key, group in (("free", free), ("fixed", fixed), ("ties", ties)):
        _known(where, key, group, known)
    for name in known:
        roles = [key for key, group in (("free", free), ("fixed", fixed), ("ties", ties)) if name in group]
        if len(roles) > 1:
            raise InputError(f"{where}: {name} cannot be {' and '.join(roles)} at once")
    for name, tie in ties.items():
        if not callable(tie):
            raise InputError(f"{where}: ties: {name} must be a function of the dict of all others, is {tie!r}")
    names = [name for name, q in known.items() if name in free or (q.default is q.empty and name not in fixed and name not in ties)]
    if not names:
        raise InputError(f"{where}: nothing is left to fit")
    return tuple(names)


def _shared(where, names, own, shared):
    """What `fit_together` takes: all by all but what is said."""
    own, shared = (own,) if isinstance(own, str) else tuple(own), dict(shared or {})
    if not isinstance(own, tuple) or set(own) & set(shared):
        raise InputError(f"{where}: {', '.join(set(own) & set(shared))} cannot be own and shared at once")
    _known(where, "own", own, names)
    return {name: "all" for name in names if name not in own} | shared


def _known(where, key, group, known):
    if isinstance(group, Mapping | tuple):
        for name in group:
            if name not in known:
                raise InputError(f"{where}: {key}: unknown parameter {name!r}; {nearest(name, known)}")


def _parameter(name, first):
    """The scaled variable of a parameter: in units of the first guess, between bounds."""
    value = first[name]
    if name == "A_max":  # of either sign, or zero
        unit = _MODEST * float(np.sqrt(first["E"] * first["B"])) if {"E", "B"} <= set(first) else abs(value)
        return Parameter(name, unit, -_FAR / _MODEST, _FAR / _MODEST, level=True)
    if not value > 0.0:
        raise InputError(f"calibrate: start: {name} = {value:g} must be above 0")
    far = _FAR_RATE if name.startswith("beta") else _FAR
    highest = (0.5 * np.pi if name.startswith(("phi", "psi")) and name != "phi_max" else 1.0) / value if bounded(name) else far
    return Parameter(name, value, _LEAST if bounded(name) else 1.0 / far, highest)
