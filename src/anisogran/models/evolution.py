"""Exponential approach to a limit: the evolution of stress ratio and anisotropy with deviatoric strain (Luding's lecture).

    dx = beta (x_max sgn(d eps_D) - x) |d eps_D|

The lecture writes it for growing eps_D. The sign makes it hold after a load reversal, where x turns towards -x_max.
"""

import numpy as np

from anisogran.outcome import InputError


def loading_sense(d_eps_D):
    """+1.0 where the increment is >= 0, else -1.0; the real part decides, so that a complex step stays on its branch."""
    return np.where(np.real(d_eps_D) < 0.0, -1.0, 1.0)


def relax(x0, x_max, beta, d_eps_D):
    """The value after an increment d_eps_D, exact for any size of the increment, same shape as the arguments broadcast.

    x0 and x_max share any unit, beta and d_eps_D have none (half/half strain). A negative increment relaxes towards -x_max.
    Analytic in all arguments but for the kink at d_eps_D = 0, where a derivative is that of loading, d_eps_D -> 0+.
    Raises InputError if a beta is negative, since x would then run away.
    """
    if np.any(np.real(beta) < 0.0):
        raise InputError(f"relax: beta = {np.min(np.real(beta)):g} must be at least 0")
    sense = loading_sense(d_eps_D)
    # expm1 keeps x0 exactly when nothing happens (beta = 0 or no increment) and tiny increments accurate
    return x0 - (x_max * sense - x0) * np.expm1(-beta * (sense * d_eps_D))
