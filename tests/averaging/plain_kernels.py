"""The smoothing kernels once more, as one would write them down, and normalised by quadrature: what the compiled ones are held against."""

from itertools import pairwise

import numpy as np
from scipy.integrate import quad

SHAPES = {  # over r/width, and the reach in widths
    "gaussian": (lambda x: np.exp(-0.5 * x * x), 6.5),
    "lucy": (lambda x: (1 - x / 2) ** 3 * (1 + 3 * x / 2), 2.0),
    "heaviside": (lambda x: 1.0 + 0.0 * x, 1.0),
}
SPHERE = {2: 2 * np.pi, 3: 4 * np.pi}


def plain_moment(kernel, dimension, power=0):
    """Integral of the kernel's shape times r^power over space, width 1."""
    shape, reach = SHAPES[kernel]
    return SPHERE[dimension] * quad(lambda x: shape(x) * x ** (dimension - 1 + power), 0, reach, epsabs=0, epsrel=1e-13)[0]


def plain_phi(kernel, width, dimension):
    """The kernel as a function of vectors (..., d), and its reach in m."""
    shape, reach = SHAPES[kernel]
    norm = 1 / (plain_moment(kernel, dimension) * width**dimension)

    def phi(vector):
        r = np.linalg.norm(vector, axis=-1)
        return np.where(r <= reach * width, norm * shape(np.minimum(r, reach * width) / width), 0.0)

    return phi, reach * width


def plain_line(kernel, width, point, start, branch):
    """The mean of the kernel over a segment, by adaptive quadrature between the places where the segment enters and leaves the reach."""
    phi, reach = plain_phi(kernel, width, len(point))
    length = np.linalg.norm(branch)
    foot = (point - start) @ branch / length**2
    height = np.linalg.norm(point - start - foot * branch)
    if height >= reach:
        return 0.0
    half = np.sqrt(reach**2 - height**2) / length
    breaks = np.clip([foot - half, foot, foot + half], 0, 1)
    options = {"epsabs": 1e-14 * float(phi(0 * point)), "epsrel": 1e-12}
    return sum(quad(lambda s: phi(point - start - s * branch), a, b, **options)[0] for a, b in pairwise(breaks))
