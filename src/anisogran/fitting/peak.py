"""The peak of a curve, defined so that it does not depend on how often the curve was sampled: of a moving average over strain."""

from typing import NamedTuple

import numpy as np
from scipy.integrate import cumulative_trapezoid

from anisogran.fitting.linear_moduli import finite_rows
from anisogran.outcome import InputError, checked

_GRID = 20  # points of the uniform grid within the width


class Peak(NamedTuple):
    """The largest value of the moving average, and the strain in the middle of it."""

    value: float
    strain: float


def peak(strain, stress, width=0.004):
    """`Peak` of stress(strain): the largest average over `width` of strain, on a uniform grid of strain.

    One curve, shape (n,), or many, shape (..., n): then value and strain have shape (...). A curve is taken as straight between its
    points, strain growing; points that are not finite are left out. The highest point of the raw curve lies above the peak by noise and
    by the ringing of walls. Raises InputError for a strain that does not grow or spans less than the width.
    """
    width = checked("peak", "width", width, above=0)
    if np.ndim(strain) < 2:
        return _peak(strain, stress, width)
    strain, stress = np.asarray(strain), np.asarray(stress)
    if strain.shape != stress.shape:
        raise InputError(f"peak: strain and stress must have one shape, have {strain.shape} and {stress.shape}")
    curves = np.stack([strain, stress], axis=-2).reshape(-1, 2, strain.shape[-1])
    found = np.array([_peak(*curve, width) for curve in curves])
    return Peak(*found.T.reshape(2, *strain.shape[:-1]))


def _peak(strain, stress, width):
    (strain, stress), _ = finite_rows("peak", strain=strain, stress=stress)
    if np.any(np.diff(strain) < 0.0):
        raise InputError("peak: the strain must grow; give one loading at a time")
    if not strain[-1] - strain[0] > width:
        raise InputError(f"peak: the strain spans {strain[-1] - strain[0]:g}, the width of the average is {width:g}")
    begin = np.append(np.arange(strain[0], strain[-1] - width, width / _GRID), strain[-1] - width)
    ends = np.concatenate([begin, begin + width])
    points = np.union1d(strain, ends)
    work = cumulative_trapezoid(np.interp(points, strain, stress), points, initial=0.0)
    below, above = np.split(np.interp(ends, points, work), 2)
    average = (above - below) / width
    best = int(np.argmax(average))
    return Peak(float(average[best]), float(begin[best] + 0.5 * width))
