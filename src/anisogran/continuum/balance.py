"""The weak steady balances at a point, the same for every law, and their tangent by a complex step."""

from typing import NamedTuple

import numpy as np

STEP = 1e-100  # of the complex step; no subtraction, hence no rounding however small it is


class Setting(NamedTuple):
    """Numbers of a reduced problem: lengths in gap widths, speeds in |wall speed|, stresses in outer pressures.

    `inertial`: (|V|/gap) sqrt(m/P), the inertial number of the mean rate; `diameter`: of a grain; `density`: rho V^2/P, 0 without
    inertia; `rate_floor`: regularisation of the shear rate in the local law; `inner`: radius of the inner ring.
    """

    inertial: float
    diameter: float
    density: float
    rate_floor: float
    inner: float


class Point(NamedTuple):
    """What a law sees, arrays of one shape: velocity, rate of deformation (gamma = 2 D_rphi), pressure, fluidity and its slopes.

    `g_f` is the slope along phi, (1/r) dg/dphi, which an axisymmetric flow has not.
    """

    u_r: np.ndarray
    u_phi: np.ndarray
    d_rr: np.ndarray
    d_ff: np.ndarray
    gamma: np.ndarray
    p: np.ndarray
    g: np.ndarray | None = None
    g_r: np.ndarray | None = None
    g_f: np.ndarray | float = 0.0


def balance(law, setting, point, r):
    """q[row, ...], paired with the variation of each component of the Point in the weak steady balances.

    Rows: inertia (centrifugal and Coriolis-like terms of a steady axisymmetric flow), stress, incompressibility, and the
    fluidity equation if the law has one.
    """
    s_rr, s_ff, s_rf = law.stress(point, setting)
    rows = [
        setting.density * (point.u_r * point.d_rr - point.u_phi**2 / r),
        setting.density * point.u_r * (point.gamma + 2.0 * point.u_phi / r),
        -s_rr,
        -s_ff,
        -s_rf,
        -(point.d_rr + point.d_ff),
    ]
    if "g" in law.fields:
        rows += law.fluidity(point, setting)[:2]
    return np.stack(np.broadcast_arrays(*rows))


def complex_step(function, z):
    """dq/dz[row, column, ...] of a pointwise function q(Point), by one evaluation for each column at once."""
    rows = len(z)
    shifted = z[:, None].astype(complex) * np.ones((1, rows) + (1,) * (z.ndim - 1))
    shifted[np.arange(rows), np.arange(rows)] += 1j * STEP
    return function(Point(*shifted)).imag / STEP
