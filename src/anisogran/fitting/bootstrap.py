"""Block bootstrap of the residuals: the fit is repeated on data made of the fitted curve and of its own residuals, drawn in blocks."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import norm
from scipy.stats import t as student

from anisogran.fitting.problem import follow
from anisogran.outcome import InputError

_BLOCK = 4.0  # length of a block in correlation times
_BLOCKS = 5  # a data set is cut into this many blocks at least
_TOLERANCE = 1e-8  # of the minimiser, relative; far below the scatter of the samples


@dataclass(frozen=True)
class Bootstrap:
    """`draws[name]`, shape (samples - failed,), are the values of the repeated fits; `blocks[label]` the length of the blocks in points.

    errors  name: their standard deviation, nan where the data cannot determine the parameter;  failed  samples without a minimum
    """

    draws: dict
    values: dict
    errors: dict
    blocks: dict
    samples: int
    seed: int
    failed: int
    free: dict

    def interval(self, name, level=0.95):
        """(low, high) that covers the true value with this probability, or nan; InputError as `FitResult.interval`.

        Percentiles of the draws, moved away from the value by the ratio of Student's t to the normal law, since the noise itself is
        only known from few points.
        """
        if name not in self.values or not 0.0 < level < 1.0:
            raise InputError(f"interval: needs one of {', '.join(self.values)} and a level in (0, 1), got {name!r}, {level!r}")
        if not np.isfinite(self.errors[name]):
            return float("nan"), float("nan")
        tail, value = 0.5 + 0.5 * level, self.values[name]
        stretch = float(student.ppf(tail, self.free[name]) / norm.ppf(tail))
        low, high = np.quantile(self.draws[name], [1.0 - tail, tail])
        return float(value + stretch * (low - value)), float(value + stretch * (high - value))

    def __str__(self):
        lengths = sorted(set(self.blocks.values()))
        length = str(lengths[0]) if len(lengths) == 1 else f"{lengths[0]} to {lengths[-1]}"
        numbers = (f"{n} +- {e:.2g}" if np.isfinite(e) else f"{n} not determined" for n, e in self.errors.items())
        failed = f", {self.failed} failed" if self.failed else ""
        return f"bootstrap of {self.samples} samples (seed {self.seed}, blocks of {length} points{failed}): {', '.join(numbers)}"


def resampled(estimate, samples, seed, block=None):
    """(draws in scaled variables, shape (samples - failed, P), lengths of the blocks, shape (K,))."""
    rng, problem = np.random.default_rng(seed), estimate.problem
    lengths = np.array([_length(estimate, k, block) for k in range(len(problem.sets))])
    noises = [_noise(estimate, k, lengths[k]) for k in range(len(problem.sets))]
    curves = [points.y + problem.raw(k, estimate.theta) / points.weight for k, points in enumerate(problem.sets)]
    parts = [problem.part(group) for group in estimate.spread.components]
    draws = np.full((samples, estimate.theta.size), np.nan)
    for draw in draws:
        sets = [
            points._replace(y=curve - _drawn(rng, noise, length, points.y.size) / points.weight)
            for points, curve, noise, length in zip(problem.sets, curves, noises, lengths, strict=True)
        ]
        for group, (part, used) in zip(estimate.spread.components, parts, strict=True):
            again = replace(part, sets=tuple(sets[k] for k in group))
            theta, chi_square = follow(again, estimate.theta[used], tolerance=_TOLERANCE)
            if np.isfinite(chi_square):
                draw[used] = theta
    return draws[np.all(np.isfinite(draws), axis=1)], lengths


def _length(estimate, k, block):
    """Points in a block: a few correlation times, one point for white noise."""
    size, tau = estimate.problem.sets[k].x.size, estimate.spread.taus[k]
    chosen = block if block is not None else 1 if tau < 1.2 else int(np.ceil(_BLOCK * tau))
    return max(1, min(int(chosen), size // _BLOCKS))


def _noise(estimate, k, length):
    """Residuals to draw from, shape (m,), in order.

    They are scaled such that the sum over a block has the variance that the degrees of freedom and the correlation time
    demand: the fit has followed the slow part of the noise, which is missing in the residuals. Data sets too short to tell their own noise
    draw from the residuals of all.
    """
    problem, about = estimate.problem, estimate.spread
    if about.own[k]:
        pool = problem.raw(k, estimate.theta)
    else:
        pool = np.concatenate([problem.raw(m, estimate.theta) / np.sqrt(one.importance) for m, one in enumerate(problem.sets)])
    if problem.bend is None:  # a robust fit has put zero where it belongs, and outliers have moved the mean
        pool = pool - np.mean(pool)
    sums = np.cumsum(np.concatenate([[0.0], pool, pool[: length - 1]]))
    variance = float(np.mean((sums[length:] - sums[:-length]) ** 2)) / length
    wanted = about.variances[k]
    if problem.bend is not None:  # the variance of the bent residuals is not that of the residuals
        wanted = float(np.mean(pool**2)) * pool.size / max(pool.size - problem.index.shape[1], 1)
    return pool * np.sqrt(wanted / variance) if variance > 0.0 else pool


def _drawn(rng, noise, length, size):
    """`size` residuals in blocks, which run round the end to the beginning."""
    starts = rng.integers(noise.size, size=-(-size // length))
    return noise[(starts[:, None] + np.arange(length)).ravel()[:size] % noise.size]
