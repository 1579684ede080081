"""Seconds of the processor, which other work on the machine disturbs less than seconds of the clock; every room computes on one core."""

import statistics
import time


def clocked(work):
    """(what the work gives, its seconds of the processor), done once as it is: what compiles must have been compiled."""
    clock = time.process_time()
    result = work()
    return result, time.process_time() - clock


def timed(work, repeats):
    """(what the work gives, the median of its seconds of the processor), after one run that may compile."""
    work()
    results, seconds = zip(*(clocked(work) for _ in range(repeats)), strict=True)
    return results[-1], statistics.median(seconds)
