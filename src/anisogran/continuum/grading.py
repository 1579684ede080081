"""Meshes graded towards the inner ring, where the grains flow."""

from math import ceil, expm1, log

import numpy as np


def graded(inner, outer, elements, layer):
    """Radii of the elements + 1 mesh points from `inner` to `outer`, half of them within the thickness `layer` of the inner ring.

    Element lengths grow geometrically outward; they are equal if `layer` is half the gap or more.
    """
    gap, growth = outer - inner, growth_exponent((outer - inner) / layer)
    place = np.linspace(0.0, 1.0, elements + 1)
    if growth > 0.0:
        place = np.expm1(growth * place) / np.expm1(growth)
    radii = inner + gap * place
    radii[-1] = outer
    return radii


def growth_exponent(layers):
    """Logarithm of outermost over innermost element length of a graded mesh, for a gap of so many layers; 0 if equal."""
    return 2.0 * log(layers - 1.0) if layers > 2.0 else 0.0


def elements_for(tail, layers):
    """The number of elements of a graded mesh whose outermost one is `tail` long, in units of the gap."""
    growth = growth_exponent(layers)
    return ceil((growth / -expm1(-growth) if growth > 0.0 else 1.0) / tail)
