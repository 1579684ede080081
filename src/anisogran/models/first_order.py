"""Elementary functions for real numbers and for complex steps, whose imaginary parts are so small that their squares are nothing.

f(x + i h) = f(x) + i h f'(x), exact where h^2 vanishes beside everything: no complex root, exponential or cosine is needed, each of which
costs several real ones. One source serves both, since z - z.real is 0 for a real number.
"""

import numpy as np

from anisogran.compiled import subkernel

STEP = 1e-100  # of a derivative by a complex step: its square is nothing beside any strain, and still no underflow, which is slow


@subkernel
def inverse(z):
    """1/z, infinite at zero, where a compiled division of complex numbers would raise."""
    value = 1.0 / z.real
    return value - (z - z.real) * (value * value)


@subkernel
def root(z):
    """sqrt(z), real part above 0."""
    value = np.sqrt(z.real)
    return value + (z - z.real) * (0.5 / value)


@subkernel
def exponential(z):
    """exp(z), where it does not overflow."""
    value = np.exp(z.real)
    return value + (z - z.real) * value


@subkernel
def cosine_and_sine(z):
    """cos(z), sin(z)."""
    c, s = np.cos(z.real), np.sin(z.real)
    return c - (z - z.real) * s, s + (z - z.real) * c


@subkernel
def size(first, second):
    """|(t_1, t_2)|; at zero its derivative is that of growth, whatever the direction."""
    length = np.sqrt(first.real * first.real + second.real * second.real)
    if length > 0.0:
        return length + ((first - first.real) * first.real + (second - second.real) * second.real) / length
    grown = np.hypot(first.imag, second.imag)
    if grown > 0.0:
        return first * (first.imag / grown) + second * (second.imag / grown)
    return 0.0 * (first + second)
