"""The spin of the grains, solved after the flow: the linear couple-stress (micropolar) equation of the lecture's eigen-rotation.

    mu_c l^2 lap omega_p = 2 mu_c (omega_p - W),      W = (dv/dr + v/r)/2

with the spin omega_p of the grains, that of the mean flow, W, and one length l; the modulus mu_c drops out. The grains follow the flow
but for a layer of l/sqrt(2) at a ring, and where W bends within that length. The flow does not feel them: that is the limit of a
symmetric stress, and holds where sigma_rphi = sigma_phir.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse.linalg import splu
from skfem import Basis, BilinearForm, ElementLineP2, LinearForm, MeshLine
from skfem.helpers import dot, grad

from anisogran.continuum.flow import Flow
from anisogran.outcome import InputError, checked

SHORTEST = 1e-3  # length in gaps: a layer at a ring thinner than that has no points of the mesh
LAYERS = np.geomspace(1e-4, 1.0, 61)  # places of such points from either ring, in gaps


class SpinProfile(NamedTuple):
    """Spin of the grains, that of the mean flow W, and their difference omega*, on the radii r; 1/s, counter-clockwise positive."""

    r: np.ndarray
    spin: np.ndarray
    continuum_spin: np.ndarray
    eigen_rotation: np.ndarray


class SpinEquation:
    """The equation between two rings for a given W(r), a function of arrays, with quadratic elements between the points r (m, ascending).

    `size` unknowns, those on the points first. Everything is linear but the length, and analytic in that.
    """

    def __init__(self, r, continuum_spin):
        self.r = np.asarray(r, dtype=float)
        self.basis = Basis(MeshLine(self.r), ElementLineP2(), intorder=8)
        self.ends = tuple(int(np.flatnonzero(self.basis.doflocs[0] == end)[0]) for end in (self.r[0], self.r[-1]))
        places = self.basis.global_coordinates()[0]

        @BilinearForm
        def product(u, w, here):
            return here.x[0] * u * w

        @BilinearForm
        def slopes(u, w, here):
            return here.x[0] * dot(grad(u), grad(w))

        @LinearForm
        def drive(w, here):
            return here.x[0] * here["W"] * w

        self.product, self.slopes = product.assemble(self.basis), slopes.assemble(self.basis)
        self.load = drive.assemble(self.basis, W=continuum_spin(places.ravel()).reshape(places.shape))

    def solve(self, length, inner=None, outer=None):
        """omega_p of all unknowns, for a length (real or complex) and the spin at either ring, None where there is no couple."""
        matrix = (self.product + 0.5 * length**2 * self.slopes).tocsc()
        given = {end: value for end, value in zip(self.ends, (inner, outer), strict=True) if value is not None}
        fixed = np.array(list(given), dtype=int)
        values = np.zeros(self.load.size, dtype=np.result_type(matrix.dtype, *given.values()))
        values[fixed] = list(given.values())
        free = np.setdiff1d(np.arange(values.size), fixed)
        load = (self.load - matrix @ values)[free]
        values[free] = splu(matrix[free][:, free]).solve(load.astype(values.dtype))
        return values

    def at(self, values, r):
        """omega_p on radii r inside."""
        r = np.asarray(r, dtype=float)
        return (self.basis.probes(np.clip(r, self.r[0], self.r[-1]).reshape(1, -1)) @ values).reshape(r.shape)

    def ring_means(self, edges):
        """The matrix (rings, size) from unknowns to the averages over the areas between `edges`, by quadrature on every piece."""
        edges = np.asarray(edges, dtype=float)
        cuts = np.unique(np.concatenate([edges, self.r[(self.r > edges[0]) & (self.r < edges[-1])]]))
        places, weights = np.polynomial.legendre.leggauss(4)
        half = 0.5 * np.diff(cuts)[:, None]
        r = 0.5 * (cuts[1:] + cuts[:-1])[:, None] + half * places
        area = (r * half * weights).ravel()
        ring = np.searchsorted(edges, r.ravel()) - 1
        share = area / np.bincount(ring, area)[ring]
        sums = (ring == np.arange(edges.size - 1)[:, None]) * share
        return sums @ self.basis.probes(r.reshape(1, -1))


@dataclass(frozen=True, eq=False)
class Spin:
    """The spin between two rings, for a length in m: `r`, `spin`, `continuum_spin`, `eigen_rotation` as in SpinProfile, on mesh points."""

    r: np.ndarray
    spin: np.ndarray
    continuum_spin: np.ndarray
    eigen_rotation: np.ndarray
    length: float
    flow: Any
    equation: SpinEquation
    unknowns: np.ndarray

    def at(self, r):
        """The SpinProfile on radii `r`, in m; InputError outside of the rings."""
        profile = self.flow.at(r)
        spin, continuum = self.equation.at(self.unknowns, profile.r), continuum_spin(profile)
        return SpinProfile(profile.r, spin, continuum, spin - continuum)

    def ring_average(self, edges):
        """The SpinProfile of averages over the areas of the rings between `edges`, in m; that of W comes from the circulation alone.

        Raises InputError if the edges do not ascend or leave the gap.
        """
        middles = self.flow.ring_average(edges).r
        edges = np.asarray(edges, dtype=float)
        continuum = np.diff(edges * self.flow.at(edges).v_phi) / np.diff(edges**2)
        spin = self.equation.ring_means(edges) @ self.unknowns
        return SpinProfile(middles, spin, continuum, spin - continuum)


def spin(flow, length, inner=None, outer=None):
    """The Spin of the grains in an axisymmetric Flow, with the length l in m.

    `inner`, `outer`: what happens at the rings. None: no couple, d omega_p/dr = 0. "ring": the grains turn with the ring. A number: the
    eigen-rotation omega_p - W there, in 1/s. Error: of third order in the mesh of the flow (in L2).

    Raises InputError for a length below a thousandth of the gap, another condition, a flow between eccentric
    rings, or what is no Flow.
    """
    if not isinstance(flow, Flow):
        raise InputError(f"spin: the flow is a {type(flow).__name__}; it must be what RingFlow(...).solve() returns")
    problem = flow.problem
    if problem.eccentricity > 0.0:
        raise InputError(f"spin: eccentricity = {problem.eccentricity:g} m: the spin is solved in axisymmetric flows only")
    length = checked("spin", "length", length, at_least=SHORTEST * problem.gap, unit="m")
    equation = SpinEquation(mesh_points(flow.r), lambda r: continuum_spin(flow.at(r)))
    continuum = continuum_spin(flow.at(equation.r))
    speeds = problem.wall_speed / problem.r_inner, problem.outer_speed / problem.r_outer
    given = [
        spin_at_ring(key, condition, ring, around)
        for key, condition, ring, around in zip(("inner", "outer"), (inner, outer), speeds, continuum[[0, -1]], strict=True)
    ]
    unknowns = equation.solve(length, *given)
    values = unknowns[: equation.r.size]
    return Spin(equation.r, values, continuum, values - continuum, length, flow, equation, unknowns)


def continuum_spin(profile):
    """W = (dv/dr + v/r)/2 of a Profile without radial flow: v/r, and half the shear rate, to which the shear stress gives the sign."""
    return profile.v_phi / profile.r - 0.5 * np.sign(profile.shear_stress) * profile.shear_rate


def spin_at_ring(key, condition, ring, around):
    """The spin at a ring that turns with `ring`, where the mean flow has the spin `around`; None if there is no couple."""
    if condition is None:
        return None
    if isinstance(condition, str):
        if condition != "ring":
            raise InputError(f'spin: {key} = {condition!r} must be None (no couple), "ring" (turning with it) or a number (omega* in 1/s)')
        return float(ring)
    return float(around) + checked("spin", key, condition, unit="1/s")


def mesh_points(r):
    """The nodes of the flow, and more of them at both rings."""
    gap = r[-1] - r[0]
    points = np.unique(np.concatenate([r, r[0] + gap * LAYERS[:-1], r[-1] - gap * LAYERS[:-1]]))
    kept = np.append(np.diff(points) > 1e-9 * gap, True)  # of two points that rounding tells apart, the outer one
    kept[0] = True
    return points[kept]
