"""What the two rings do to the grains: they carry them along, let them slip, and press on them."""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from scipy.sparse import csr_array

from anisogran.continuum.balance import balance, stacked
from anisogran.continuum.system import System
from anisogran.keys import check_keys, key
from anisogran.outcome import InputError

AT_REST = 1e3  # fluidity, in rate floors, that is as good as none: the rounding of shear rates makes changes of 1e-6 floors
STICK_BAND = 1e-9  # by which a wall force must exceed friction before the grains let go


@dataclass(frozen=True)
class CoulombSlip:
    """A wall on which grains stick up to the shear stress friction x normal stress and slip at just that stress.

    Raises InputError if `friction` is below 0; at 0 the wall is perfectly smooth and takes no torque.
    """

    friction: float = key("1", "shear over normal stress while slipping", at_least=0.0, example=0.2)

    kind = "coulomb_slip"

    def __post_init__(self):
        check_keys(self)


@dataclass(frozen=True)
class NavierSlip:
    """A wall on which the shear stress is `viscosity` (N s/m^2) x slip speed, as on a thin layer of fluid.

    Raises InputError if `viscosity` is below 0; at 0 the wall is perfectly smooth, and rough in the limit of a large one.
    """

    viscosity: float = key("N s/m^2", "shear stress over slip speed", at_least=0.0, example=1.0)

    kind = "navier_slip"

    def __post_init__(self):
        check_keys(self)


def check_wall(key, wall):
    """The wall itself; InputError if it is neither None (rough), a CoulombSlip nor a NavierSlip."""
    if wall is not None and not isinstance(wall, (CoulombSlip, NavierSlip)):
        raise InputError(f"RingFlow: {key} = {wall!r} is no wall; give None (rough), CoulombSlip(friction) or NavierSlip(viscosity)")
    return wall


def wall_of(problem, outer):
    """The wall of the inner or the outer ring."""
    return problem.outer_wall if outer else problem.inner_wall


def wall_velocity(space, problem, outer):
    """Reduced u_r and u_phi of a ring at its nodes, by angle; the inner one turns about its own centre."""
    angle = space.angle[space.ring("u_phi", outer)]
    if outer:
        return np.zeros_like(angle), np.full_like(angle, problem.outer_speed / problem.speed)
    inner, offset = space.vertices[0], space.offset
    r = space.polar(inner, angle)[0]
    turn = problem.wall_speed / problem.speed / inner
    return -turn * offset * np.sin(angle), turn * (r - offset * np.cos(angle))


def sticking(space):
    """The slip of Coulomb walls, {outer: sign of the slip velocity at each node}, with no node slipping."""
    return {outer: np.zeros(space.ring("u_phi", outer).size, dtype=int) for outer in (False, True)}


def slip_velocity(space, problem, x, outer):
    """Reduced velocity of a ring less that of the grains on it, along phi, at each node."""
    return wall_velocity(space, problem, outer)[1] - x[space.ring("u_phi", outer)]


def slip_signs(space, problem, x, reaction, signs):
    """The signs that the forces and velocities of `x` ask for: let go where friction is exceeded, stick where slip would reverse."""
    out = {}
    for outer, before in signs.items():
        out[outer] = before
        wall = wall_of(problem, outer)
        if isinstance(wall, CoulombSlip):
            force = reaction[space.ring("u_phi", outer)]
            most = wall.friction * np.abs(reaction[space.ring("u_r", outer)])
            lets_go = np.where(np.abs(force) > most * (1.0 + STICK_BAND), np.sign(force), 0).astype(int)
            reverses = before * slip_velocity(space, problem, x, outer) < 0.0
            out[outer] = np.where(before == 0, lets_go, np.where(reverses, 0, before))
    return out


def equations(space, problem, setting, signs):
    """The System of a ring flow; `signs` says which nodes of Coulomb walls slip (see `sticking`)."""
    law, column = problem.law, columns(space, problem, signs)
    free, number = np.flatnonzero(column >= 0), int(column.max()) + 1
    test, linear, load = [(column[free], free, np.ones(free.size))], [], np.zeros(number)
    for outer in (False, True):
        wall = wall_of(problem, outer)
        places, normal = space.ring("u_phi", outer), space.ring("u_r", outer)
        if isinstance(wall, NavierSlip):
            strength = wall.viscosity * problem.speed / problem.outer_pressure * space.arc(outer)
            linear.append((column[places], places, strength))
            load[column[places]] = strength * wall_velocity(space, problem, outer)[1]
        elif isinstance(wall, CoulombSlip):
            slips = signs[outer] != 0  # there the force along phi is friction x normal force, which points inward on the outer ring
            factors = wall.friction * signs[outer][slips] * (1.0 if outer else -1.0)
            test.append((column[places[slips]], normal[slips], factors))
    if "g" in law.fields:
        places = space.ring("g", outer=False)
        linear.append((column[places], places, law.wall_exchange(setting) / setting.inner * space.arc(outer=False)))
    moves = column[space.ring("u_r", outer=True)[0]]
    if problem.outer == "pressure":
        load[moves] = -space.vertices[-1] * space.radians
    else:  # grains of constant density let the outer ring stay where it is in any case
        test[0] = tuple(part[column[free] != moves] for part in test[0])
        mean = space.residual(stacked({"p": 1.0}, space.rows, space.r))
        linear.append((np.full(space.size, moves), np.arange(space.size), mean))
        load[moves] = space.weight.sum()
    trial = sparse([(free, column[free], np.ones(free.size))], (space.size, number))
    test, linear = sparse(test, (number, space.size)), sparse(linear, (number, space.size))
    return with_setting(System(space, None, None, trial, test, linear, load), law, setting)


def with_setting(system, law, setting):
    """The same equations with another rate floor."""
    forms, positive = partial(balance, law, setting), partial(law.positive, setting=setting)
    return replace(system, balance=forms, positive=positive, fluidity_unit=AT_REST * setting.rate_floor)


def sparse(entries, shape):
    """The csr matrix of [(rows, columns, values), ...]."""
    rows, columns, values = (np.concatenate(part) for part in zip(*entries, strict=True)) if entries else ([], [], [])
    return csr_array((values, (rows, columns)), shape=shape)


def columns(space, problem, signs):
    """The column of each unknown in `trial`, -1 if it is prescribed; the radial velocities of the outer ring share one."""
    out = np.zeros(space.size, dtype=int)
    out[space.ring("u_r", outer=False)] = -1
    out[space.ring("u_r", outer=True)[1:]] = -1
    for outer in (False, True):
        wall = wall_of(problem, outer)
        if not isinstance(wall, NavierSlip):
            out[space.ring("u_phi", outer)[signs[outer] == 0]] = -1
    out[out == 0] = np.arange(np.count_nonzero(out == 0))
    out[space.ring("u_r", outer=True)] = out[space.ring("u_r", outer=True)[0]]
    return out
