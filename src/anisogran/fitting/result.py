"""What a fit returns."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.stats import t as student

from anisogran.fitting.believed import comparison
from anisogran.fitting.bootstrap import Bootstrap, resampled
from anisogran.fitting.estimate import Estimate
from anisogran.fitting.gate import Verdict
from anisogran.fitting.profile import Profile, limits
from anisogran.fitting.sharing import Sharing, nearest
from anisogran.outcome import InputError


@dataclass(frozen=True)
class FitResult:
    """Values with honest errors, and a verdict that must be read: `if not result.verdict: print(result.verdict)`.

    law           the fitted formula
    values        name: best value, in the units of the data
    errors        name: one standard error, correlated residuals included; nan if the data cannot determine the parameter
    errors_from   "covariance", or "bootstrap" with a robust loss; `compare_errors` says which error to believe
    correlations  (name, name): correlation of the two estimates, nan without an error
    verdict       truthy only if the fit is trustworthy; `.reasons`, `.remarks`
    table         which variable each parameter of each data set is (`Sharing`, prints as a table)
    points        number of points used;  x_range  their first and last abscissa
    dropped       number of points left out because they are not finite (or not positive, where a logarithm is taken)
    cut           number of points left out on purpose, such as those after the peak
    free          degrees of freedom in independent points, n/tau - p
    residuals     "rms" and "largest" (units of y), "chi_square" (weighted sum of squares), "correlation_time" tau in points,
                  "independent_points" n/tau, "runs_p" (probability of signs so ordered), "condition"
    data_sets     the same figures for each data set, by label, without "condition"
    starts        the start values tried, one dict for each;  start  the one that led to the values
    lmfit_version
    """

    law: str
    values: dict
    errors: dict
    correlations: dict
    errors_from: str
    verdict: Verdict
    table: Sharing
    points: int
    x_range: tuple
    dropped: int
    cut: int
    free: float
    residuals: dict
    data_sets: dict
    starts: tuple
    start: dict
    lmfit_version: str
    _curve: Callable = field(repr=False, compare=False)
    _estimate: Estimate = field(repr=False, compare=False)
    _known: dict = field(repr=False, compare=False)

    def of(self, label):
        """{parameter: value} of one data set. Raises InputError for a label that there is not."""
        return {name: self.values[variable] for name, variable in self._variables(label)}

    def errors_of(self, label):
        """{parameter: error} of one data set, as `of`."""
        return {name: self.errors[variable] for name, variable in self._variables(label)}

    def _variables(self, label):
        if label not in self.table.labels:
            raise InputError(f"data set {label!r} is unknown; {nearest(label, self.table.labels)}")
        return [(name, self.table.variables[label, name]) for name in self.table.parameters]

    def predict(self, x, label=None):
        """The fitted curve at x, same shape, of the data set `label`; outside `x_range` it is an extrapolation.

        Raises InputError for a label that there is not, or none where there are several data sets.
        """
        if label is None and len(self.table.labels) == 1:
            label = self.table.labels[0]
        return self._curve(np.asarray(x, dtype=float), **self.of(label), **self._known[label])

    def interval(self, name, level=0.95):
        """(low, high) that covers the true value with this probability (Student's t with `free` degrees of freedom), or nan.

        Raises InputError for an unknown name or a level outside (0, 1).
        """
        self._check(name, level)
        if not np.isfinite(self.errors[name]):
            return float("nan"), float("nan")
        half = float(student.ppf(0.5 + 0.5 * level, self._free_of(name))) * self.errors[name]
        return self.values[name] - half, self.values[name] + half

    def _free_of(self, name):
        """The degrees of freedom behind the error of a parameter."""
        return self._estimate.spread.free_of[self._estimate.names.index(name)]

    def profile(self, name, level=0.95):
        """The `Profile` of one parameter: limits that need not lie symmetrically, or an outcome that says why there are none.

        A parameter that the verdict calls undetermined gets no interval; it may get one limit, if the other one is open.
        Raises InputError as `interval`.
        """
        self._check(name, level)
        if self.errors_from == "bootstrap":
            return Profile(float("nan"), float("nan"), level, "a robust loss has no likelihood")
        found = limits(self._estimate, name, level)
        if not np.isfinite(self.errors[name]) and np.isfinite(found.low) == np.isfinite(found.high):
            return Profile(float("nan"), float("nan"), level, found.outcome or "the data do not determine it, see the verdict")
        return found

    def bootstrap(self, samples=200, seed=0, block=None):
        """The `Bootstrap` of all parameters: block bootstrap of the residuals, `block` points in a block (default: 4 correlation times).

        Raises InputError for fewer than 20 samples, or a block that is no number of points.
        """
        if not (isinstance(samples, int) and samples >= 20 and (block is None or (isinstance(block, int) and block >= 1))):
            raise InputError(f"bootstrap: samples = {samples!r} must be at least 20, block = {block!r} at least 1 or None")
        scaled, lengths = resampled(self._estimate, samples, seed, block)
        draws = dict(zip(self.values, (scaled * self._estimate.units).T, strict=True))
        return Bootstrap(
            draws=draws,
            values=self.values,
            errors={n: float(np.std(draws[n], ddof=1)) if np.isfinite(self.errors[n]) else float("nan") for n in self.values},
            blocks=dict(zip(self.table.labels, lengths.tolist(), strict=True)),
            samples=samples,
            seed=seed,
            failed=samples - len(scaled),
            free=dict(zip(self.values, self._estimate.spread.free_of.tolist(), strict=True)),
        )

    def compare_errors(self, level=0.95, samples=200, seed=0):
        """The `ErrorComparison`: intervals from covariance, profile and bootstrap side by side, and which one to believe."""
        return comparison(self, level, samples, seed)

    def _check(self, name, level):
        if name not in self.values or not 0.0 < level < 1.0:
            raise InputError(f"interval: needs one of {', '.join(self.values)} and a level in (0, 1), got {name!r}, {level!r}")

    def __str__(self):
        numbers = (f"{n} = {v:.5g} +- {self.errors[n]:.2g}" if np.isfinite(self.errors[n]) else f"{n} = {v:.5g} (not determined)"
                   for n, v in self.values.items())  # fmt: skip
        return f"{self.law}: {', '.join(numbers)}; {self.verdict}"
