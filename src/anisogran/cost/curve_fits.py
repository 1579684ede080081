"""What accuracy costs in the fits: number of points, strain reached, loss, size of a bootstrap, and the kinds of error bar.

The data are made up: the exponential approach of the stress ratio with known values, and noise of a known size. An error is the root
mean square over so many data sets of what the fit says less what was put in, relative to that; it is itself known to one over the root
of twice their number. Errors of both s_max and beta are told, since beta is the hard one. How many starts a fit tries is no knob.
"""

from functools import partial

import numpy as np
from scipy.stats import norm

from anisogran.cost.tables import row
from anisogran.cost.timing import clocked
from anisogran.fitting import relaxation
from anisogran.fitting.exponential_approach import approach

TRUTH = {"s_0": 0.02, "s_max": 0.45, "beta": 80.0}
STRAIN = 0.06  # eps_D at the end: beta eps_D = 4.8
NOISE = 0.02  # standard deviation
MEMORY = 0.001  # of correlated noise, in eps_D
OUTLIERS, OFF = 0.05, 0.2  # share of points, and how far they are off at most
POINTS = (25, 50, 100, 200, 400, 800, 1600)
ROWS = 400  # of a biaxial test, its default
STRAINS = (0.015, 0.02, 0.03, 0.04, 0.06)
SAMPLES = (20, 60, 200, 600)
DEFAULT_SAMPLES = 200


def fitting_cost(quick=False):
    """Rows {knob, value, error, seconds, default} for the fits, a list; processor seconds of one fit, means over the data sets."""
    sets, thin = (4, slice(None, None, 2)) if quick else (100, slice(None))
    told = f"error of {{}}, {sets} data sets"
    rows = block(f"points, white noise: {told}", ((n, data_sets(n, sets)) for n in POINTS[thin]), ROWS)
    correlated = ((n, data_sets(n, sets, memory=MEMORY)) for n in POINTS[thin])
    rows += block(f"points, noise with a memory of {MEMORY / STRAIN:.2g} of the path: {told}", correlated, ROWS)
    rows += block(f"largest eps_D, {ROWS} points: {told}", ((strain, data_sets(ROWS, sets, strain)) for strain in STRAINS[thin]), STRAIN)
    for name, outliers in {"clean data": 0.0, f"{OUTLIERS:.0%} outliers": OUTLIERS}.items():
        losses = ((loss, data_sets(100, sets, outliers=outliers)) for loss in ("linear", "soft_l1"))
        rows += block(f"loss, 100 points, {name}: {told}", losses, "linear")
    return rows + error_rows(data_sets(ROWS, sets), SAMPLES[thin], told.format("the errors of s_max and beta"))


def noise(eps_D, rng, memory=None):
    """White noise of the size NOISE on the points eps_D (n,), or that of a process that forgets over `memory`."""
    white = rng.normal(0.0, NOISE, eps_D.size)
    if memory is None:
        return white
    kept = np.exp(-(eps_D[1] - eps_D[0]) / memory)
    out = white.copy()
    for k in range(1, out.size):
        out[k] = kept * out[k - 1] + np.sqrt(1.0 - kept**2) * white[k]
    return out


def data_sets(points, sets, strain=STRAIN, memory=None, outliers=0.0):
    """[(eps_D (n,), s (n,)), ...]; outliers are a share of the points that lie too low, by up to OFF."""
    eps_D, found = np.linspace(0.0, strain, points), []
    for seed in range(sets):
        rng = np.random.default_rng(seed)
        s = approach(eps_D, **TRUTH) + noise(eps_D, rng, memory)
        found.append((eps_D, s - OFF * rng.random(points) * (rng.random(points) < outliers)))
    return found


def block(knob, entries, default):
    """Rows for s_max and beta of entries (value, data sets); the value is a loss if it is a word."""
    rows = {"s_max": [], "beta": []}
    for value, sets in entries:
        loss = value if isinstance(value, str) else "linear"
        results, seconds = clocked(lambda sets=sets, loss=loss: [relaxation(*one, until=None, loss=loss) for one in sets])
        for name, found in rows.items():
            error = np.sqrt(np.mean([(result.values[name] / TRUTH[name] - 1.0) ** 2 for result in results]))
            found.append(row(knob.format(name), value, float(error), seconds / len(sets), value == default))
    return rows["s_max"] + rows["beta"]


def error_rows(sets, counts, told):
    """How wrong standard errors are, of a bootstrap against its size and of each kind; seconds with those of the fit."""
    results, fit_seconds = clocked(lambda: [relaxation(*one, until=None) for one in sets])

    def entry(knob, value, errors_of, default):
        error, seconds = wrongness(results, errors_of)
        return row(f"{knob}: {told}", value, error, seconds + fit_seconds / len(sets), default)

    rows = [entry("samples of a bootstrap", n, partial(bootstrapped, samples=n), n == DEFAULT_SAMPLES) for n in counts]
    [usual] = [one for one in rows if one["default"]]
    rows.append(entry("kind of error bar", "covariance", lambda result: result.errors, True))
    rows.append(entry("kind of error bar", "profile", profiled, False))
    return [*rows, usual | {"knob": rows[-1]["knob"], "value": f"bootstrap of {DEFAULT_SAMPLES}", "default": False}]


def bootstrapped(result, samples):
    """{name: standard error} of a bootstrap whose seed goes with the data, so that no two data sets draw alike."""
    return result.bootstrap(samples=samples, seed=int(1e6 * abs(result.values["s_max"]))).errors


def profiled(result):
    """{name: standard error}: half the width of the profile where a normal law has one standard deviation."""
    limits = {name: result.profile(name, level=float(2.0 * norm.cdf(1.0) - 1.0)) for name in ("s_max", "beta")}
    return {name: 0.5 * (limit.high - limit.low) for name, limit in limits.items()}


def wrongness(results, errors_of):
    """(root mean square relative error of the standard errors of s_max and beta, mean seconds for one result)."""
    true = true_errors(ROWS)
    found, seconds = clocked(lambda: [errors_of(result) for result in results])
    square = np.mean([(errors[name] / true[name] - 1.0) ** 2 for errors in found for name in ("s_max", "beta")])
    return float(np.sqrt(square)), seconds / len(results)


def true_errors(points):
    """{name: standard error} of s_max and beta from white noise of the size NOISE: the linearised fit, exact for small noise."""
    eps_D = np.linspace(0.0, STRAIN, points)
    slopes = np.array([approach(eps_D, **TRUTH | {name: TRUTH[name] + 1e-30j}).imag / 1e-30 for name in TRUTH])
    covariance = NOISE**2 * np.linalg.inv(slopes @ slopes.T)
    return dict(zip(TRUTH, np.sqrt(np.diag(covariance)).tolist(), strict=True))
