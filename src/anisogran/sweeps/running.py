"""Sweeps: one scene with other values, one folder a case, on any executor; what is done is done, and what was stopped goes on."""

import os
import signal
import time
from concurrent.futures import wait
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from anisogran.experiments.scene_file import read_scene
from anisogran.outcome import InputError, Interrupted, RunFailed, checked
from anisogran.runs.estimates import SHARE, estimate, free_memory
from anisogran.runs.folder import made_folder, run_in_folder
from anisogran.runs.lock import is_locked, locked
from anisogran.sweeps.cases import case_scenes
from anisogran.sweeps.folder import check_sweep_folder, fraction_of, taken_up
from anisogran.sweeps.processes import LocalProcesses

GO = "go"  # the file that is there while cases are to run
GRACE = 2.0  # s, for cases to see that they are to stop
PATIENCE = 30.0  # s, for cases on other machines to save themselves
TOLD = 3  # failures in a message


class Progress(NamedTuple):
    """How far a sweep is: its cases, those finished and failed, and the fraction of its work."""

    cases: int
    finished: int
    failed: int
    fraction: float


def sweep(scene, vary, folder, *, executor=None, workers=None, retry=False, listen=None):
    """Runs the scene with all combinations of the values {key: values}, such as {"contact.kc": [0, 5e4], "seed": range(1, 7)}, in a folder.

    Each case is a run in a folder of its own. In a folder that holds this sweep, only cases that are not finished are run, from their
    checkpoints; failed ones with `retry`. Values may have been added. `executor`: any of concurrent.futures whose workers see the folder
    and have anisogran; default: `workers` processes of this machine, as many as it has cores; a script that is run must then keep its own
    calls under `if __name__ == "__main__"`. `listen(Progress)` is called several times a second.

    Returns the states of the cases (see `sweep_status`), all finished. Raises InputError before any case runs if a value, a combination
    or the folder cannot be used; RunFailed, naming them, if cases have failed, after the others are done; Interrupted at Ctrl-C: cases at
    work have then saved themselves, and the same call goes on.
    """
    check_workers(workers, [] if executor else case_scenes(scene, vary)[1].values())
    check_sweep_folder(folder)
    folder = made_folder(folder)
    with locked(folder):
        there = taken_up(folder, scene, vary)
        states = there.states()
        waiting = [one["case"] for one in states if one["state"] != "finished" and (retry or one["state"] != "failed")]
        told = {}
        if waiting:
            with _executor(executor, min(workers or cores(), len(waiting))) as pool:
                told = _run_cases(there, waiting, pool, listen)
        states = there.states()
    return _all_finished(folder, states, told)


def run_case(folder):
    """Runs the case in a folder, from its checkpoint if there is one: (how it ended, a message). It stops when the sweep does."""
    folder = Path(folder)
    go = folder.parent / GO

    def stop_if_told(session):
        if not go.exists():
            raise KeyboardInterrupt

    if not go.exists():
        return "interrupted", "not begun"
    try:
        run = run_in_folder(read_scene(folder / "scene.toml"), folder, resume=True, listen=stop_if_told)
        return "finished", str(run.status)
    except Interrupted as stopped:
        return "interrupted", str(stopped)
    except (RunFailed, InputError) as error:
        return "failed", str(error)


def _run_cases(there, waiting, pool, listen):
    """Runs the waiting cases; what those that did not finish told, by name."""
    folder, futures = there.path.resolve(), {}
    go, count, before = folder / GO, len(there.cases), len(there.cases) - len(waiting)
    go.touch()
    try:
        for name in waiting:
            futures[name] = pool.submit(run_case, str(folder / name))
        pending = set(futures.values())
        while pending:
            _, pending = wait(pending, timeout=0.2, return_when="FIRST_COMPLETED")
            if listen is not None:
                failed = sum(_told(future)[0] != "finished" for future in futures.values() if future.done())
                finished = before + len(futures) - len(pending) - failed
                parts = sum(fraction_of(folder / name) for name, future in futures.items() if not future.done())
                listen(Progress(count, finished, failed, (count - len(pending) + parts) / count))
    except BaseException as error:
        go.unlink(missing_ok=True)
        _stop(futures, pool, folder)
        if not isinstance(error, KeyboardInterrupt):
            raise
        finished = sum(one["state"] == "finished" for one in there.states())
        raise Interrupted(f"interrupted: {finished} of {count} cases are finished; {there.path} holds the sweep, which can go on") from None
    finally:
        go.unlink(missing_ok=True)
    return {name: told[1] for name, told in ((name, _told(future)) for name, future in futures.items()) if told[0] != "finished"}


def _stop(futures, pool, folder):
    """Lets the cases at work save themselves; a second interrupt ends them at once, if they are processes of ours."""
    for future in futures.values():
        future.cancel()
    ours = isinstance(pool, LocalProcesses)
    try:
        begun = [future for future in futures.values() if not future.cancelled()]
        if wait(begun, timeout=GRACE).not_done and ours and os.name == "posix":
            pool.signal(signal.SIGTERM)  # heard while a stage is compiled too
        wait(begun)
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end and any(is_locked(folder / name) for name in futures):
            time.sleep(0.1)
    except KeyboardInterrupt:
        if ours and os.name == "posix":
            pool.signal(signal.SIGKILL)


def _told(future):
    """(how a case ended, message) of a future that is done."""
    if future.cancelled():
        return "interrupted", "not begun"
    error = future.exception()
    if error is None:
        return future.result()
    return "failed", str(error) if isinstance(error, RunFailed) else f"{type(error).__name__}: {error}"


@contextmanager
def _executor(executor, workers):
    """The executor of the user, or one of our own for the time of the block."""
    if executor is not None:
        yield executor
        return
    with LocalProcesses(workers) as pool:
        yield pool


def _all_finished(folder, states, told):
    """The states, if all are finished; else raises RunFailed."""
    unfinished = [one for one in states if one["state"] != "finished"]
    if not unfinished:
        return states
    reasons = [f"{one['case']}: {one['state']}, {told.get(one['case']) or one['message']}".rstrip(", ") for one in unfinished]
    more = [f"and {len(reasons) - TOLD} more, see the status of the sweep"] if len(reasons) > TOLD else []
    retry = " (failed ones are run again with retry)" if any(one["state"] == "failed" for one in unfinished) else ""
    raise RunFailed(f"{folder}: {len(unfinished)} of {len(states)} cases are not finished{retry}: {'; '.join([*reasons[:TOLD], *more])}")


def check_workers(workers, scenes):
    """Raises InputError if that many (None: all cores) are not possible, or have not the memory for these scenes at once."""
    if workers is not None:
        checked("sweep", "workers", workers, at_least=1, at_most=1024)
        if int(workers) != workers:
            raise InputError(f"sweep: workers = {workers} is not a whole number")
    free = free_memory()
    needed = sorted((estimate(scene).memory for scene in scenes), reverse=True)[: workers or cores()]
    if free is not None and sum(needed) > SHARE * free:
        raise InputError(
            f"sweep: workers = {len(needed)} take about {sum(needed) / 1e9:.1f} GB of memory, "
            f"more than {SHARE:.0%} of the {free / 1e9:.1f} GB that are free"
        )


def cores():
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
