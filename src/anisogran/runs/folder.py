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
from anisogran.files import software, write_json
from anisogran.outcome import InputError, Interrupted, RunFailed
from anisogran.runs.lock import is_locked, locked
from anisogran.runs.session import Session

EVERY, SHARE = 10.0, 0.05  # seconds between two saves, and how much of the time they may take
STATES = ("new", "running", "killed", "interrupted", "failed", "finished")


def run_in_folder(scene, folder, resume=False, listen=None, every=EVERY):
    """The Run of a scene that keeps itself in `folder`; with `resume` it goes on from what is there, if anything is.

    `listen(session)` is called several times a second. Saved every `every` seconds, or so seldom that it takes 5 % of the time; and at
    SIGINT (Ctrl-C) and SIGTERM, which then raise Interrupted, a second one at once. Raises InputError if the folder cannot be used,
    another process is at work there, or its checkpoint is of another scene or damaged; RunFailed if a stage is refused or the
    simulation stops, or the disk takes no more: then the checkpoint is still the last good one.
    """
    folder = made_folder(folder)
    with locked(folder):
        checkpoint = folder / "checkpoint.npz"
        there = checkpoint.exists() or previous_of(checkpoint).exists()
        session = Session.load(checkpoint, scene) if resume and there else Session(scene)
        keeper = Keeper(session, folder, every)
        if session.is_over:  # finished, or killed between its last checkpoint and its results
            return session.result() if state_of(folder)["state"] == "finished" else keeper.finish()
        if not there or not resume:
            clear(folder)
        keeper.tell("running")
        with stops_noted(session) as stop:
            try:
                session.go(lambda: keeper.hear(stop, listen))
                return keeper.finish()
            except KeyboardInterrupt:
                keeper.save()
                keeper.tell("interrupted")
                raise Interrupted(
                    f"interrupted in stage {session.stage_name}, {session.fraction:.0%} done; {folder} holds the run"
                ) from None
            except RunFailed as error:
                with suppress(RunFailed):  # of a full disk, which is what the error is about
                    keeper.tell("failed", str(error))
                if session.simulation is not None and session.simulation.failure is not None:
                    session.save(folder / "checkpoint.npz.failed")
                    raise RunFailed(f"{error}; {folder / 'checkpoint.npz.failed'} holds the state") from None
                raise


class Keeper:
    """Writes a session down whenever it is due."""

    def __init__(self, session, folder, every):
        self.session, self.folder, self.every = session, folder, every
        software()  # asks git, which takes a while the first time: not when a signal wants the run saved
        self.written, self.cost = time.monotonic(), 0.0

    def hear(self, stop, listen):
        """Called between steps: stops if that is wanted, saves if it is due, and passes on."""
        if stop.is_set():
            raise KeyboardInterrupt
        session = self.session
        between_stages = session.begun is None  # what comes next may be long to compile, and cannot be left
        if between_stages or time.monotonic() - self.written >= max(self.every, self.cost / SHARE):
            self.save()
        if listen is not None:
            listen(session)

    def save(self):
        """Checkpoint, results, state."""
        begin = time.monotonic()
        self.session.save(self.folder / "checkpoint.npz")
        result = self.session.result()
        if result is not None:
            result.save(self.folder / "results.h5")
        self.tell("running")
        self.written = time.monotonic()
        self.cost = self.written - begin
        self.session.saving += self.cost

    def finish(self):
        """The Run, after everything is written and the older checkpoint is gone."""
        self.save()
        previous_of(self.folder / "checkpoint.npz").unlink(missing_ok=True)
        run = self.session.result()
        self.tell("finished", str(run.status))
        return run

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
    except TypeError:
        raise InputError(f"folder {folder!r} is no path") from None
    except OSError as error:
        raise InputError(f"{folder}: cannot be made ({error.strerror})") from None
    return folder


def clear(folder):
    """Removes what an earlier run has left, so that nothing of it can be taken for this one's."""
    for name in ("checkpoint.npz", "checkpoint.npz.previous", "checkpoint.npz.failed", "results.h5", "state.json"):
        (folder / name).unlink(missing_ok=True)


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

    Only the main thread hears signals; in another one nothing is changed.
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

    before = {number: signal.signal(number, note) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield stop
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
