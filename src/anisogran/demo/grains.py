"""The particle runs of the demo in two processes: the ring, one or more biaxial boxes, and the homogeneous shear tests."""

import multiprocessing
import signal
from collections import Counter
from concurrent.futures import ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import resource_tracker

from anisogran.outcome import RunFailed
from anisogran.runs.estimates import estimate

_shares = None  # in a worker: progress of each job between 0 and 1, shared with the parent


def _adopt(shares):
    global _shares
    _shares = shares


def _report_to(job, begin, end):
    """A progress listener for a run that covers `begin`..`end` of its job."""

    def listen(fraction):
        _shares[job] = begin + (end - begin) * fraction

    return listen


def _run_all(job, scenes, costs):
    """Runs the scenes of one job one after another; `costs` are their expected shares of its time."""
    runs, done = [], 0.0
    for scene, cost in zip(scenes, costs, strict=True):
        share = cost / sum(costs)
        runs.append(scene.run(progress=_report_to(job, done, done + share)))
        done += share
    return runs


@contextmanager
def without_interrupts():
    """Processes started within the block do not hear Ctrl-C, which a terminal sends to all: it is for their parent, which ends them."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # it would let Ctrl-C through to the processes that are started beside it
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def run_grains(jobs, progress):
    """The Runs of all jobs (lists of experiments), each job in a process of its own.

    `progress(fractions)` is called several times a second.

    Workers are spawned, not forked, since a fork after the compiler's threads have started can hang. An exception of a worker comes
    out here, and ends the others.
    """
    context = multiprocessing.get_context("spawn")
    others = set(multiprocessing.active_children())
    shares = context.Array("d", len(jobs), lock=False)
    with ProcessPoolExecutor(len(jobs), mp_context=context, initializer=_adopt, initargs=(shares,)) as pool:
        costs = [[estimate(scene).grain_steps for scene in scenes] for scenes in jobs]
        with without_interrupts():
            futures = [pool.submit(_run_all, k, *job) for k, job in enumerate(zip(jobs, costs, strict=True))]
        try:
            pending = futures
            while pending:
                progress(list(shares))
                finished, pending = wait(pending, timeout=0.2, return_when="FIRST_EXCEPTION")
                for future in finished:
                    future.result()
        except BaseException as error:
            for worker in set(multiprocessing.active_children()) - others:
                worker.terminate()
            if isinstance(error, BrokenProcessPool):
                raise RunFailed("a worker process died; was it out of memory, or ended by hand?") from None
            raise
    return [future.result() for future in futures]


def shared_out(experiments, workers=2):
    """The experiments in lists for so many processes, about equally long."""
    jobs, work = [[] for _ in range(workers)], [0.0] * workers
    for experiment in experiments:
        least = work.index(min(work))
        jobs[least].append(experiment)
        work[least] += estimate(experiment).grain_steps
    return jobs


NAMES = {"ring_shear": "ring shear cell", "biaxial": "biaxial box", "simple_shear": "shear test"}


def told(run):
    """A run in a few words."""
    scene = run.scene
    details = {"biaxial": f", seed {scene.seed}", "simple_shear": f", I = {getattr(scene, 'inertial_number', None) or 0:g}"}
    return NAMES[scene.kind] + details.get(scene.kind, "")


def described(job):
    """A job in a few words, such as "ring shear cell, 2 biaxial boxes"."""
    counts = Counter(NAMES[experiment.kind] for experiment in job)
    return ", ".join(name if count == 1 else f"{count} {name}{'es' if name.endswith('x') else 's'}" for name, count in counts.items())


def of_kind(runs, kind):
    """Those of a kind, in the order of their seeds and inertial numbers."""
    found = [run for run in runs if run.scene.kind == kind]
    return sorted(found, key=lambda run: (run.scene.seed, getattr(run.scene, "inertial_number", 0.0)))
