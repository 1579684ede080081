"""The particle runs of the demo: the ring in one process, the biaxial box and the homogeneous shear tests in another."""

import multiprocessing
from concurrent.futures import ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool

from anisogran.experiments import SimpleShear
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
        futures = [pool.submit(_run_all, k, scenes, [estimate(scene).grain_steps for scene in scenes]) for k, scenes in enumerate(jobs)]
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


def demo_jobs(scene):
    """The experiments of the demo, as one list for each process: the ring; the biaxial box and the shear tests."""
    shear_tests = [
        SimpleShear(inertial_number=inertial, n=scene.shear_grains, strain=scene.shear_strain, seed=scene.seed)
        for inertial in scene.inertial_numbers
    ]
    return [[scene.ring.model_copy(update={"seed": scene.seed})], [scene.biaxial.model_copy(update={"seed": scene.seed}), *shear_tests]]
