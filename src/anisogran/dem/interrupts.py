"""Ctrl-C between steps only: an interrupt is kept until the compiled call has come back and its result has been read."""

import signal
import threading
from contextlib import contextmanager


@contextmanager
def interrupts_deferred():
    """Within the block an interrupt (SIGINT) is only noted; it is passed on at the end of the block, unless that ends in an error.

    Only the main thread hears interrupts; in another one, or if there is no handler in Python, nothing is changed.
    """
    handler = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(handler):
        yield
        return
    heard = []
    signal.signal(signal.SIGINT, lambda *arguments: heard.append(arguments))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, handler)
    if heard:
        handler(*heard[0])
