"""The processes of the demo."""

import multiprocessing
import signal
from concurrent.futures import ProcessPoolExecutor

import pytest

from anisogran.cost.main_job import MainJob
from anisogran.demo.grains import shared_out, without_interrupts
from anisogran.runs.estimates import estimate


@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="this system has no masks of signals")
def test_workers_do_not_hear_an_interrupt_and_their_parent_does():
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        with without_interrupts():
            mask = pool.submit(signal.pthread_sigmask, signal.SIG_BLOCK, ())
        assert signal.SIGINT in mask.result()
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, ())


def test_two_processes_share_the_work():
    experiments = MainJob(boxes=3).experiments()
    jobs = shared_out(experiments)
    assert sorted(repr(one) for job in jobs for one in job) == sorted(map(repr, experiments))
    work = [sum(estimate(one).grain_steps for one in job) for job in jobs]
    assert max(work) < 1.3 * min(work)


def test_boxes_have_seeds_of_their_own():
    assert [one.seed for one in MainJob(seed=5, boxes=3).experiments() if one.kind == "biaxial"] == [5, 6, 7]
