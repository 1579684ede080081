"""Where the calibration of a law starts: cheap fits to the curves, and a spread about them."""

import numpy as np
from scipy.stats import qmc

from anisogran.fitting.exponential_approach import relaxation
from anisogran.fitting.initial_slope import initial_moduli
from anisogran.models.controls import ROWS
from anisogran.models.laws import LAWS
from anisogran.outcome import InputError, NotConverged

STARTS = 8  # beside the first
_TRIES = 200
_BETA = 5.0  # over the largest strain, where no curve tells how fast the stress ratio saturates


def first_guess(law, names, curves):
    """{name: value} of the free parameters from relaxation and initial slopes of the curves, or examples of the law."""
    told = _told(curves)
    limits = {"s_max": told["s_max"], "E": told["E"], "B": told["B"], "G": 0.5 * told["B"], "beta_F": 0.5 * told["beta"]}
    limits |= {"A_max": 0.3 * float(np.sqrt(told["E"] * told["B"])), "phi": float(np.arcsin(told["s_max"]))}
    return {name: limits.get(name, LAWS[law].KEYS[name][2]) for name in names}


def spread_guesses(names, first, valid):
    """`STARTS` guesses about the first one: factors up to 4 for moduli and rates, 1.25 for limits of stress, either sign of A_max.

    Only those that `valid` accepts; the same ones every time.
    """
    found, points = [], qmc.Halton(len(names), scramble=False)
    points.fast_forward(1)
    for point in points.random(_TRIES):
        guess = {name: _moved(name, first[name], 2.0 * u - 1.0) for name, u in zip(names, point, strict=True)}
        if valid(guess):
            found.append(guess)
        if len(found) == STARTS:
            break
    return found


def _moved(name, value, u):
    """A value moved by u in (-1, 1)."""
    if name == "A_max":
        return value * (0.5 + 1.5 * u)
    return value * (1.25 if bounded(name) else 4.0) ** u


def bounded(name):
    """Whether a parameter is a ratio or an angle of limited range, not a modulus or a rate."""
    return name in ("s_max", "phi", "phi_residual", "psi", "mu_s", "mu_d", "phi_max")


def _told(curves):
    """E, B, s_max, and beta of the stress ratio as all curves together tell them: medians."""
    found = {"E": [], "B": [], "s_max": [], "beta": []}
    largest = 0.0
    for one in curves:
        eps, sigma = (_components(one, kind) for kind in ("eps", "sigma"))
        if sigma is None or eps is None:
            continue
        known = np.all(np.isfinite(eps), axis=0) & np.all(np.isfinite(sigma), axis=0)
        eps, sigma = eps[:, known], sigma[:, known]
        if eps.shape[1] < 4 or np.any(sigma[0] <= 0.0):
            continue
        largest = max(largest, float(np.max(np.abs(eps[1:]))))
        _tell(found, eps, sigma)
    stress = _typical_stress(curves)
    s_max = float(np.clip(np.median(found["s_max"]), 0.01, 0.9)) if found["s_max"] else 0.3
    beta = float(np.median(found["beta"])) if found["beta"] else _BETA / (largest or 0.1)
    B = float(np.median(found["B"])) if found["B"] else beta * s_max * stress
    E = float(np.median(found["E"])) if found["E"] else 2.0 * B
    return {"E": E, "B": B, "s_max": s_max, "beta": beta}


def _tell(found, eps, sigma):
    """Adds what one curve tells, up to its first reversal."""
    size = np.hypot(*(eps[1:] - eps[1:, :1]))
    falls = np.flatnonzero(np.diff(size) < 0.0)
    used = slice(None if falls.size == 0 else int(falls[0]) + 1)
    eps, sigma, size = eps[:, used], sigma[:, used], size[used]
    deviator = np.hypot(*sigma[1:])
    try:
        fit = relaxation(size, deviator / sigma[0])
        if 0.0 < fit.values["s_max"] < 1.0 and fit.values["beta"] > 0.0:
            found["s_max"].append(fit.values["s_max"])
            found["beta"].append(fit.values["beta"])
    except (InputError, NotConverged):
        pass  # a path without shear tells nothing of it
    try:
        moduli = initial_moduli(eps[0], size, sigma[0], deviator).values
        for name in ("E", "B"):
            if moduli[name] > 0.0:
                found[name].append(moduli[name])
    except InputError:
        pass  # a path of one kind of strain leaves a modulus open


def _components(one, kind):
    """(V, 1, 2) of strain or stress along a curve, (3, n), if control and measurement tell all three, else None."""
    rows = {key: np.broadcast_to(values, one.path.size) for key, values in one.path.plan.path.items() if key in one.path.plan.rows}
    rows |= dict(zip(one.names, one.rows, strict=True))
    rows = {key: row for key, row in rows.items() if key.split("_")[0] == kind and key.split("_")[1] in ROWS}
    if not any(key.endswith("xz") for key in rows):
        rows[f"{kind}_xz"] = np.zeros(one.path.size)
    matrix = np.array([ROWS[key.split("_")[1]] for key in rows])
    if np.linalg.matrix_rank(matrix) < 3:
        return None
    return np.linalg.pinv(matrix) @ np.array(list(rows.values()))


def _typical_stress(curves):
    stresses = [np.abs(row) for one in curves for name, row in _stresses(one)]
    return float(np.nanmean(np.concatenate(stresses))) if stresses else 1.0


def _stresses(one):
    yield from ((name, np.atleast_1d(row)) for name, row in one.path.plan.path.items() if name.startswith("sigma"))
    yield from ((name, row) for name, row in zip(one.names, one.rows, strict=True) if name.startswith("sigma"))
