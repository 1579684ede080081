"""How large an error is, from runs that differ by chance: their scatter, and the slope of their mean against a power of a knob.

Values are numbers or profiles, (..., points), which are compared in relative L2 with weights of the points.
"""

import math
from typing import NamedTuple

import numpy as np

CHANCE = 0.5  # order of chance
FIRST = 1.0  # of the time step of a damped contact, and of the rate


class Slope(NamedTuple):
    """What the answers tend to as the power of the knob goes to 0, and how far they are from that at power 1, with its uncertainty."""

    limit: np.ndarray
    error: float
    uncertainty: float


def size(values, reference, weights=1.0):
    """The relative size of values: sqrt(sum w values^2 / sum w reference^2)."""
    values, reference = np.asarray(values, float), np.asarray(reference, float)
    return float(np.sqrt(np.sum(weights * values**2) / np.sum(weights * reference**2)))


def chance(values, counts=(1,), usual=1.0, weights=1.0):
    """(error of a mean over the `usual` number of repetitions, its uncertainty, [(count, error of a mean over so many)]).

    values (repetitions, ...). Means over 1, 2, ... of them scatter about that of all, which holds each of them; the error is what all
    counts make of the usual number, since all fall as one over its root. The uncertainty is that of a single normal quantity, whose
    scatter by one count holds that by the next: a profile of independent points knows its scatter better.
    """
    values = np.asarray(values, float)
    mean, measured = values.mean(axis=0), []
    for count in counts:
        sets = np.stack([values[k : k + count].mean(axis=0) for k in range(0, len(values) - count + 1, count)])
        spread = np.sqrt(np.mean((sets - mean) ** 2, axis=0) / (1.0 - count / len(values)))
        measured.append((count, size(spread, mean, weights)))
    error = math.sqrt(sum(count * error**2 for count, error in measured) / len(measured) / usual)
    free = np.array([len(values) / count - 1.0 for count in counts])
    return error, error * math.sqrt(0.5 * np.mean(1.0 / np.maximum.outer(free, free))), measured


def slope(powers, values, weights=1.0):
    """The Slope of values (knob, seeds, ...) at the powers (knob,): each seed has its own limit, all have one slope, by least squares.

    The uncertainty is what the residuals make of it.
    """
    values = np.asarray(values, float)
    knobs, seeds = values.shape[:2]
    x = np.asarray(powers, float) - np.mean(powers)
    y = values - values.mean(axis=0)
    change = np.tensordot(x, y.sum(axis=1), 1) / (seeds * np.sum(x**2))
    left = y - x.reshape(-1, *[1] * (y.ndim - 1)) * change
    free = seeds * (knobs - 1) - 1
    noise = np.sqrt(np.sum(left**2, axis=(0, 1)) / free / (seeds * np.sum(x**2)))
    limit = values.mean(axis=(0, 1)) - np.mean(powers) * change
    return Slope(limit, size(change, limit, weights), size(noise, limit, weights))
