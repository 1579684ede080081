"""The weak steady balances at a point, the same for every law and mesh, and their tangent by a complex step."""

from typing import NamedTuple

import numpy as np

STEP = 1e-100  # of the complex step; no subtraction, hence no rounding however small it is


class Setting(NamedTuple):
    """Numbers of a reduced problem: lengths in gap widths, speeds in that of the faster ring, stresses in outer pressures.

    `inertial`: (speed/gap) sqrt(m/P), the inertial number of the mean rate; `diameter`: of a grain; `density`: rho speed^2/P, 0
    without inertia; `rate_floor`: regularisation of the shear rate in the local law; `inner`: radius of the inner ring.
    """

    inertial: float
    diameter: float
    density: float
    rate_floor: float
    inner: float


class Point(NamedTuple):
    """What a law sees, arrays of one shape: velocity, rate of deformation (gamma = 2 D_rphi), pressure, fluidity and its slopes.

    `g_f` is the slope along phi, (1/r) dg/dphi, which an axisymmetric flow has not. `spin` is that of the flow, half the curl of
    the velocity, counter-clockwise positive; no law may depend on it.
    """

    u_r: np.ndarray | None = None
    u_phi: np.ndarray | None = None
    d_rr: np.ndarray | None = None
    d_ff: np.ndarray | None = None
    gamma: np.ndarray | None = None
    p: np.ndarray | None = None
    g: np.ndarray | None = None
    g_r: np.ndarray | None = None
    g_f: np.ndarray | float = 0.0
    spin: np.ndarray | None = None


def balance(law, setting, point):
    """{row: q}, paired with the variation of that component of the Point in the weak steady balances.

    Stress, incompressibility, the fluidity equation if the law has one; with inertia (density above 0) also the advection of
    momentum, the velocity gradient (D + spin) times the velocity, which in polar components has no further term.
    """
    s_rr, s_ff, s_rf = law.stress(point, setting)
    q = {"d_rr": -s_rr, "d_ff": -s_ff, "gamma": -s_rf, "p": -(point.d_rr + point.d_ff)}
    if setting.density > 0.0:
        q["u_r"] = setting.density * (point.d_rr * point.u_r + (0.5 * point.gamma - point.spin) * point.u_phi)
        q["u_phi"] = setting.density * ((0.5 * point.gamma + point.spin) * point.u_r + point.d_ff * point.u_phi)
    if "g" in law.fields:
        q["g"], q["g_r"], q["g_f"] = law.fluidity(point, setting)
    return q


def stacked(q, rows, like):
    """q[row, ...] of a dict of rows, each broadcast to the shape of the array `like`; a row that is not in it is 0."""
    out = np.zeros((len(rows), *like.shape), dtype=like.dtype)
    for k, row in enumerate(rows):
        if row in q:
            out[k] = q[row]
    return out


def complex_step(function, z, rows):
    """dq/dz[row, column, ...] of a pointwise function q(Point) that gives a dict of rows, by one evaluation for all columns."""
    number = len(rows)
    shifted = z[:, None].astype(complex) * np.ones((1, number) + (1,) * (z.ndim - 1))
    shifted[np.arange(number), np.arange(number)] += 1j * STEP
    q = function(Point(**dict(zip(rows, shifted, strict=True))))
    return stacked(q, rows, shifted[0]).imag / STEP
