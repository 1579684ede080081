"""The local law made well posed by creep at small inertial numbers and a linear tail at large ones."""

from dataclasses import dataclass
from math import inf

from anisogran.continuum.laws.local import Local
from anisogran.keys import check_keys, key
from anisogran.models import mu_regularised, neutral_inertial_numbers
from anisogran.outcome import InputError


@dataclass(frozen=True)
class Regularised(Local):
    """The law `Jop`, partly regularised: C(I) <= 0 from rest up to a large I (Barker & Gray, J. Fluid Mech. 828, 5 (2017), at second hand).

    Below the lower neutral number I_1 of the unregularised law mu = sqrt(alpha/ln(A/I)), which falls to 0 at rest: no yield stress is
    left, everything creeps, log slowly; above it mu grows by a tail mu_inf I^2/(I_0 + I). See `models.mu_regularised`.

    Raises InputError for values out of bounds or parameters without a well-posed range to begin with.
    """

    mu_s: float = key("1", "friction of slow flow of the law that is regularised", above=0.0, example=0.342)
    mu_2: float = key("1", "its friction of fast flow, above mu_s", above=0.0, example=0.557)
    I_0: float = key("1", "inertial number half way from mu_s to mu_2", above=0.0, example=0.069)
    alpha: float = key("1", "strength of the creep", 1.9, above=0.0, below=2.0)
    mu_inf: float = key("1", "slope of the tail", 0.05, at_least=0.0)

    kind = "regularised"
    valid_to = inf

    def __post_init__(self):
        check_keys(self)
        try:
            neutral_inertial_numbers(self.mu_s, self.mu_2, self.I_0)
        except InputError as error:
            raise InputError(f"Regularised: {str(error).partition(': ')[2].replace('mu_d', 'mu_2').replace('I0', 'I_0')}") from None

    def friction(self, I):
        """mu(I), shape of I, real or complex."""
        return mu_regularised(I, self.mu_s, self.mu_2, self.I_0, self.alpha, self.mu_inf)

    @property
    def start(self):
        return self.mu_s, (self.mu_2 - self.mu_s) / self.I_0
