"""A run that keeps itself in a folder, so that it survives whatever stops it.

    scene.toml      the scene as it is run
    checkpoint.npz  the whole state, from which the run goes on bit for bit; the one before is checkpoint.npz.previous
    results.h5      series, fields and snapshots so far, whole at any time
    state.json      running, finished, interrupted or failed; how far; what is to be known
    lock            while a process is at work

The checkpoint holds all of it; the results are written from it, so a kill between the two does no harm.
"""

import json
import signal
import threading
import time
from contextlib import contextmanager, suppress
from pathlib import Path

from anisogran.dem.sealed import previous_of
from anisogran.files import software, write_json, write_text
from anisogran.outcome import InputError, Interrupted, RunFailed
from anisogran.runs.lock import is_locked, locked
from anisogran.runs.session import Session
from anisogran.scenes.writing import scene_text

EVERY, SHARE = 10.0, 0.05  # seconds between two saves, and how much of the time they may take
STATES = ("new", "running", "killed", "interrupted", "failed", "finished")


def run_in_folder(scene, folder, resume=False, force=False, listen=None, every=EVERY):
    """The Run of a scene that keeps itself in `folder`; with `resume` it goes on from what is there, if anything is.

    A run that is there is removed only with `force`.

    `listen(session)` is called several times a second; a KeyboardInterrupt from it stops the run like a signal. Saved every `every`
    seconds, or so seldom that it takes 5 % of the time; and at SIGINT (Ctrl-C) and SIGTERM, which then raise Interrupted; a second one
    ends it at once. Raises InputError if the folder cannot be used, another process is at work there, or its checkpoint is of another
    scene or damaged; RunFailed if a stage is refused or the simulation stops, or the disk takes no more: then the checkpoint is still the
    last good one.
    """
    folder = made_folder(folder)
    with locked(folder):
        session = taken_up(scene, folder) if resume else Session(scene)
        if session.is_over and state_of(folder)["state"] == "finished" and (folder / "results.h5").exists():
            return session.result()
        keeper = Keeper(session, folder, every)
        if session.simulation is None:
            clear(folder, force or resume)
        with stops_noted(session) as stop:
            try:
                write_text(folder / "scene.toml", scene_text(scene))
                keeper.tell("running")
                session.go(lambda: keeper.hear(stop, listen))
                run = keeper.finish()
            except KeyboardInterrupt:
                if not session.beginning:  # a second one, anywhere in the midst of things
                    raise
                raise keeper.interrupted() from None
            except Interrupted:
                raise
            except Exception as error:
                told = keeper.failed(error)
                if told is error:
                    raise
                raise told from None
        if stop.is_set():  # too late to leave anything undone, but whoever asked for it wants no more to follow
            raise Interrupted(f"interrupted at the end; {folder} holds the run, which is finished")
        return run


def taken_up(scene, folder):
    """The Session that goes on from what is in the folder; a new one if nothing is."""
    checkpoint = folder / "checkpoint.npz"
    if checkpoint.exists() or previous_of(checkpoint).exists():
        return Session.load(checkpoint, scene)
    if (folder / "results.h5").exists():
        raise InputError(f"{folder}: holds results but no checkpoint to go on from; begin anew in another folder")
    return Session(scene)


class Keeper:
    """Writes a session down whenever it is due."""

    def __init__(self, session, folder, every):
        self.session, self.folder, self.every = session, folder, every
        software()  # asks git, which takes a while the first time: not when a signal wants the run saved
        self.written, self.cost = time.monotonic(), 0.0

    def hear(self, stop, listen):
        """Called between whole steps: saves if it is due, passes on, and leaves the run if that is wanted, before or by now."""
        session = self.session
        if not stop.is_set():
            between_stages = session.begun is None and not session.is_over  # what comes next may be long to compile, and cannot be left
            if between_stages or time.monotonic() - self.written >= max(self.every, self.cost / SHARE):
                self.save()
                self.tell("running")
            if listen is not None:
                try:
                    listen(session)
                except KeyboardInterrupt:
                    stop.set()
        if stop.is_set():
            self.save()
            raise self.interrupted()

    def save(self):
        """Writes checkpoint and results; the Run so far, or None."""
        begin = time.monotonic()
        self.session.save(self.folder / "checkpoint.npz")
        run = self.session.result()
        if run is not None:
            run.save(self.folder / "results.h5")
        self.written = time.monotonic()
        self.cost = self.written - begin
        self.session.saving += self.cost
        return run

    def finish(self):
        """The Run, after everything is written and the older checkpoint is gone."""
        run = self.save()
        for name in ("checkpoint.npz.previous", "checkpoint.npz.failed"):
            (self.folder / name).unlink(missing_ok=True)
        self.tell("finished", str(run.status))
        return run

    def interrupted(self):
        """Writes that the run was left; the exception that says so."""
        self.tell("interrupted")
        return Interrupted(
            f"interrupted in stage {self.session.stage_name}, {self.session.fraction:.0%} done; {self.folder} holds the run"
        )  # fmt: skip

    def failed(self, error):
        """Writes why the run has failed, and apart from the good checkpoint the state of a simulation that had to stop; the exception."""
        known = isinstance(error, RunFailed | InputError)
        with suppress(RunFailed, InputError):  # of a full disk or a lost folder, which is what the error is about
            self.tell("failed", str(error) if known else f"{type(error).__name__}: {error}")
        simulation, path = self.session.simulation, self.folder / "checkpoint.npz.failed"
        if isinstance(error, RunFailed) and simulation is not None and simulation.failure is not None:
            with suppress(RunFailed, InputError):
                self.session.save(path)
                return RunFailed(f"{error}; {path} holds the state")
        return error

    def tell(self, state, message=""):
        """Writes how the run is."""
        session = self.session
        figures = {
            "stage": session.stage_name,
            "fraction": session.fraction,
            "grain_steps": session.grain_steps,
            "seconds": session.seconds,
        }
        write_json(self.folder / "state.json", {"state": state, "message": message, **figures})


def made_folder(folder):
    """The folder as a Path, made if it is not there. Raises InputError if it cannot be."""
    try:
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
    except (TypeError, ValueError):  # ValueError: a name that no folder can have
        raise InputError(f"folder {folder!r} is no path") from None
    except OSError as error:
        raise InputError(f"{folder}: cannot be made ({error.strerror})") from None
    return folder


def clear(folder, force):
    """Removes what an earlier run has left, so that nothing of it can be taken for this one's.

    Raises InputError where it cannot be, or, without `force`, if there is a result or a state that would be lost.
    """
    kept = [name for name in ("results.h5", "checkpoint.npz", "checkpoint.npz.previous") if (folder / name).exists()]
    if kept and not force:
        raise InputError(f"{folder}: holds a run ({', '.join(kept)}); resume=True goes on with it, force=True begins anew")
    for name in ("state.json", "results.h5", "checkpoint.npz", "checkpoint.npz.previous", "checkpoint.npz.failed"):
        try:
            (folder / name).unlink(missing_ok=True)
        except OSError as error:
            raise InputError(f"{folder / name}: cannot be removed ({error.strerror})") from None


def state_of(folder):
    """How the run of a folder is: a dict with `state` (one of STATES), `message`, `stage`, `fraction`; and so it is after a kill too."""
    path = Path(folder) / "state.json"
    nothing = {"state": "new", "message": "", "stage": "", "fraction": 0.0, "grain_steps": 0, "seconds": 0.0}
    try:
        state = json.loads(path.read_text(encoding="utf-8"))
        state = {key: state[key] for key in nothing}
    except FileNotFoundError:
        return nothing
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"{path}: is no state of a run ({' '.join(str(error).split())})") from None
    if state["state"] == "running" and not is_locked(folder):
        state["state"] = "killed"
    return state


@contextmanager
def stops_noted(session):
    """Within the block the first SIGINT or SIGTERM sets the event that is given; a second one, or one while a stage begins, interrupts.

    Only the main thread hears signals; in another one nothing is changed. A signal that the process was told to ignore stays ignored.
    """
    stop = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        yield stop
        return

    def note(number, frame):
        again = stop.is_set()
        stop.set()  # in any case: what is raised within a callback of the compiler is lost
        if again or session.beginning:
            raise KeyboardInterrupt

    heard = [number for number in (signal.SIGINT, signal.SIGTERM) if signal.getsignal(number) not in (signal.SIG_IGN, None)]
    before = {number: signal.signal(number, note) for number in heard}
    try:
        yield stop
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
