"""Signals and mistakes at the worst moments: what is on the disk is whole and true, whatever a run was doing."""

import json
import os
import platform
import signal
import threading
import time
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
from test_run_folder import SHEAR, WHOLE, assert_same, contents

import anisogran
from anisogran import InputError
from anisogran import open as open_results
from anisogran.outcome import Interrupted, RunFailed
from anisogran.runs import folder as run_folder
from anisogran.runs import session as run_session
from anisogran.runs.folder import Keeper, run_in_folder, state_of
from anisogran.runs.session import Session


@pytest.fixture(scope="module")
def straight():
    return SHEAR.run()


def interrupt(times=1):
    for _ in range(times):
        os.kill(os.getpid(), signal.SIGINT)


def after(monkeypatch, owner, name, deed, when=lambda *arguments: True):
    """Does something at the end of a method, once."""
    method, done = getattr(owner, name), []

    def patched(self, *arguments, **options):
        result = method(self, *arguments, **options)
        if not done and when(self, *arguments):
            done.append(True)
            deed()
        return result

    monkeypatch.setattr(owner, name, patched)


def test_a_second_signal_in_the_midst_of_a_row_saves_no_half_of_it(straight, tmp_path, monkeypatch):
    """It ends the run at once; the last save holds, and it goes on from there."""
    with monkeypatch.context() as patch:
        after(patch, type(SHEAR), "look", lambda: interrupt(2), when=lambda scene, simulation, records, k: k == 8)
        with pytest.raises(KeyboardInterrupt):
            run_in_folder(SHEAR, tmp_path, every=0.0)
    assert state_of(tmp_path)["state"] == "killed"
    session = Session.load(tmp_path / "checkpoint.npz", SHEAR)
    assert len(session.records.rows) <= 8
    assert session.simulation.attached is None  # it is the session now, and no memory is held twice
    assert_same(run_in_folder(SHEAR, tmp_path, resume=True), straight)


def test_a_signal_while_saving_between_two_stages_is_heard_before_the_next_begins(straight, tmp_path, monkeypatch):
    """The next stage may be long to compile."""
    with monkeypatch.context() as patch:
        after(patch, Keeper, "save", interrupt, when=lambda keeper: keeper.session.begun is None)
        with pytest.raises(Interrupted, match="interrupted in stage relax, "):
            run_in_folder(SHEAR, tmp_path)
    session = Session.load(tmp_path / "checkpoint.npz", SHEAR)
    assert (session.stage, session.begun) == (1, None)
    assert_same(run_in_folder(SHEAR, tmp_path, resume=True), straight)


@pytest.mark.parametrize("stage", ["pressed", "sheared"])
def test_a_signal_while_a_stage_begins_leaves_it_there(stage, straight, tmp_path, monkeypatch):
    """Nothing is half done; at the first stage there is nothing yet to keep."""
    with monkeypatch.context() as patch:
        after(patch, type(SHEAR), stage, interrupt)
        with pytest.raises(Interrupted, match=r"interrupted in stage (prepare|shear), "):
            run_in_folder(SHEAR, tmp_path)
    assert state_of(tmp_path)["state"] == "interrupted"
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if stage == "sheared":
        assert Session.load(tmp_path / "checkpoint.npz", SHEAR).begun is None
    else:
        assert contents(tmp_path) == ["scene.toml", "state.json"]
    assert_same(run_in_folder(SHEAR, tmp_path, resume=True), straight)


def test_an_interrupt_that_the_compiler_swallows_is_heard_all_the_same(straight, tmp_path, monkeypatch):
    """What is raised in a callback of the compiler is lost; the run ends as soon as the stage has begun."""
    compile_ = run_session.Simulation.compile

    def swallowing(self):
        with suppress(KeyboardInterrupt):
            interrupt()
        compile_(self)

    with monkeypatch.context() as patch:
        patch.setattr(run_session.Simulation, "compile", swallowing)
        with pytest.raises(Interrupted, match="interrupted in stage prepare, 0% done"):
            run_in_folder(SHEAR, tmp_path)
    assert Session.load(tmp_path / "checkpoint.npz", SHEAR).begun == 0
    assert_same(run_in_folder(SHEAR, tmp_path, resume=True), straight)


def test_a_run_that_is_taken_up_can_be_left_while_it_is_compiled(straight, tmp_path, monkeypatch):
    """In another process its kernels may have to be made anew; that is no time of the time loop, nor is what a listener takes."""
    pauses = []
    with pytest.raises(Interrupted):
        run_in_folder(SHEAR, tmp_path, listen=lambda session: interrupt() if len(session.records.rows) == 8 else None)
    compile_ = run_session.Simulation.compile
    with monkeypatch.context() as patch:
        patch.setattr(run_session.Simulation, "compile", lambda self: interrupt())
        with pytest.raises(Interrupted, match="interrupted in stage shear, "):
            run_in_folder(SHEAR, tmp_path, resume=True, listen=lambda session: pytest.fail("it ran"))
    with monkeypatch.context() as patch:
        patch.setattr(run_session.Simulation, "compile", lambda self: [time.sleep(1.0), compile_(self)])
        run = run_in_folder(SHEAR, tmp_path, resume=True, listen=lambda session: time.sleep(0.0 if pauses else pauses.append(1) or 1.0))
    assert_same(run, straight)
    assert run.provenance["seconds"] < 1.0


def test_a_run_that_is_taken_up_is_saved_when_it_is_left_again(tmp_path, monkeypatch):
    """In the midst of its time loop, as it was the first time."""
    for k in (8, 15):
        with monkeypatch.context() as patch:
            after(patch, type(SHEAR), "look", interrupt, when=lambda scene, simulation, records, now, k=k: now == k)
            with pytest.raises(Interrupted):
                run_in_folder(SHEAR, tmp_path, resume=True)
        assert len(Session.load(tmp_path / "checkpoint.npz", SHEAR).records.rows) == k + 1


def test_a_signal_at_the_very_end_does_not_get_lost(straight, tmp_path, monkeypatch):
    """The run is finished, but a script that would go on with the next one is stopped."""
    with monkeypatch.context() as patch:
        after(patch, Keeper, "finish", interrupt)
        with pytest.raises(Interrupted, match=f"^interrupted at the end; {tmp_path} holds the run, which is finished$"):
            run_in_folder(SHEAR, tmp_path)
    assert state_of(tmp_path)["state"] == "finished"
    assert_same(run_in_folder(SHEAR, tmp_path, resume=True), straight)


def test_a_signal_that_is_ignored_stays_so(straight, tmp_path, monkeypatch):
    """As of a process that a shell has put in the background."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        after(monkeypatch, type(SHEAR), "look", lambda: interrupt(2))
        assert_same(run_in_folder(SHEAR, tmp_path), straight)
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)


def test_a_run_in_another_thread(straight, tmp_path):
    """It hears no signals, but its listener can stop it; the handlers of the main thread are left alone."""
    told = []

    def stop(session):
        if len(session.records.rows) == 8:
            assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
            raise KeyboardInterrupt

    def work():
        try:
            run_in_folder(SHEAR, tmp_path, listen=stop)
        except Interrupted as error:
            told.append(str(error))
            told.append(run_in_folder(SHEAR, tmp_path, resume=True))

    thread = threading.Thread(target=work)
    thread.start()
    thread.join(60)
    assert told[0].startswith("interrupted in stage shear, ")
    assert_same(told[1], straight)


@pytest.mark.parametrize(
    ("error", "message"),
    [
        (InputError("Simulation: grain 3 is a square"), "Simulation: grain 3 is a square"),
        (MemoryError(), "MemoryError: "),
        (ZeroDivisionError("a mistake of ours"), "ZeroDivisionError: a mistake of ours"),
    ],
)
def test_whatever_else_ends_a_run_is_told(error, message, tmp_path, monkeypatch, straight):
    """In the state of the folder; the exception is passed on as it is."""

    def fail():
        raise error

    with monkeypatch.context() as patch:
        after(patch, type(SHEAR), "sheared", fail)
        with pytest.raises(type(error)) as caught:
            run_in_folder(SHEAR, tmp_path)
    assert caught.value is error
    state = state_of(tmp_path)
    assert (state["state"], state["stage"], state["message"]) == ("failed", "shear", message)
    assert contents(tmp_path) == ["checkpoint.npz", "checkpoint.npz.previous", "scene.toml", "state.json"]
    assert_same(run_in_folder(SHEAR, tmp_path, resume=True), straight)


def test_an_interrupt_that_cannot_be_saved_is_a_failure(straight, tmp_path, monkeypatch):
    """The disk is full just then."""
    with monkeypatch.context() as patch:
        save = run_session.Simulation.save

        def full(self, path, attached=None):
            if self.step > 0 and len(attached["records"]["rows"]):
                raise RunFailed(f"{path}: cannot be written (No space left on device)")
            save(self, path, attached)

        patch.setattr(run_session.Simulation, "save", full)
        after(patch, type(SHEAR), "look", interrupt, when=lambda scene, simulation, records, k: k == 8)
        with pytest.raises(RunFailed, match=r"checkpoint.npz: cannot be written"):
            run_in_folder(SHEAR, tmp_path)
    state = state_of(tmp_path)
    assert (state["state"], state["message"]) == ("failed", f"{tmp_path}/checkpoint.npz: cannot be written (No space left on device)")
    assert_same(run_in_folder(SHEAR, tmp_path, resume=True), straight)


def test_a_blow_up_on_a_full_disk_is_told_as_the_blow_up(tmp_path, monkeypatch):
    def blow_up(session):
        if session.stage_name == "shear" and session.begun is not None:
            session.simulation._state.body.rows[3, 2] = float("nan")
            monkeypatch.setattr(run_folder, "write_json", full)
            monkeypatch.setattr(run_session.Simulation, "save", full)

    def full(*arguments):
        raise RunFailed("cannot be written (No space left on device)")

    with pytest.raises(RunFailed, match=r"at grain \d+, .*not a finite number; .* has blown up$"):
        run_in_folder(SHEAR, tmp_path, listen=blow_up)


def test_what_is_missing_of_a_finished_run(straight, tmp_path):
    """Results are made again from the checkpoint; without it, they are not taken for nothing."""
    run_in_folder(SHEAR, tmp_path)
    whole = (tmp_path / "results.h5").read_bytes()
    (tmp_path / "results.h5").unlink()
    (tmp_path / "checkpoint.npz.failed").write_text("of another time")
    assert_same(run_in_folder(SHEAR, tmp_path, resume=True), straight)
    assert contents(tmp_path) == WHOLE
    assert open_results(tmp_path / "results.h5").attrs["status"] == str(straight.status)
    (tmp_path / "checkpoint.npz").unlink()
    with pytest.raises(InputError, match=f"^{tmp_path}: holds results but no checkpoint to go on from; begin anew in another folder$"):
        run_in_folder(SHEAR, tmp_path, resume=True)
    assert len((tmp_path / "results.h5").read_bytes()) == len(whole)


def test_nothing_that_is_kept_tells_of_the_machine(straight, tmp_path):
    """Neither folder nor home, user nor host."""
    run_in_folder(SHEAR, tmp_path / "somewhere")
    words = ["somewhere", str(tmp_path), os.getcwd(), os.path.expanduser("~"), platform.node(), str(Path(anisogran.__file__).parent)]
    for name in WHOLE:
        content = (tmp_path / "somewhere" / name).read_bytes()
        assert not [word for word in words if word.encode() in content]


def test_a_run_killed_before_its_last_results_is_finished_afterwards(straight, tmp_path):
    """Its last checkpoint was written; state and results are those of the save before, whole but old."""
    run_in_folder(SHEAR, tmp_path)
    old = straight.series.isel(time=slice(3))
    replace(straight, series=old).save(tmp_path / "results.h5")
    told = json.loads((tmp_path / "state.json").read_text())
    (tmp_path / "state.json").write_text(json.dumps({**told, "state": "running"}))
    assert_same(run_in_folder(SHEAR, tmp_path, resume=True), straight)
    assert state_of(tmp_path)["state"] == "finished"
    assert open_results(tmp_path / "results.h5")["series"].sizes["time"] == straight.series.sizes["time"]


def test_the_older_checkpoint_alone_will_do(straight, tmp_path):
    """On a file system without hard links a kill may leave no other."""
    with pytest.raises(Interrupted):
        run_in_folder(SHEAR, tmp_path, every=0.0, listen=lambda session: interrupt() if len(session.records.rows) == 8 else None)
    (tmp_path / "checkpoint.npz").unlink()
    with pytest.warns(UserWarning, match=r"going on from .*checkpoint.npz.previous, step \d+"):
        assert_same(run_in_folder(SHEAR, tmp_path, resume=True), straight)


def test_the_folder_says_so_as_soon_as_it_is_at_work(tmp_path, monkeypatch):
    """Before the first stage begins, which may take long; and what git knows is asked before, not when a signal wants the run saved."""
    seen = []
    monkeypatch.setattr(run_folder, "software", lambda: seen.append("software"))
    after(monkeypatch, type(SHEAR), "pressed", lambda: seen.append(state_of(tmp_path)["state"]))
    run_in_folder(SHEAR, tmp_path)
    assert seen == ["software", "running"]


def test_who_wants_to_leave_waits_for_one_save_only(tmp_path, monkeypatch):
    """Also when one was due, and for nobody who listens."""
    stop, saves = threading.Event(), []
    stop.set()
    monkeypatch.setattr(Keeper, "save", lambda keeper: saves.append(keeper))
    with pytest.raises(Interrupted):
        Keeper(Session(SHEAR), tmp_path, 0.0).hear(stop, lambda session: pytest.fail("too late"))
    assert len(saves) == 1


def test_saving_takes_a_twentieth_of_the_time_at_most(tmp_path, monkeypatch):
    """Every ten seconds; but where it takes two seconds, every forty after the last one."""
    now, saves = [0.0], []

    def save(session, path):
        saves.append(now[0])
        now[0] += 2.0

    monkeypatch.setattr(run_folder, "time", SimpleNamespace(monotonic=lambda: now[0]))
    monkeypatch.setattr(Session, "save", save)
    monkeypatch.setattr(Keeper, "tell", lambda keeper, state: None)
    session = Session(SHEAR)
    session.begun = 0
    keeper = Keeper(session, tmp_path, 10.0)
    while now[0] < 100:
        keeper.hear(threading.Event(), None)
        now[0] += 1.0
    assert saves == [10.0, 52.0, 94.0]
    assert session.saving == 6.0


def test_the_run_that_is_given_is_the_one_in_the_file(tmp_path):
    run = run_in_folder(SHEAR, tmp_path)
    stored = open_results(tmp_path / "results.h5")
    for name in ("seconds", "saving_seconds", "grain_steps"):
        assert stored.attrs[name] == run.provenance[name]


def test_a_finished_run_is_saved_once_for_each_stage(tmp_path, monkeypatch):
    """Between stages, and at the end."""
    saves = []
    save = Keeper.save
    monkeypatch.setattr(Keeper, "save", lambda keeper: [saves.append(keeper.session.stage_name), save(keeper)][1])
    run_in_folder(SHEAR, tmp_path, every=1e9)
    assert saves == ["relax", "shear", "end"]


def test_a_folder_in_the_way_is_named(tmp_path):
    (tmp_path / "results.h5").mkdir()
    with pytest.raises(InputError, match=r"^[^\n]*results.h5: cannot be removed \("):
        run_in_folder(SHEAR, tmp_path, force=True)
    assert contents(tmp_path) == ["results.h5"]
