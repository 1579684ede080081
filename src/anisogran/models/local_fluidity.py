"""The local part of the nonlocal law: the granular fluidity that a point would have alone, and how far it acts on others.

    xi^2 lap g = g - g_loc,    g = shear_rate/mu,    g_loc = I(mu)/mu sqrt(p/m),    xi = A d/sqrt|mu - mu_s|

Kamrin & Koval, Phys. Rev. Lett. 108, 178301 (2012), with the linear law I(mu) = (mu - mu_s)/b above mu_s (equations recalled, not
re-read). The nonlocal part is solved in the room of continua, where g_loc and the singular xi do not appear.
"""

import numpy as np

from anisogran.models.mu_of_i import I_linear
from anisogran.outcome import InputError


def g_local(mu, pressure, mass, mu_s, b):
    """g_loc = (mu - mu_s)/(b mu) sqrt(pressure/mass) [1/s], 0 for mu <= mu_s; shape of the arguments broadcast; N/m and kg.

    Raises InputError for mu < 0, pressure < 0 or mass <= 0.
    """
    mu, pressure, mass = np.asarray(mu), np.asarray(pressure), np.asarray(mass)
    if np.any(np.real(pressure) < 0.0) or np.any(np.real(mass) <= 0.0):
        low = np.nanmin(np.real(pressure)), np.nanmin(np.real(mass))
        raise InputError(f"g_local: pressure = {low[0]:g} must be at least 0 and mass = {low[1]:g} above 0")
    I = I_linear(mu, mu_s, b)
    return (I / np.where(I == 0.0, 1.0, mu) * np.sqrt(pressure / mass))[()]


def cooperativity_length(mu, diameter, mu_s, amplitude):
    """xi = amplitude diameter/sqrt|mu - mu_s|, unit of the diameter, shape of mu and diameter broadcast; inf at mu = mu_s.

    Raises InputError for mu < 0.
    """
    mu = np.asarray(mu)
    if np.any(np.real(mu) < 0.0):
        raise InputError(f"cooperativity_length: mu = {np.nanmin(np.real(mu)):g} must be at least 0")
    excess = np.where(np.real(mu) < mu_s, mu_s - mu, mu - mu_s)  # |mu - mu_s|, analytic on either side
    neutral = excess == 0.0
    return np.where(neutral, np.inf, amplitude * np.asarray(diameter) / np.sqrt(np.where(neutral, 1.0, excess)))[()]
