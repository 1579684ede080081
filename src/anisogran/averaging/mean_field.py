"""The local linear mean field: v(x) = v + G (x - centre), the weighted least squares over the grains that a cell holds.

All of it follows from moments of the grains about the middle of the cell, which may be averaged over time first. An affine motion is
recovered exactly, whichever grains there are, and what is left over is the fluctuation. With the Gaussian kernel the slope is the kernel's
own gradient of the mean velocity over its own gradient of the mean position, since that kernel's gradient is linear times itself.
"""

import numpy as np

STEADY = 1e-12  # share of the momentum flux below which what is left of it is rounding
FLAT = 1e-6  # share of the spread: grains within a thousandth of it from one line tell no slope across the line
UNSURE = 1e-10  # share of the mean square distance from the middle: below 1e6 times the rounding of the moments nothing is known


def quotient(numerator, denominator):
    """numerator / denominator, NaN where the denominator is 0: the field of a cell that holds nothing is not defined."""
    numerator, denominator = np.broadcast_arrays(numerator, denominator)
    return np.divide(numerator, denominator, out=np.full(numerator.shape, np.nan), where=denominator != 0)


def inverse_spread(density, mass_offset, mass_spread):
    """The pseudo-inverse (k, k, cells) of the covariance of the positions in a cell, 1/m2; and whether it has full rank, (cells,)."""
    centre = quotient(mass_offset, density)
    square = quotient(mass_spread, density)
    covariance = np.moveaxis(square - centre[:, None] * centre[None], -1, 0)
    empty = ~np.isfinite(covariance[:, 0, 0])
    values, vectors = np.linalg.eigh(np.where(empty[:, None, None], 0.0, covariance))
    distance = np.where(empty, 0.0, np.trace(square))
    used = values > np.maximum(FLAT * values.sum(axis=1), UNSURE * distance)[:, None]
    inverse = np.divide(1.0, values, out=np.zeros_like(values), where=used)
    return np.einsum("cik,ck,cjk->ijc", vectors, inverse, vectors), used.all(axis=1)


def mean_slope(place, density, mass_offset, spread, total, offset):
    """(mean at the place's centres (d, cells), slope (d, k, cells)) of a quantity with the sums total (d, cells), offset (d, k, cells).

    Directions in which the grains do not differ have slope 0. For the whole box the mean is that at the centre of mass.
    """
    mean, centre = quotient(total, density), quotient(mass_offset, density)
    covariance = quotient(offset, density) - mean[:, None] * centre[None]
    slope = np.einsum("ikc,kjc->ijc", covariance, spread[0])
    if not place.at_centroid:
        mean = mean - np.einsum("ikc,kc->ic", slope, centre)
    return mean, slope


def fluctuation_stress(density, mass_offset, spread, momentum, offset, flux):
    """Momentum flux of the fluctuations about the linear mean field, (d, d, cells): sum m v' v' over volume.

    It is the difference of the whole flux and that of the mean: its error is some 1e-15 of the whole, so that with velocities 10^4 times
    the fluctuations they are good to 1e-6. What is below `STEADY` of the whole is nothing, and 0.
    """
    mean, centre = quotient(momentum, density), quotient(mass_offset, density)
    covariance = quotient(offset, density) - mean[:, None] * centre[None]
    explained = np.einsum("ikc,klc,jlc->ijc", covariance, spread[0], covariance)
    agitation = density * (quotient(flux, density) - mean[:, None] * mean[None] - explained)
    known = np.trace(agitation) > STEADY * np.trace(flux)  # not where density is 0, and nothing is known
    return np.where(known, agitation, 0.0)


def rotation_rate(gradient):
    """Half the curl of a velocity gradient (d, d, ...): the spin of the continuum, counter-clockwise positive; (...), in space (3, ...)."""
    skew = 0.5 * (np.swapaxes(gradient, 0, 1) - gradient)  # skew[i, j] = (d v_j / d x_i - d v_i / d x_j) / 2
    return skew[0, 1] if len(gradient) == 2 else np.stack([skew[1, 2], skew[2, 0], skew[0, 1]])


def strain_fit(moment, spread):
    """moment . spread^-1 for each cell, (d, d, ...); NaN where the matrix is singular, as without contacts in every direction."""
    matrix = np.moveaxis(np.broadcast_to(spread, moment.shape), (0, 1), (-2, -1))
    values = np.linalg.eigvalsh(matrix)
    whole = values[..., 0] > FLAT * values[..., -1]
    identity = np.eye(len(moment))
    inverse = np.linalg.inv(np.where(whole[..., None, None], matrix, identity))
    return np.where(whole, np.einsum("ik...,...kj->ij...", moment, inverse), np.nan)
