"""Where a friction law mu(I) makes incompressible flow ill posed: short waves grow without bound, and no mesh converges.

    C(I) = 4 n^2 - 4 n + mu^2 (1 - n/2)^2,     n = I mu'(I)/mu;      ill posed where C > 0

for time-dependent flow in two dimensions; a steady flow that depends on one coordinate is not concerned. Barker et al., J. Fluid
Mech. 779, 794 (2015), in the form of Barker & Gray, J. Fluid Mech. 828, 5 (2017), eq. 3.9 (citations recalled; formula as in a
public OpenFOAM implementation).
"""

from functools import lru_cache
from math import exp, log

import numpy as np
from scipy.optimize import brentq

from anisogran.models.mu_of_i import inertial_number_checked, mu_of_I
from anisogran.outcome import InputError, checked

_STEP = 1e-8  # of the complex step, relative to I: its error is the square, and I = 1e-300 still has room for it
_POINTS_PER_DECADE = 125  # of the search for changes of sign; the laws at hand change over a decade


def well_posedness(I, law, *parameters, **named):
    """C(I) of any law, shape of I: positive where flow is ill posed, by any amount; no unit.

    `law(I, *parameters, **named)` must be analytic in I, since n comes from a complex step: `well_posedness(I, mu_of_I, mu_s, mu_d,
    I0)`. inf where mu^2 is too large for a number. Raises InputError for I < 0, and where mu <= 0, for n has no value there.
    """
    I = inertial_number_checked(I)
    value = law(I * (1.0 + 1j * _STEP), *parameters, **named)
    mu, slope = np.real(value), np.imag(value) / _STEP  # slope is I mu'
    if np.any(mu <= 0.0):
        raise InputError(f"well_posedness: mu = {np.nanmin(mu):g} at I = {np.real(I).flat[np.nanargmin(mu)]:g} must be above 0")
    n = slope / mu
    with np.errstate(over="ignore"):
        return 4.0 * n**2 - 4.0 * n + mu**2 * (1.0 - 0.5 * n) ** 2


def ill_posed(I, mu_s, mu_d, I0):
    """Whether mu(I) is ill posed at I, bool of the shape of I: C(I) > 0. InputError for I < 0 or, at I = 0, mu_s <= 0."""
    return well_posedness(I, mu_of_I, mu_s, mu_d, I0) > 0.0


def well_posed_ranges(law, *parameters, I_min=1e-8, I_max=1e8, **named):
    """The ranges of I in which a law is well posed, C <= 0, between I_min and I_max: a list of (low, high), perhaps empty.

    Limits are exact to rounding; one that equals I_min or I_max is the end of the search, not of the range. A range much narrower
    than 2 % of its I can be missed. Raises InputError unless 0 < I_min < I_max, or as `well_posedness`.
    """
    low = checked("well_posed_ranges", "I_min", I_min, above=0.0)
    high = checked("well_posed_ranges", "I_max", I_max, above=low)

    def C(log_I):
        return well_posedness(np.exp(log_I), law, *parameters, **named)

    logs = np.linspace(log(low), log(high), 2 + int(_POINTS_PER_DECADE * log(high / low) / log(10.0)))
    good = C(logs) <= 0.0
    changes = np.flatnonzero(good[1:] != good[:-1])
    limits = [exp(brentq(C, logs[k], logs[k + 1], xtol=1e-15)) for k in changes]
    limits = [low] * bool(good[0]) + limits + [high] * bool(good[-1])
    return list(zip(limits[::2], limits[1::2], strict=True))


@lru_cache
def neutral_inertial_numbers(mu_s, mu_d, I0):
    """(I1, I2): mu(I) is well posed for I1 < I < I2. Raises InputError if there is no such range, or for bad parameters."""
    where = "neutral_inertial_numbers"
    mu_s = checked(where, "mu_s", mu_s, above=0.0)
    mu_d = checked(where, "mu_d", mu_d, above=mu_s)
    I0 = checked(where, "I0", I0, above=0.0)
    ends = 1e-8 * I0, 1e8 * I0
    ranges = well_posed_ranges(mu_of_I, mu_s, mu_d, I0, I_min=ends[0], I_max=ends[1])
    if not ranges or ranges[0][0] == ends[0] or ranges[-1][1] == ends[1]:
        raise InputError(f"{where}: mu_s = {mu_s:g}, mu_d = {mu_d:g}, I0 = {I0:g} has no bounded well-posed range")
    return ranges[0][0], ranges[-1][1]
