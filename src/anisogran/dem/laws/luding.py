"""Luding's hysteretic contact: plastic loading k1, elastic un- and reloading k2, adhesive limit -kc.

With the largest overlap d_max: f = k1 d while loading; f = k2 (d - d_0) while un- or reloading, d_0 = (1 - k1/k2) d_max; f = -kc d at the
adhesive limit, met at d_min = (k2 - k1)/(k2 + kc) d_max. Unloading along the limit lowers d_max so that the reloading line passes through
where the contact is; without this the force would jump back to the old line and create energy.

With a plastic depth the stiffness grows with the damage done: k1 + (k2 - k1) d_max/d_p up to d_p = k2/(k2 - k1) depth size, where
size = 2 a1 a2/(a1 + a2); d_max is not remembered beyond d_p, so that a deeper contact loads and unloads elastically on the line of k2.
Luding, Granular Matter 10, 235 (2008); Singh, Magnanimo & Luding (2013) for the lowering of d_max, here for the growing stiffness too.
"""

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

from anisogran.keys import check_keys, key
from anisogran.outcome import checked


class LudingParameters(NamedTuple):
    """What the kernel is compiled for; `reset` = (k2 + kc)/(k2 - k1)."""

    k1: float
    k2: float
    kc: float
    damping: float
    reset: float


class GrowingLudingParameters(NamedTuple):
    """What the kernel is compiled for where the stiffness grows; lengths as shares of the size of the contact."""

    k1: float
    kc: float
    damping: float
    plastic: float  # d_p/size, beyond which the contact is elastic
    growth: float  # N/m: size times the growth of stiffness with d_max
    reset: float  # 4 (k1 + kc)/growth


@dataclass(frozen=True)
class Luding:
    """Hysteretic normal contact: 0 < k1 <= k2 and kc >= 0 in N/m, damping >= 0 in kg/s. Raises InputError for values out of bounds.

    plastic_depth > 0: the overlap at zero force, as a share of the harmonic mean of the radii, of a contact that has just reached its
    limit stiffness k2, to which the unloading stiffness grows from k1. None: the unloading stiffness is k2 from the beginning.
    """

    k1: float = key("N/m", "stiffness of first loading", above=0, example=5e4)
    k2: float = key("N/m", "stiffness of un- and reloading, at least k1", above=0, example=1e5)
    kc: float = key("N/m", "slope of the adhesive limit; 0: no cohesion", 0.0, at_least=0)
    damping: float = key("kg/s", "normal force per speed of approach", 0.0, at_least=0)
    plastic_depth: float | None = key(
        "1", "overlap at zero force over the mean radius at which unloading, as stiff as k1 at first, has become as stiff as k2", None,
        above=0, example=0.05,
    )  # fmt: skip
    remembers: ClassVar[bool] = True  # the law needs the largest overlap of each contact

    def __post_init__(self):
        check_keys(self)
        checked("Luding", "k2", self.k2, at_least=self.k1, unit="N/m (= k1)")

    @property
    def sees_size(self):
        """Whether the law needs the radii of a pair."""
        return self.plastic_depth is not None

    @property
    def stiffest(self):
        """The largest stiffness of any branch in N/m; it sets the time step."""
        return float(max(self.k2, self.kc))

    def parameters(self):
        """The floats for the kernel. With k1 = k2 there is no plastic branch, and no stiffness that could grow."""
        k1, k2, kc, damping = float(self.k1), float(self.k2), float(self.kc), float(self.damping)
        if k2 == k1:
            return LudingParameters(k1, k2, kc, damping, 0.0)  # the limit is never met on unloading
        if self.plastic_depth is None:
            return LudingParameters(k1, k2, kc, damping, (k2 + kc) / (k2 - k1))
        plastic = k2 / (k2 - k1) * float(self.plastic_depth)
        growth = (k2 - k1) / plastic
        return GrowingLudingParameters(k1, kc, damping, plastic, growth, 4.0 * (k1 + kc) / growth)


def force(law, overlap, rate, largest, size):
    """Normal force (repulsion positive), the force that bounds friction, and the new largest overlap.

    `rate` is the speed of separation. The Coulomb reference is the normal force measured from the adhesive limit, dashpot included,
    so that a contact under tension still has friction.
    """
    largest = max(largest, overlap)
    limit = -law.kc * overlap
    elastic = law.k2 * overlap - (law.k2 - law.k1) * largest
    largest = law.reset * overlap if elastic < limit else largest
    total = max(elastic, limit) - law.damping * rate
    return total, abs(total - limit), largest


def growing_force(law, overlap, rate, largest, size):
    """As `force`, with a stiffness of un- and reloading that grows with the largest overlap.

    At the adhesive limit the new largest overlap m solves k(m) d - (k(m) - k1) m = -kc d with k(m) = k1 + g m, a quadratic equation; it
    is below d_p by itself, since at d_p the limit is met at just d_min. Open pairs come here too: no root of a negative number.
    """
    slope = law.growth / size
    largest = min(max(largest, overlap), law.plastic * size)
    limit = -law.kc * overlap
    elastic = (law.k1 + slope * largest) * overlap - slope * largest * largest
    closed = max(overlap, 0.0)
    lowered = 0.5 * (closed + math.sqrt(closed * (closed + law.reset * size)))
    largest = lowered if elastic < limit else largest
    total = max(elastic, limit) - law.damping * rate
    return total, abs(total - limit), largest


def reloading_line(law, largest, size):
    """The line of un- and reloading: its stiffness in N/m, overlap d_0 of zero force, and overlap d_min where it meets the limit."""
    return law.k2, (1.0 - law.k1 / law.k2) * largest, (law.k2 - law.k1) / (law.k2 + law.kc) * largest


def growing_reloading_line(law, largest, size):
    """As `reloading_line`, with the stiffness that has grown up to `largest`."""
    remembered = min(largest, law.plastic * size)
    grown = law.growth / size * remembered
    k2 = law.k1 + grown
    return k2, grown / k2 * remembered, grown / (k2 + law.kc) * remembered


def stored_energy(law, overlap, largest, size):
    """Energy in J that a closed contact can give back along its un- and reloading line, in compression or tension.

    `largest` is what the force has left. The rest of the work, along the loading branch and the adhesive limit, is lost.
    """
    elastic = law.k2 * overlap - (law.k2 - law.k1) * largest
    return 0.5 * elastic * elastic / law.k2


def growing_stored_energy(law, overlap, largest, size):
    """As `stored_energy`, with the stiffness that has grown up to `largest`."""
    slope = law.growth / size
    k2 = law.k1 + slope * largest
    elastic = k2 * overlap - slope * largest * largest
    return 0.5 * elastic * elastic / k2
