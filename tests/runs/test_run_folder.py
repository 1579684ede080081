"""A run in a folder: killed, interrupted, damaged, short of disk or memory, it goes on bit for bit or says in one line why not."""

import errno
import json
import os
import re
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
import xarray as xr

from anisogran import (
    Biaxial,
    CohesiveGas,
    Friction,
    InputError,
    RingShear,
    RingShearVolume,
    SimpleShear,
    Tablet,
    average,
    read_scene,
)
from anisogran import open as open_results
from anisogran.dem import Simulation
from anisogran.outcome import Interrupted, RunFailed
from anisogran.runs import estimates
from anisogran.runs import folder as run_folder
from anisogran.runs.estimates import check_memory, estimate
from anisogran.runs.folder import run_in_folder, state_of
from anisogran.runs.lock import is_locked, locked
from anisogran.runs.session import Session

SCENES = {
    "biaxial": Biaxial(n=40, friction=Friction(2e4, 0.5), strain=0.02, duration=0.002, samples=20, seed=3),
    "ring_shear": RingShear(n=150, inner_radius=3.0, travel=2.0, discard=0.5, block=0.5, seed=3, frames=3),
    "ring_shear_volume": RingShearVolume(
        n=150, large=25, inner_radius=0.03, outer_radius=0.07, wall_speed=1.0, travel=2.0, discard=0.5, block=0.5, seed=3, frames=3
    ),
    "cohesive_gas": CohesiveGas(n=40, duration=0.01, samples=20, frames=3, seed=3),
    "simple_shear": SimpleShear(inertial_number=0.2, n=60, strain=0.6, discard=0.1, seed=3, frames=3),
    "tablet": Tablet(test="tension", n=40, pressure=20.0, strain=0.005, duration=0.002, samples=20, seed=3),
}
SHEAR = SCENES["simple_shear"]  # Stiffness takes longer, and has its own tests
WHOLE = ["checkpoint.npz", "results.h5", "scene.toml", "state.json"]  # what a run that is finished leaves
TIMES = ("seconds", "saving_seconds", "particle_steps_per_s")  # of the provenance: the only values that a clock has a say in


@pytest.fixture(scope="module")
def straight():
    """The runs that nothing disturbs, by name of the scene."""
    return {name: scene.run() for name, scene in SCENES.items()}


def assert_same(run, other):
    """Bit for bit, but for the time it took."""
    for name, dataset in other.datasets().items():
        xr.testing.assert_identical(run.datasets()[name].assign_attrs(dict.fromkeys(TIMES)), dataset.assign_attrs(dict.fromkeys(TIMES)))
    assert run.datasets().keys() == other.datasets().keys()


def contents(folder):
    return sorted(path.name for path in folder.iterdir())


class Leave:
    """A listener that leaves the run, as a signal would, at the n-th time it is called; `before` is done first."""

    def __init__(self, n, before=lambda session: None):
        self.n, self.before = n, before

    def __call__(self, session):
        self.n -= 1
        if self.n == 0:
            self.before(session)
            raise KeyboardInterrupt


@pytest.mark.hard_case("D23", "F1")
@pytest.mark.parametrize("name", SCENES)
def test_a_run_left_anywhere_goes_on_bit_for_bit(name, straight, tmp_path, answer):
    """Left again and again, after ever more calls of the listener, through all stages: the result is that of the straight run."""
    scene, stages = SCENES[name], set()
    for n in range(1, 1000):
        try:
            run = run_in_folder(scene, tmp_path, resume=True, listen=Leave(1 + n * n // (4 * len(scene.stages()))))
        except Interrupted as error:
            assert re.fullmatch(rf"interrupted in stage \w+, \d+% done; {tmp_path} holds the run", str(error))  # noqa: PT017
            state = state_of(tmp_path)
            assert state["state"] == "interrupted"
            stages.add(state["stage"])
        else:
            break
    assert stages >= {stage.name for stage in scene.stages()}
    assert_same(run, straight[name])
    assert state_of(tmp_path)["state"] == "finished"
    assert contents(tmp_path) == WHOLE
    for group, dataset in straight[name].datasets().items():
        stored = open_results(tmp_path / "results.h5")[group or "/"].to_dataset(inherit=False)
        assert stored.sizes == dataset.sizes
        for variable in dataset.variables:
            np.testing.assert_array_equal(stored[variable], dataset[variable])
    again = run_in_folder(scene, tmp_path, resume=True, listen=lambda session: pytest.fail("it was finished"))
    assert_same(again, straight[name])
    answer.named(f"left {n - 1} times, in every stage, and resumed: bit for bit")


KILLS = """
import os, random, shutil, signal, sys, time
import numpy as np
sys.path.insert(0, sys.argv[1])
from pathlib import Path
from test_run_folder import SCENES, assert_same
from anisogran.runs.folder import run_in_folder, state_of

scene, folder, kills = SCENES["ring_shear"], Path(sys.argv[2]), int(sys.argv[3])
moments = random.Random(20050603)
clock = time.perf_counter()
straight = scene.run()
clock = time.perf_counter()
scene.run()  # compiled by now
longest = 1.5 * (time.perf_counter() - clock)
finished, states = 0, set()
while kills:
    if state_of(folder)["state"] == "finished":
        assert_same(run_in_folder(scene, folder, resume=True), straight)
        finished += 1
        shutil.rmtree(folder)
    child = os.fork()
    if child == 0:
        run_in_folder(scene, folder, resume=True, every=0.0)
        os._exit(0)
    time.sleep(moments.uniform(0.0, longest))
    os.kill(child, signal.SIGKILL)
    killed = os.waitpid(child, 0)[1] == signal.SIGKILL
    kills -= killed
    if killed:
        states.add(state_of(folder)["state"])
assert_same(run_in_folder(scene, folder, resume=True), straight)
print(finished + 1, *sorted(states))
"""


@pytest.mark.hard_case("F1")
def test_fifty_kills_at_random_moments(tmp_path):
    """SIGKILL while it runs and while it saves, which it does all the time here: every run resumes and is the straight one."""
    command = [sys.executable, "-c", KILLS, os.path.dirname(__file__), str(tmp_path / "run"), "50"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    runs, *states = done.stdout.split()
    assert int(runs) >= 2
    assert "killed" in states
    assert set(states) <= {"killed", "new", "finished"}


def anisogran(*arguments, **options):
    """The command line in another process."""
    return subprocess.Popen([sys.executable, "-m", "anisogran", *map(str, arguments)], text=True, stdout=-1, stderr=-1, **options)


def wait_for(folder, stage):
    """Until a run in the folder has come to that stage."""
    end = time.monotonic() + 60
    while time.monotonic() < end:
        state = state_of(folder)
        if (state["state"], state["stage"]) == ("running", stage):
            return
        time.sleep(0.02)
    pytest.fail(f"{folder} did not come to stage {stage}")


@pytest.mark.hard_case("D23", of="simple_shear")
def test_a_signal_saves_within_half_a_second(tmp_path, answer):
    """SIGINT and SIGTERM, in the loading of 400 grains: exit code 130, one line, everything kept, and goes on with --resume."""
    scene, folder, seconds = tmp_path / "scene.toml", tmp_path / "run", []
    scene.write_text('kind = "simple_shear"\nstrain = 200.0\ninertial_number = 0.1\n')
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGINT, signal.SIGTERM):
        child = anisogran("run", scene, "--out", folder, *(["--resume"] if folder.exists() else []))
        wait_for(folder, "shear")
        time.sleep(0.3)
        before = state_of(folder)["grain_steps"]
        clock = time.time()
        child.send_signal(number)
        _, err = child.communicate(timeout=60)
        assert child.returncode == 130, err
        assert re.search(rf"anisogran: interrupted in stage shear, \d+% done; {folder} holds the run", err)
        state = state_of(folder)
        assert state["state"] == "interrupted"
        assert state["grain_steps"] >= before  # nothing lost; a resumed run may be told to stop before its first step
        seconds.append((folder / "state.json").stat().st_mtime - clock)
        assert open_results(folder / "results.h5")["series"].sizes["time"] > 0
    assert not is_locked(folder)
    assert min(seconds) < 0.5  # the least of four: the others may have met a busy machine
    answer.named("SIGINT and SIGTERM: saved within half a second, exit code 130")


def test_a_second_signal_is_not_waited_for(tmp_path):
    """While the state is being saved, another Ctrl-C ends it at once; whatever is on the disk is whole."""

    def twice(session):
        os.kill(os.getpid(), signal.SIGINT)
        os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises((KeyboardInterrupt, Interrupted)):
        run_in_folder(SHEAR, tmp_path, listen=twice)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    assert not is_locked(tmp_path)


@pytest.mark.hard_case("F7")
def test_other_output_is_the_same_run(straight, tmp_path):
    """The rows and snapshots that are asked for, and saving all the time, change no bit of the grains."""
    for name, other in (("biaxial", {"samples": 10}), ("ring_shear", {"frames": 0}), ("simple_shear", {"frames": 11})):
        scene = SCENES[name]
        run = run_in_folder(scene.model_copy(update=other), tmp_path / name, every=0.0)
        for part in ("position", "velocity", "spin", "force", "overlap"):
            np.testing.assert_array_equal(getattr(run.snapshots["end"], part), getattr(straight[name].snapshots["end"], part))


@pytest.mark.hard_case("F7")
def test_whoever_looks_on_changes_nothing(straight, tmp_path):
    """All fields averaged, energies, forces and pictures taken again and again."""

    def look(session):
        if session.begun is not None:
            snapshot = session.simulation.snapshot()
            average(snapshot, least_contacts=0)
            session.simulation.energy()
            session.simulation.force_imbalance()

    for name in SCENES:
        assert_same(run_in_folder(SCENES[name], tmp_path / name, listen=look), straight[name])


@pytest.mark.hard_case("F5")
def test_an_edited_scene_is_refused_by_its_keys_but_for_output(tmp_path, answer):
    scene = SCENES["biaxial"]
    with pytest.raises(Interrupted):
        run_in_folder(scene, tmp_path, listen=lambda session: Leave(1)(session) if len(session.records.rows) == 7 else None)
    edited = scene.model_copy(update={"pressure": 50.0, "friction": Friction(2e4, 0.4), "samples": 40})
    message = "checkpoint.npz: is of another scene: pressure = 50.0, in the file 100.0; friction.mu = 0.4, in the file 0.5"
    with pytest.raises(InputError, match=re.escape(message) + "$") as caught:
        run_in_folder(edited, tmp_path, resume=True)
    answer.refused(caught)
    with pytest.raises(InputError, match="is of another scene: kind = 'simple_shear', in the file 'biaxial'"):
        run_in_folder(SHEAR, tmp_path, resume=True)
    finer = run_in_folder(scene.model_copy(update={"samples": 40}), tmp_path, resume=True)
    steps = np.round(finer.series.time.values / finer.provenance["dt"]).astype(int)
    whole = round(0.002 / finer.provenance["dt"] + 0.5)
    coarse, fine = (np.linspace(0, whole, n + 1).astype(int) for n in (20, 40))
    assert coarse[6] < steps[7] <= coarse[7]  # the grains were somewhere here when they were left
    np.testing.assert_array_equal(steps, [*coarse[:7], *fine[fine >= steps[7]]])


def test_a_run_is_taken_up_with_fewer_rows(tmp_path):
    """Of another number of rows the place in the file says nothing; and what scene.toml says is what is run from there."""
    scene = SCENES["biaxial"].model_copy(update={"samples": 40})
    with pytest.raises(Interrupted):
        run_in_folder(scene, tmp_path, listen=lambda session: Leave(1)(session) if len(session.records.rows) == 30 else None)
    fewer = scene.model_copy(update={"samples": 10})
    with pytest.raises(Interrupted):
        run_in_folder(fewer, tmp_path, resume=True, listen=Leave(1))
    assert read_scene(tmp_path / "scene.toml") == fewer
    run = run_in_folder(fewer, tmp_path, resume=True)
    steps = np.round(run.series.time.values / run.provenance["dt"]).astype(int)
    fine, coarse = (np.linspace(0, steps[-1], n + 1).astype(int) for n in (40, 10))
    np.testing.assert_array_equal(steps, [*fine[:30], *coarse[coarse > fine[29]]])


def test_a_row_that_is_there_is_not_taken_again(tmp_path, monkeypatch):
    """Left at the very step of a row, as where room must be made for the neighbour list: the next mark lies ahead."""
    scene, path, sessions = SCENES["biaxial"], tmp_path / "checkpoint.npz", set()
    look = Biaxial.look

    def saving(self, simulation, records, k):
        look(self, simulation, records, k)
        if k == 6:
            (session,) = sessions
            session.save(path)

    with monkeypatch.context() as patch:
        patch.setattr(Biaxial, "look", saving)
        run_in_folder(scene, tmp_path / "run", listen=sessions.add)
    session = Session.load(path, scene.model_copy(update={"samples": 40}))
    marks, step = session.stages[2].marks, session.simulation.step
    assert (marks[session.marks - 1], marks[session.marks]) == (step, np.linspace(0, marks[-1], 41).astype(int)[13])


@pytest.mark.hard_case("F6")
def test_one_process_at_a_time(tmp_path, answer):
    """A second one ends with a line that names the first; a lock that a killed process has left holds nobody up."""
    with locked(tmp_path):
        with pytest.raises(InputError, match=rf"{tmp_path}: process {os.getpid()} on .* is at work there") as caught:
            run_in_folder(SHEAR, tmp_path)
        answer.refused(str(caught.value).partition(": ")[2].replace(str(os.getpid()), "1").split(" on ")[0] + " on ... is at work there")
        assert is_locked(tmp_path)
        assert contents(tmp_path) == ["lock"]
    assert contents(tmp_path) == []
    (tmp_path / "lock").write_text("process 1 on nowhere\n")
    assert not is_locked(tmp_path)
    with locked(tmp_path):
        assert (tmp_path / "lock").read_text().startswith(f"process {os.getpid()} on ")
    assert contents(tmp_path) == []


@pytest.mark.hard_case("F3")
def test_a_damaged_checkpoint_is_found_and_the_one_before_it_taken(straight, rng, tmp_path):
    """Cut, flipped, empty: said so, and the run is still the straight one; if both are damaged, nothing is begun anew in silence."""
    path = tmp_path / "checkpoint.npz"
    for damage in (lambda data: data[: len(data) // 2], lambda data: data[:500] + bytes([data[500] ^ 4]) + data[501:], lambda data: b""):
        run_folder.clear(tmp_path, force=True)
        with pytest.raises(Interrupted):
            run_in_folder(SHEAR, tmp_path, every=0.0, listen=Leave(12))
        path.write_bytes(damage(path.read_bytes()))
        with pytest.warns(UserWarning, match=r"checkpoint.npz: .*; going on from .*checkpoint.npz.previous, step \d+"):
            run = run_in_folder(SHEAR, tmp_path, resume=True)
        assert_same(run, straight["simple_shear"])
    for name in ("checkpoint.npz", "checkpoint.npz.previous"):
        (tmp_path / name).write_bytes(b"nothing")
    before = contents(tmp_path)
    with pytest.raises(InputError, match=r"^[^\n]*checkpoint.npz: [^\n]*; [^\n]*checkpoint.npz.previous: [^\n]*$"):
        run_in_folder(SHEAR, tmp_path, resume=True)
    assert contents(tmp_path) == before


EMPTY = {"rows": {}, "tables": {}, "snapshots": {}}  # records


def test_a_forged_checkpoint_is_refused(tmp_path):
    """Whole and under seal, but not of a run."""
    with pytest.raises(Interrupted):
        run_in_folder(SHEAR, tmp_path, listen=Leave(12))
    path = tmp_path / "checkpoint.npz"
    simulation = Simulation.load(path)
    good = simulation.attached
    place = good["place"]
    for attached, message in [
        (None, "is no checkpoint of a run"),
        ([1, 2], "is no checkpoint of a run"),
        ({**good, "place": {**place, "stage": 7}}, "is no checkpoint of a run"),
        ({**good, "place": {**place, "stage": -1}}, "is no checkpoint of a run"),
        ({**good, "place": {**place, "stage": 3, "marks": 0}}, "is no checkpoint of a run"),
        ({**good, "place": {**place, "begun": 10**9}}, "is no checkpoint of a run"),
        ({**good, "place": {**place, "begun": "0"}}, "is no checkpoint of a run"),
        ({**good, "place": {**place, "marks": -1}}, "is no checkpoint of a run"),
        ({**good, "place": {**place, "marks": 10**9}}, "is no checkpoint of a run"),
        ({**good, "place": {**place, "more": 0}}, "is no checkpoint of a run"),
        (
            {**good, "records": {**EMPTY, "rows": {"time": np.zeros(2), "p": np.zeros(3)}}},
            "is no checkpoint of a run",
        ),
        ({**good, "records": {**EMPTY, "snapshots": {"end": {"position": np.zeros(2)}}}}, "is no checkpoint of a run"),
        ({**good, "scene": {}}, "is of another scene: "),
    ]:
        simulation.save(path, attached)
        with pytest.raises(InputError, match=f"^{re.escape(str(path))}: {message}[^\n]*$"):
            Session.load(path, SHEAR)


FULL = """
import resource, sys
sys.path.insert(0, sys.argv[1])
from test_run_folder import SHEAR, Leave
from anisogran.runs import session
from anisogran.runs.folder import run_in_folder
from anisogran.outcome import Interrupted, RunFailed

def on_a_full_disk(write):
    def attempt(*arguments):
        resource.setrlimit(resource.RLIMIT_FSIZE, (1000, resource.RLIM_INFINITY))
        try:
            write(*arguments)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY,) * 2)
    return attempt

try:
    run_in_folder(SHEAR, sys.argv[2], listen=lambda session: Leave(1)(session) if len(session.records.rows) == 5 else None)
except Interrupted:
    print("left")
writer = {"checkpoint.npz": session.Simulation, "results.h5": session.Run}[sys.argv[3]]
writer.save = on_a_full_disk(writer.save)
try:
    run_in_folder(SHEAR, sys.argv[2], resume=True, every=0.0)
except RunFailed as error:
    print(error)
"""


@pytest.mark.hard_case("F2")
@pytest.mark.parametrize("name", ["checkpoint.npz", "results.h5"])
def test_a_full_disk_stops_the_run_and_harms_nothing(name, straight, tmp_path, answer):
    """That file may not be written: the run fails by name, what was on the disk stays whole, and with room again it goes on."""
    command = [sys.executable, "-c", FULL, os.path.dirname(__file__), str(tmp_path / "run"), name]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    left, error = done.stdout.splitlines()
    assert left == "left"
    assert error == f"{tmp_path / 'run' / name}: cannot be written ({os.strerror(errno.EFBIG)})"
    answer.named(f"run failed: {error}")
    state = state_of(tmp_path / "run")
    assert (state["state"], state["message"]) == ("failed", error)
    assert Session.load(tmp_path / "run" / "checkpoint.npz", SHEAR).records.rows
    assert open_results(tmp_path / "run" / "results.h5")["series"].sizes["time"] > 0
    assert_same(run_in_folder(SHEAR, tmp_path / "run", resume=True), straight["simple_shear"])
    assert contents(tmp_path / "run") == WHOLE


@pytest.mark.hard_case("F8")
def test_folders_that_cannot_be_used(tmp_path, answer):
    (tmp_path / "file").write_text("mine")
    with pytest.raises(InputError, match=r"file: cannot be made \(File exists\)"):
        run_in_folder(SHEAR, tmp_path / "file")
    with pytest.raises(InputError, match=r"below: cannot be made \(Not a directory\)"):
        run_in_folder(SHEAR, tmp_path / "file" / "below")
    with pytest.raises(InputError, match="folder 3 is no path") as caught:
        run_in_folder(SHEAR, 3)
    answer.refused(caught)
    assert contents(tmp_path) == ["file"]
    if hasattr(os, "geteuid") and os.geteuid():
        (tmp_path / "locked").mkdir(mode=0o500)
        with pytest.raises(InputError, match=r"cannot be written \(Permission denied\)"):
            run_in_folder(SHEAR, tmp_path / "locked")


@pytest.mark.hard_case("F8", "F9")
def test_neither_clock_nor_locale_nor_place_matter(straight, tmp_path, monkeypatch):
    """The clock of the day may jump or stand still, the folder bear any name."""
    monkeypatch.setattr(time, "time", lambda: pytest.fail("nothing may ask for the time of day"))
    monkeypatch.setenv("TZ", "Pacific/Kiritimati")
    monkeypatch.setenv("LC_ALL", "de_DE.UTF-8")
    assert_same(SHEAR.run(folder=tmp_path / "größe 粒"), straight["simple_shear"])


@pytest.mark.hard_case("F10")
def test_memory_is_looked_at_before_the_start(monkeypatch, answer):
    needed = estimate(SHEAR).memory
    check_memory(SHEAR, free=needed / 0.79)
    with pytest.raises(InputError, match=r"simple_shear: n = 60 take about 0.3 GB of memory, more than 80% of the 0.4 GB") as caught:
        check_memory(SHEAR, free=needed / 0.81)
    answer.refused(caught)
    monkeypatch.setattr(estimates, "free_memory", lambda: None)  # a system that does not tell
    check_memory(SHEAR)
    monkeypatch.undo()
    assert 1e8 < estimates.free_memory() < 1e13


def test_a_job_has_what_its_control_group_leaves(tmp_path, monkeypatch):
    for limit, used, free in (("8000000000", "3000000000", 5e9), ("max", "3000000000", None), ("eight", "3", None)):
        (tmp_path / "memory.max").write_text(f"{limit}\n")
        (tmp_path / "memory.current").write_text(f"{used}\n")
        assert estimates._free_in_group(tmp_path) == free
    assert estimates._free_in_group(tmp_path / "none") is None
    monkeypatch.setattr(estimates, "_free_in_group", lambda: 123.0)
    assert estimates.free_memory() == 123.0


MEMORY = """
import sys
from anisogran import SimpleShear
from anisogran.runs.estimates import estimate
scene = SimpleShear(inertial_number=0.5, n=2000, strain=0.6, discard=0.1, frames=30)
scene.run(folder=sys.argv[1])
with open("/proc/self/status") as file:  # getrusage would tell of the process that has started this one
    (peak,) = (float(line.split()[1]) for line in file if line.startswith("VmHWM"))
print(estimate(scene).memory / (1024 * peak))
"""


@pytest.mark.hard_case("F10")
@pytest.mark.skipif(not os.path.exists("/proc/self/status"), reason="only Linux tells the peak of a process")
def test_the_estimate_of_memory_is_good_to_a_factor_of_two(tmp_path, answer):
    done = subprocess.run([sys.executable, "-c", MEMORY, str(tmp_path)], capture_output=True, text=True, check=True)
    assert 0.5 < float(done.stdout) < 2.0
    answer.computed(abs(float(done.stdout) - 1.0), "estimated memory")


@pytest.mark.hard_case("D22", of="ring_shear_volume")
def test_a_shear_that_is_too_fast_is_warned_of(straight, answer):
    (warning,) = [reason for reason in straight["ring_shear_volume"].status.reasons if "quasi-static" in reason]
    answer.named(f"warned: {warning}")


@pytest.mark.parametrize("name", SCENES)
def test_the_estimate_of_the_work_is_good_to_a_factor_of_two(name, straight):
    """But for what preparations take, which is a guess."""
    assert 0.5 < estimate(SCENES[name]).grain_steps / straight[name].provenance["grain_steps"] < 2.5


def test_a_refused_stage_and_a_run_that_stops_are_failures(tmp_path, monkeypatch):
    """No equilibrium: by the name of the stage. A blow-up: the state is kept apart, the checkpoint stays the last good one."""
    with monkeypatch.context() as patch:
        patch.setattr("anisogran.experiments.simple_shear.ATTEMPTS", 1)
        with pytest.raises(RunFailed, match=r"stage relax: no equilibrium after \d+ steps: E_kin/E_pot = "):
            run_in_folder(SHEAR, tmp_path)
    state = state_of(tmp_path)
    assert (state["state"], state["stage"]) == ("failed", "relax")
    assert state["message"].startswith("stage relax: no equilibrium")
    assert "checkpoint.npz.failed" not in contents(tmp_path)  # the simulation itself is well

    def blow_up(session):
        if session.stage_name == "shear" and session.begun is not None:
            session.simulation._state.body.rows[3, 2] = np.nan

    with pytest.raises(RunFailed, match=r"at grain \d+, .*not a finite number.*checkpoint.npz.failed holds the state"):
        run_in_folder(SHEAR, tmp_path, force=True, listen=blow_up)
    assert state_of(tmp_path)["state"] == "failed"
    assert Simulation.load(tmp_path / "checkpoint.npz.failed").status.level == "failed"
    assert Session.load(tmp_path / "checkpoint.npz", SHEAR).simulation.failure is None


@pytest.mark.hard_case("F4")
def test_an_unfinished_result_says_so(tmp_path, answer):
    with pytest.raises(Interrupted):
        run_in_folder(SHEAR, tmp_path, listen=lambda session: Leave(1)(session) if len(session.records.rows) == 9 else None)
    tree = open_results(tmp_path / "results.h5")
    assert re.fullmatch(r"warned: unfinished: in stage shear, \d\d% done", tree.attrs["status"])
    assert tree["series"].sizes["time"] == 9
    answer.named(f'read, with the status "{tree.attrs["status"]}"')
    assert "end" in tree["snapshots"].children


def test_a_folder_begun_anew_keeps_nothing_of_the_run_before(straight, tmp_path):
    with pytest.raises(Interrupted):
        run_in_folder(SCENES["biaxial"], tmp_path, listen=Leave(12))
    before = {name: (tmp_path / name).read_bytes() for name in contents(tmp_path)}
    with pytest.raises(
        InputError, match=rf"^{tmp_path}: holds a run \(checkpoint.npz.*\); resume=True goes on with it, force=True begins anew$"
    ):
        run_in_folder(SHEAR, tmp_path)
    assert {name: (tmp_path / name).read_bytes() for name in contents(tmp_path)} == before
    assert_same(SHEAR.run(folder=tmp_path, force=True), straight["simple_shear"])
    assert contents(tmp_path) == WHOLE


def test_the_state_of_a_folder(tmp_path):
    assert state_of(tmp_path)["state"] == "new"
    (tmp_path / "state.json").write_text(json.dumps({**state_of(tmp_path), "state": "running"}))
    assert state_of(tmp_path)["state"] == "killed"
    with locked(tmp_path):
        assert state_of(tmp_path)["state"] == "running"
    for text in ("", "[]", "{}", "7", '{"state": "running"}'):
        (tmp_path / "state.json").write_text(text)
        with pytest.raises(InputError, match=r"^[^\n]*state.json: is no state of a run[^\n]*$"):
            state_of(tmp_path)
