"""What all laws share: the shear rate, and a stress coaxial with the rate of deformation.

Stress is compression positive, sigma = p 1 - 2 eta D with D the deviator of the rate of deformation, so that sigma_rphi > 0
where the angular velocity falls outward.
"""

import numpy as np


def shear_rate(point, floor=0.0):
    """2 |D_dev|, the difference of the eigenvalues of D; in simple shear the engineering rate |gamma|."""
    return np.sqrt((point.d_rr - point.d_ff) ** 2 + point.gamma**2 + floor**2)


def viscous(point, eta):
    """sigma_rr, sigma_phiphi, sigma_rphi of p 1 - 2 eta D_dev."""
    difference = eta * (point.d_rr - point.d_ff)
    return point.p - difference, point.p + difference, -eta * point.gamma
