"""The mean over seeds, or other independent repetitions, and how well it is known."""

import numpy as np


def mean_and_error(values, axis=-1):
    """Mean of `values` along an axis and its standard error (NaN where there is but one value), two arrays without that axis."""
    values = np.asarray(values, dtype=float)
    mean, count = values.mean(axis=axis), values.shape[axis]
    if count < 2:
        return mean, np.full_like(mean, np.nan)
    return mean, values.std(axis=axis, ddof=1) / np.sqrt(count)
