"""Processes of this machine as an executor: one for each worker, so that one that dies takes only its own case with it."""

import multiprocessing
import os
import signal
import threading
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from multiprocessing import resource_tracker

from anisogran.outcome import RunFailed

_at_work = threading.Lock()  # in a worker: held while it computes


class LocalProcesses(Executor):
    """A concurrent.futures executor of `workers` spawned processes (a fork after the compiler's threads have started can hang).

    A ProcessPoolExecutor ends all its processes when one of them dies; here each worker is a pool of one, and is replaced.
    """

    def __init__(self, workers):
        resource_tracker.ensure_running()  # it would let Ctrl-C through to the thread that starts it, and so to its process
        self._threads = ThreadPoolExecutor(workers, initializer=_without_interrupts)  # each thread waits for one process
        self._own = threading.local()
        self._pools = {}  # by process id

    def submit(self, function, /, *arguments):
        """A future of function(*arguments); its exception is RunFailed if the process dies."""
        return self._threads.submit(self._run, function, arguments)

    def _run(self, function, arguments):
        """In a thread: runs the function in the process of this thread, a new one if it has none."""
        if not hasattr(self._own, "pool"):
            self._own.pool = ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn"), initializer=_begin)
        pool = self._own.pool
        try:
            process = pool.submit(os.getpid).result()
            self._pools[process] = pool
            return pool.submit(_work, function, arguments).result()
        except BrokenProcessPool:
            del self._own.pool
            for process in [process for process, other in list(self._pools.items()) if other is pool]:
                del self._pools[process]
            raise RunFailed("its process was killed; was it out of memory, or ended by hand?") from None

    def signal(self, number):
        """Sends a signal to the processes."""
        for process in list(self._pools):
            with suppress(ProcessLookupError):
                os.kill(process, number)

    def shutdown(self, wait=True, *, cancel_futures=False):
        """Ends the processes when they are done."""
        self._threads.shutdown(wait, cancel_futures=cancel_futures)
        for pool in self._pools.values():
            pool.shutdown(wait)


def _without_interrupts():
    """In a thread: it and the processes that it starts do not hear Ctrl-C, which is for the main thread; it tells them to stop."""
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})


def _begin():
    """In a worker: without its parent it has nothing to work for."""
    threading.Thread(target=_follow_parent, daemon=True).start()


def _follow_parent():
    multiprocessing.parent_process().join()
    os.kill(os.getpid(), signal.SIGTERM)  # what is at work saves itself
    with _at_work:
        os._exit(1)


def _work(function, arguments):
    with _at_work:
        return function(*arguments)
