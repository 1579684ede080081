"""Time means with honest errors: the record is cut into blocks longer than its memory, and the spread of the blocks is the error."""

import numpy as np
import xarray as xr

from anisogran.averaging.fields import field_values, half_turn, missing
from anisogran.glossary import CONVENTIONS, attributes

MOST_BLOCKS = 32
JUDGED = 8


class TimeBlocks:
    """Means of extensive quantities over blocks of time, of any number of snapshots in bounded memory.

    `size` snapshots a block; without it blocks are joined in pairs, and twice as long, whenever there are MOST_BLOCKS of them.
    """

    def __init__(self, size=None):
        self.size, self.fixed = size or 1, size is not None
        self.sums, self.counts = [], []

    def add(self, quantities):
        """Takes the quantities (a dict of arrays) of one more snapshot."""
        if not self.counts or self.counts[-1] == self.size:
            if not self.fixed and len(self.counts) == MOST_BLOCKS:
                self.sums = [{name: a[name] + b[name] for name in a} for a, b in zip(self.sums[::2], self.sums[1::2], strict=True)]
                self.counts = [a + b for a, b in zip(self.counts[::2], self.counts[1::2], strict=True)]
                self.size *= 2
            self.sums.append(dict.fromkeys(quantities, 0.0))
            self.counts.append(0)
        self.sums[-1] = {name: total + quantities[name] for name, total in self.sums[-1].items()}
        self.counts[-1] += 1

    def means(self):
        """The means over each block, a list of dicts; what does not fill the last block is left out of it."""
        whole = [k for k, count in enumerate(self.counts) if count == self.size]
        return [{name: total / self.size for name, total in self.sums[k].items()} for k in whole]

    def mean(self):
        """The mean over all snapshots."""
        return {name: sum(sums[name] for sums in self.sums) / sum(self.counts) for name in self.sums[0]}


def field_profiles(blocks, place, names):
    """(Dataset of the fields `names` of a place with errors `name_error`, Dataset of the blocks over "block") from a TimeBlocks.

    The fields are those of the mean quantities: quotients of means, not means of quotients. The error is the standard error of the mean
    from the spread of the blocks, enlarged for the correlation of neighbouring blocks; NaN with one block.
    """
    quantities, means = blocks.mean(), blocks.means()
    values = field_values(quantities, place, names)
    parts = [field_values(part, place, names) for part in means]
    mean = labelled(values, place, quantities["volume"]).assign_attrs(snapshots=sum(blocks.counts), blocks=len(parts))
    for name in names:
        record = np.stack([part[name] for part in parts]) if parts else np.empty((0, *values[name].shape))
        error, independent = standard_error(record, axis="period" in attributes(name))
        variable = mean[name]
        variable.attrs["independent_blocks"] = independent
        meaning = {**variable.attrs, "long_name": f"standard error of: {variable.attrs['long_name']}"}
        mean[f"{name}_error"] = (variable.dims, error.reshape(variable.shape), meaning)
    records = [labelled(part, place, one["volume"]) for part, one in zip(parts, means, strict=True)]
    records = xr.concat(records, "block") if records else None
    return mean, records


def with_errors(blocks, fields, coords):
    """Dataset of `fields(sums)`, a dict of arrays over the one coordinate, of the mean sums of a TimeBlocks; with errors `name_error`.

    For sums that belong to no place; the errors are those of `field_profiles`.
    """
    parts, variables, dim = [fields(sums) for sums in blocks.means()], {}, next(iter(coords))
    for name, values in fields(blocks.mean()).items():
        error, _ = standard_error(np.stack([part[name] for part in parts]))
        told = attributes(name)
        meaning = {**told, "long_name": f"standard error of: {told['long_name']}"}
        variables |= {name: (dim, values, told), f"{name}_error": (dim, error, meaning)}
    return xr.Dataset(variables, coords, {"conventions": CONVENTIONS, "blocks": len(parts)})


def standard_error(record, axis=False):
    """(standard error of the mean of a record (blocks, ...) of equal blocks, number of blocks that count as independent).

    Neighbouring blocks with the correlation c are worth (1 - c)/(1 + c) of independent ones; one c for the whole field, from the products
    of neighbours, since a single cell has too few blocks to tell. The angle of an `axis` is compared modulo half a turn.
    """
    count = len(record)
    if count < 2:
        return np.full(record.shape[1:], np.nan), float(count)
    deviation = half_turn(record - record[0]) if axis else record - record[0]
    deviation = deviation - deviation.mean(axis=0)
    scale = (deviation**2).sum(axis=0)
    known = np.isfinite(scale) & (scale > 0)
    neighbours = (deviation[1:] * deviation[:-1]).sum(axis=0)
    if count < JUDGED:
        return np.sqrt(scale / (count - 1) / count), float(count)
    found = float((neighbours[known] / scale[known]).mean()) if known.any() else 0.0
    # the mean has been taken out of the record, so c is found too low by (1 + 4 c)/count (Kendall 1954, from memory)
    correlation = min(max((found + 1 / count) / (1 - 4 / count), 0.0), 1 - 1 / count)
    independent = count * (1 - correlation) / (1 + correlation)
    return np.sqrt(scale / (count - 1) / independent), independent


def labelled(values, place, volume):
    """The values (a dict of arrays (..., cells)) of the fields of a place as a Dataset with dims, units, frame and conventions.

    `volume` (cells,) that was averaged over is a coordinate, of the whole box an attribute as well.
    """
    variables = {}
    for name, array in values.items():
        rank = array.ndim - 1
        told = attributes(name, place.dimension)
        if np.isnan(array).any():
            told["reason"] = missing(name)
        variables[name] = ((*"ijk"[:rank], *place.dims), array.reshape(array.shape[:rank] + place.shape), told)
    coords = {name: (dims, array, attributes(name)) for name, (dims, array) in place.coords().items()}
    if place.name != "points":  # a kernel is a density already, there is no volume
        coords["volume"] = (place.dims, volume.reshape(place.shape), attributes("volume", place.dimension))
    whole = {"volume": float(volume[0])} if place.name == "box" else {}
    told = {"conventions": CONVENTIONS, "on": place.name, "frame": place.frame, **place.attributes(), **whole}
    return xr.Dataset(variables, coords, told)


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


def chance_drift(count, chance=0.01):
    """What |drift| of a steady record of that many independent values exceeds by `chance` only; infinite for fewer than four."""
    from scipy.stats import t  # slow to import, and only needed here

    half = count // 2
    return float(t.ppf(1 - 0.5 * chance, 2 * half - 2)) if half > 1 else np.inf
