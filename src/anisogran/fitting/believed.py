"""Which error to believe: the covariance, the profile or the bootstrap.

Each answers one question more than the one before it, and costs more; they agree where nothing is wrong.

1. The covariance (one solution of a linear problem) takes the curve as linear in its parameters within the error, and the residuals
   as noise with a finite memory, whose correlation time is estimated.
2. The profile (some ten fits for each limit) follows the curve: its limits need not lie symmetrically. It takes the same noise.
   Where the two differ by more than a tenth, the curve bends within the error, and the profile is right.
3. The bootstrap (as many fits as samples) draws the noise from the residuals as they are: not Gaussian, with outliers, with another
   memory. Its errors are themselves known to 1/sqrt(2 samples), 5 % for 200. Where they exceed the covariance by more than a quarter,
   the noise is not what the other two take it for, and the bootstrap is right. Where they are smaller, nothing is gained: the
   bootstrap knows only the noise that is seen in one run.

With a robust loss only the bootstrap has an answer. A parameter that the verdict calls undetermined has none at all, whatever is
computed. And none of the three knows that a law is wrong: that is what the verdict is for.
"""

from dataclasses import dataclass

import numpy as np

BENT = 0.1  # difference of profile and covariance, in half-widths, above which the curve bends within the error
UNEXPECTED = 1.25  # ratio of the errors of bootstrap and covariance above which the noise is not what the covariance takes it for


@dataclass(frozen=True)
class ErrorComparison:
    """Intervals of the level `level` by each way, {name: (low, high)}; `believed` {name: way, or ""} and `reasons` {name: why}.

    Prints as a table.
    """

    level: float
    values: dict
    covariance: dict
    profile: dict
    bootstrap: dict
    believed: dict
    reasons: dict
    blocks: dict

    def interval(self, name):
        """(low, high) of the way that is believed, or nan."""
        way = self.believed[name]
        return getattr(self, way)[name] if way else (float("nan"), float("nan"))

    def __str__(self):
        head = ("parameter", "value", "covariance", "profile", "bootstrap", "believe")
        rows = [
            (
                name,
                f"{value:.5g}",
                *(_words(getattr(self, way)[name]) for way in ("covariance", "profile", "bootstrap")),
                self._belief(name),
            )
            for name, value in self.values.items()
        ]
        widths = [max(len(row[i]) for row in (head, *rows)) for i in range(len(head))]
        lines = ["   ".join(word.ljust(width) for word, width in zip(row, widths, strict=True)).rstrip() for row in (head, *rows)]
        lengths = ", ".join(f"{label}: {length}" if label else str(length) for label, length in self.blocks.items())
        return "\n".join([f"{self.level:.0%} intervals; points in a block of the bootstrap: {lengths}", *lines])

    def _belief(self, name):
        return f"{self.believed[name]}: {self.reasons[name]}" if self.believed[name] else self.reasons[name]


def comparison(result, level, samples, seed):
    """The `ErrorComparison` of a `FitResult`."""
    again = result.bootstrap(samples, seed)
    profiles = {name: result.profile(name, level) for name in result.values}
    beliefs = {name: _believed(result, name, profiles[name], again, level) for name in result.values}
    return ErrorComparison(
        level=level,
        values=result.values,
        covariance={
            name: result.interval(name, level) if result.errors_from == "covariance" else (np.nan, np.nan) for name in result.values
        },
        profile={name: (one.low, one.high) for name, one in profiles.items()},
        bootstrap={name: again.interval(name, level) for name in result.values},
        believed={name: way for name, (way, _) in beliefs.items()},
        reasons={name: why for name, (_, why) in beliefs.items()},
        blocks=again.blocks,
    )


def _believed(result, name, profile, again, level):
    """(way, why)."""
    if not np.isfinite(result.errors[name]):
        return "", "not determined"
    if result.errors_from == "bootstrap":
        return "bootstrap", "the loss is robust"
    ratio = again.errors[name] / result.errors[name]
    if ratio > UNEXPECTED:
        return "bootstrap", f"the residuals scatter it {ratio:.2g} times as much as the covariance expects"
    if profile.outcome:
        return "bootstrap", profile.outcome
    ends = np.array(result.interval(name, level))
    bend = float(np.max(np.abs(np.array([profile.low, profile.high]) - ends)) / (0.5 * np.ptp(ends)))
    if bend > BENT:
        return "profile", f"a limit is moved by {bend:.0%}, the curve bends within the error"
    return "covariance", "all three agree"


def _words(interval):
    return f"{interval[0]:.4g} .. {interval[1]:.4g}" if not np.any(np.isnan(interval)) else "-"
