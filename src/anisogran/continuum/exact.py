"""Exact steady flows between two rings, to check solvers and to draw beside them."""

from math import sqrt

import numpy as np
from scipy.optimize import brentq

from anisogran.outcome import checked


def newtonian_couette(r, r_inner, r_outer, wall_speed):
    """v_phi(r) of a Newtonian fluid, a r + b/r, with the inner ring at `wall_speed` and the outer one at rest."""
    r = np.asarray(r, dtype=float)
    share = wall_speed * r_inner / (r_outer**2 - r_inner**2)
    return share * (r_outer**2 / r - r)


def local_speed(r, stress_ratio, law, r_inner, r_outer, pressure, grain_mass=1.0):
    """v_phi(r) of the local law mu_s + b I in a ring whose stress ratio at the inner ring is given.

    The pressure is uniform and mu = stress_ratio (r_inner/r)^2, so the grains flow inside r_c = r_inner sqrt(stress_ratio/mu_s)
    (or everywhere, if r_c > r_outer) and I = (mu - mu_s)/b there; v_phi/r is the integral of shear_rate/r. Derived here.
    """
    r = np.asarray(r, dtype=float)
    edge = min(r_outer, r_inner * sqrt(max(stress_ratio, law.mu_s) / law.mu_s))
    inside = np.minimum(r, edge)
    driven = 0.5 * stress_ratio * r_inner**2 * (inside**-2.0 - edge**-2.0)
    return r * sqrt(pressure / grain_mass) / law.b * (driven - law.mu_s * np.log(edge / inside))


def local_stress_ratio(wall_speed, law, r_inner, r_outer, pressure, grain_mass=1.0):
    """The stress ratio at the inner ring at which the local law moves with |wall_speed| there; InputError if that is 0."""
    speed = checked("local_stress_ratio", "wall_speed", abs(wall_speed), above=0.0)

    def excess(stress_ratio):
        return float(local_speed(r_inner, stress_ratio, law, r_inner, r_outer, pressure, grain_mass)) - speed

    upper = 2.0 * law.mu_s
    while excess(upper) < 0.0:
        upper *= 2.0
    return brentq(excess, law.mu_s, upper, xtol=1e-15 * upper, rtol=1e-14)


def local_mu_i(r, wall_speed, law, r_inner, r_outer, pressure, grain_mass=1.0):
    """v_phi(r) of the local law mu_s + b I with the inner ring at `wall_speed`, the outer one at rest; `law` is a LocalMuI."""
    ratio = local_stress_ratio(wall_speed, law, r_inner, r_outer, pressure, grain_mass)
    return np.sign(wall_speed) * local_speed(r, ratio, law, r_inner, r_outer, pressure, grain_mass)
