"""The partial regularisation of mu(I): a law of creep at small I and a linear tail at large I, so that flow is well posed."""

from math import log

import numpy as np

from anisogran.models.ill_posedness import neutral_inertial_numbers
from anisogran.models.mu_of_i import inertial_number_checked, mu_of_I
from anisogran.outcome import checked


def mu_regularised(I, mu_s, mu_d, I0, alpha=1.9, mu_inf=0.05):
    """The partly regularised law, shape of I, well posed up to a large I: creep below I1, mu(I) with a linear tail mu_inf above.

        I <= I1: sqrt(alpha/ln(A/I));    I > I1: (mu_s I0 + mu_d I + mu_inf I^2)/(I0 + I)

    A makes mu continuous at I1, the lower neutral number of mu(I) without the tail. No yield stress is left: mu -> 0 as I -> 0.
    Barker & Gray, J. Fluid Mech. 828, 5 (2017), eqs. 6.3 and 6.4, in the form of a public OpenFOAM implementation; alpha < 2.
    Raises InputError for I < 0, alpha outside (0, 2), or parameters without a well-posed range.
    """
    alpha = checked("mu_regularised", "alpha", alpha, above=0.0, below=2.0)
    mu_inf = checked("mu_regularised", "mu_inf", mu_inf, at_least=0.0)
    I = inertial_number_checked(I)
    I1, _ = neutral_inertial_numbers(mu_s, mu_d, I0)

    def with_tail(I):
        return mu_of_I(I, mu_s, mu_d, I0) + mu_inf * I * (I / (I0 + I))

    rest, creeping = I == 0.0, np.real(I) <= I1
    ln_A = log(I1) + alpha / with_tail(I1) ** 2
    creep = np.sqrt(alpha / (ln_A - np.log(np.where(creeping & ~rest, I, I1))))
    return np.where(rest, 0.0, np.where(creeping, creep, with_tail(I)))[()]
