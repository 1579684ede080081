"""A minimisation of overlaps from the outside: set up, run in short compiled calls, read out."""

import time

import numpy as np

from anisogran.dem.boundaries import lattice
from anisogran.dem.fire import DEEPEST, DUE, FIRST_MIX, FIRST_STEP, LOOK_EVERY, PAIRS, STEPS, Progress, look, minimise, new_list
from anisogran.dem.grains import Grains
from anisogran.dem.neighbours import empty_pair_list
from anisogran.dem.pairs import scratch
from anisogran.dem.rows import RADIUS, grain_rows
from anisogran.dem.stepping import CELL_TOO_SMALL, DONE, LIST_FULL, body_of

INFLATION = 1e-6  # discs are first moved apart a little larger than they are, so that "no overlap" is reached, not only approached


class Minimisation:
    """Discs on their way to mechanical equilibrium, or until they no longer overlap.

    boundary: any; walls stay where they begin. `cap` is the longest way of a disc in one step, in m; `order`: in which the discs are kept.
    Positions are not wrapped.
    """

    def __init__(self, position, radius, boundary, order, skin, cap, driven=0):
        mean = float(radius.mean())
        inertia = (radius + mean) / (2.0 * mean)
        self._radius, self._order = radius[order], order
        inflated = Grains(position, radius * (1.0 + INFLATION), mass=inertia, driven=driven)
        self._body = body_of(grain_rows(inflated, order))
        self._movable = len(radius) - driven
        self._boundary, self._walls = boundary.state(), boundary.walls or None
        self._box = getattr(self._boundary, "lattice", None)
        self._skin, self._cap, self._pressure = skin, cap, 0.0
        self._pairs = empty_pair_list(len(radius), 6 * len(radius) + 64)
        self._out = scratch(virial=True, whole=False)
        # a breath lasts about as long as that of a disc: two contacts a disc are stretched by its diameter
        breath = 2.0 * float(np.sum((2.0 * radius) ** 2))
        self.progress = Progress(
            np.array([FIRST_STEP, FIRST_MIX, 0.0, breath, 1.0]), np.array([0, 0, 1, 0, 0]), np.zeros(2, np.int64), np.zeros(5), np.zeros(2)
        )

    def press(self, pressure):
        """From here the periodic cell breathes until it bears this pressure (by k)."""
        self._pressure = pressure

    def deflate(self):
        """From here the discs are as large as they are."""
        self._body.rows[:, RADIUS] = self._radius
        self.progress.count[DUE] = 1  # the list knows the old sums of radii

    def first_look(self):
        """Finds the worst overlap without moving or pushing anything; DONE or CELL_TOO_SMALL."""
        cell = lattice(self._boundary)
        while (found := new_list(self._body, cell, self._movable, self._skin, self._pairs)) > self._pairs.first.size:
            self._pairs = empty_pair_list(len(self._radius), found)
        if found < 0:
            return CELL_TOO_SMALL
        look(self._body, self._radius, self._boundary, cell, self._walls, self._pairs, self._movable, self.progress)
        return DONE

    def run(self, enough, balance, longest):
        """Until SEPARATE, BALANCED or what is wrong; DONE after `longest` steps in all. An interrupt is heard about twice a second."""
        chunk, code = LOOK_EVERY, DONE
        while code == DONE and (begin := self.progress.count[STEPS]) < longest:
            clock = time.perf_counter()
            code = minimise(
                self._body, self._radius, self._boundary, self._box, self._walls, self._pairs, self._movable, self._skin, self._cap,
                self._pressure, enough, balance, self._out, self.progress, min(chunk, longest - begin),
            )  # fmt: skip
            if code == LIST_FULL:
                self._pairs = empty_pair_list(len(self._radius), int(1.25 * self.progress.count[PAIRS]) + 64)
                code = DONE
            seconds = time.perf_counter() - clock
            chunk = max(1, min(2 * chunk, int(chunk * 0.4 / seconds)))
        return code

    @property
    def cell(self):
        """Width and height of the periodic cell in m."""
        return self._box[:2].copy()

    @property
    def position(self):
        """(N, 2) in m, in the order they came."""
        position = np.empty((len(self._order), 2))
        position[self._order] = self._body.rows[:, :2]
        return position

    @property
    def worst(self):
        """The pair that overlaps most, as the user numbers the discs (a wall is -1 - wall), and its overlap by the smaller radius."""
        i, j = (int(k) for k in self.progress.worst)
        return int(self._order[i]), int(self._order[j]) if j >= 0 else j, float(self.progress.reached[DEEPEST])
