"""The smoothing kernels of coarse graining: phi(r) spreads what a body carries over its surroundings, and its integral over space is 1.

Also its slope and its mean along a straight line, which spreads what a contact carries over the branch. In two or three dimensions.
"""

import math
from typing import NamedTuple

from anisogran.compiled import subkernel
from anisogran.outcome import InputError, checked

KERNELS = ("gaussian", "lucy", "heaviside")
GAUSSIAN, LUCY, HEAVISIDE = range(3)
REACH = (6.5, 2.0, 1.0)  # in widths; there the Gaussian has fallen to 7e-10 of its top, so that sums over a grid of points keep the mass
SHORT = 3e-4  # in reaches: below, the closed forms would lose digits in a difference, and two points of Gauss-Legendre lose none


class Smoothing(NamedTuple):
    """A smoothing kernel, as numbers for the compiled code; made by `smoothing`."""

    kind: int  # index in KERNELS
    width: float  # m
    reach: float  # m, phi = 0 beyond
    norm: float  # 1/m^d, phi(0), the largest value
    dimension: int


def smoothing(kernel, width, dimension):
    """The Smoothing with one of the KERNELS and a width in m, in 2 or 3 dimensions; rho = r/reach.

    gaussian: norm exp(-r^2/(2 width^2)), cut off at reach = 6.5 width and normalised to 1 again: the width is its standard deviation.
    lucy: norm (1 - rho)^3 (1 + 3 rho), reach = 2 width, twice differentiable at the reach too. heaviside: norm within reach = width.
    Source: Weinhart, Thornton, Luding & Bokhove, Granular Matter 14 (2012) 289 and Tunuguntla, Thornton & Weinhart, Comput. Part. Mech.
    3 (2016) 349, both from memory. Codes differ: in MercuryDPM (read in its source) the Gaussian is cut off at 3 widths, and the width
    of Lucy's polynomial is its reach; so compare standard deviations.
    Raises InputError for an unknown kernel, a width that is not above 0 and a dimension that is not 2 or 3.
    """
    if kernel not in KERNELS:
        raise InputError(f"smoothing: kernel = {kernel!r} is unknown; known are {', '.join(KERNELS)}")
    if dimension not in (2, 3):
        raise InputError(f"smoothing: dimension = {dimension!r} must be 2 or 3")
    width = checked("smoothing", "width", width, above=0.0, unit="m")
    kind = KERNELS.index(kernel)
    reach = REACH[kind] * width
    if kind == GAUSSIAN:
        integral = _moment(dimension) * 2.0 * (dimension - 1) * math.pi * width**dimension
    elif kind == LUCY:
        integral = (math.pi / 5.0 if dimension == 2 else 16.0 * math.pi / 105.0) * reach**dimension
    else:
        integral = (math.pi if dimension == 2 else 4.0 * math.pi / 3.0) * reach**dimension
    return Smoothing(kind, width, reach, 1.0 / integral, dimension)


def _moment(dimension):
    """The integral of exp(-x^2/2) x^(dimension - 1) from 0 to the reach, in widths."""
    cut = REACH[GAUSSIAN]
    edge = math.exp(-0.5 * cut**2)
    return 1.0 - edge if dimension == 2 else math.sqrt(0.5 * math.pi) * math.erf(cut / math.sqrt(2.0)) - cut * edge


def standard_deviation(s):
    """sqrt(integral of phi x^2), along one axis x, m: what makes different kernels comparable."""
    if s.kind == GAUSSIAN:  # just below the width, for what was cut off
        cut = REACH[GAUSSIAN]
        return s.width * math.sqrt(1.0 - cut**s.dimension * math.exp(-0.5 * cut**2) / (s.dimension * _moment(s.dimension)))
    if s.kind == LUCY:
        return s.reach * math.sqrt(5.0 / 56.0 if s.dimension == 2 else 1.0 / 12.0)
    return s.reach / math.sqrt(s.dimension + 2.0)


@subkernel
def phi(s, r2):
    """The kernel at the squared distance r2 <= reach^2, 1/m^d."""
    if s.kind == GAUSSIAN:
        return s.norm * math.exp(-0.5 * r2 / (s.width * s.width))
    if s.kind == LUCY:
        rho = min(math.sqrt(r2) / s.reach, 1.0)  # rounding may lead beyond the edge
        return s.norm * (1.0 - rho) ** 3 * (1.0 + 3.0 * rho)
    return s.norm


@subkernel
def slope(s, r2):
    """phi'(r)/r at the squared distance r2 <= reach^2, 1/m^(d + 2): the gradient is this times the vector from body to point."""
    if s.kind == GAUSSIAN:
        return -phi(s, r2) / (s.width * s.width)
    rho = min(math.sqrt(r2) / s.reach, 1.0)
    return -12.0 * s.norm * (1.0 - rho) ** 2 / (s.reach * s.reach)


@subkernel
def line_mean(s, h2, low, high):
    """Mean of phi over a piece low .. high of a line that passes at the squared distance h2, all of it within reach, 1/m^d.

    Lengths along the line count from the foot of the perpendicular.
    """
    if s.kind == HEAVISIDE:
        return s.norm
    length = high - low
    if length < SHORT * s.reach:
        middle, away = 0.5 * (low + high), length / math.sqrt(12.0)
        return 0.5 * (phi(s, h2 + (middle - away) ** 2) + phi(s, h2 + (middle + away) ** 2))
    if s.kind == GAUSSIAN:
        unit = math.sqrt(2.0) * s.width
        return phi(s, h2) * 0.5 * math.sqrt(math.pi) * unit * (math.erf(high / unit) - math.erf(low / unit)) / length
    height2 = h2 / (s.reach * s.reach)
    integral = lucy_integral(height2, high / s.reach) - lucy_integral(height2, low / s.reach)
    return s.norm * max(integral, 0.0) * s.reach / length  # near the edge the integral is smaller than its rounding


@subkernel
def lucy_integral(h2, t):
    """Integral of 1 - 6 rho^2 + 8 rho^3 - 3 rho^4 = (1 - rho)^3 (1 + 3 rho) from 0 to t, with rho^2 = h2 + t^2."""
    t2 = t * t
    h4 = h2 * h2
    rho2 = h2 + t2
    square = t * (h2 + t2 / 3.0)
    cube = 0.125 * t * math.sqrt(rho2) * (2.0 * rho2 + 3.0 * h2)
    if h4 > 0.0:
        cube += 0.375 * h4 * math.asinh(t / math.sqrt(h2))
    fourth = t * (h4 + 2.0 * h2 * t2 / 3.0 + 0.2 * t2 * t2)
    return t - 6.0 * square + 8.0 * cube - 3.0 * fourth
