"""The rooms of the cost tables, and how all of them are gone through."""

import multiprocessing
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool

from anisogran.cost.averages import averaging_cost
from anisogran.cost.curve_fits import fitting_cost
from anisogran.cost.grains import dem_cost
from anisogran.cost.point_laws import models_cost
from anisogran.cost.ring_flows import continuum_cost
from anisogran.cost.whole_way import whole_way_cost
from anisogran.outcome import RunFailed

LONGEST_FIRST = ("whole", "dem", "models", "continuum", "fitting", "averaging")  # in quick mode with a cold compile cache
ROOMS = {
    "dem": dem_cost,
    "averaging": averaging_cost,
    "models": models_cost,
    "fitting": fitting_cost,
    "continuum": continuum_cost,
    "whole": whole_way_cost,
}


def rows_of(room, quick=False):
    """The rows of a room, a list; KeyError if there is none of that name."""
    return ROOMS[room](quick)


def place(room):
    """Where a room stands in the queue of two processes: the longest come first, so that none is left alone at the end."""
    return LONGEST_FIRST.index(room) if room in LONGEST_FIRST else -1


def all_rows(quick=False):
    """Yields (room, rows) of all rooms in their order: one after the other, so that they do not disturb each other, or quick two at a time.

    Raises RunFailed if a process dies.
    """
    if not quick:
        yield from ((room, rows_of(room)) for room in ROOMS)
        return
    try:
        with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as pool:  # a fork of compiled threads can hang
            rows = {room: pool.submit(rows_of, room, True) for room in sorted(ROOMS, key=place)}
            yield from ((room, rows[room].result()) for room in ROOMS)
    except BrokenProcessPool:
        raise RunFailed("cost all: a process was killed; was it out of memory, or ended by hand?") from None
