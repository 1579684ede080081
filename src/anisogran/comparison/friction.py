"""The friction law of homogeneous shear, the only source of mu_s and b for the continuum of a ring."""

import numpy as np

from anisogran.fitting import mu_of_I
from anisogran.models import LINEAR_LIMIT


def homogeneous_friction(steady):
    """FitResult of mu_s + b I to the steady states of homogeneous shear, a Dataset with inertial_number, stress_ratio and its error.

    Of a study this is the group "shear/steady", see data_generation/ring_friction_law.py. Raises InputError as `fitting.mu_of_I` does.
    """
    inertial, mu, error = (np.ravel(steady[name].values) for name in ("inertial_number", "stress_ratio", "stress_ratio_error"))
    used = inertial < LINEAR_LIMIT  # the law is not meant for faster flow
    return mu_of_I(inertial[used], mu[used], error[used])
