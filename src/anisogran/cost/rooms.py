"""The rooms of the cost tables, and how all of them are gone through."""

import multiprocessing
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool

from anisogran.cost.averages import averaging_cost
from anisogran.cost.curve_fits import fitting_cost
from anisogran.cost.grains import dem_cost
from anisogran.cost.point_laws import models_cost
from anisogran.cost.ring_flows import continuum_cost
from anisogran.outcome import RunFailed

ROOMS = {"dem": dem_cost, "averaging": averaging_cost, "models": models_cost, "fitting": fitting_cost, "continuum": continuum_cost}


def rows_of(room, quick=False):
    """The rows of a room, a list; KeyError if there is none of that name."""
    return ROOMS[room](quick)


def all_rows(quick=False):
    """Yields (room, rows) of all rooms in their order: one after the other, so that they do not disturb each other, or quick in pairs.

    Raises RunFailed if a process dies.
    """
    if not quick:
        yield from ((room, rows_of(room)) for room in ROOMS)
        return
    try:
        with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as pool:  # a fork of compiled threads can hang
            yield from zip(ROOMS, pool.map(rows_of, ROOMS, [True] * len(ROOMS)), strict=True)
    except BrokenProcessPool:
        raise RunFailed("cost all: a process was killed; was it out of memory, or ended by hand?") from None
