"""Checkpoints: a whole Simulation in one file, from which it goes on bit for bit.

What is kept: the arguments of the constructor, from which `load` makes the same simulation without building or computing anything, and
every array of its state, which is then filled in. The pair list is kept as it is, because a new one would change the order of the sums.
Nothing here knows which arrays a state has: whatever the constructor puts there is saved and has to be there again.
"""

import json
import time
import warnings
from contextlib import contextmanager
from dataclasses import dataclass, fields
from inspect import signature
from pathlib import Path
from types import SimpleNamespace

import numba
import numpy as np
from numpy.lib.array_utils import byte_bounds

from anisogran import __version__
from anisogran.dem.records import differences, packed, unpacked
from anisogran.dem.sealed import previous_of, read_sealed, write_sealed
from anisogran.outcome import InputError, Interrupted, RunFailed, checked
from anisogran.whole_file import check_target

FORMAT = 3
VERSIONS = {"anisogran": __version__, "numba": numba.__version__, "numpy": np.__version__}
SCRATCH = "out."  # holds nothing from one step to the next
A_PAIR = ("pairs.first", "pairs.second", "pairs.reach", "memory.")  # arrays with an entry a pair, of which those in use are written
EXTRAS = ("unbalanced_force", "failure")  # attributes of a simulation beside its state and its arguments


def leaves(value, name=""):
    """(name, array or number or None) of everything in a state, whatever records it is made of."""
    if isinstance(value, SimpleNamespace):
        parts = vars(value)
    elif isinstance(value, tuple):
        parts = value._asdict() if hasattr(value, "_asdict") else dict(enumerate(value))
    else:
        yield name, value
        return
    for key, part in parts.items():
        yield from leaves(part, f"{name}.{key}" if name else str(key))


def inventory(state):
    """({name: array}, {name: number or None}) of a state; without scratch, and without arrays that only show a part of another."""
    arrays, numbers = {}, {}
    for name, leaf in leaves(state):
        if name.startswith(SCRATCH):
            continue
        if not isinstance(leaf, np.ndarray):
            numbers[name] = packed(leaf)
        elif not any(_is_part(leaf, array) for array in arrays.values()):
            arrays[name] = leaf
    return arrays, numbers


def _is_part(array, whole):
    """Whether all bytes of the array are bytes of the other one."""
    if not whole.flags.c_contiguous or not array.size:
        return False
    (begin, end), (low, high) = byte_bounds(array), byte_bounds(whole)
    return low <= begin and end <= high


def save(simulation, path, attached=None):
    """Writes the simulation; see Simulation.save."""
    arrays, numbers = inventory(simulation._state)
    pairs = simulation._state.pairs
    arrays = {name: array[: pairs.start[-1]] if name.startswith(A_PAIR) else array for name, array in arrays.items()}
    grains = {field.name: getattr(simulation.grains, field.name) for field in fields(simulation.grains) if field.init}
    columns = {name: value for name, value in grains.items() if isinstance(value, np.ndarray)}
    description = {
        "format": FORMAT,
        "versions": VERSIONS,
        "step": simulation.step,
        "arguments": {name: packed(value) for name, value in simulation.arguments().items()},
        "grains": {name: packed(value) for name, value in grains.items() if name not in columns},
        "capacity": pairs.first.size,
        "numbers": numbers,
        "extras": {name: packed(getattr(simulation, name)) for name in EXTRAS},
    }
    members = {f"state.{name}": array for name, array in arrays.items()} | {f"grains.{name}": array for name, array in columns.items()}
    description["attached"] = taken_apart(attached, members)
    write_sealed(path, json.dumps(description), members)


def taken_apart(value, members):
    """The value (arrays, numbers, text, lists, and dicts of such) in terms of JSON; its arrays go to `members` by a name of their own."""
    if isinstance(value, np.ndarray):
        name = f"attached.{len(members)}"
        members[name] = value
        return {"array": name}
    if isinstance(value, dict):
        return {"dict": {key: taken_apart(part, members) for key, part in value.items()}}
    return [taken_apart(part, members) for part in value] if isinstance(value, list) else value


def put_together(value, members):
    """The inverse of `taken_apart`."""
    if isinstance(value, dict):
        ((kind, content),) = value.items()
        if kind == "array":
            return members[content]
        return {key: put_together(part, members) for key, part in content.items()}
    return [put_together(part, members) for part in value] if isinstance(value, list) else value


@dataclass
class Stored:
    """A checkpoint that has been read: its description (a dict, as in `save`) and its arrays by name."""

    path: Path
    description: dict
    arrays: dict

    @classmethod
    def read(cls, path):
        """Raises InputError, one line naming file and reason, for anything that is no whole checkpoint of this format."""
        text, arrays = read_sealed(path)
        try:
            description = json.loads(text)
            if description["format"] != FORMAT:
                raise InputError(f"has format {description['format']!r}, and format {FORMAT} is read")
            return cls(path, description, arrays)
        except (KeyError, TypeError, ValueError, RecursionError) as error:
            raise InputError(f"{path}: is no checkpoint of a simulation that can be read: {error}") from None

    def arguments(self):
        """Arguments of the constructor as they were, Grains among them; how coarse dt may be was settled then."""
        from anisogran.dem import Grains

        columns = {name.removeprefix("grains."): array for name, array in self.arrays.items() if name.startswith("grains.")}
        grains = Grains(**columns, **{name: unpacked(value) for name, value in self.description["grains"].items()})
        others = {name: unpacked(value) for name, value in self.description["arguments"].items()}
        return {"grains": grains, "allow_coarse_dt": True, **others}

    @property
    def capacity(self):
        """Pairs that the list has room for."""
        return int(self.description["capacity"])

    def fill(self, simulation):
        """Puts the saved state into a simulation that was made from the same arguments. Raises InputError where it does not fit."""
        unlike = []
        for name, value in simulation.arguments().items():
            unlike += differences(name, packed(value), self.description["arguments"].get(name))
        if unlike:
            raise InputError(f"{self.path}: was saved with other arguments: {'; '.join(unlike)}")
        state = simulation._state
        arrays, numbers = inventory(state)
        found = {name.removeprefix("state."): array for name, array in self.arrays.items() if name.startswith("state.")}
        lost = sorted((arrays.keys() ^ found.keys()) | (numbers.keys() ^ self.description["numbers"].keys()))
        if lost:
            raise InputError(f"{self.path}: does not fit its own arguments: {', '.join(lost)} is in the one but not in the other")
        for name, array in arrays.items():
            place = array[: len(found[name])] if name.startswith(A_PAIR) else array
            if (place.shape, place.dtype) != (found[name].shape, found[name].dtype):
                raise InputError(f"{self.path}: {name} has shape {found[name].shape}, but its own arguments make {place.shape}")
            place[...] = found[name]
        for name, value in self.description["numbers"].items():
            if isinstance(value, float) and isinstance(getattr(state, name, None), float):
                setattr(state, name, value)  # it may have changed in the run
            elif value != numbers[name]:
                raise InputError(f"{self.path}: {name} = {value!r}, but its own arguments make {numbers[name]!r}")
        self._check_indices(state)
        for name in EXTRAS:
            setattr(simulation, name, self.description["extras"][name])
        simulation.attached = put_together(self.description["attached"], self.arrays)

    def _check_indices(self, state):
        """The kernels look up what these name without asking, so a forged file must not name what is not there."""
        n, pairs, walls = len(state.order), state.pairs, state.wall_list
        grains = [state.order, pairs.first, pairs.second, state.counters.deep[:2]]
        good = all(np.all((index >= 0) & (index < n)) for index in grains) and len(np.unique(state.order)) == n
        good &= bool(pairs.start[0] == 0 and np.all(np.diff(pairs.start) >= 0) and pairs.start[-1] == len(self.arrays["state.pairs.first"]))
        if walls is not None:
            good &= bool(np.all((walls.grain >= 0) & (walls.grain < n) & (walls.wall >= 0) & (walls.wall < walls.wall.size // n)))
            good &= bool(0 <= walls.size[0] <= walls.grain.size)
        if not good:
            raise InputError(f"{self.path}: its lists name grains, pairs or walls that do not exist")


def loaded(kind, path, expected):
    """A `kind` of simulation from a checkpoint, or else from the one before it; see Simulation.load."""
    reasons = []
    for file in (path, previous_of(path)):
        try:
            stored = Stored.read(file)
        except InputError as error:
            reasons.append(str(error))
            continue
        try:
            arguments = stored.arguments()
            unknown = sorted((arguments | expected).keys() - signature(kind).parameters.keys())
            if unknown:
                raise InputError(f"{file}: Simulation has no argument {', '.join(unknown)}")
            _check_grains(file, arguments["grains"], expected.get("grains", arguments["grains"]))
            simulation = kind(**{**arguments, **expected}, restored=stored)
            others = [f"{name} {version}" for name, version in stored.description["versions"].items() if VERSIONS.get(name) != version]
        except InputError:
            raise
        except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError, MemoryError, RecursionError) as error:
            raise InputError(f"{file}: is no checkpoint of a simulation ({error!r})") from error  # a forged one: its seal is good
        if others:
            warnings.warn(f"{file} was written with {', '.join(others)}: the run may not go on bit for bit", stacklevel=3)
        if reasons:
            warnings.warn(f"{reasons[0]}; going on from {file}, step {simulation.step}", stacklevel=3)
        return simulation
    raise InputError("; ".join(reasons))


def _check_grains(file, stored, asked):
    """Raises InputError naming what of the grains is not as it was."""
    if asked is stored:
        return
    names = [field.name for field in fields(stored)]
    unlike = [name for name in names if not np.array_equal(getattr(stored, name), getattr(asked, name, None))]
    if unlike:
        raise InputError(f"{file}: was saved with other grains: {', '.join(unlike)} differ")


@contextmanager
def checkpoints(simulation, path, every, on_error):
    """A run that keeps itself: within the block, the function that it gives writes a checkpoint whenever one is due.

    At the end there is one more; an interrupt is turned into Interrupted after another; a run that failed leaves its state in
    <path>.failed, where it spoils no good checkpoint. With path None nothing is done at all.
    """
    if path is None:
        yield lambda: None
        return
    every = checked("Simulation.run", "every", every, at_least=0, unit="s")
    if on_error not in ("raise", "continue"):
        raise InputError(f"Simulation.run: on_checkpoint_error = {on_error!r} must be 'raise' or 'continue'")
    path = check_target(path)
    written, saved = time.monotonic(), None

    def keep(path=path):
        """Whether the checkpoint could be written; raises instead of False unless on_error is "continue"."""
        nonlocal written, saved
        try:
            save(simulation, path)
            saved = simulation.step
        except (InputError, RunFailed) as error:
            if on_error == "raise":
                raise
            warnings.warn(f"{error}; the run goes on without this checkpoint", stacklevel=4)
            return False
        finally:
            written = time.monotonic()
        return True

    def keep_if_due():
        if time.monotonic() - written >= every:
            keep()

    try:
        yield keep_if_due
        if saved != simulation.step:
            keep()
    except KeyboardInterrupt:
        kept = f"{path} holds the state" if keep() else "its state could not be written"
        raise Interrupted(f"interrupted at step {simulation.step} (t = {simulation.time:.6g} s); {kept}") from None
    except RunFailed as error:
        if simulation.failure is None:  # not the run, but a checkpoint
            raise
        failed = Path(f"{path}.failed")
        raise RunFailed(f"{error}; {failed} holds the state" if keep(failed) else str(error)) from None
