"""A loose random start: discs dropped one after another where there is room (random sequential addition).

Every trial is compared with all discs placed so far, so the work grows with the square of their number: 0.1 s for 1,000 discs. That is
enough for a start that is compressed afterwards, and it cannot go beyond an area fraction of about one half.
"""

import numpy as np

from anisogran.outcome import InputError


def uniform_radii(count, mean, ratio, rng):
    """`count` radii uniform between mean * 2/(1 + ratio) and `ratio` times that, so that their mean is `mean`; shape (count,)."""
    smallest = 2.0 * mean / (1.0 + ratio)
    return rng.uniform(smallest, ratio * smallest, count)


def random_positions(radius, sample, clearance, rng, taken=(), taken_radius=(), period=None):
    """Positions (N, 2) of discs that do not overlap, nor touch the discs already `taken` (M, 2).

    sample(rng, count) draws points (count, 2) of the region; clearance(points, radius) says which of them, (count,) bool, keep a disc of
    that radius inside it. `period` = (width, height) wraps around a rectangle. The largest discs are placed first; the order of
    `radius` is kept. Raises InputError if there is no room.
    """
    placed = np.empty((len(radius) + len(taken), 2))
    sizes = np.empty(len(placed))
    used = len(taken)
    if used:
        placed[:used], sizes[:used] = taken, taken_radius
    position = np.empty((len(radius), 2))
    for i in np.argsort(-np.asarray(radius), kind="stable"):
        for _ in range(1000):
            trial = sample(rng, 20)
            apart = trial[:, None, :] - placed[None, :used]
            if period is not None:
                apart -= np.rint(apart / period) * period
            free = np.all(np.einsum("tpd,tpd->tp", apart, apart) > (sizes[:used] + radius[i]) ** 2, axis=1)
            free &= clearance(trial, radius[i])
            if free.any():
                position[i] = trial[np.argmax(free)]
                break
        else:
            raise InputError(f"random start: no room for grain {i} of {len(radius)} after 20,000 trials; try another seed, or more grains")
        placed[used], sizes[used] = position[i], radius[i]
        used += 1
    return position
