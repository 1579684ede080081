"""Luding's hysteretic contact: plastic loading k1, elastic un- and reloading k2, adhesive limit -kc.

With the largest overlap d_max: f = k1 d while loading; f = k2 (d - d_0) while un- or reloading, d_0 = (1 - k1/k2) d_max; f = -kc d at the
adhesive limit, met at d_min = (k2 - k1)/(k2 + kc) d_max. Unloading along the limit lowers d_max to d (k2 + kc)/(k2 - k1), so that a
reloading starts from where the contact is; without this the force would jump back to the old branch and create energy.
Luding, Granular Matter 10, 235 (2008); Singh, Magnanimo & Luding (2013) for the lowering of d_max.
"""

from dataclasses import dataclass
from typing import ClassVar, NamedTuple

from anisogran.outcome import checked


class LudingParameters(NamedTuple):
    """What the kernel is compiled for; `reset` = (k2 + kc)/(k2 - k1)."""

    k1: float
    k2: float
    kc: float
    damping: float
    reset: float


@dataclass(frozen=True)
class Luding:
    """Hysteretic normal contact: 0 < k1 <= k2 and kc >= 0 in N/m, damping >= 0 in kg/s. Raises InputError for values out of bounds."""

    k1: float
    k2: float
    kc: float = 0.0
    damping: float = 0.0
    remembers: ClassVar[bool] = True  # the law needs the largest overlap of each contact

    def __post_init__(self):
        checked("Luding", "k1", self.k1, above=0, unit="N/m")
        checked("Luding", "k2", self.k2, at_least=self.k1, unit="N/m (= k1)")
        checked("Luding", "kc", self.kc, at_least=0, unit="N/m")
        checked("Luding", "damping", self.damping, at_least=0, unit="kg/s")

    @property
    def stiffest(self):
        """The largest stiffness of any branch in N/m; it sets the time step."""
        return float(max(self.k2, self.kc))

    def parameters(self):
        """The floats for the kernel."""
        k1, k2, kc = float(self.k1), float(self.k2), float(self.kc)
        # with k1 = k2 there is no plastic branch: the limit is never met on unloading, and the factor is never used
        reset = (k2 + kc) / (k2 - k1) if k2 > k1 else 0.0
        return LudingParameters(k1, k2, kc, float(self.damping), reset)


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


def stored_energy(law, overlap, largest, size):
    """Energy in J that a closed contact can give back along its un- and reloading line, in compression or tension.

    `largest` is what the force has left. The rest of the work, along the loading branch and the adhesive limit, is lost.
    """
    elastic = law.k2 * overlap - (law.k2 - law.k1) * largest
    return 0.5 * elastic * elastic / law.k2
