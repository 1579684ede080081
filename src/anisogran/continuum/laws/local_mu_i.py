"""The linear local law of discs."""

from dataclasses import dataclass

from anisogran.continuum.laws.local import Local
from anisogran.keys import check_keys, key
from anisogran.models import LINEAR_LIMIT, mu_linear


@dataclass(frozen=True)
class LocalMuI(Local):
    """Local friction law mu(I) = mu_s + b I, for discs at I <= 0.2; see `Local` for what a local law cannot do.

    Raises InputError if mu_s or b is not above 0.
    """

    mu_s: float = key("1", "friction of slow flow", above=0.0, example=0.26)
    b: float = key("1", "mu grows by b I", above=0.0, example=1.0)

    kind = "local_mu_i"
    valid_to = LINEAR_LIMIT

    def __post_init__(self):
        check_keys(self)

    def friction(self, I):
        """mu(I), shape of I, real or complex."""
        return mu_linear(I, self.mu_s, self.b)

    @property
    def start(self):
        return self.mu_s, self.b
