"""The ring shear cell as a continuum, steady: a line mesh in r if it is axisymmetric, else a mesh in r and phi.

Unknowns u_r, u_phi (quadratic), pressure (linear) and, for a nonlocal law, the fluidity g (quadratic). The rings turn with given
speeds; the outer one is free to move radially under the outer pressure, as one. Everything is solved in reduced units (gap, speed
of the faster ring, outer pressure), in which a slow flow is no harder than a fast one.
"""

from dataclasses import dataclass
from functools import partial
from time import perf_counter
from typing import Any

import numpy as np

from anisogran.continuum.balance import Setting
from anisogran.continuum.doubts import between_mesh_points, beyond_the_law, ill_posed_share
from anisogran.continuum.flow import Flow, inner_wall, mean_fields, slip, torques
from anisogran.continuum.laws import check_law
from anisogran.continuum.steady import solved
from anisogran.continuum.walls import check_wall
from anisogran.outcome import InputError, Status, checked

MOST_ELEMENTS = 20000  # some 10 s and half a gigabyte on a line
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
    rate of a local law in the square and to the fluidity of a nonlocal one, by default 1e-4 and 1e-8; the status tells if the
    answer depends on it. `max_iterations`, of all stages. Measured (13 < r < 33, mu_s 0.26, b 1, wall speed 1e-3; relative L2
    error of v_phi, stress ratio, seconds on one core):

        Nonlocal, A = 0.9:  32 elements 3.5e-5, 2e-6, 0.02;  64  4e-6, 1e-7, 0.03;  128  5e-7, 9e-9, 0.04;  256  7e-8, 6e-10, 0.07
        LocalMuI:           16 elements 3.8e-4, 6e-7, 0.02;  32  3.7e-4, 6e-7, 0.04;  64  3.7e-4, 6e-7, 0.05 (floor 1e-5: 3.7e-5)

    Raises InputError for a value out of range; two resting rings are refused, since a law with a yield stress leaves the stress at
    rest undetermined.
    """

    r_inner: float
    r_outer: float
    law: Any
    wall_speed: float
    outer_pressure: float
    grain_diameter: float = 1.0
    grain_mass: float = 1.0
    inertia: bool = False
    dimension: int = 1
    areal_density: float | None = None
    outer_speed: float = 0.0
    outer: str = "pressure"
    inner_wall: Any = None
    outer_wall: Any = None
    eccentricity: float = 0.0
    elements: int | None = None
    elements_around: int = 48
    rate_floor: float | None = None
    max_iterations: int = 200

    def __post_init__(self):
        check = partial(checked, "RingFlow")
        outer = check("r_outer", self.r_outer, above=0.0, unit="m")
        check("r_inner", self.r_inner, at_least=1e-6 * outer, below=outer, unit="m")
        check("outer_pressure", self.outer_pressure, above=0.0, unit="N/m")
        check("grain_diameter", self.grain_diameter, above=0.0, unit="m")
        check("grain_mass", self.grain_mass, above=0.0, unit="kg")
        check_law(self.law)
        check("rate_floor", self.floor, above=0.0, at_most=1.0)
        wholes = (("elements", 2, self.elements), ("elements_around", 4, self.elements_around), ("max_iterations", 1, self.max_iterations))
        for key, least, value in wholes:
            if value is not None and check(key, value, at_least=least) != int(value):
                raise InputError(f"RingFlow: {key} = {value:g} must be a whole number")
        speeds = [check(key, getattr(self, key), unit="m/s") for key in ("wall_speed", "outer_speed")]
        if speeds == [0.0, 0.0]:
            raise InputError("RingFlow: wall_speed = 0: nothing flows, and the stress of grains at rest is undetermined")
        if self.inertia and self.areal_density is None:
            raise InputError("RingFlow: inertia = True needs areal_density, the mass of grains on an area (kg/m^2)")
        if self.areal_density is not None:
            check("areal_density", self.areal_density, above=0.0, unit="kg/m^2")
        if self.outer not in ("pressure", "volume"):
            raise InputError(f'RingFlow: outer = {self.outer!r} must be "pressure" or "volume"')
        check_wall("inner_wall", self.inner_wall)
        check_wall("outer_wall", self.outer_wall)
        self._check_geometry()
        if "g" in self.law.fields:
            self.law.wall_exchange(self.setting())

    def _check_geometry(self):
        if self.dimension not in (1, 2):
            raise InputError(f"RingFlow: dimension = {self.dimension!r} must be 1 (axisymmetric) or 2")
        checked("RingFlow", "eccentricity", self.eccentricity, at_least=0.0, below=self.gap, unit="m")
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

        Raises NotConverged, with the history of corrections and the best iterate, if there is no solution or none is found, for
        example when the centrifugal load is as large as the outer pressure.
        """
        start, history = perf_counter(), []
        solution, change = solved(self, history)
        space, x = solution.space, solution.x
        r = self.gap * space.nodes()
        profile, stress = mean_fields(self, space, x, r / self.gap)
        reaction = solution.system.reaction(x)
        ratio, force = inner_wall(self, space, reaction)
        balance_of_torques = torques(self, space, reaction)
        return Flow(
            r=r,
            v_phi=profile.v_phi,
            pressure=profile.pressure,
            stress=stress,
            fluidity=profile.fluidity,
            shear_rate=profile.shear_rate,
            inertial_number=profile.inertial_number,
            stress_ratio_wall=ratio,
            torques=balance_of_torques,
            ill_posed_share=ill_posed_share(self.law, space.point(x), space.weight, self.setting()),
            slip=slip(self, space, x),
            wall_force=force,
            status=self._status(profile, balance_of_torques, change),
            iterations=len(history),
            history=tuple(history),
            seconds=perf_counter() - start,
            problem=self,
            space=space,
            unknowns=x,
        )

    def _status(self, profile, torques, change):
        """What a user should doubt: torque balance, range of the law, mesh, influence of the rate floor."""
        status = Status()
        if torques.difference > TORQUE_WARNING and self.eccentricity == 0.0:
            share = f"{torques.difference:.1g}"
            status = status.warn(f"the torques on the rings differ by {share}: rounding, or with inertia a coarse mesh")
        status = beyond_the_law(status, self.law, profile)
        status = between_mesh_points(status, profile.r[::2], profile.v_phi[::2], self.speed)
        if change is None:
            return status.warn("no solution with a tenth of the rate floor: its influence is not known")
        if change > CREEP_WARNING:
            status = status.warn(f"v_phi changes by {100 * change:.2g} % with a tenth of the rate floor: lower it")
        return status
