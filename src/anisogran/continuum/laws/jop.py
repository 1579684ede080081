"""The local law that saturates at large inertial numbers."""

from dataclasses import dataclass
from math import inf

from anisogran.continuum.laws.local import Local
from anisogran.keys import check_keys, key
from anisogran.models import mu_of_I
from anisogran.outcome import checked


@dataclass(frozen=True)
class Jop(Local):
    """Local friction law mu(I) = mu_s + (mu_2 - mu_s)/(1 + I_0/I) of Jop, Forterre & Pouliquen, Nature 441, 727 (2006), from memory.

    mu -> mu_2 at large I: no ring exerts more, and as it turns faster the flow shrinks to a layer of no thickness at the ring. See
    `Local` for what a local law cannot do. Raises InputError unless 0 < mu_s < mu_2 and I_0 > 0.
    """

    mu_s: float = key("1", "friction of slow flow", above=0.0, example=0.342)
    mu_2: float = key("1", "friction of fast flow, above mu_s", above=0.0, example=0.557)
    I_0: float = key("1", "inertial number half way from mu_s to mu_2", above=0.0, example=0.069)

    kind = "jop"
    valid_to = inf

    def __post_init__(self):
        check_keys(self)
        checked("Jop", "mu_2", self.mu_2, above=self.mu_s, unit="(= mu_s)")

    def friction(self, I):
        """mu(I), shape of I, real or complex."""
        return mu_of_I(I, self.mu_s, self.mu_2, self.I_0)

    @property
    def start(self):
        return self.mu_s, (self.mu_2 - self.mu_s) / self.I_0
