"""Time means with honest errors: the record is cut into blocks longer than its memory, and the blocks are taken as independent."""

import numpy as np
import xarray as xr


def mean_and_error(blocks, dimension="block"):
    """Mean over the blocks, and for each variable `name` a `name_error`: the standard error of the mean from the spread of the blocks.

    With one block the error is unknown: NaN. The number of blocks is in the attributes.
    """
    count = blocks.sizes[dimension]
    mean = blocks.mean(dimension, keep_attrs=True)
    spread = blocks.std(dimension, ddof=1) / np.sqrt(count) if count > 1 else xr.full_like(mean, np.nan)
    for name in list(blocks.data_vars):
        attributes = dict(mean[name].attrs)
        attributes["long_name"] = f"standard error of: {attributes.get('long_name', name)}"
        mean[f"{name}_error"] = spread[name].assign_attrs(attributes)
    return mean.assign_attrs(blocks.attrs, blocks=count)


def drift(values):
    """How far a record moved: difference of its second and first half over their joint standard error; 0/0 counts as no drift."""
    values = np.asarray(values, dtype=float)
    half = len(values) // 2
    first, second = values[:half], values[-half:]
    error = np.sqrt(first.var(ddof=1) / half + second.var(ddof=1) / half) if half > 1 else np.nan
    shift = second.mean() - first.mean()
    return 0.0 if shift == 0 else float(shift / error)
