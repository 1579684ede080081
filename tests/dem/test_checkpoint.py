"""Checkpoints: a run goes on bit for bit from its file, and no damage, kill, full disk or edited scene passes unnoticed."""

import errno
import hashlib
import io
import os
import re
import signal
import subprocess
import sys
import warnings
import zipfile
from collections import namedtuple
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from crowds import FRICTION, LAW, crowd
from test_simulation import BOUNDARIES

from anisogran import whole_file
from anisogran.dem import Box, Grains, Linear, Simulation, checkpoint
from anisogran.dem.checkpoint import FORMAT, inventory
from anisogran.dem.interrupts import interrupts_deferred
from anisogran.dem.sealed import previous_of, write_sealed
from anisogran.outcome import InputError, Interrupted, RunFailed


def scene(rng, name="box", count=60):
    """A Simulation of loose grains with every effect that the other tests of the time loop have compiled."""
    grains, side = crowd(rng, count=count, origin=0.5 if name == "ring" else 0.0)
    wall_friction = FRICTION if name == "ring" else None
    return Simulation(grains, LAW, friction=FRICTION, boundary=BOUNDARIES[name](side), wall_friction=wall_friction)


def held(sim):
    """The bytes of every array of the state that a checkpoint keeps whole, and of the lists what is in use."""
    arrays, numbers = inventory(sim._state)
    used = sim._state.pairs.start[-1]
    return {name: (a[:used] if name.startswith(checkpoint.A_PAIR) else a).tobytes() for name, a in arrays.items()} | numbers


def python(code, *arguments, **options):
    """Another Python process at work."""
    return subprocess.Popen([sys.executable, "-c", code, *map(str, arguments)], stdout=subprocess.PIPE, text=True, **options)


def forged(members, packing=zipfile.ZIP_STORED):
    """The bytes of an .npz of these members (name: bytes or array), with a good seal, as the format says it has to be."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", packing) as archive:
        for name, value in members.items():
            file = io.BytesIO()
            np.save(file, value, allow_pickle=True)
            archive.writestr(f"{name}.npy", file.getvalue())
        archive.comment = b"0" * 64
    content = stream.getvalue()
    return content[:-64] + hashlib.sha256(content).hexdigest().encode()


@pytest.mark.parametrize("name", BOUNDARIES)
def test_a_run_saved_at_any_step_is_the_straight_run(name, rng, tmp_path):
    """Saved and loaded at random steps, the last part in a new process: at the end the files of both are equal byte for byte."""
    sim = scene(rng, name)
    straight = scene(np.random.default_rng(20050603), name)
    straight.run(3000)
    straight.save(tmp_path / "straight.npz")
    assert straight.counters["builds"] > 5
    splits = np.sort(rng.choice(3000, 4, replace=False))
    for steps in np.diff([0, *splits]):
        sim.run(int(steps))
        sim.save(tmp_path / "pieces.npz")
        loaded = Simulation.load(tmp_path / "pieces.npz")
        assert held(loaded) == held(sim)
        assert (loaded.step, loaded.counters, loaded.status) == (sim.step, sim.counters, sim.status)
        sim = loaded
    code = """
import sys
from anisogran.dem import Simulation
sim = Simulation.load(sys.argv[1])
sim.run(3000 - sim.step)
sim.save(sys.argv[1])
"""
    python(code, tmp_path / "pieces.npz").communicate()
    assert (tmp_path / "pieces.npz").read_bytes() == (tmp_path / "straight.npz").read_bytes()


def test_a_loaded_simulation_is_a_whole_one(rng, tmp_path):
    """Columns and spins are views of the rows, which lie on cache lines; grains, snapshot and next stage are what they were."""
    sim = scene(rng)
    sim.run(500)
    sim = sim.next_stage(replace(sim.boundary, width=float(sim.walls.position[1]), height=float(sim.walls.position[3])))
    sim.run(10)
    sim.unbalanced_force = 0.125
    sim.save(tmp_path / "a.npz")
    loaded = Simulation.load(tmp_path / "a.npz")
    state = loaded._state
    assert state.body.rows.ctypes.data % 64 == 0
    loaded._state.body.rows[3] = np.arange(8.0)
    assert (state.body.x[3], state.body.vy[3], state.body.radius[3], state.spin[3]) == (0.0, 3.0, 4.0, 5.0)
    loaded = Simulation.load(tmp_path / "a.npz")
    assert loaded.unbalanced_force == 0.125
    assert loaded.arguments() == sim.arguments()
    for name in ("position", "radius", "mass", "velocity", "spin"):
        np.testing.assert_array_equal(getattr(loaded.grains, name), getattr(sim.grains, name))
    for name in ("position", "force", "point", "pairs"):
        np.testing.assert_array_equal(getattr(loaded.snapshot(), name), getattr(sim.snapshot(), name))
    stages = [each.next_stage(each.boundary) for each in (sim, loaded)]
    assert held(stages[0]) == held(stages[1])


def test_a_full_list_is_saved_as_full(rng, tmp_path, monkeypatch):
    """An interrupt may come just after the list was found too short: the room is made after loading."""
    sim, same = scene(rng), scene(np.random.default_rng(20050603))
    for each in (sim, same):
        s = each._state
        room = -(-int(s.pairs.start[-1]) // 8) * 8  # no more than is in use
        s.pairs = s.pairs._replace(**{name: getattr(s.pairs, name)[:room].copy() for name in ("first", "second", "reach")})
        s.memory = s.memory._replace(largest=s.memory.largest[:room].copy(), spring=s.memory.spring[:room].copy())
    with monkeypatch.context() as patch:
        patch.setattr("anisogran.dem.simulation.make_room", lambda state: None)
        while sim._state.counters.pairs[0] <= room:
            sim._advance(1)
    same.run(sim.step + 1000)
    sim.save(tmp_path / "a.npz")
    loaded = Simulation.load(tmp_path / "a.npz")
    loaded.run(1000)
    assert held(loaded) == held(same)


def test_the_list_is_judged_by_whole_steps(rng):
    """When it is due must not depend on where the compiled calls end, which is a matter of the clock; nor may the longest way."""
    pieces, straight = scene(rng, "periodic"), scene(np.random.default_rng(20050603), "periodic")
    for _ in range(1000):
        pieces.run(1)
    straight._chunk = 1000
    straight.run(1000)
    assert straight.counters["builds"] > 1
    assert held(pieces) == held(straight)


@pytest.mark.hard_case("F7")
def test_checkpoints_change_nothing(rng, tmp_path):
    """A run that saves itself after every compiled call has the bits of one that never does."""
    quiet, kept = scene(rng), scene(np.random.default_rng(20050603))
    quiet.run(2000)
    kept.run(2000, checkpoint=tmp_path / "a.npz", every=0.0)
    assert held(quiet) == held(kept) == held(Simulation.load(tmp_path / "a.npz"))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.npz", "a.npz.previous"]
    assert Simulation.load(previous_of(tmp_path / "a.npz")).step < 2000
    with np.load(tmp_path / "a.npz", allow_pickle=False) as file:  # anybody can read it
        np.testing.assert_array_equal(file["state.body.rows"], quiet._state.body.rows)


@pytest.mark.hard_case("F3")
def test_no_damage_goes_unnoticed(rng, damages, tmp_path, answer):
    """300 random flips, cuts and zeroed blocks: never does a damaged file load, and the one before it, if any, is used with a warning."""
    sim = scene(rng, count=8)
    path = tmp_path / "a.npz"
    sim.save(path)
    sim._state.body.rows[0, 0] += 1e-9
    before = held(sim)
    sim.save(path)
    good, older = path.read_bytes(), path.read_bytes()
    for trial, damaged in enumerate(damages(good, 300)):
        path.write_bytes(damaged)
        if trial % 2:
            previous_of(path).write_bytes(older)
            with pytest.warns(UserWarning, match=re.escape(f"{path}: ") + ".*; going on from .*a.npz.previous, step 0$"):
                assert held(Simulation.load(path)) == before
        else:
            previous_of(path).unlink(missing_ok=True)
            with pytest.raises(InputError, match=re.escape(f"{path}: ") + r"[^\n]*; [^\n]*a.npz.previous: cannot be read [^\n]*$"):
                Simulation.load(path)
    answer.named("300 of 300 damaged checkpoints found; the one before is taken, and said so")


@pytest.mark.hard_case("F1")
def test_a_run_killed_again_and_again_is_the_straight_run(rng, tmp_path):
    """Six processes, each killed at a random moment of running and saving; each goes on from the file of the one before."""
    path = tmp_path / "a.npz"
    sim, straight = scene(rng), scene(np.random.default_rng(20050603))
    sim.save(path)
    code = """
import sys
from anisogran.dem import Simulation
sim = Simulation.load(sys.argv[1])
sim.run(1)
print("at work", flush=True)
sim.run(10**9, checkpoint=sys.argv[1], every=0.0)
"""
    steps = [0]
    for _ in range(6):
        child = python(code, path)
        assert child.stdout.readline() == "at work\n"
        with pytest.raises(subprocess.TimeoutExpired):
            child.wait(rng.uniform(0.05, 0.2))
        child.kill()
        child.communicate()
        sim = Simulation.load(path)
        steps.append(sim.step)
    assert np.all(np.diff(steps) >= 0)
    assert steps[-1] > 100
    sim.run(500)
    straight.run(sim.step)
    assert held(sim) == held(straight)


@pytest.mark.hard_case("F2")
def test_a_file_that_grows_too_large_stops_the_run_or_is_warned_about(rng, tmp_path, answer):
    """Under a limit of the file size (EFBIG) the old checkpoint stays, no temporary file is left, and nobody is in doubt."""
    path = tmp_path / "a.npz"
    scene(rng).save(path)
    code = """
import os, resource, sys, warnings
from anisogran.dem import Simulation
from anisogran.outcome import RunFailed
sim = Simulation.load(sys.argv[1])
sim.run(5)
resource.setrlimit(resource.RLIMIT_FSIZE, (os.path.getsize(sys.argv[1]) // 2,) * 2)
try:
    sim.run(5, checkpoint=sys.argv[1])
except RunFailed as error:
    print(error, sim.step, sim.failure)
with warnings.catch_warnings(record=True) as caught:
    sim.run(5, checkpoint=sys.argv[1], on_checkpoint_error="continue")
print(*(warning.message for warning in caught), sim.step)
"""
    before = path.read_bytes()
    out, _ = python(code, path).communicate()
    reason = f"{path}: cannot be written ({os.strerror(errno.EFBIG)})"
    assert out.splitlines() == [f"{reason} 10 None", f"{reason}; the run goes on without this checkpoint 15"]
    answer.named(f"run failed: {reason}")
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.hard_case("F2")
def test_a_full_disk_leaves_the_old_checkpoint(rng, tmp_path, monkeypatch, answer):
    """The temporary file is led to /dev/full, where every write ends in ENOSPC."""
    path = tmp_path / "a.npz"
    sim = scene(rng)
    sim.save(path)
    before = path.read_bytes()
    monkeypatch.setattr(whole_file, "open", lambda path, mode: open("/dev/full", "wb"), raising=False)  # noqa: SIM115
    with pytest.raises(RunFailed, match=re.escape(f"{path}: cannot be written ({os.strerror(errno.ENOSPC)})")) as caught:
        sim.save(path)
    answer.named(f"run failed: {caught.value}; the old file stays")
    monkeypatch.undo()
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.hard_case("F8")
def test_a_place_where_no_file_can_be_is_named_before_the_first_step(rng, tmp_path, answer):
    (tmp_path / "file").touch()
    sim = scene(rng)
    for path, reason in [
        (tmp_path / "nowhere" / "a.npz", "its folder does not exist"),
        (tmp_path / "file" / "a.npz", "its folder does not exist"),
        (tmp_path, "it is a folder"),
        ("/dev/null", "it is no regular file"),
    ]:
        for act in (sim.save, lambda path: sim.run(10, checkpoint=path)):
            with pytest.raises(InputError, match=re.escape(f"{path}: cannot be written ({reason})")) as caught:
                act(path)
    answer.refused(caught)
    for arguments, message in [
        ({"checkpoint": 3}, "3 is no path"),
        ({"every": -1.0}, "every = -1 must be at least 0 s"),
        ({"on_checkpoint_error": "ignore"}, "on_checkpoint_error = 'ignore' must be 'raise' or 'continue'"),
    ]:
        with pytest.raises(InputError, match=message):
            sim.run(10, **{"checkpoint": tmp_path / "a.npz", **arguments})
    assert sim.step == 0


def interrupt_after(seconds):
    """Sends SIGINT to this process from outside, also while it is in compiled code."""
    return subprocess.Popen(["sh", "-c", f"sleep {seconds}; kill -INT {os.getpid()}"])


def test_an_interrupt_is_kept_and_the_run_goes_on_from_there(rng, tmp_path):
    """Ctrl-C leaves whole steps, with a checkpoint, which it then names, and without; the run is still the straight one."""
    path = tmp_path / "a.npz"
    sim = scene(rng)
    sim.run(10)
    for seconds in (0.1, 0.23):
        with interrupt_after(seconds), pytest.raises(KeyboardInterrupt):
            sim.run(10**9)
        with interrupt_after(seconds), pytest.raises(Interrupted, match=rf"interrupted at step \d+ .*; {path} holds the state"):
            sim.run(10**9, checkpoint=path)
        assert held(Simulation.load(path)) == held(sim)
    assert sim.step > 1000
    straight = scene(np.random.default_rng(20050603))
    straight.run(sim.step)
    assert held(sim) == held(straight)


def test_an_interrupt_waits_for_the_end_of_a_step():
    done = []
    with pytest.raises(KeyboardInterrupt), interrupts_deferred():  # noqa: PT012
        signal.raise_signal(signal.SIGINT)
        done.append("step")
    assert done == ["step"]
    with pytest.raises(RunFailed), interrupts_deferred():  # noqa: PT012
        signal.raise_signal(signal.SIGINT)
        raise RunFailed("the failure is what has to be heard")
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_a_failed_run_is_marked_kept_apart_and_goes_no_further(tmp_path):
    grains = Grains([[0.0, 0.0], [0.95, 0.0]], [0.5, 0.5], mass=[1.0, 1.0], velocity=[[300.0, 0.0], [-300.0, 0.0]])
    sim = Simulation(grains, Linear(1e3))
    path = tmp_path / "a.npz"
    sim.save(path)
    before = path.read_bytes()
    with pytest.raises(RunFailed, match=rf"moves more than half the smallest radius.*; {path}\.failed holds the state"):
        sim.run(1000, checkpoint=path)
    assert path.read_bytes() == before
    failed = Simulation.load(f"{path}.failed")
    assert held(failed) == held(sim)
    for each in (sim, failed):
        assert each.status.level == "failed"
        assert each.status.reasons[0].startswith("stopped at step ")
        step = each.step
        with pytest.raises(RunFailed, match="stopped at step"):
            each.run(10)
        assert each.step == step
    assert Simulation.load(path).failure is None


@pytest.mark.hard_case("F5")
def test_an_edited_scene_is_refused_by_its_keys(rng, tmp_path, answer):
    """All that is asked for must be in the file; what is asked for in other words (a default, a list, a whole number) is the same."""
    grains, side = crowd(rng, count=10)
    sim = Simulation(grains, LAW, FRICTION, gravity=(0, -10), boundary=Box(side, side), dt=1e-7)
    path = tmp_path / "a.npz"
    sim.save(path)
    same = {"grains": grains, "normal": LAW, "friction": FRICTION, "gravity": [0, -10.0], "boundary": Box(side, side), "dt": 1e-7}
    assert held(Simulation.load(path, **same, drag=None, skin=None)) == held(sim)
    for change, message in [
        ({"friction": replace(FRICTION, mu=0.4)}, "friction.mu = 0.4, in the file 0.5"),
        ({"normal": Linear(1e5)}, r"normal = Linear\(stiffness=100000.0, damping=0.0\), in the file Luding\(k1=50000.0, .*\)"),
        ({"drag": 1.0, "dt": 2e-7}, "drag = 1.0, in the file None; dt = 2e-07, in the file 1e-07"),
        ({"dt": None}, "dt = .*, in the file 1e-07"),
        ({"gravity": None}, r"gravity = None, in the file \(0.0, -10.0\)"),
        ({"boundary": None}, r"boundary = Open\(\), in the file Box"),
        ({"boundary": Box(side, 2 * side)}, "boundary.height = "),
        ({"grains": replace(grains, mass=2 * grains.mass)}, "was saved with other grains: mass differ"),
        ({"colour": "red"}, "Simulation has no argument colour"),
    ]:
        with pytest.raises(InputError, match=f"^{path}: [^\n]*{message}[^\n]*$") as caught:
            Simulation.load(path, **change)
        answer.refused(caught)


class Mine:
    """What unpickling would call."""

    def __reduce__(self):
        return (Path("/nowhere/harm").touch, ())


@pytest.mark.hard_case("S1", "S4")
def test_a_hostile_file_is_refused(rng, tmp_path, answer):
    """Sealed as the format says, but: objects to unpickle, a bomb, lists that name what is not there, text that is none."""
    sim = scene(rng, "periodic", count=20)
    path = tmp_path / "a.npz"
    sim.save(path)
    with np.load(path, allow_pickle=False) as file:
        good = dict(file)
    text = str(good["text"].item())
    path.write_bytes(forged(good))
    assert held(Simulation.load(path)) == held(sim)
    for name, array, packing, message in [
        ("state.order", np.array([Mine()], dtype=object), zipfile.ZIP_STORED, "an array of Python objects"),
        ("state.bomb", np.zeros(10**6), zipfile.ZIP_DEFLATED, r"would unpack to \d+ bytes, more than its own \d+"),
    ]:
        path.write_bytes(forged({**good, name: array}, packing))
        with pytest.raises(InputError, match=rf"^{path}: .*{message}[^\n]*$") as caught:
            Simulation.load(path)
        answer.refused(caught)
    for change, message in [
        ({"state.pairs.second": good["state.pairs.second"] + np.uint32(20)}, "name grains, pairs or walls that do not exist"),
        ({"state.order": 0 * good["state.order"]}, "name grains, pairs or walls that do not exist"),
        ({"state.pairs.start": good["state.pairs.start"] + 8}, "name grains, pairs or walls that do not exist"),
        ({"state.body.rows": good["state.body.rows"][:5]}, r"body.rows has shape \(5, 8\), but its own arguments make \(20, 8\)"),
        ({"state.body.rows": good["state.body.rows"].astype(np.float32)}, "body.rows has shape"),
        ({"state.more": np.zeros(2)}, "does not fit its own arguments: more is in the one but not in the other"),
        ({"text": text.replace('"movable": 20', '"movable": 9000')}, "movable = 9000, but its own arguments make 20"),
        ({"text": text.replace(f'"format": {FORMAT}', '"format": 1')}, f"has format 1, and format {FORMAT} is read"),
        ({"text": text.replace('"Luding"', '"Simulation"')}, "there is no record dem.Simulation"),
        ({"text": text.replace('"Luding"', '"Friction"')}, "is no checkpoint of a simulation"),
        ({"text": text.replace('"k1": 50000.0', '"k1": -1.0')}, "k1 = -1 must be above 0"),
        ({"text": text.replace('"drag": null', '"slide": null')}, "Simulation has no argument slide"),
        ({"text": text.replace('"capacity"', '"space"')}, "is no checkpoint of a simulation"),
        ({"text": text[:-5]}, "is no checkpoint of a simulation"),
        ({"text": np.arange(3)}, "is no checkpoint"),
        ({"text": "[" * 100_000}, "is no checkpoint of a simulation"),
    ]:
        members = {**good, **{name: np.array(value) for name, value in change.items()}}
        write_sealed(path, members["text"], {name: array for name, array in members.items() if name != "text"})
        previous_of(path).unlink(missing_ok=True)
        with pytest.raises(InputError, match=rf"{message}[^\n]*$"):
            Simulation.load(path)


@pytest.mark.hard_case("F3")
def test_a_file_of_another_kind_is_refused(tmp_path, answer):
    np.savez(tmp_path / "foreign.npz", position=np.zeros((3, 2)))
    (tmp_path / "empty").touch()
    (tmp_path / "text").write_text("0" * 1000)
    for name, message in [
        ("foreign.npz", "has no seal at its end"),
        ("empty", "is empty"),
        ("text", "is damaged"),
        ("missing", "cannot be read"),
        (".", "is a folder"),
    ]:
        with pytest.raises(InputError, match=message) as caught:
            Simulation.load(tmp_path / name)
        assert "\n" not in str(caught.value)
        answer.refused(caught)


@pytest.mark.hard_case("F3")
def test_other_versions_are_named(rng, tmp_path, monkeypatch, answer):
    sim = scene(rng, count=10)
    monkeypatch.setitem(checkpoint.VERSIONS, "numba", "0.1")
    sim.save(tmp_path / "a.npz")
    monkeypatch.undo()
    with pytest.warns(UserWarning, match=r"a.npz was written with numba 0.1: the run may not go on bit for bit") as caught:
        Simulation.load(tmp_path / "a.npz")
    answer.named(f"warned: {caught[0].message}")


def test_a_state_is_kept_whatever_it_is_made_of():
    """Arrays, numbers and None in records of records; an array that shows a part of another one is kept once."""
    Ledger = namedtuple("Ledger", "sums work inner")
    matrix = np.arange(12.0).reshape(3, 4)
    state = SimpleNamespace(
        matrix=matrix, column=matrix[:, 1], ledger=Ledger(np.zeros(2), 0.5, Ledger(None, np.int64(3), np.ones(1))), out=Ledger(1, 2, 3)
    )
    arrays, numbers = inventory(state)
    assert list(arrays) == ["matrix", "ledger.sums", "ledger.inner.inner"]
    assert numbers == {"ledger.work": 0.5, "ledger.inner.sums": None, "ledger.inner.work": 3}
    apart = SimpleNamespace(odd=matrix[:, ::2], even=matrix[:, 1])  # interleaved: none is a part of the other
    assert list(inventory(apart)[0]) == ["odd", "even"]
    with pytest.raises(InputError, match=r"is neither a record of anisogran\.dem nor a number"):
        inventory(SimpleNamespace(strange=object()))


def test_a_float_of_the_state_goes_on_and_a_new_array_is_missed(rng, tmp_path):
    sim = scene(rng, count=10)
    sim._state.skin *= 0.5  # stands for a sum that a run keeps as a float
    sim.save(tmp_path / "a.npz")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert Simulation.load(tmp_path / "a.npz")._state.skin == sim._state.skin
    richer = Simulation(sim.grains, LAW, FRICTION, boundary=sim.boundary)
    richer._state.more = np.zeros(3)  # as a later version of the constructor might make it
    richer.save(tmp_path / "b.npz")
    with pytest.raises(InputError, match="does not fit its own arguments: more is in the one but not in the other"):
        Simulation.load(tmp_path / "b.npz")


def test_what_is_attached_comes_back_as_it_was(rng, tmp_path):
    """Arrays wherever they are, bit for bit; without any, nothing."""
    simulation = scene(rng)
    attached = {
        "a": [np.arange(3), {"b": np.array([[0.1, -0.0], [np.nan, np.inf]])}],
        "none": None,
        "empty": {},
        "text": "\u00fc",
        "list": [],
    }
    simulation.save(tmp_path / "one", attached)
    found = Simulation.load(tmp_path / "one").attached
    assert found.keys() == attached.keys()
    assert (found["none"], found["empty"], found["text"], found["list"]) == (None, {}, "\u00fc", [])
    np.testing.assert_array_equal(found["a"][0], [0, 1, 2])
    assert found["a"][1]["b"].tobytes() == attached["a"][1]["b"].tobytes()
    simulation.save(tmp_path / "two")
    assert Simulation.load(tmp_path / "two").attached is None
