"""A calibrated law: its parameters with errors, the element tests that they give, and how well these follow the curves."""

from dataclasses import dataclass, field

import numpy as np

from anisogran.fitting.law_curves import column, measured
from anisogran.fitting.law_paths import LawPaths
from anisogran.fitting.result import FitResult
from anisogran.models.element import ElementTest, element_test
from anisogran.models.laws import law_parameters
from anisogran.outcome import InputError


@dataclass(frozen=True)
class Misfit:
    """How far a law lies from one measured column, in its unit: `rms` and `largest`; `error` is the typical error of a point,
    `extent` the range of the measured values, `points` how many the law reached."""

    rms: float
    largest: float
    error: float
    extent: float
    points: int

    @property
    def in_errors(self):
        """rms over the error: 1 for a law that leaves noise."""
        return self.rms / self.error

    def __str__(self):
        return f"rms {self.rms:.3g} ({self.in_errors:.2g} errors, {self.rms / self.extent:.2%} of the range), largest {self.largest:.3g}"


@dataclass(frozen=True)
class Comparison:
    """A law beside a curve that it need not have been fitted to: `columns` {name: Misfit}, and the ElementTest `test`; prints as text."""

    label: str
    columns: dict
    test: ElementTest

    def __str__(self):
        ended = [] if self.test.status else [f"{self.label}: {self.test.status}"]
        return "\n".join([*(f"{self.label}: {name}: {misfit}" for name, misfit in self.columns.items()), *ended])


@dataclass(frozen=True)
class LawFit(FitResult):
    """A `FitResult` of a whole law; what has no meaning for a law of many columns is in units of the errors: `residuals`, `data_sets`.

    columns   {curve label: {column: Misfit}}
    tests     {curve label: ElementTest} of the best fit along the measured paths
    """

    columns: dict
    tests: dict
    _paths: LawPaths = field(repr=False, compare=False)

    def parameters(self, label=None):
        """{name: value} of all parameters of the law, fixed and tied ones too, as `element_test` takes them.

        `label` is that of a curve, if parameters are own. Raises InputError for a label that there is not, or none where it matters.
        """
        own = len(set(self.table.variables.values())) > len(self.table.parameters)
        if label is None and own:
            raise InputError(f"parameters: curves have own ones; name one of {', '.join(self.table.labels)}")
        values = self.of(self.table.labels[0] if label is None else label)
        return self._paths.parameters([values[name] for name in self._paths.names])

    def predict(self, control, start=None, label=None):
        """The ElementTest of the fitted law along any path, such as one at a pressure that was not fitted; see `element_test`."""
        return element_test(self._paths.law, self.parameters(label), control, start)

    def compare(self, curve, label=None):
        """The `Comparison` with a `Curve` that need not have been fitted, with the parameters of the fitted curve `label`."""
        (one,) = measured(self._paths.law, [curve])
        test = self.predict(curve.control, curve.start, label)
        return Comparison(one.label, misfits(self._paths.law, one, self.parameters(label)), test)

    def __str__(self):
        misfits = [f"{label}: {name}: {misfit}" for label, of in self.columns.items() for name, misfit in of.items()]
        return "\n".join([str(self.table), super().__str__(), *misfits])


def misfits(law, one, parameters):
    """{column: Misfit} of a `Measured` curve for parameters of the law, over the points that it reaches."""
    driven = one.path.driven(law_parameters(law, **parameters))
    found = {}
    for name, row, errors in zip(one.names, one.rows, one.errors, strict=True):
        n = len(driven.states)
        left = column(law, name, driven.states, driven.strains) - row[:n]
        known = np.isfinite(left)
        left, errors = left[known], errors[:n][known]
        rms = float(np.sqrt(np.mean(left**2))) if left.size else float("nan")
        weighted = float(np.sqrt(np.mean((left / errors) ** 2))) if left.size else float("nan")
        error = rms / weighted if weighted > 0.0 else float(np.sqrt(np.mean(one.errors[0] ** 2)))
        largest = float(np.max(np.abs(left))) if left.size else float("nan")
        found[name] = Misfit(rms, largest, error, float(np.nanmax(row) - np.nanmin(row)), int(left.size))
    return found
