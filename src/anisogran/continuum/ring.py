"""The ring shear cell as a continuum: steady, axisymmetric, solved on a line mesh in r.

Unknowns u_r, u_phi (quadratic), pressure (linear) and, for a nonlocal law, the fluidity g (quadratic). The inner ring turns, the
outer one is at rest against rotation and free to move radially under the outer pressure. Everything is solved in reduced units
(gap, |wall speed|, outer pressure), in which a slow flow is no harder than a fast one.
"""

from dataclasses import dataclass
from functools import partial
from time import perf_counter
from typing import Any

import numpy as np

from anisogran.continuum.balance import Setting, balance
from anisogran.continuum.flow import Flow, fields, torques
from anisogran.continuum.laws import check_law
from anisogran.continuum.newton import System, alternated, newton
from anisogran.continuum.space import Space, graded
from anisogran.outcome import InputError, NotConverged, Status, checked

LINEAR_LAW_RANGE = 0.2  # inertial number above which mu_s + b I is not supported by data (da Cruz et al. 2005; from memory)
MOST_ELEMENTS = 20000  # some 10 s, half a gigabyte
TORQUE_WARNING = 1e-8  # relative difference of the two torques
CREEP_WARNING = 0.01  # relative change of v_phi with a tenth of the rate floor


@dataclass(frozen=True)
class RingFlow:
    """Steady flow of grains between an inner ring turning with `wall_speed` (m/s, counter-clockwise positive) and an outer ring.

    `r_inner`, `r_outer` (m); `law`, a LocalMuI or Nonlocal; `outer_pressure` (N/m) on the outer ring, which moves radially as
    one; `grain_diameter` (m) and `grain_mass` (kg), means. `inertia=True` adds the centrifugal load and needs `areal_density`
    (kg/m^2), the mass of grains on an area: area fraction x 4 grain_mass / (pi grain_diameter^2) for discs.

    Accuracy: `elements` along the radius, half of them in the layer that flows, by default the law's own number; `rate_floor`, in
    units of |wall_speed|/gap, regularises: it is added to the shear rate of a local law in the square and to the fluidity of a
    nonlocal one, by default 1e-4 and 1e-8; the status tells if the answer depends on it. `max_iterations`, of all stages.
    Measured (13 < r < 33, mu_s 0.26, b 1, wall speed 1e-3; relative L2 error of v_phi, stress ratio, seconds on one core):

        Nonlocal, A = 0.9:  32 elements 3.5e-5, 2e-6, 0.02;  64  4e-6, 1e-7, 0.03;  128  5e-7, 9e-9, 0.04;  256  7e-8, 6e-10, 0.07
        LocalMuI:           16 elements 3.8e-4, 6e-7, 0.02;  32  3.7e-4, 6e-7, 0.04;  64  3.7e-4, 6e-7, 0.05 (floor 1e-5: 3.7e-5)

    Raises InputError for a value out of range; a resting ring is refused, since a law with a yield stress leaves the stress at
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
    areal_density: float | None = None
    elements: int | None = None
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
        for key, least, given in (("elements", 2, self.elements is not None), ("max_iterations", 1, True)):
            value = check(key, getattr(self, key), at_least=least) if given else least
            if value != int(value):
                raise InputError(f"RingFlow: {key} = {value:g} must be a whole number")
        if check("wall_speed", self.wall_speed, unit="m/s") == 0.0:
            raise InputError("RingFlow: wall_speed = 0: nothing flows, and the stress of grains at rest is undetermined")
        if self.inertia and self.areal_density is None:
            raise InputError("RingFlow: inertia = True needs areal_density, the mass of grains on an area (kg/m^2)")
        if self.areal_density is not None:
            check("areal_density", self.areal_density, above=0.0, unit="kg/m^2")
        if "g" in self.law.fields:
            self.law.wall_exchange(self.setting())

    @property
    def gap(self):
        """r_outer - r_inner, m."""
        return self.r_outer - self.r_inner

    @property
    def floor(self):
        """The rate floor used: the one given, or the law's own."""
        return self.law.floor if self.rate_floor is None else self.rate_floor

    def setting(self, floor=None):
        """The numbers of the reduced problem, a laws.Setting; with another rate floor if one is given."""
        speed, pressure = abs(self.wall_speed), self.outer_pressure
        density = self.areal_density * speed**2 / pressure if self.inertia else 0.0
        inertial = speed / self.gap * np.sqrt(self.grain_mass / pressure)
        return Setting(float(inertial), self.grain_diameter / self.gap, density, floor or self.floor, self.r_inner / self.gap)

    def solve(self):
        """The Flow; its status is "warned" if the answer depends on the rate floor or leaves the range of the linear law.

        Raises NotConverged, with the history of corrections and the best iterate, if there is no solution or none is found, for
        example when the centrifugal load is as large as the outer pressure.
        """
        start, history = perf_counter(), []
        setting = self.setting()
        inner = setting.inner
        layer = min(self.law.layer(setting), inner)
        elements = self.elements or self.law.elements(1.0 / layer, setting)
        if elements > MOST_ELEMENTS:
            raise InputError(f"RingFlow: elements = {elements} is above {MOST_ELEMENTS}: too wide a gap for these grains")
        space = Space(graded(inner, self.r_outer / self.gap, int(elements), layer), self.law.fields)
        x = first_guess(space, self.law, setting, np.sign(self.wall_speed))
        known = self._continued(space, x, history)
        x = known[-1][1]
        profile, stress = fields(self, space, x, self.gap * space.nodes())
        reaction = system(space, self.law, setting).residual(x)
        ratio = abs(reaction[space.at_end("u_phi", outer=False)]) / reaction[space.at_end("u_r", outer=False)]
        balance_of_torques = torques(self, space, reaction)
        return Flow(
            r=profile.r,
            v_phi=profile.v_phi,
            pressure=profile.pressure,
            stress=stress,
            fluidity=profile.fluidity,
            shear_rate=profile.shear_rate,
            inertial_number=profile.inertial_number,
            stress_ratio_wall=float(ratio),
            torques=balance_of_torques,
            status=self._status(space, known, profile, balance_of_torques),
            iterations=len(history),
            history=tuple(history),
            seconds=perf_counter() - start,
            problem=self,
            space=space,
            unknowns=x,
        )

    def _continued(self, space, x, history):
        """Solutions as [(floor, x), ...], the floor lowered in the steps of the law to the final one.

        A law with fluidity begins with Picard rounds: flow, then fluidity.
        """
        free, fluidity, known = free_places(space), space.part.get("g"), []
        for floor in floors(self.law, self.floor):
            equations = system(space, self.law, self.setting(floor))
            if known:
                x = predicted(space, known, floor)
            elif fluidity:
                groups = free[free < fluidity.start], free[free >= fluidity.start]
                x = alternated(equations, x, groups, history, self.max_iterations)
            known.append((floor, newton(equations, x, free, history, self.max_iterations)))
        return known

    def _status(self, space, known, profile, balance_of_torques):
        """What a user should doubt: range of the law, torque balance, influence of the rate floor."""
        status = Status()
        if balance_of_torques.difference > TORQUE_WARNING:
            share = f"{balance_of_torques.difference:.1g}"
            status = status.warn(f"the torques on the rings differ by {share}: rounding, or with inertia a coarse mesh")
        fastest = int(np.argmax(profile.inertial_number))
        highest = profile.inertial_number[fastest]
        if highest > LINEAR_LAW_RANGE:
            where = f"reaches {highest:.2g} at r = {profile.r[fastest]:g}"
            status = status.warn(f"the inertial number {where}; the linear law is meant for I <= {LINEAR_LAW_RANGE}")
        x = known[-1][1]
        finer = system(space, self.law, self.setting(0.1 * self.floor))
        try:
            change = newton(finer, predicted(space, known, 0.1 * self.floor), free_places(space), [], self.max_iterations) - x
        except NotConverged:
            return status.warn("no solution with a tenth of the rate floor: its influence is not known")
        share = norm(space, change) / norm(space, x)
        if share > CREEP_WARNING:
            status = status.warn(f"v_phi changes by {100 * share:.2g} % with a tenth of the rate floor: lower it")
        return status


def floors(law, last):
    """Rate floors from the law's first one down to `last`, each the law's factor below the one before."""
    floor = law.first_floor
    while floor > last * 1.000001:
        yield floor
        floor *= law.floor_factor
    yield last


def predicted(space, known, floor):
    """A start for a lower floor from the solutions [(floor, x), ...] known.

    With fluidity: the last one, the fluidity raised as much as the floor falls, which keeps its stress and its positivity. Else
    the line through the last two: where grains are all but at rest, the velocity is proportional to the floor.
    """
    last, x = known[-1]
    out = x.copy()
    if "g" in space.part:
        out[space.part["g"]] += last - floor
    elif len(known) > 1:
        before, older = known[-2]
        out += (floor - last) / (last - before) * (x - older)
    return out


def system(space, law, setting):
    """The discrete equations of the ring: outer pressure as a load, exchange of fluidity with the inner ring."""
    load = np.zeros(space.size)
    load[space.at_end("u_r", outer=True)] = -space.vertices[-1]
    exchange = {space.at_end("g", outer=False): law.wall_exchange(setting)} if "g" in law.fields else {}
    return System(space, partial(balance, law, setting), partial(law.positive, setting=setting), load, exchange)


def free_places(space):
    """Unknowns that are not prescribed: all but u_r on the inner ring and u_phi on both."""
    prescribed = [space.at_end("u_r", outer=False), space.at_end("u_phi", outer=False), space.at_end("u_phi", outer=True)]
    return np.setdiff1d(np.arange(space.size), prescribed)


def first_guess(space, law, setting, direction):
    """Reduced unknowns with the prescribed values: velocity linear in r, pressure 1, fluidity decaying as in grains at rest."""
    x = np.zeros(space.size)
    depth = space.place - space.vertices[0]
    x[space.part["u_phi"]] = direction * (1.0 - depth[space.part["u_phi"]])
    x[space.at_end("u_phi", outer=True)] = 0.0
    x[space.part["p"]] = 1.0
    if "g" in law.fields:
        x[space.part["g"]] = np.exp(-depth[space.part["g"]] / law.length(setting))
    return x


def norm(space, x):
    """The L2 norm of u_phi over the ring."""
    u_phi = np.einsum("eqn,en->eq", space.b[:, :, 1], x[space.dofs])
    return np.sqrt(np.sum(space.weight * u_phi**2))
