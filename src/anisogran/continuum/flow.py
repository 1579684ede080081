"""The answer of a ring problem: fields on the nodes, on any radii, averaged over rings, and the torques on the rings."""

from dataclasses import dataclass, field
from math import pi
from typing import Any, NamedTuple

import numpy as np

from anisogran.continuum.balance import Point
from anisogran.outcome import InputError, Status

GAUSS = np.polynomial.legendre.leggauss(4)


class Profile(NamedTuple):
    """Fields on the radii `r`, arrays of its shape in the units of the problem; `fluidity` is None for a law without it.

    shear_stress is sigma_rphi, compression positive: the outward flux of azimuthal momentum.
    """

    r: np.ndarray
    v_phi: np.ndarray
    shear_rate: np.ndarray
    pressure: np.ndarray
    shear_stress: np.ndarray
    inertial_number: np.ndarray
    fluidity: np.ndarray | None


class Torques(NamedTuple):
    """Torque of the inner ring on the grains and of the grains on the outer ring, force times length; their relative difference.

    Both are reactions of the discrete equations, exactly in balance if these are solved, on any mesh.
    """

    inner: float
    outer: float
    difference: float


@dataclass(frozen=True, eq=False)
class Flow:
    """A steady axisymmetric flow between two rings, as solved by `RingFlow.solve`.

    `r[nodes]`, ascending: mesh points and element middles; on them `v_phi`, `pressure` (half the trace of the stress),
    `stress[2, 2, nodes]` in polar components (r, phi), compression positive, `shear_rate` = 2 |D_dev| (third order in the mesh
    for v_phi, second for the rate: mean of both sides on mesh points), `inertial_number`, `fluidity` (None for a local law).
    `stress_ratio_wall` = |sigma_rphi|/sigma_rr at the inner ring, from the reactions. `status` (see outcome.Status) must be read;
    `iterations` of all stages; `history`, the relative size of each correction; `seconds` of wall time.
    """

    r: np.ndarray
    v_phi: np.ndarray
    pressure: np.ndarray
    stress: np.ndarray
    fluidity: np.ndarray | None
    shear_rate: np.ndarray
    inertial_number: np.ndarray
    stress_ratio_wall: float
    torques: Torques
    status: Status
    iterations: int
    history: tuple[float, ...]
    seconds: float
    problem: Any = field(repr=False)
    space: Any = field(repr=False)
    unknowns: np.ndarray = field(repr=False)

    def at(self, r):
        """The Profile on radii `r` (array or number, length), from the finite elements; InputError outside of the rings."""
        r = np.asarray(r, dtype=float)
        inner, outer = self.problem.r_inner, self.problem.r_outer
        slack = 1e-9 * (outer - inner)
        if r.size == 0 or not np.all((r >= inner - slack) & (r <= outer + slack)):
            raise InputError(f"Flow.at: r must be finite, not empty, and lie between {inner:g} and {outer:g}")
        return fields(self.problem, self.space, self.unknowns, r)[0]

    def ring_average(self, edges):
        """The Profile of averages over the areas of the rings edges[i] < r < edges[i+1]; its r are the middles of the rings.

        Gauss quadrature on every piece of an element, exact for v_phi to rounding. Raises InputError if the edges do not ascend
        or leave the gap.
        """
        edges = np.asarray(edges, dtype=float)
        if edges.ndim != 1 or edges.size < 2 or not np.all(np.diff(edges) > 0.0):
            raise InputError("Flow.ring_average: edges must be two or more radii in ascending order")
        self.at(edges)
        corners = self.space.vertices * self.problem.gap
        slack = 1e-12 * self.problem.gap  # a mesh point that rounding puts beside an edge cuts no piece off
        inside = np.min(np.abs(corners[:, None] - edges), axis=1) > slack
        inside &= (corners > edges[0]) & (corners < edges[-1])
        cuts = np.unique(np.concatenate([edges, corners[inside]]))
        half = 0.5 * np.diff(cuts)[:, None]
        r = 0.5 * (cuts[1:] + cuts[:-1])[:, None] + half * GAUSS[0]
        weight = r * half * GAUSS[1]
        ring = np.searchsorted(edges, r.ravel()) - 1

        def mean(values):
            sums = np.bincount(ring, weights=(values * weight).ravel(), minlength=edges.size - 1)
            return sums / np.bincount(ring, weights=weight.ravel(), minlength=edges.size - 1)

        middles, *values = self.at(r)
        middles = 0.5 * (edges[1:] + edges[:-1])
        return Profile(middles, *(None if value is None else mean(value) for value in values))


def fields(problem, space, x, r):
    """The Profile and the stress[2, 2, ...] of the reduced solution `x` on radii `r`, in the units of the problem."""
    law, setting = problem.law, problem.setting()
    stress = np.stack(law.stress(Point(*space.points(x)), setting))
    s_rr, s_ff, s_rf = space.recovered(stress, r / problem.gap)
    point = Point(*space.evaluated(x, r / problem.gap))
    speed, pressure = abs(problem.wall_speed), problem.outer_pressure
    rate = speed / problem.gap * law.rate(point, setting, np.hypot(0.5 * (s_rr - s_ff), s_rf))
    inertial_number = rate * np.sqrt(problem.grain_mass / (pressure * point.p))
    fluidity = None if point.g is None else speed / problem.gap * point.g
    profile = Profile(r, speed * point.u_phi, rate, pressure * point.p, pressure * s_rf, inertial_number, fluidity)
    return profile, pressure * np.array([[s_rr, s_rf], [s_rf, s_ff]])


def torques(problem, space, reaction):
    """The Torques from the residual in the rows of the prescribed velocities (for one radian and reduced)."""
    unit = 2.0 * pi * problem.outer_pressure * problem.gap**2
    inner = unit * space.vertices[0] * reaction[space.at_end("u_phi", outer=False)]
    outer = -unit * space.vertices[-1] * reaction[space.at_end("u_phi", outer=True)]
    return Torques(float(inner), float(outer), float(abs(inner - outer) / abs(inner)))
