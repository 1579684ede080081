"""Loose grains flying about, and the contact effects that the tests of the time loop use."""

import numpy as np

from anisogran.dem import Friction, Grains, Linear, Luding
from anisogran.dem.packing import random_positions, uniform_radii

LAW = Luding(5e4, 1e5, 2e4, 0.1)
FRICTION = Friction(2e4, 0.5)

K = 1e4
EVERY_LAW = {  # for the general tests; every kernel of every law
    "linear": Linear(K, 10.0),
    "luding": Luding(K / 2, K, K / 4, 10.0),
    "growing luding": Luding(K / 2, K, K / 4, 10.0, plastic_depth=0.01),  # elastic beyond an overlap of 0.02 size
}


def crowd(rng, count=60, fraction=0.5, size_ratio=3.0, origin=0.0):
    """A box of loose grains flying about: (Grains, side); `origin` = 0.5 puts the middle of the box at the origin."""
    radius = uniform_radii(count, 1e-3, size_ratio, rng)
    side = float(np.sqrt(np.sum(np.pi * radius**2) / fraction))

    def inside(points, r):
        return np.all((points > r) & (points < side - r), axis=1)

    position = random_positions(radius, lambda rng, n: rng.uniform(0, side, (n, 2)), inside, rng)
    return Grains(position - origin * side, radius, velocity=rng.normal(0, 0.3, (count, 2)), spin=rng.normal(0, 50, count)), side


def state(sim):
    """All that moves, as one array: two runs are equal if these are."""
    return np.concatenate([sim.position.ravel(), sim.velocity.ravel(), sim.spin, sim.net_force.ravel()])
