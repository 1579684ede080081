"""A simulation of grains with exactly the effects it was given: state, steps, and snapshots for the averages."""

import time
from dataclasses import replace

import numpy as np

from anisogran.dem.boundaries import Open
from anisogran.dem.checkpoint import checkpoints, loaded, save
from anisogran.dem.contacts import contact_table
from anisogran.dem.energies import energies, kinetic_energy
from anisogran.dem.grains import Grains, driven_last
from anisogran.dem.interrupts import interrupts_deferred
from anisogran.dem.limits import CAUSES, START_OVERLAP, STARTS, check_effects, doubts, gravity_vector, longest_step
from anisogran.dem.rows import SPIN, TORQUE
from anisogran.dem.state import find_forces, inherit, make_room, new_list, new_state
from anisogran.dem.stepping import DEEP_OVERLAP, DONE, LIST_FULL, run_steps
from anisogran.outcome import InputError, RunFailed, Status, checked
from anisogran.snapshot import Snapshot


class Simulation:
    """Grains, contact effects and a boundary, ready to run.

    normal: Linear or Luding; friction: Friction between grains, or None; rolling: None (discs have no rolling resistance);
    gravity: (g_x, g_y) in m/s2, or None; boundary: Open, Box, Ring or Periodic; dt in s, default a tenth of `longest_step`, which is a
    fiftieth of the shortest contact time unless a dashpot is strong, and never more than `longest_step` unless `allow_coarse_dt`.
    wall_friction: Friction at smooth walls and rings, or None; drag: background damping in kg/s for preparation, which takes velocity, not
    spin, at the rate drag/mass, or None; `skin` in m is the reserve of the neighbour list; `ledger` asks for the book of energies, see
    `energy`. An absent effect is not compiled and holds no memory.
    Driven grains move on with the velocity and the spin they are given, unless they belong to a ring or are glued to a wall of the box.
    `predecessor` and `restored` are given by `next_stage` and `load`.
    Raises InputError before the first step for anything that cannot be simulated.
    """

    def __init__(
        self, grains, normal, friction=None, rolling=None, gravity=None, boundary=None, dt=None, *,
        wall_friction=None, drag=None, skin=None, allow_coarse_dt=False, ledger=False, predecessor=None, restored=None,
    ):  # fmt: skip
        if not isinstance(grains, Grains):
            raise InputError(f"Simulation: grains = {grains!r} must be a dem.Grains record")
        boundary = Open() if boundary is None else boundary
        check_effects(grains, normal, friction, rolling, wall_friction, boundary)
        gravity = gravity_vector(gravity)
        drag = None if drag is None else checked("Simulation", "drag", drag, above=0, unit="kg/s")
        limit = min(longest_step(normal, rubbing, drag, grains.mass) for rubbing in (friction, wall_friction))
        longest = None if allow_coarse_dt else limit
        self.dt = 0.1 * limit if dt is None else checked("Simulation", "dt", dt, above=0, at_most=longest, unit="s")
        skin = 0.2 * float(grains.radius.mean()) if skin is None else checked("Simulation", "skin", skin, above=0, unit="m")
        self.grains, self.boundary = grains, boundary
        self.effects = {
            "normal": normal, "friction": friction, "rolling": rolling, "gravity": gravity, "wall_friction": wall_friction, "drag": drag,
        }  # fmt: skip
        self.unbalanced_force = None
        self.failure = None  # the sentence with which a run has stopped
        self.attached = None  # what came with the checkpoint

        self._state = new_state(grains, self.effects, boundary, skin, ledger, None if restored is None else restored.capacity)
        self._chunk = 1  # steps in one compiled call; adapted to the speed
        if restored is not None:
            restored.fill(self)
            return
        if predecessor is not None:
            before, order = predecessor
            inherit(self._state, before._state, order)
        self._build(start=predecessor is None)
        find_forces(self._state)
        if ledger:
            self._state.energy_at_start = self.energy()["imbalance"]

    def _build(self, start):
        """The first neighbour list; at the very start of a simulation also a look for overlaps that would fly apart."""
        s = self._state
        while (code := new_list(s)) == LIST_FULL:
            make_room(s)
        if not start:
            self._raise_unless_done(code)
            return
        i = int(s.order[s.counters.grain[0]])
        deepest = float(s.counters.deepest[0])
        if code == DEEP_OVERLAP or (code == DONE and deepest > (1 + 1e-9) * START_OVERLAP):
            i, j = (int(s.order[k]) for k in s.counters.deep[:2])
            raise InputError(
                f"Simulation: grains {i} and {j} overlap by {deepest:.0%} of the smaller radius at the start, "
                f"where at most {START_OVERLAP:.0%} are allowed; dem.relaxed moves such grains apart"
            )
        if code != DONE:
            x, y = self.position[i]
            raise InputError(f"Simulation: grain {i} at ({x:.6g}, {y:.6g}) m {STARTS[code]} at the start")

    def _raise_unless_done(self, code):
        if code != DONE:
            i = int(self._state.order[self._state.counters.grain[0]])
            (x, y), (u, v) = self.position[i], self.velocity[i]
            place = f"x = ({x:.6g}, {y:.6g}) m, v = ({u:.3g}, {v:.3g}) m/s"
            self.failure = f"stopped at step {self.step} (t = {self.time:.6g} s) at grain {i}, {place}: {CAUSES[code]}"
            raise RunFailed(self.failure)

    def run(self, steps, checkpoint=None, every=10.0, on_checkpoint_error="raise", listen=None):
        """Advances by a whole number of steps. Raises RunFailed naming step, grain and likely cause, InputError for a part of a step.

        The compiled loop comes back several times a second, so that an interrupt is heard; it always finds whole steps. `listen()`, if
        given, is called each time; if it raises, the run ends there and can go on later. With
        `checkpoint`, a path, the simulation is saved there every `every` seconds of wall-clock time and at the end; an interrupt then
        raises Interrupted, after saving. If a checkpoint cannot be written, that is raised, or, with on_checkpoint_error="continue",
        warned about. No bit of the result depends on checkpoints. A run that has failed leaves its state in <checkpoint>.failed and
        cannot go on.
        """
        if checked("Simulation.run", "steps", steps, at_least=0) != int(steps):
            raise InputError(f"Simulation.run: steps = {steps} must be a whole number; dt is {self.dt:g} s")
        if self.failure is not None:
            raise RunFailed(self.failure)
        end = self.step + int(steps)
        with checkpoints(self, checkpoint, every, on_checkpoint_error) as keep_if_due:
            while self.step < end:
                with interrupts_deferred():
                    self._advance(min(self._chunk, end - self.step))
                keep_if_due()
                if listen is not None:
                    listen()

    def compile(self):
        """Compiles the time loop for the effects of this simulation, or finds it in the cache; no step is done."""
        self._advance(0)

    def _advance(self, steps):
        """One call of the compiled loop; what it says is heeded."""
        s = self._state
        begin, clock = self.step, time.perf_counter()
        code = run_steps(
            s.body, s.spin, s.pairs, s.wall_list, s.memory, s.wall_memory, s.normal, s.friction, s.wall_friction, s.gravity, s.drag,
            s.boundary, s.movable, s.skin, s.reach, s.step_limit, s.ledger, s.out, s.counters, self.dt, steps,
        )  # fmt: skip
        if code == LIST_FULL:
            make_room(s)
            return
        self._raise_unless_done(code)
        seconds = time.perf_counter() - clock
        # a third of the half second in which an interrupt is heard and the state saved: the next steps may be slower
        self._chunk = max(1, min(2 * self._chunk, int((self.step - begin) * 0.15 / seconds)))

    def save(self, path, attached=None):
        """Writes a checkpoint, a .npz file from which `load` goes on bit for bit; an older one is kept as <path>.previous.

        `attached`: what else belongs to the run, as arrays, numbers, text, lists, and dicts of such; `load` gives it back as `attached`.
        Whenever the process is stopped, the new or the old file is whole. Raises InputError if no file can be made there, RunFailed if
        the machine does not take it; then the old file is untouched.
        """
        save(self, path, attached)

    @classmethod
    def load(cls, path, **expected):
        """The simulation of a checkpoint; if that is missing or damaged, of <path>.previous, with a warning that says so.

        `expected`: arguments of the constructor, as `friction=...`; raises InputError listing those that are not as in the file.
        Raises InputError, one line naming file and reason, if there is no whole checkpoint.
        """
        return loaded(cls, path, expected)

    def arguments(self):
        """The arguments of the constructor that make a simulation like this one, beside its grains; a dict."""
        s = self._state
        return {**self.effects, "boundary": self.boundary, "dt": self.dt, "skin": s.skin, "ledger": s.ledger is not None}

    def next_stage(self, boundary, **changes):
        """A new simulation of the grains as they are now, with some of the arguments of this one changed; its time begins at 0.

        The boundary is always given, with its walls where they are now. Contact memory (largest overlap, tangential spring) is kept
        where both stages have the effect. `position` and `velocity` may be given anew. With `driven`, (N,) bool or a list of such, one
        for each wall of a box in their order, these grains belong to walls from now on: they become the last ones, and the Box says
        how many are glued to each wall; the other grains keep their order. How far this stage is from equilibrium (mean net force by
        mean contact force) is kept as `unbalanced_force` of the new one. Raises InputError for a grain that is to ride on two walls.
        """
        position, velocity = changes.pop("position", self.position), changes.pop("velocity", self.velocity)
        grains = replace(self.grains, position=position, velocity=velocity, spin=self.spin)
        order = None
        if "driven" in changes:
            order, driven = driven_last(len(grains), changes.pop("driven"))
            rows = {name: getattr(grains, name)[order] for name in ("position", "radius", "mass", "velocity", "spin")}
            grains = replace(grains, driven=driven, **rows)
        arguments = {**self.arguments(), "boundary": boundary, "allow_coarse_dt": "dt" not in changes, **changes}
        stage = Simulation(grains, predecessor=(self, order), **arguments)
        stage.unbalanced_force = self.force_imbalance()
        return stage

    def force_imbalance(self):
        """Mean net force on a movable grain by the mean contact force; None without forces."""
        contact = np.hypot(*contact_table(self._state)[1].T)
        net = np.hypot(*self.net_force[: self._state.movable].T)
        return float(net.mean() / contact.mean()) if contact.size and contact.any() and net.size else None

    def _by_grain(self, values):
        """Values (N, ...) of the state, in the order of the user's grains."""
        sorted_out = np.empty_like(values)
        sorted_out[self._state.order] = values
        return sorted_out

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
        return self._by_grain(self._state.body.rows[:, :2])

    @property
    def velocity(self):
        """(N, 2) in m/s."""
        return self._by_grain(self._state.body.rows[:, 2:4])

    @property
    def spin(self):
        """(N,) in 1/s; unchanged from the start where no effect acts on it."""
        return self._by_grain(self._state.body.rows[:, SPIN])

    @property
    def net_force(self):
        """(N, 2) in N: the sum of all contact forces on each grain, at the end of the last step."""
        return self._by_grain(self._state.body.forces[:, :2])

    @property
    def torque(self):
        """(N,) in N m; zero where no effect gives one."""
        return self._by_grain(self._state.body.forces[:, TORQUE])

    @property
    def walls(self):
        """State of the walls (position, velocity, force, traction: arrays) or of the periodic lattice; a live view."""
        return self._state.boundary

    @property
    def counters(self):
        """What happened so far: steps, lists built, lists built late, pairs in the list, and extremes; a dict.

        deep_pairs: most pairs at one time that overlap by more than 5 % of the smaller radius, looked for every 30 steps;
        deepest_overlap (share of the smaller radius) and deepest_pair: the worst of them; longest_way: of a grain in one step, in m.
        """
        s = self._state
        counters = s.counters
        return {
            "steps": self.step,
            "builds": int(counters.builds[0]),
            "late_builds": int(counters.late[0]),
            "pairs": int(counters.pairs[0]),
            "deep_pairs": int(counters.deep[2]),
            "deepest_overlap": float(counters.deepest[0]),
            "deepest_pair": tuple(int(s.order[k]) for k in counters.deep[:2]),
            "longest_way": float(counters.travel[2]),
        }

    @property
    def status(self):
        """The Status: failed after a run that had to stop; warned, with reasons, where the results are to be read with care."""
        status = Status() if self.failure is None else Status().fail(self.failure)
        for reason in doubts(self):
            status = status.warn(reason)
        return status

    def bytes_per_grain(self):
        """Memory of the state in bytes a grain: rows, forces, pair list, contact memory."""
        s = self._state
        arrays = [s.order, s.body.rows, s.body.forces, s.body.built, *s.pairs, *s.memory, *s.wall_memory]
        return sum(array.nbytes for array in [*arrays, *(s.wall_list or ())] if array is not None) / len(self.grains)

    def active_effects(self):
        """Two lists of names: the effects this simulation is compiled for, and those it leaves out."""
        active = {name: effect for name, effect in self.effects.items() if effect is not None}
        return [f"{name}: {effect}" for name, effect in active.items()], [name for name in self.effects if name not in active]

    def energy(self):
        """Energies in J, a dict: kinetic, elastic (what all contacts can give back) and, under gravity, potential.

        With `ledger=True` also what has gone since the start: dissipated_dashpot, _friction, _plasticity and _drag, the boundary_work that
        walls, driven grains and the periodic lattice have done on the free grains, and the `imbalance` of the whole book, which is 0 but
        for the error of the time step.
        """
        return energies(self._state)

    def kinetic_energy(self, rotation=True):
        """Kinetic energy of the movable grains in J, with `rotation` that of the spins too, where they take part."""
        return kinetic_energy(self._state, rotation)

    def coordination_number(self):
        """Mean number of contacts of a movable grain, those with walls and driven grains included; 0 without contacts."""
        pairs = contact_table(self._state)[0]
        return float(np.count_nonzero((pairs >= 0) & (pairs < self._state.movable)) / max(self._state.movable, 1))

    def snapshot(self):
        """The present state as a Snapshot, contacts included. Nothing of the run is changed by it."""
        pairs, force, point, overlap = contact_table(self._state)
        fixed = np.arange(len(self.grains)) >= self._state.movable
        return Snapshot(
            self.position, self.grains.radius, self.grains.mass, self.velocity, self.spin, pairs, force, point, overlap,
            fixed=fixed, time=self.time, **self.boundary.extent(self._state.boundary),
        )  # fmt: skip
