"""Friction that depends on the inertial number I: the linear law in two dimensions, mu(I), and its regularisation.

mu is the stress ratio s_D = sin(mobilised angle) of coaxial shear, I is that of the glossary; neither has a unit.
All functions are analytic in I (they take complex I, for derivatives by complex step) and finite for 0 <= I <= 1e300.
"""

from functools import lru_cache
from math import exp, log

import numpy as np

from anisogran.outcome import InputError, checked


def _inertial_number(I):
    I = np.asarray(I)
    if np.any(np.real(I) < 0.0):
        raise InputError(f"mu(I): I = {np.nanmin(np.real(I)):g} must be at least 0")
    return I


def mu_linear(I, mu_s, b):
    """mu_s + b I, shape of I; for discs at I below about 0.2. InputError for I < 0."""
    return mu_s + b * _inertial_number(I)[()]


def mu_of_I(I, mu_s, mu_d, I0):
    """mu_s + (mu_d - mu_s)/(1 + I0/I), shape of I: from mu_s at rest to mu_d at large I. InputError for I < 0."""
    return mu_d - (mu_d - mu_s) * _rest_share(I, I0)


def _rest_share(I, I0):
    return I0 / (I0 + _inertial_number(I)[()])


def well_posedness(I, mu, slope):
    """mu^2 C(I), shape of the arguments, with C = 4 n^2 - 4 n + mu^2 (1 - n/2)^2 and n = I mu'(I)/mu; `slope` is mu'(I).

    Where it is positive, incompressible time-dependent flow in two dimensions is ill posed: short waves grow without bound
    (Barker et al., J. Fluid Mech. 779, 794 (2015); the form is Barker & Gray, J. Fluid Mech. 828, 5 (2017), eq. 3.9: citations
    recalled, formula as in a public OpenFOAM implementation). The factor mu^2 > 0 keeps the sign and avoids a division by mu.
    """
    m = I * slope
    return 4.0 * m**2 - 4.0 * m * mu + mu**2 * (mu - 0.5 * m) ** 2


def _well_posedness_of_mu_of_I(I, mu_s, mu_d, I0):
    rest = _rest_share(I, I0)
    # I mu'(I) = (mu_d - mu_s) rest (1 - rest), which neither overflows nor divides; so "slope" is this over I with I = 1
    return well_posedness(1.0, mu_of_I(I, mu_s, mu_d, I0), (mu_d - mu_s) * rest * (1.0 - rest))


def ill_posed(I, mu_s, mu_d, I0):
    """Whether mu(I) is ill posed at I, bool of the shape of I; see `well_posedness`. I real and >= 0, else InputError."""
    return _well_posedness_of_mu_of_I(I, mu_s, mu_d, I0) > 0.0


@lru_cache
def neutral_inertial_numbers(mu_s, mu_d, I0):
    """(I1, I2): mu(I) is well posed for I1 < I < I2. Raises InputError if there is no such range, or for bad parameters."""
    where = "neutral_inertial_numbers"
    mu_s = checked(where, "mu_s", mu_s, above=0.0)
    mu_d = checked(where, "mu_d", mu_d, above=mu_s)
    I0 = checked(where, "I0", I0, above=0.0)
    logs = np.linspace(log(1e-8), log(1e8), 2001) + log(I0)
    bad = ill_posed(np.exp(logs), mu_s, mu_d, I0)
    inside = np.flatnonzero(~bad)
    if inside.size == 0 or bad[0] != bad[-1]:
        raise InputError(f"{where}: mu_s = {mu_s:g}, mu_d = {mu_d:g}, I0 = {I0:g} has no bounded well-posed range")
    first, last = inside[0], inside[-1]
    lower = _bisect(logs[first - 1], logs[first], (mu_s, mu_d, I0))
    upper = _bisect(logs[last + 1], logs[last], (mu_s, mu_d, I0))
    return exp(lower), exp(upper)


def _bisect(log_bad, log_good, law):
    for _ in range(60):  # 60 halvings of 0.02 reach rounding
        middle = 0.5 * (log_bad + log_good)
        if ill_posed(exp(middle), *law):
            log_bad = middle
        else:
            log_good = middle
    return log_good


def mu_regularised(I, mu_s, mu_d, I0, alpha=1.9, mu_inf=0.05):
    """The partly regularised law, shape of I, well posed up to a large I: creep below I1, mu(I) with a linear tail mu_inf above.

        I <= I1: sqrt(alpha/ln(A/I));    I > I1: (mu_s I0 + mu_d I + mu_inf I^2)/(I0 + I)

    A makes mu continuous at I1, the lower neutral number of mu(I) without the tail. No yield stress is left: mu -> 0 as I -> 0.
    Barker & Gray, J. Fluid Mech. 828, 5 (2017), eqs. 6.3 and 6.4, in the form of a public OpenFOAM implementation; alpha < 2.
    Raises InputError for I < 0, alpha outside (0, 2), or parameters without a well-posed range.
    """
    alpha = checked("mu_regularised", "alpha", alpha, above=0.0, below=2.0)
    mu_inf = checked("mu_regularised", "mu_inf", mu_inf, at_least=0.0)
    I = _inertial_number(I)
    I1, _ = neutral_inertial_numbers(mu_s, mu_d, I0)

    def with_tail(I):
        return mu_of_I(I, mu_s, mu_d, I0) + mu_inf * I * (1.0 - _rest_share(I, I0))

    rest, creeping = I == 0.0, np.real(I) <= I1
    ln_A = log(I1) + alpha / with_tail(I1) ** 2
    creep = np.sqrt(alpha / (ln_A - np.log(np.where(creeping & ~rest, I, I1))))
    return np.where(rest, 0.0, np.where(creeping, creep, with_tail(I)))[()]
