"""Friction that depends on the inertial number I: the linear law in two dimensions and mu(I), each with its inverse.

mu is the stress ratio s_D = sin(mobilised angle) of coaxial shear, I is that of the glossary; neither has a unit.
All functions are analytic in I (they take complex I, for derivatives by complex step) and finite for 0 <= I <= 1e300.
"""

import numpy as np

from anisogran.outcome import InputError

# the largest I at which discs still follow mu_s + b I (da Cruz et al., Phys. Rev. E 72, 021309 (2005); recalled, not re-read)
LINEAR_LIMIT = 0.2


def inertial_number_checked(I):
    """I as an array; InputError where it is negative."""
    I = np.asarray(I)
    if np.any(np.real(I) < 0.0):
        raise InputError(f"mu(I): I = {np.nanmin(np.real(I)):g} must be at least 0")
    return I


def mu_linear(I, mu_s, b):
    """mu_s + b I, shape of I; for discs at I below about 0.2, see `within_linear_range`. InputError for I < 0."""
    return mu_s + b * inertial_number_checked(I)[()]


def I_linear(mu, mu_s, b):
    """The inverse of `mu_linear`: (mu - mu_s)/b, and 0 where mu <= mu_s, for there is no flow; shape of mu. InputError for mu < 0."""
    return _flowing(mu, mu_s, "I_linear") / b


def within_linear_range(I):
    """Whether the linear law is meant for I, I <= LINEAR_LIMIT = 0.2, bool of the shape of I; False for a NaN.

    A flag and no refusal in `mu_linear`: the iterates of a solver may pass through large I on their way to a flow within the range,
    so it is the result that has to be asked. Slow flow (I -> 0) is within: there the law says mu_s.
    """
    return (np.real(inertial_number_checked(I)) <= LINEAR_LIMIT)[()]


def mu_of_I(I, mu_s, mu_d, I0):
    """mu_s + (mu_d - mu_s)/(1 + I0/I), shape of I: from mu_s at rest to mu_d at large I. InputError for I < 0.

    The form of Jop, Forterre & Pouliquen, Nature 441, 727 (2006), where mu_d is called mu_2.
    """
    return saturating(inertial_number_checked(I)[()], mu_s, mu_d, I0)


def saturating(I, mu_s, mu_d, I0):
    """The formula of `mu_of_I`, for numbers and arrays, real and complex, also compiled: at rest and at large I exact, no overflow."""
    return mu_d - (mu_d - mu_s) * (I0 / (I0 + I))


def I_of_mu(mu, mu_s, mu_d, I0):
    """The inverse of `mu_of_I`: I0 (mu - mu_s)/(mu_d - mu), and 0 where mu <= mu_s, for there is no flow; shape of mu.

    Raises InputError for mu < 0, and for mu >= mu_d, which no steady flow reaches.
    """
    mu = np.asarray(mu)
    if np.any(np.real(mu) >= mu_d):
        raise InputError(f"I_of_mu: mu = {np.nanmax(np.real(mu)):g} must be below mu_d = {mu_d:g}, which is reached at no I")
    return I0 * _flowing(mu, mu_s, "I_of_mu") / (mu_d - mu)


def _flowing(mu, mu_s, where):
    """mu - mu_s where it is positive, else 0."""
    mu = np.asarray(mu)
    if np.any(np.real(mu) < 0.0):
        raise InputError(f"{where}: mu = {np.nanmin(np.real(mu)):g} must be at least 0")
    return np.where(np.real(mu) <= mu_s, 0.0, mu - mu_s)[()]
