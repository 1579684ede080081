"""The answer of a ring problem: fields on the nodes, on any radii, averaged over rings, and the torques on the rings."""

from dataclasses import dataclass, field
from math import pi
from typing import Any, NamedTuple

import numpy as np

from anisogran.continuum.space import nodes
from anisogran.continuum.walls import slip_velocity
from anisogran.outcome import InputError, Status

GAUSS = np.polynomial.legendre.leggauss(4)
NO_TORQUE = 1e-5  # of what a shear stress as large as the outer pressure exerts; rounding of the rate over the rate floor makes 2e-6


class Profile(NamedTuple):
    """Fields on the radii `r`, arrays of its shape in the units of the problem; `fluidity` is None for a law without it.

    shear_stress is sigma_rphi, radial_stress sigma_rr, compression positive: the outward fluxes of azimuthal and radial momentum;
    sigma_phiphi is 2 pressure - radial_stress.
    """

    r: np.ndarray
    v_phi: np.ndarray
    shear_rate: np.ndarray
    pressure: np.ndarray
    shear_stress: np.ndarray
    inertial_number: np.ndarray
    fluidity: np.ndarray | None
    v_r: np.ndarray
    radial_stress: np.ndarray


class Torques(NamedTuple):
    """Torque of the inner ring on the grains and of the grains on the outer ring, force times length; their relative difference.

    Both are reactions of the discrete equations about the centre of the outer ring, exactly in balance on any mesh if these are
    solved and the rings concentric. The difference counts as 0 if neither torque exceeds NO_TORQUE, where both are but rounding.
    """

    inner: float
    outer: float
    difference: float


class Slip(NamedTuple):
    """Velocity of each ring less that of the grains on it (length/time), 0 at a rough wall; in 2D the mean over phi."""

    inner: float
    outer: float


@dataclass(frozen=True, eq=False)
class Flow:
    """A steady flow between two rings, as solved by `RingFlow.solve`.

    `r[nodes]`, ascending: mesh points and element middles; on them `v_phi`, `pressure` (half the trace of the stress),
    `stress[2, 2, nodes]` in polar components (r, phi), compression positive, `shear_rate` = 2 |D_dev| (third order in the mesh
    for v_phi, second for the rate: mean of both sides on mesh points), `inertial_number`, `fluidity` (None for a local law); of a
    flow in 2D the means over phi, and if it is eccentric, along lines that divide the gap in the same ratio everywhere, named by
    the radius that they would have in the concentric ring.

    `stress_ratio_wall` = shear force over normal force on the inner ring, from the reactions; `slip`, the Slip at both rings;
    `wall_force[2]`, of the grains on the inner ring, across and along the line of centres, (x, y) with x towards phi = 0 (force;
    0 if the rings are concentric). `ill_posed_share`: of the area, where a flow in time under this law would be ill posed
    (C(I) > 0, see `models.well_posedness`), which a slow flow is almost everywhere and a steady one need not mind; None for a
    nonlocal law, to which that C(I) does not apply. `status` (see outcome.Status) must be read; `iterations` of all stages;
    `history`, the relative size of each correction; `seconds` of wall time.
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
    slip: Slip
    wall_force: np.ndarray
    ill_posed_share: float | None
    status: Status
    iterations: int
    history: tuple[float, ...]
    seconds: float
    problem: Any = field(repr=False)
    space: Any = field(repr=False)
    unknowns: np.ndarray = field(repr=False)

    def at(self, r, phi=None):
        """The Profile on radii `r` and angles `phi` (arrays or numbers), from the finite elements.

        Without `phi` the mean over it (see `r` above). Raises InputError outside of the rings.
        """
        r, phi = np.asarray(r, dtype=float), None if phi is None else np.asarray(phi, dtype=float)
        gap, outer = self.problem.gap, self.problem.r_outer
        if phi is not None:
            if not np.isfinite(phi).all():
                raise InputError("Flow.at: phi must be finite")
            r, phi = np.broadcast_arrays(r, phi)
        inner = self.problem.r_inner if phi is None else gap * self.space.polar(self.space.vertices[0], phi)[0]
        slack = 1e-9 * gap
        if r.size == 0 or not np.all((r >= inner - slack) & (r <= outer + slack)):
            raise InputError(f"Flow.at: r must be finite, not empty, and lie between {np.max(inner):g} and {outer:g}")
        if phi is None:
            return mean_fields(self.problem, self.space, self.unknowns, r / gap)[0]._replace(r=r)
        s = r / gap if self.space.offset == 0.0 else (outer - (outer - r) * gap / (outer - inner)) / gap
        return fields(self.problem, self.space, self.unknowns, s, phi)[0]._replace(r=r)

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


def fields(problem, space, x, s, phi=0.0):
    """The Profile and the stress[2, 2, ...] of the reduced solution `x` at places s, phi of the mesh, in the units of the problem."""
    law, setting = problem.law, problem.setting()
    stress = np.stack(law.stress(space.point(x), setting))
    s_rr, s_ff, s_rf = space.recovered(stress, s, phi)
    point = space.evaluated(x, s, phi)
    speed, pressure = problem.speed, problem.outer_pressure
    rate = speed / problem.gap * law.rate(point, setting, np.hypot(0.5 * (s_rr - s_ff), s_rf))
    inertial_number = rate * np.sqrt(problem.grain_mass / (pressure * point.p))
    fluidity = None if point.g is None else speed / problem.gap * point.g
    flow = speed * point.u_phi, rate, pressure * point.p, pressure * s_rf, inertial_number, fluidity, speed * point.u_r, pressure * s_rr
    return Profile(problem.gap * space.polar(s, phi)[0], *flow), pressure * np.array([[s_rr, s_rf], [s_rf, s_ff]])


def mean_fields(problem, space, x, s):
    """Profile and stress of `fields`, averaged over phi at the same s."""
    if space.angles is None:
        return fields(problem, space, x, s)
    middles, halves = 0.5 * (space.angles[1:] + space.angles[:-1]), 0.5 * np.diff(space.angles)
    phi = np.concatenate([middles - halves / np.sqrt(3.0), middles + halves / np.sqrt(3.0)])  # Gauss: exact for these elements
    weights = np.tile(halves, 2) / (2.0 * np.pi)
    profile, stress = fields(problem, space, x, s[..., None], phi)
    return Profile(*(None if value is None else value @ weights for value in profile)), stress @ weights


def torques(problem, space, reaction):
    """The Torques from the forces of the walls on the grains, `reaction` (reduced)."""
    unit = 2.0 * pi / space.radians * problem.outer_pressure * problem.gap**2
    around = nodes(space.angles, 2)[:-1] if space.angles is not None else np.zeros(1)
    radii = space.polar(space.vertices[0], around)[0]
    inner = unit * float(radii @ reaction[space.ring("u_phi", outer=False)])
    outer = -unit * float(space.vertices[-1] * reaction[space.ring("u_phi", outer=True)].sum())
    largest = max(abs(inner), abs(outer))
    nothing = largest < NO_TORQUE * unit * space.radians * space.vertices[0] ** 2
    return Torques(inner, outer, 0.0 if nothing else float(abs(inner - outer) / largest))


def inner_wall(problem, space, reaction):
    """Ratio of shear to normal force on the inner ring, and the force[2] on it, from the forces `reaction` on the grains."""
    places = space.ring("u_phi", outer=False)
    angle, radial, around = space.angle[places], reaction[space.ring("u_r", outer=False)], reaction[places]
    r, inner = space.polar(space.vertices[0], angle)[0], space.vertices[0]
    cosine, sine = (r - space.offset * np.cos(angle)) / inner, space.offset * np.sin(angle) / inner  # of the normal to e_r, e_phi
    shear, normal = np.sum(around * cosine - radial * sine), np.sum(radial * cosine + around * sine)
    if space.angles is None:
        return float(abs(shear) / normal), np.zeros(2)
    x, y = radial * np.cos(angle) - around * np.sin(angle), radial * np.sin(angle) + around * np.cos(angle)
    return float(abs(shear) / normal), -problem.outer_pressure * problem.gap * np.array([x.sum(), y.sum()])


def slip(problem, space, x):
    """The Slip at both rings."""
    return Slip(*(problem.speed * float(np.mean(slip_velocity(space, problem, x, outer))) for outer in (False, True)))
