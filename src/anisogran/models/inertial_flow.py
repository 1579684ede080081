"""What belongs to steady flow of discs at the inertial number I: I itself, the viscosity, and the area fraction that falls with I.

I = shear_rate sqrt(mass/pressure) with the mass of a disc and the pressure in N/m (da Cruz et al., Phys. Rev. E 72, 021309 (2005),
as is the falling area fraction; recalled, not re-read). The shear rate is 2 |D_dev|, the engineering rate of simple shear.
"""

import numpy as np

from anisogran.models.mu_of_i import inertial_number_checked
from anisogran.outcome import InputError


def _must(holds, key, value, words, where):
    if not np.all(holds):
        raise InputError(f"{where}: {key} = {np.nanmin(np.real(value)):g} must be {words}")


def inertial_number(shear_rate, pressure, mass):
    """I = shear_rate sqrt(mass/pressure), shape of the arguments broadcast; 1/s, N/m and kg.

    Raises InputError for shear_rate < 0, pressure <= 0 (without pressure I has no value) or mass <= 0.
    """
    shear_rate, pressure, mass = np.asarray(shear_rate), np.asarray(pressure), np.asarray(mass)
    _must(~(np.real(shear_rate) < 0.0), "shear_rate", shear_rate, "at least 0", "inertial_number")
    _must(~(np.real(pressure) <= 0.0), "pressure", pressure, "above 0", "inertial_number")
    _must(~(np.real(mass) <= 0.0), "mass", mass, "above 0", "inertial_number")
    return (shear_rate * np.sqrt(mass / pressure))[()]


def viscosity(I, pressure, mass, law, *parameters, I_floor=0.0, **named):
    """|tau|/shear_rate = mu(I)/I sqrt(mass pressure) of any law, shape of I, pressure and mass broadcast; N s/m with N/m and kg.

    |tau| = mu pressure is the deviator of the stress. `viscosity(I, p, m, mu_of_I, mu_s, mu_d, I0)`. At I = 0 it is inf, for a law
    with a yield stress has no largest viscosity; `I_floor` > 0 puts sqrt(I^2 + I_floor^2) in the place of I, as a solver must,
    whose answer is then to be compared with that of a floor ten times smaller. Log-log against I its slope of -1 at small I is no
    more than mu being constant. Raises InputError for I < 0, pressure < 0, mass <= 0, I_floor < 0, or 0/0: mu = 0 at I = 0.
    """
    I, pressure, mass = inertial_number_checked(I), np.asarray(pressure), np.asarray(mass)
    _must(~(np.real(pressure) < 0.0), "pressure", pressure, "at least 0", "viscosity")
    _must(~(np.real(mass) <= 0.0), "mass", mass, "above 0", "viscosity")
    _must(I_floor >= 0.0, "I_floor", I_floor, "at least 0", "viscosity")
    if I_floor > 0.0:
        size = np.maximum(np.real(I), I_floor)  # so that no square overflows
        I = size * np.sqrt((I / size) ** 2 + (I_floor / size) ** 2)
    mu, rest = np.asarray(law(I, *parameters, **named)), np.asarray(I == 0.0)
    if np.any(rest & (mu == 0.0)):
        raise InputError("viscosity: mu = 0 at I = 0 makes it 0/0; give I > 0, or an I_floor")
    return np.where(rest, np.inf, mu / np.where(rest, 1.0, I) * np.sqrt(mass * pressure))[()]


def area_fraction_of_I(I, nu_max, a):
    """nu_max - a I, the area fraction of steady flow, shape of I; nu_max is that of slow flow. No unit.

    Raises InputError for I < 0, and where nothing would be left, I >= nu_max/a; the line is meant for I below about 0.2.
    """
    nu = nu_max - a * inertial_number_checked(I)
    _must(~(np.real(nu) <= 0.0), "area fraction nu_max - a I", nu, "above 0", "area_fraction_of_I")
    return nu[()]


def I_of_area_fraction(nu, nu_max, a):
    """The inverse: (nu_max - nu)/a, and 0 where nu >= nu_max, for nothing that dense flows steadily; shape of nu.

    Raises InputError for nu <= 0 or a <= 0.
    """
    nu = np.asarray(nu)
    _must(~(np.real(nu) <= 0.0), "nu", nu, "above 0", "I_of_area_fraction")
    _must(a > 0.0, "a", a, "above 0", "I_of_area_fraction")
    return np.where(np.real(nu) >= nu_max, 0.0, (nu_max - nu) / a)[()]
