"""Dense random packings of discs in a periodic rectangle, of any number of discs: random points, then the least energy of their overlaps.

This is the athermal quench of O'Hern et al. (Phys. Rev. E 68, 011306, 2003) with frictionless linear springs. At an area fraction below
jamming (about 0.84) it ends without overlaps, above it in mechanical equilibrium; under a prescribed pressure the rectangle breathes too.
"""

import math
from dataclasses import dataclass

import numpy as np

from anisogran.dem.boundaries import Periodic
from anisogran.dem.fire import BALANCED, CONTACTS, MEAN_OVERLAP, PRESSURE, SEPARATE, STEPS, UNBALANCED
from anisogran.dem.minimisation import INFLATION, Minimisation
from anisogran.dem.random_start import random_positions, uniform_radii
from anisogran.dem.state import memory_order
from anisogran.dem.stepping import CELL_TOO_SMALL, DONE
from anisogran.outcome import InputError, RunFailed, checked

__all__ = ["Packing", "dense_packing", "random_positions", "uniform_radii"]

SKIN, THINNEST_SKIN = 0.4, 0.05  # of the mean radius; the reserve of the neighbour list shrinks where few discs leave little room
CAP = 0.1  # of the mean radius: the longest way in one step
JAMMING, SOFTENING = 0.842, 3.0  # area fraction = JAMMING + SOFTENING pressure/stiffness, measured: where the search for a pressure begins


@dataclass(frozen=True, eq=False)
class Packing:
    """A packing in a periodic rectangle: position (N, 2) and radius (N,) in m, centres in 0 <= x < width, 0 <= y < height (m).

    pressure: half the trace of the stress, in N/m, compression positive; mean_contacts: of a disc, those without contact included;
    mean_overlap in m; unbalanced_force: mean net force on a disc by mean contact force. All of these are 0 without contacts.
    """

    position: np.ndarray
    radius: np.ndarray
    width: float
    height: float
    area_fraction: float
    pressure: float
    mean_contacts: float
    mean_overlap: float
    unbalanced_force: float
    iterations: int


def dense_packing(
    radius, area_fraction=None, pressure=None, stiffness=1e5, aspect=1.0, seed=0, *, unbalanced_force=1e-3, iterations=100_000
):  # fmt: skip
    """A Packing of discs of these radii (N,), in m, at an area fraction (exactly) or under a pressure in N/m (to `unbalanced_force`).

    Frictionless linear springs of `stiffness` (N/m); width = `aspect` times height; the same seed gives the same bits on the same
    machine. It ends when the mean net force is less than `unbalanced_force` of the mean contact force, or no two discs overlap.
    Raises InputError for what cannot be packed, RunFailed ("no equilibrium ...") after `iterations` steps, as happens next to jamming.
    """
    radius = _radii(radius)
    width, height = _start_cell(radius, area_fraction, pressure, stiffness, aspect)
    balance = checked("dense_packing", "unbalanced_force", unbalanced_force, above=0, at_most=0.1)
    longest = int(checked("dense_packing", "iterations", iterations, at_least=1))
    seed = checked("dense_packing", "seed", seed, at_least=0)
    mean, largest = float(radius.mean()), float(radius.max()) * (1.0 + INFLATION)
    skin = min(SKIN * mean, 0.99 * (0.5 * min(width, height) - 2.0 * largest))
    if skin < THINNEST_SKIN * mean:
        raise InputError(
            f"dense_packing: {len(radius)} discs fill a cell of {width:.3g} x {height:.3g} m; it must be wider and higher than four of the "
            f"largest radius {radius.max():.3g} m, or a disc would meet images of its neighbours: more discs, or fewer to the area"
        )
    start = np.random.default_rng(int(seed)).uniform(0.0, 1.0, (len(radius), 2)) * (width, height)
    run = Minimisation(start, radius, Periodic(width, height), memory_order(start, len(radius), 2 * mean + skin), skin, CAP * mean)
    if len(radius) == 1:  # nothing to be compiled for a single disc
        code = SEPARATE
    elif pressure is None:
        code = run.run(-INFLATION, balance, longest)
    else:
        code = run.run(-INFLATION, 10 * balance, longest)  # first the bulk of the overlaps, in a cell of nearly the right size
        run.press(pressure / stiffness)
        code = run.run(-INFLATION, balance, longest) if code in (BALANCED, SEPARATE) else code
    if code == BALANCED:
        run.deflate()
        code = run.run(-INFLATION, balance, longest)
    reached = run.progress.reached
    if code not in (BALANCED, SEPARATE):
        raise RunFailed(
            f"dense_packing: no equilibrium after {run.progress.count[STEPS]} iterations: "
            f"{FAILURES.get(code, 'a position is not finite')}; mean net force is {reached[UNBALANCED]:.2g} "
            f"of the mean contact force (wanted < {balance:g}), pressure {stiffness * reached[PRESSURE]:.3g} N/m"
        )
    return _record(radius, run, stiffness, touching=code == BALANCED)


FAILURES = {DONE: "too few, or too close to jamming", CELL_TOO_SMALL: "the cell shrank below four of the largest radii and two skins"}


def _record(radius, run, stiffness, touching):
    """What the minimisation reached; without overlaps there is no force, though the inflated discs may touch."""
    width, height = (float(side) for side in run.cell)
    position = np.mod(run.position, (width, height))
    position[position >= (width, height)] = 0.0  # the remainder of a tiny negative number is rounded to the side itself
    reached = run.progress.reached if touching else np.zeros(5)
    return Packing(
        position, radius, width, height, float(np.pi * np.sum(radius**2)) / (width * height), stiffness * float(reached[PRESSURE]),
        2.0 * float(reached[CONTACTS]) / len(radius), float(reached[MEAN_OVERLAP]), float(reached[UNBALANCED]),
        int(run.progress.count[STEPS]),
    )  # fmt: skip


def _radii(radius):
    """The radii as a fresh array (N,)."""
    try:
        radius = np.array(radius, float)
    except (TypeError, ValueError):
        raise InputError(f"dense_packing: radius = {radius!r} is no array of numbers") from None
    if radius.ndim != 1 or radius.size == 0:
        raise InputError(f"dense_packing: radius has shape {radius.shape}; it must be (N,) with N > 0")
    bad = np.flatnonzero(~(np.isfinite(radius) & (radius > 0)))
    if bad.size:
        raise InputError(f"dense_packing: radius[{bad[0]}] = {radius[bad[0]]:g} must be a finite number above 0")
    return radius


def _start_cell(radius, area_fraction, pressure, stiffness, aspect):
    """Width and height: of the area fraction, or of the one that about bears the pressure."""
    if (area_fraction is None) == (pressure is None):
        raise InputError(f"dense_packing: area_fraction = {area_fraction} and pressure = {pressure}: exactly one of them must be given")
    stiffness = checked("dense_packing", "stiffness", stiffness, above=0, unit="N/m")
    aspect = checked("dense_packing", "aspect", aspect, above=0)
    if pressure is None:
        fraction = checked("dense_packing", "area_fraction", area_fraction, above=0, at_most=1.2)
    else:
        fraction = (
            JAMMING + SOFTENING * checked("dense_packing", "pressure", pressure, above=0, at_most=0.1 * stiffness, unit="N/m") / stiffness
        )
    height = math.sqrt(float(np.pi * np.sum(radius**2)) / fraction / aspect)
    return aspect * height, height
