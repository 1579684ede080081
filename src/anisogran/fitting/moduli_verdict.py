"""Fitted moduli as a result: the gate, whether the coupling is symmetric, and what to know in any case."""

import lmfit
import numpy as np

from anisogran.fitting.gate import RANDOM_SIGNS, STARTS, Evidence, Source, Verdict, judge
from anisogran.fitting.profile import Profile
from anisogran.fitting.residuals import runs_test
from anisogran.fitting.result import FitResult
from anisogran.fitting.sharing import Sharing
from anisogran.outcome import InputError

_SAME = 1e-3  # of E or B: two A that differ by less are the same for any use
_UNEQUAL = 0.5  # of their mean; measures that mix a full and a half strain make two A differ by 2/3 of it
_LEVELS = ("sigma_V_0", "sigma_D_0", "bend_V", "bend_D")  # stresses that may be zero, beside the moduli
_SIGNIFICANT = 3.0  # standard errors


class ModuliFit(FitResult):
    """A `FitResult` whose law is linear: one data set, no starts, and errors that the covariance tells in full."""

    def _free_of(self, name):
        return self.free

    def profile(self, name, level=0.95):
        """As in `FitResult`; for a linear law it is the interval."""
        low, high = self.interval(name, level)
        return Profile(low, high, level, "" if np.isfinite(low) else "the data do not determine it, see the verdict")

    def bootstrap(self, samples=200, seed=0, block=None):
        """InputError: a linear law needs none."""
        raise InputError("bootstrap: not for moduli, which are linear: their covariance knows the noise in both stresses and its memory")


def moduli_result(law, found, stress, curve, *, x_range, weight=1.0, dropped=0, cut=0, series=False, bias=None, symmetry=None,
                  reasons=None, remarks=()):  # fmt: skip
    """The `FitResult` of a `LinearEstimate`; a linear law has one minimum only, hence no starts.

    `bias` {name: size of a systematic error} is added to the errors in quadrature, `symmetry` is what `coupling` found, `reasons`
    {name: why the data do not determine this parameter}.
    """
    values, left = found.values, found.residual / weight
    noise, signal = float(np.sqrt(np.mean(left**2))), float(np.ptp(stress - left))
    names, sigma = list(values), np.sqrt(np.diag(found.covariance))
    errors = {name: float(np.hypot(error, (bias or {}).get(name, 0.0))) for name, error in zip(names, sigma, strict=True)}
    chi_square = float(np.sum(found.residual**2))
    evidence = Evidence(
        sources=(Source("", stress.size, signal, noise, tuple(names)),),
        free=found.free,
        values=values,
        errors=errors,
        sizes=_sizes(values, signal),
        # two moduli are told apart by the strains: one wall that moves both stresses correlates their errors, no more. And a modulus
        # that depends on where the stresses start or bend is still determined: its error knows of it
        correlations={pair: value for pair, value in _correlations(names, found.design).items() if pair[1] not in _LEVELS},
        at_bound=(),
        condition=found.condition,
        chi_square=chi_square,
        all_chi_squares=(chi_square,) * STARTS,
    )
    objections, open_names = judge(evidence)
    runs_p = runs_test(found.residual.ravel()) if series else float("nan")
    objections, remarks = [*objections, *(reasons or {}).values()], list(remarks)
    if symmetry is not None and abs(symmetry[0] - symmetry[1]) > _SAME * max(abs(values[name]) for name in ("E", "B")):
        (objections if _asymmetric(symmetry) else remarks).append(_symmetry_words(symmetry))
    remarks += _remarks(dropped, runs_p, found.tau)
    named = {} if symmetry is None else dict(zip(("A_in_sigma_V", "A_in_sigma_D", "A_difference_error"), symmetry, strict=True))
    figures = {
        "rms": noise, "largest": float(np.max(np.abs(left))), "chi_square": chi_square, "correlation_time": found.tau,
        "independent_points": float(found.effective / found.tau), "runs_p": runs_p,
    }  # fmt: skip
    return ModuliFit(
        law=law,
        values=values,
        errors={name: float("nan") if name in open_names | set(reasons or {}) else errors[name] for name in names},
        correlations=_correlations(names, found.covariance),
        verdict=Verdict(tuple(objections), tuple(remarks)),
        table=Sharing(tuple(names), ("",), {("", name): name for name in names}, {"": stress.size}, {"": 1.0}),
        points=stress.size,
        x_range=x_range,
        dropped=dropped,
        cut=cut,
        free=found.free,
        residuals={**figures, "condition": found.condition, **named},
        data_sets={"": figures},
        starts=(),
        start={},
        errors_from="covariance",
        lmfit_version=lmfit.__version__,
        _curve=curve,
        _estimate=None,
        _known={"": {}},
    )  # fmt: skip


def _correlations(names, covariance):
    """{(name, name): correlation}, nan without errors."""
    sigma = np.sqrt(np.diag(covariance))
    return {
        (a, b): float(covariance[i, j] / (sigma[i] * sigma[j])) if sigma[i] * sigma[j] > 0.0 else float("nan")
        for i, a in enumerate(names)
        for j, b in enumerate(names)
        if i < j
    }


def _remarks(dropped, runs_p, tau):
    if dropped:
        yield f"{dropped} points dropped"
    if runs_p < RANDOM_SIGNS:
        yield f"structure left in residuals (runs test p = {runs_p:.1e})"
    if tau > 1.5:
        yield f"residuals correlated over {tau:.1f} points, errors enlarged by {np.sqrt(tau):.1f}"


def _sizes(values, signal):
    """What the error of each is compared with: A may well be 0 and is seen against E and B, a stress against the signal, an angle
    against 1 rad, a modulus against itself."""
    stiff = max(abs(values.get(name, 0.0)) for name in ("E", "B"))
    special = {"A": stiff, "A_max": stiff, "phi_C": 1.0, **dict.fromkeys(_LEVELS, signal)}
    return {name: special.get(name, value) for name, value in values.items()}


def _asymmetric(symmetry):
    """Whether the two A differ so much, beyond their errors, that one A means nothing."""
    one, other, error = symmetry
    return abs(one - other) > max(_SIGNIFICANT * error, 0.5 * _UNEQUAL * abs(one + other))


def _symmetry_words(symmetry):
    one, other, error = symmetry
    beyond = f"{abs(one - other) / error:.1f} standard errors apart" if error > 0.0 else "no error to compare them by"
    return f"A = {one:.4g} in d sigma_V and {other:.4g} in d sigma_D ({beyond})"
