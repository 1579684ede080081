"""Linear spring and dashpot: the normal force k overlap - g rate (Cundall & Strack, Geotechnique 29, 47, 1979)."""

from dataclasses import dataclass
from typing import ClassVar, NamedTuple

from anisogran.keys import check_keys, key


class LinearParameters(NamedTuple):
    """What the kernel is compiled for."""

    stiffness: float
    damping: float


@dataclass(frozen=True)
class Linear:
    """Linear normal contact: stiffness > 0 in N/m, damping >= 0 in kg/s. Raises InputError for values out of bounds.

    The dashpot acts as long as the overlap is positive and may pull at the end, so that the restitution coefficient has its closed
    form exp(-damping t_c / (2 m12)).
    """

    stiffness: float = key("N/m", "stiffness of the spring", above=0, example=1e5)
    damping: float = key("kg/s", "normal force per speed of approach", 0.0, at_least=0)
    remembers: ClassVar[bool] = False  # the law needs no largest overlap
    sees_size: ClassVar[bool] = False  # nor the radii of a pair

    def __post_init__(self):
        check_keys(self)

    @property
    def stiffest(self):
        """The largest stiffness of any branch in N/m; it sets the time step."""
        return float(self.stiffness)

    def parameters(self):
        """The floats for the kernel."""
        return LinearParameters(float(self.stiffness), float(self.damping))


def force(law, overlap, rate, largest, size):
    """Normal force (repulsion positive), the force that bounds friction, and the largest overlap (unused here).

    `rate` is the speed of separation. The Coulomb reference is the whole normal force, dashpot included.
    """
    elastic = max(law.stiffness * overlap, 0.0)  # rounded by itself, not fused with the dashpot: the bits of Luding's law with k1 = k2
    total = elastic - law.damping * rate
    return total, abs(total), largest


def reloading_line(law, largest, size):
    """The line of un- and reloading, here the whole law: its stiffness in N/m, overlap of zero force, and overlap at which it ends."""
    return law.stiffness, 0.0, 0.0


def stored_energy(law, overlap, largest, size):
    """Energy in J that a closed contact can give back."""
    return 0.5 * law.stiffness * overlap * overlap
