"""Sliding friction: a tangential spring and dashpot, bounded by Coulomb's law (Luding, Granular Matter 10, 235, 2008).

In two dimensions the spring is one number along the tangent n x z, so it turns with the contact: objectivity needs no projection.
"""

from dataclasses import dataclass
from math import copysign
from typing import NamedTuple

from anisogran.keys import check_keys, key
from anisogran.outcome import checked


class FrictionParameters(NamedTuple):
    """What the kernel is compiled for."""

    stiffness: float
    damping: float
    mu_static: float
    mu_dynamic: float


@dataclass(frozen=True)
class Friction:
    """Sliding friction: stiffness > 0 in N/m, mu >= mu_dynamic >= 0, damping >= 0 in kg/s. Raises InputError for values out of bounds.

    A contact sticks while the spring force stays below mu times the normal force, and slides at mu_dynamic (default: mu) times it.
    """

    stiffness: float = key("N/m", "stiffness of the tangential spring", above=0, example=2e4)
    mu: float = key("1", "coefficient up to which a contact sticks", at_least=0, example=0.5)
    mu_dynamic: float | None = key("1", "coefficient at which it slides, at most mu; left out: mu", None, at_least=0, example=0.4)
    damping: float = key("kg/s", "tangential force per speed of slip", 0.0, at_least=0)

    def __post_init__(self):
        check_keys(self)
        if self.mu_dynamic is not None:
            checked("Friction", "mu_dynamic", self.mu_dynamic, at_most=self.mu, unit="(= mu)")

    def parameters(self):
        """The floats for the kernel."""
        mu_dynamic = self.mu if self.mu_dynamic is None else self.mu_dynamic
        return FrictionParameters(float(self.stiffness), float(self.damping), float(self.mu), float(mu_dynamic))


def force(law, spring, slip, normal, dt):
    """Tangential force against the slip velocity, and the new spring length.

    A sliding spring is cut back to the Coulomb limit, dashpot included, so that it never holds more force than it can give.
    """
    stretched = spring + slip * dt
    trial = -law.stiffness * stretched - law.damping * slip
    sticks = abs(trial) <= law.mu_static * normal
    total = trial if sticks else copysign(law.mu_dynamic * normal, trial)
    return total, stretched if sticks else -(total + law.damping * slip) / law.stiffness


def stored_energy(law, spring):
    """Energy in J of the tangential spring."""
    return 0.5 * law.stiffness * spring * spring
