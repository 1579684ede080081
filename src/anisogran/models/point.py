"""What every law at a point shares: its state, the increment that drives it, and the ways in which it can end.

Deviators of two dimensions are vectors, t = (t_1, t_2) = ((t_xx - t_zz)/2, t_xz): a rotation by w turns them by 2 w, and |t| is half the
difference of the eigenvalues. The laws take these numbers one by one, real or complex, so that one source, compiled, serves a point, a
series and all quadrature points, and its derivative by a complex step is exact.
"""

from typing import NamedTuple

import numpy as np

from anisogran.compiled import subkernel
from anisogran.models.first_order import cosine_and_sine

# outcomes of an update
OK, TENSION, INDEFINITE, RESOLUTION, JAMMED, EMPTY, APEX, BRITTLE, NOT_FINITE = range(9)
MEANING = {
    OK: "ok",
    TENSION: "the sample goes into tension (sigma_V <= 0), where the law does not hold",
    INDEFINITE: "the stiffness is not positive definite (E B <= A^2)",
    RESOLUTION: "the increment needs more sub-steps than the integrator may take",
    JAMMED: "the sample jams: its area fraction reaches phi_max, where the law has no finite stress",
    EMPTY: "the area fraction falls to zero within one increment",
    APEX: "the stress passes the apex of the yield line (tension beyond the cohesion)",
    BRITTLE: "the strength falls faster than the stiffness can follow (snap-back)",
    NOT_FINITE: "the state is not finite",
}
MOST_SUBSTEPS = 100_000
FINEST = 0.03  # largest part of a relaxation, and largest rotation in rad, in one sub-step: errors of some 1e-5, being second order


class Point(NamedTuple):
    """Stress (compression positive) and two internal variables, whose meaning belongs to the law."""

    sigma_V: float
    sigma_1: float
    sigma_2: float
    x: float
    y: float


class Increment(NamedTuple):
    """Strain increment (compression positive, half/half), rotation increment in rad (counter-clockwise) and time increment in s."""

    eps_V: float
    eps_1: float
    eps_2: float
    spin: float
    time: float


@subkernel
def part_of(increment, h):
    """The share h of the increment."""
    return Increment(
        h * increment.eps_V, h * increment.eps_1, h * increment.eps_2, h * increment.spin, h * increment.time
    )  # fmt: skip


@subkernel
def turned(first, second, angle):
    """The vector of a deviator after a rotation of the material by `angle`."""
    c, s = cosine_and_sine(2.0 * angle)
    return c * first - s * second, s * first + c * second


@subkernel
def substeps(relaxation, rotation):
    """How many equal sub-steps an increment is cut into; they depend on real parts only."""
    parts = np.ceil(max(relaxation, abs(rotation)) / FINEST)
    return int(max(1.0, parts)) if parts <= MOST_SUBSTEPS else MOST_SUBSTEPS + 1
