"""Grains that overlap too much to start with are moved apart."""

import math
from dataclasses import replace

import numpy as np

from anisogran.dem.boundaries import Box, Open, Periodic, Ring
from anisogran.dem.fire import BALANCED, SEPARATE
from anisogran.dem.grains import Grains
from anisogran.dem.minimisation import INFLATION, Minimisation
from anisogran.dem.state import memory_order
from anisogran.dem.stepping import CELL_TOO_SMALL, DONE
from anisogran.outcome import InputError, RunFailed, checked

GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))
CAP = 0.01  # of the smallest radius: the longest way in one step


def relaxed(grains, boundary=None, *, overlap=0.01, iterations=50_000):
    """The same Grains moved apart until no two, and none and a wall, overlap by more than `overlap` of the smaller radius.

    The energy of the overlaps is minimised (fire.py); no grain moves more than 0.01 of the smallest radius in one of at most `iterations`
    steps. boundary: Open (default), Box, Ring or Periodic, with its walls where they are at the start. Driven grains stay, velocities and
    all else are kept, positions are not wrapped into a periodic cell. Grains that need no move come back as they are. Else each is
    first nudged by half a step, in a direction that only its index decides: coincident or aligned centres have no way to go of their own.
    Raises InputError for what cannot be relaxed, RunFailed naming the worst pair if they are too many for the room.
    """
    if not isinstance(grains, Grains):
        raise InputError(f"relaxed: grains = {grains!r} must be a dem.Grains record")
    boundary = Open() if boundary is None else boundary
    if not isinstance(boundary, (Open, Box, Ring, Periodic)):
        raise InputError(f"relaxed: boundary = {boundary!r} must be one of Open, Box, Ring, Periodic")
    enough = checked("relaxed", "overlap", overlap, at_least=0, at_most=0.2) - INFLATION
    longest = int(checked("relaxed", "iterations", iterations, at_least=1))
    movable = len(grains) - grains.driven
    cap = CAP * float(grains.radius.min())
    skin = 0.2 * float(grains.radius.mean())
    order = memory_order(grains.position, movable, 2 * float(grains.radius.max()) + skin)

    def minimisation(position):
        return Minimisation(position, grains.radius, boundary, order, skin, cap, grains.driven)

    start = minimisation(grains.position)
    if start.first_look() == CELL_TOO_SMALL:
        raise InputError(
            f"relaxed: the periodic cell of {boundary.width:g} x {boundary.height:g} m is narrower than four of the largest radii "
            f"{grains.radius.max():g} m and two skins of {skin:g} m: contacts would meet their own images"
        )
    if start.worst[2] <= enough:
        return grains
    angle = GOLDEN_ANGLE * np.arange(movable)
    position = grains.position.copy()
    position[:movable] += 0.5 * cap * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    run = minimisation(position)
    code = run.run(enough, 1e-4, longest)
    if code == SEPARATE:
        return replace(grains, position=run.position)
    i, j, deepest = run.worst
    other = f"grains {i} and {j} overlap" if j >= 0 else f"grain {i} and wall {-1 - j} overlap"
    why = {BALANCED: "they are too many for the room", DONE: f"not done after {longest} steps"}.get(
        code, "a position is not a finite number"
    )
    raise RunFailed(f"relaxed: {other} by {deepest:.2%} of the smaller radius, where at most {overlap:.2%} are wanted; {why}")
