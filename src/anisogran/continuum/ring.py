"""The ring shear cell as a continuum, steady: a line mesh in r if it is axisymmetric, else a mesh in r and phi.

Unknowns u_r, u_phi (quadratic), pressure (linear) and, for a nonlocal law, the fluidity g (quadratic). The rings turn with given
speeds; the outer one is free to move radially under the outer pressure, as one. Everything is solved in reduced units (gap, speed
of the faster ring, outer pressure), in which a slow flow is no harder than a fast one.
"""

from dataclasses import dataclass, replace
from time import perf_counter
from typing import Literal

import numpy as np

from anisogran.continuum.balance import Setting
from anisogran.continuum.doubts import between_mesh_points, beyond_the_law, ill_posed_share
from anisogran.continuum.flow import Flow, inner_wall, mean_fields, slip, torques
from anisogran.continuum.laws import Jop, LocalMuI, Nonlocal, Regularised, check_law
from anisogran.continuum.steady import Solution, levels, solved
from anisogran.continuum.walls import CoulombSlip, NavierSlip, check_wall, equations, sticking
from anisogran.keys import check_value, key, record_keys
from anisogran.outcome import InputError, NotConverged, Status, checked

MOST_ELEMENTS = 20000  # some 10 s and half a gigabyte on a line
MOST_OFFSET = 0.9  # of the eccentricity in inner radii: the centre of the outer ring, the origin, stays inside of the inner one
TORQUE_WARNING = 1e-8  # relative difference of the two torques
CREEP_WARNING = 0.01  # relative change of v_phi with a tenth of the rate floor


@dataclass(frozen=True)
class RingFlow:
    """Steady flow of grains between an inner ring turning with `wall_speed` (m/s, counter-clockwise positive) and an outer ring.

    `r_inner`, `r_outer` (m); `law`, one of continuum.LAWS; `outer_pressure` (N/m); `grain_diameter` (m) and `grain_mass` (kg),
    means. `outer_speed` (m/s) of the outer ring. `inertia=True` adds advection, such as the centrifugal load, and needs
    `areal_density` (kg/m^2), the mass of grains on an area: area fraction x 4 grain_mass / (pi grain_diameter^2) for discs.

    Walls: `inner_wall` and `outer_wall` are None (rough: grains move with the ring), CoulombSlip(friction) or NavierSlip(viscosity).
    `outer="pressure"`: the outer ring moves radially as one and `outer_pressure` is the mean normal stress on it;
    `outer="volume"`: it is fixed, and since grains of constant density leave the level of the pressure open, `outer_pressure` is
    the mean pressure of the grains. Without inertia and with concentric rings both are the same.

    `dimension=1` solves an axisymmetric flow; `dimension=2` solves on r and phi, which pays only if something depends on phi: an
    `eccentricity` (m), how far the axis of the inner ring is mounted off that of the outer one, towards phi = 0. It then turns
    about its own axis, between rough walls, and fields are functions of r and phi about the centre of the outer ring.

    Accuracy: `elements` along the radius, half of them in the layer that flows, by default the law's own number (in 2D half of
    it), `elements_around` in 2D; `rate_floor`, in units of speed/gap of the faster ring, regularises: it is added to the shear
    rate of a local law in the square and to the fluidity of a nonlocal one, by default 1e-5 and 1e-8; the status tells if the
    answer depends on it. `max_iterations`, of all stages. Measured (13 < r < 33, mu_s 0.26, b 1, wall speed 1e-3; relative L2
    error of v_phi, stress ratio, processor seconds on a busy machine; `anisogran bench continuum` tells those of yours):

        Nonlocal, A = 0.9:  32 elements 3.5e-5, 2e-6, 0.03;  64  4e-6, 1e-7, 0.04;  128  5e-7, 9e-9, 0.1;  256  7e-8, 6e-10, 0.13
        LocalMuI:           16 elements 7e-5, 6e-8, 0.05;  32  3.6e-5, 6e-8, 0.09;  64  3.6e-5, 6e-8, 0.1 (floor 1e-6: 9e-6)
        in 2D, Nonlocal:    48 x 60 elements, 37 860 unknowns, 1e-5, 4e-7, 5.8 s; an axisymmetric flow is that of the line to rounding

    Raises InputError for a value out of range; two resting rings are refused, since a law with a yield stress leaves the stress at
    rest undetermined.
    """

    r_inner: float = key("m", "radius of the inner ring", above=0.0, example=13.0)
    r_outer: float = key("m", "radius of the outer ring, above r_inner", above=0.0, example=33.0)
    law: LocalMuI | Jop | Regularised | Nonlocal = key("1", "law of the flow")
    wall_speed: float = key("m/s", "speed of the inner ring at its radius, counter-clockwise positive", example=1e-3)
    outer_pressure: float = key("N/m", "pressure on the outer ring", above=0.0, example=1.0)
    grain_diameter: float = key("m", "mean diameter of the grains", 1.0, above=0.0)
    grain_mass: float = key("kg", "mean mass of a grain", 1.0, above=0.0)
    inertia: bool = key("1", "whether momentum is advected: centrifugal load; needs areal_density", False)
    dimension: int = key("1", "1: axisymmetric; 2: on r and phi", 1, at_least=1, at_most=2)
    areal_density: float | None = key("kg/m^2", "mass of grains on an area", None, above=0.0, example=0.8)
    outer_speed: float = key("m/s", "speed of the outer ring at its radius", 0.0)
    outer: Literal["pressure", "volume"] = key("1", "what is given of the outer ring", "pressure")
    inner_wall: CoulombSlip | NavierSlip | None = key("1", "slip at the inner ring; absent: rough", None)
    outer_wall: CoulombSlip | NavierSlip | None = key("1", "slip at the outer ring; absent: rough", None)
    eccentricity: float = key("m", "offset of the axes of the rings, below the gap; needs dimension = 2", 0.0, at_least=0.0)
    elements: int | None = key("1", "elements along the radius; left out: the law's own number", None, at_least=2, example=64)
    elements_around: int = key("1", "elements around in 2D", 24, at_least=4)
    rate_floor: float | None = key("1", "regularisation in speed/gap; left out: the law's own", None, above=0.0, at_most=1.0, example=1e-8)
    max_iterations: int = key("1", "of all stages together", 200, at_least=1)

    kind = "ring_flow"

    def __post_init__(self):
        for name, one in record_keys(self).items():
            if not one.records:
                check_value("RingFlow", name, one, getattr(self, name))
        checked("RingFlow", "r_inner", self.r_inner, at_least=1e-6 * self.r_outer, below=self.r_outer, unit="m")
        check_law(self.law)
        if self.speed == 0.0:
            raise InputError("RingFlow: wall_speed = 0: nothing flows, and the stress of grains at rest is undetermined")
        if self.inertia and self.areal_density is None:
            raise InputError("RingFlow: inertia = True needs areal_density, the mass of grains on an area (kg/m^2)")
        check_wall("inner_wall", self.inner_wall)
        check_wall("outer_wall", self.outer_wall)
        self._check_geometry()
        if "g" in self.law.fields:
            self.law.wall_exchange(self.setting())

    def _check_geometry(self):
        checked("RingFlow", "eccentricity", self.eccentricity, below=min(self.gap, MOST_OFFSET * self.r_inner), unit="m")
        if self.eccentricity > 0.0 and self.dimension == 1:
            raise InputError(f"RingFlow: eccentricity = {self.eccentricity:g} m is not axisymmetric and needs dimension = 2")
        if self.eccentricity > 0.0 and self.inner_wall is not None:
            raise InputError("RingFlow: inner_wall must be rough (None) if the rings are eccentric: slip along it is not modelled")

    @property
    def gap(self):
        """r_outer - r_inner, m."""
        return self.r_outer - self.r_inner

    @property
    def speed(self):
        """Speed of the faster ring, the unit of all speeds, m/s."""
        return max(abs(self.wall_speed), abs(self.outer_speed))

    @property
    def floor(self):
        """The rate floor used: the one given, or the law's own."""
        return self.law.floor if self.rate_floor is None else self.rate_floor

    def setting(self, floor=None):
        """The numbers of the reduced problem, a balance.Setting; with another rate floor if one is given."""
        speed, pressure = self.speed, self.outer_pressure
        density = self.areal_density * speed**2 / pressure if self.inertia else 0.0
        inertial = speed / self.gap * np.sqrt(self.grain_mass / pressure)
        return Setting(float(inertial), self.grain_diameter / self.gap, density, floor or self.floor, self.r_inner / self.gap)

    def layer(self):
        """Thickness of the layer that flows, reduced, for the mesh; at most the inner radius."""
        setting = self.setting()
        return min(self.law.layer(setting), setting.inner)

    def elements_along(self):
        """The number of elements along the radius; InputError if there are too many."""
        number = int(self.elements or self.law.elements(1.0 / self.layer(), self.setting()))
        if self.elements is None and self.dimension == 2:
            number = 2 * -(-number // 4)
        if number * (int(self.elements_around) if self.dimension == 2 else 1) > MOST_ELEMENTS:
            raise InputError(f"RingFlow: elements = {number} is above {MOST_ELEMENTS} in all: too wide a gap for these grains")
        return number

    def solve(self):
        """The Flow; its status is "warned" if the answer depends on the rate floor or the mesh, or leaves the range of the law.

        Raises NotConverged, with the history of corrections and the last iterate as `best`, a Flow of status failed, if there is no
        solution or none is found, for example when the centrifugal load is as large as the outer pressure.
        """
        start, history = perf_counter(), []
        try:
            solution, change = solved(self, history)
        except NotConverged as error:
            error.best = self._unsolved(error.best, history, str(error), perf_counter() - start)
            raise
        flow = self._flow(solution, history)
        return replace(flow, status=self._status(flow, change), seconds=perf_counter() - start)

    def _unsolved(self, x, history, reason, seconds):
        """The last iterate as a Flow whose status says that it is none."""
        space = next(space for space in levels(self) if space.size == x.size)
        signs = sticking(space)
        with np.errstate(all="ignore"):  # it may lie outside of the domain of the law
            flow = self._flow(Solution(space, x, equations(space, self, self.setting(), signs), signs), history)
        return replace(flow, status=Status().fail(f"not converged: {reason}"), seconds=seconds)

    def _flow(self, solution, history):
        """The Flow of unknowns, status and seconds still to be told."""
        space, x = solution.space, solution.x
        r = self.gap * space.nodes()
        profile, stress = mean_fields(self, space, x, r / self.gap)
        profile = profile._replace(r=r)
        reaction = solution.system.reaction(x)
        ratio, force = inner_wall(self, space, reaction)
        return Flow(
            r=r,
            v_phi=profile.v_phi,
            pressure=profile.pressure,
            stress=stress,
            fluidity=profile.fluidity,
            shear_rate=profile.shear_rate,
            inertial_number=profile.inertial_number,
            stress_ratio_wall=ratio,
            torques=torques(self, space, reaction),
            slip=slip(self, space, x),
            wall_force=force,
            ill_posed_share=ill_posed_share(self.law, space.point(x), space.weight, self.setting()),
            status=Status(),
            iterations=len(history),
            history=tuple(history),
            seconds=0.0,
            problem=self,
            space=space,
            unknowns=x,
        )

    def _status(self, flow, change):
        """What a user should doubt: torque balance, range of the law, mesh, influence of the rate floor."""
        status = Status()
        if flow.torques.difference > TORQUE_WARNING and self.eccentricity == 0.0:
            share = f"{flow.torques.difference:.1g}"
            status = status.warn(f"the torques on the rings differ by {share}: rounding, or with inertia a coarse mesh")
        status = beyond_the_law(status, self.law, flow)
        status = between_mesh_points(status, flow.r[::2], flow.v_phi[::2], self.speed)
        if change is None:
            return status.warn("no solution with a tenth of the rate floor: its influence is not known")
        if change > CREEP_WARNING:
            status = status.warn(f"v_phi changes by {100 * change:.2g} % with a tenth of the rate floor: lower it")
        return status
