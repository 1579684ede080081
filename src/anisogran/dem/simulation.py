"""A simulation of grains with exactly the effects it was given: state, steps, and snapshots for the averages."""

import math
import time
from dataclasses import replace
from types import SimpleNamespace

import numpy as np

from anisogran.dem.boundaries import Open
from anisogran.dem.contacts import contact_table
from anisogran.dem.grains import Grains
from anisogran.dem.laws import NORMAL_LAWS, Friction
from anisogran.dem.neighbours import empty_pair_list
from anisogran.dem.pairs import scratch
from anisogran.dem.stepping import (
    CELL_TOO_SMALL,
    DEEP_OVERLAP,
    DONE,
    LIST_FULL,
    NOT_FINITE,
    OUTSIDE,
    TOO_FAST,
    Body,
    Counters,
    add_all_forces,
    rebuild,
    run_steps,
)
from anisogran.dem.walls import empty_wall_list
from anisogran.outcome import InputError, RunFailed, checked
from anisogran.snapshot import Snapshot

CAUSES = {
    NOT_FINITE: "its position is not a finite number; the time step is too long or a force has blown up",
    DEEP_OVERLAP: "it overlaps a neighbour by more than half a radius; the load is too high for the stiffness, or the time step too long",
    TOO_FAST: "it moves more than half the smallest radius in one step; faster than contacts can be found",
    CELL_TOO_SMALL: "the periodic cell is narrower than four of its radii and two skins; a contact would meet its own image",
    OUTSIDE: "its centre lies beyond a wall; the wall is too soft for the load, or the grain too fast for the time step",
}
STARTS = {
    NOT_FINITE: "is not at a finite place",
    DEEP_OVERLAP: "overlaps a neighbour by more than half a radius",
    OUTSIDE: "has its centre beyond a wall",
    CELL_TOO_SMALL: "is too large for the periodic cell, which must be wider and higher than four radii and two skins,",
}


def collision_time(normal, mass):
    """Duration t_c = pi / sqrt(k/m12 - (g/(2 m12))^2) of a binary contact of the lightest pair on the stiffest branch, in s.

    An overdamped pair has no such time; there the undamped pi sqrt(m12/k) is returned.
    """
    reduced = 0.5 * float(np.min(mass))
    square = normal.stiffest / reduced
    damped = square - (normal.damping / (2.0 * reduced)) ** 2
    return math.pi / math.sqrt(damped if damped > 0 else square)


def longest_step(normal, friction, drag, mass):
    """The longest time step that is allowed, in s: a fifth of the shortest undamped contact time, less for strong dashpots or friction.

    The dashpots are explicit: a step beyond 2 m12/damping would turn damping into driving. A quarter of that leaves room for grains with
    many contacts. A tangential force also turns the grains, which makes it 1 + 1/0.4 = 3.5 times as effective on spheres; its
    oscillation may take 0.3 of its half period, so that k_t up to 0.6 of the normal stiffness leaves the step as it is.
    """
    lightest = float(np.min(mass))
    reduced = 0.5 * lightest
    limits = [math.pi / 5 * math.sqrt(reduced / normal.stiffest)]
    dashpots = [(normal.damping, reduced), (drag or 0.0, lightest)]
    if friction is not None:
        limits.append(0.3 * math.pi * math.sqrt(reduced / (3.5 * friction.stiffness)))
        dashpots.append((3.5 * friction.damping, reduced))
    return min(limits + [0.5 * inertia / damping for damping, inertia in dashpots if damping > 0])


def check_effects(grains, normal, friction, wall_friction, boundary):
    """Raises InputError naming the first argument that is not what it has to be."""
    if type(normal) not in NORMAL_LAWS:
        laws = ", ".join(law.__name__ for law in NORMAL_LAWS)
        raise InputError(f"Simulation: normal = {normal!r} must be a contact law ({laws}) with its parameters")
    for name, effect in (("friction", friction), ("wall_friction", wall_friction)):
        if effect is not None and not isinstance(effect, Friction):
            raise InputError(f"Simulation: {name} = {effect!r} must be a Friction record or None")
    if not hasattr(boundary, "walls") or isinstance(boundary, type):
        raise InputError(f"Simulation: boundary = {boundary!r} must be one of Open, Box, Ring, Periodic")
    if getattr(boundary, "inner", 0) > grains.driven:
        raise InputError(f"Simulation: the ring has inner = {boundary.inner} driven grains, but only {grains.driven} are given")


class Simulation:
    """Grains, contact effects and a boundary, ready to run.

    normal: Linear or Luding; friction: Friction between grains, or None; wall_friction: Friction at smooth walls and rings, or None;
    boundary: Open, Box, Ring or Periodic; drag: background damping in kg/s for preparation, or None; dt in s, default a tenth of
    `longest_step`, which is a fiftieth of the shortest contact time unless a dashpot is strong. An absent effect is not compiled and
    holds no memory. `skin` in m is the reserve of the neighbour list. Raises InputError before the first step for anything that cannot
    be simulated.
    """

    def __init__(self, grains, normal, friction=None, boundary=None, wall_friction=None, drag=None, dt=None, skin=None, predecessor=None):
        if not isinstance(grains, Grains):
            raise InputError(f"Simulation: grains = {grains!r} must be a dem.Grains record")
        boundary = Open() if boundary is None else boundary
        check_effects(grains, normal, friction, wall_friction, boundary)
        n = len(grains)
        movable = n - grains.driven
        drag = None if drag is None else checked("Simulation", "drag", drag, above=0, unit="kg/s")
        limit = min(longest_step(normal, rubbing, drag, grains.mass) for rubbing in (friction, wall_friction))
        self.dt = 0.1 * limit if dt is None else checked("Simulation", "dt", dt, above=0, at_most=limit, unit="s")
        self.grains, self.boundary = grains, boundary
        self.effects = {"normal": normal, "friction": friction, "wall_friction": wall_friction, "drag": drag}
        largest_radius = float(grains.radius.max())
        skin = 0.2 * float(grains.radius.mean()) if skin is None else checked("Simulation", "skin", skin, above=0, unit="m")

        rotates = friction is not None or wall_friction is not None
        walls = boundary.walls
        inverse_mass = 1.0 / grains.mass
        x, y = grains.position.T.copy()
        vx, vy = grains.velocity.T.copy()
        remembers = normal.remembers
        capacity = 6 * n + 64
        self._state = SimpleNamespace(
            body=Body(x, y, vx, vy, np.zeros(n), np.zeros(n), grains.radius.copy(), inverse_mass, x.copy(), y.copy()),
            spin=grains.spin.copy() if rotates else None,
            torque=np.zeros(n) if rotates else None,
            inverse_inertia=inverse_mass / (grains.inertia_factor * grains.radius**2) if rotates else None,
            pairs=empty_pair_list(n, capacity),
            wall_list=empty_wall_list(n, walls),
            largest=np.zeros(capacity) if remembers else None,
            spring=np.zeros(capacity) if friction is not None else None,
            wall_largest=np.zeros((walls, n)) if remembers and walls else None,
            wall_spring=np.zeros((walls, n)) if wall_friction is not None and walls else None,
            normal=normal.parameters(),
            friction=None if friction is None else friction.parameters(),
            wall_friction=None if wall_friction is None or not walls else wall_friction.parameters(),
            drag=drag,
            boundary=boundary.state(),
            movable=movable,
            skin=skin,
            reach=2 * largest_radius + skin,
            step_limit=0.5 * float(grains.radius.min()),
            out=scratch(),
            counters=Counters(*(np.zeros(1, np.int64) for _ in range(5)), np.zeros(2)),
        )
        self._chunk = 100  # steps in one compiled call; adapted to the speed
        self._build(predecessor)
        self._force()

    def _build(self, predecessor):
        """The first neighbour list, with the contact memory of the stage before if there is one."""
        s = self._state
        if predecessor is not None:
            before = predecessor._state
            s.pairs = type(s.pairs)(before.pairs.first.copy(), before.pairs.second.copy(), before.pairs.start.copy())
            for name in ("largest", "spring", "wall_largest", "wall_spring"):
                mine, theirs = getattr(s, name), getattr(before, name)
                if mine is not None:
                    of_walls = name.startswith("wall")
                    if theirs is not None and (not of_walls or theirs.shape == mine.shape):
                        setattr(s, name, theirs.copy())
                    elif not of_walls:
                        setattr(s, name, np.zeros(s.pairs.first.size))
        while (code := self._rebuild()) == LIST_FULL:
            self._make_room()
        if code != DONE and predecessor is None:
            i = int(s.counters.grain[0])
            raise InputError(f"Simulation: grain {i} at ({s.body.x[i]:.6g}, {s.body.y[i]:.6g}) m {STARTS[code]} at the start")
        self._raise_unless_done(code)

    def _rebuild(self):
        s = self._state
        return rebuild(s.body, s.pairs, s.wall_list, s.largest, s.spring, s.boundary, s.movable, s.skin, s.counters)

    def _make_room(self):
        """Longer arrays for the list and its memory, with a reserve of a quarter."""
        s = self._state
        capacity = int(1.25 * s.counters.pairs[0]) + 64
        pairs = empty_pair_list(len(self.grains), capacity)
        used = int(s.pairs.start[-1])
        pairs.first[:used] = s.pairs.first[:used]
        pairs.second[:used] = s.pairs.second[:used]
        pairs.start[:] = s.pairs.start
        s.pairs = pairs
        for name in ("largest", "spring"):
            memory = getattr(s, name)
            if memory is not None:
                longer = np.zeros(capacity)
                longer[:used] = memory[:used]
                setattr(s, name, longer)

    def _force(self):
        """Forces at the present positions and velocities; springs do not stretch in no time."""
        s = self._state
        add_all_forces(
            s.body, s.spin, s.torque, s.pairs, s.wall_list, s.largest, s.spring, s.wall_largest, s.wall_spring,
            s.normal, s.friction, s.wall_friction, s.boundary, s.out, 0.0,
        )  # fmt: skip

    def _raise_unless_done(self, code):
        if code != DONE:
            s = self._state
            i = int(s.counters.grain[0])
            place = f"x = ({s.body.x[i]:.6g}, {s.body.y[i]:.6g}) m, v = ({s.body.vx[i]:.3g}, {s.body.vy[i]:.3g}) m/s"
            raise RunFailed(f"stopped at step {self.step} (t = {self.time:.6g} s) at grain {i}, {place}: {CAUSES[code]}")

    def run(self, steps):
        """Advances by a whole number of steps. Raises RunFailed naming step, grain and likely cause, InputError for a part of a step.

        The compiled loop comes back at least about twice a second, so that an interrupt is heard.
        """
        if checked("Simulation.run", "steps", steps, at_least=0) != int(steps):
            raise InputError(f"Simulation.run: steps = {steps} must be a whole number; dt is {self.dt:g} s")
        s = self._state
        end = self.step + int(steps)
        while self.step < end:
            begin, clock = self.step, time.perf_counter()
            code = run_steps(
                s.body, s.spin, s.torque, s.inverse_inertia, s.pairs, s.wall_list, s.largest, s.spring, s.wall_largest, s.wall_spring,
                s.normal, s.friction, s.wall_friction, s.drag, s.boundary, s.movable, s.skin, s.reach, s.step_limit, s.out, s.counters,
                self.dt, min(self._chunk, end - begin),
            )  # fmt: skip
            if code == LIST_FULL:
                self._make_room()
                continue
            self._raise_unless_done(code)
            seconds = time.perf_counter() - clock
            self._chunk = max(1, min(2 * self._chunk, int((self.step - begin) * 0.4 / seconds)))

    def next_stage(self, boundary, **changes):
        """A new simulation of the grains as they are now, with some of the arguments of this one changed; its time begins at 0.

        The boundary is always given, with its walls where they are now. Contact memory (largest overlap, tangential spring) is kept
        where both stages have the effect. `position` and `velocity` may be given anew.
        """
        position, velocity = changes.pop("position", self.position), changes.pop("velocity", self.velocity)
        grains = replace(self.grains, position=position, velocity=velocity, spin=self.spin)
        arguments = {**self.effects, "dt": self.dt, "skin": self._state.skin, **changes}
        return Simulation(grains, boundary=boundary, predecessor=self, **arguments)

    @property
    def step(self):
        """Steps done."""
        return int(self._state.counters.step[0])

    @property
    def time(self):
        """Time since the beginning of this simulation in s."""
        return self.step * self.dt

    @property
    def position(self):
        """(N, 2) in m."""
        return np.stack([self._state.body.x, self._state.body.y], axis=1)

    @property
    def velocity(self):
        """(N, 2) in m/s."""
        return np.stack([self._state.body.vx, self._state.body.vy], axis=1)

    @property
    def spin(self):
        """(N,) in 1/s; unchanged from the start where no effect acts on it."""
        return self.grains.spin.copy() if self._state.spin is None else self._state.spin.copy()

    @property
    def net_force(self):
        """(N, 2) in N: the sum of all contact forces on each grain, at the end of the last step."""
        return np.stack([self._state.body.fx, self._state.body.fy], axis=1)

    @property
    def torque(self):
        """(N,) in N m; zero where no effect gives one."""
        return np.zeros(len(self.grains)) if self._state.torque is None else self._state.torque.copy()

    @property
    def walls(self):
        """State of the walls (position, velocity, force, traction: arrays) or of the periodic lattice; a live view."""
        return self._state.boundary

    @property
    def counters(self):
        """Steps, lists built, lists built late, pairs in the list: a dict of int."""
        counters = self._state.counters
        return {
            "steps": self.step,
            "builds": int(counters.builds[0]),
            "late_builds": int(counters.late[0]),
            "pairs": int(counters.pairs[0]),
        }

    def active_effects(self):
        """Two lists of names: the effects this simulation is compiled for, and those it leaves out."""
        active = {name: effect for name, effect in self.effects.items() if effect is not None}
        return [f"{name}: {effect}" for name, effect in active.items()], [name for name in self.effects if name not in active]

    def kinetic_energy(self):
        """Kinetic energy of the movable grains in J, spin included where it takes part."""
        s, free = self._state, slice(0, self._state.movable)
        energy = 0.5 * np.sum(self.grains.mass[free] * (s.body.vx[free] ** 2 + s.body.vy[free] ** 2))
        if s.spin is not None:
            energy += 0.5 * np.sum(s.spin[free] ** 2 / s.inverse_inertia[free])
        return float(energy)

    def snapshot(self):
        """The present state as a Snapshot, contacts included. Nothing of the run is changed by it."""
        pairs, force, point, overlap = contact_table(self._state)
        fixed = np.arange(len(self.grains)) >= self._state.movable
        cell, volume = self.boundary.extent(self._state.boundary)
        return Snapshot(
            self.position, self.grains.radius, self.grains.mass, self.velocity, self.spin, pairs, force, point, overlap,
            cell=cell, volume=volume, fixed=fixed, time=self.time,
        )  # fmt: skip
