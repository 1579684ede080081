"""What local laws share: the stress ratio at a point is mu(I) of the inertial number at that very point.

I = shear_rate sqrt(grain mass / p) (da Cruz et al. 2005, Phys. Rev. E 72, 021309; cited from memory). The shear rate is regularised as
sqrt(rate^2 + floor^2), since a stress at rest would be undetermined.
"""

from math import sqrt

import numpy as np

from anisogran.continuum.laws.coaxial import shear_rate, viscous
from anisogran.models import well_posedness


class Local:
    """A law with `friction(I)`, the stress ratio, and `start`: (mu, mu') by which the flow at an inner ring that begins to turn is judged.

    It flows only where the stress ratio exceeds that of rest: the layer at the inner ring shrinks like the square root of the wall speed,
    so it cannot describe a slow ring cell; it is here as base line and to verify the solver.

    A steady axisymmetric flow is a well-posed problem at every I. A time-dependent incompressible flow in two dimensions is well-posed
    only where C(I) <= 0 (`models.well_posedness`), which a slow cell violates unless the law is regularised: `Flow.ill_posed_share`.
    """

    fields = ("u_r", "u_phi", "p")
    first_floor, floor_factor, floor = 1.0, 0.3, 1e-5  # in steps of 0.1 some of the finer meshes of `compare` find no solution

    def layer(self, setting):
        """Thickness of the flowing layer in the limit of slow flow, reduced: sqrt(mu' I R_i / mu)."""
        mu, slope = self.start
        return sqrt(slope * setting.inertial * setting.inner / mu)

    def elements(self, layers, setting):
        """The default number: from 32 on, the error at the default rate floor (4e-5 of v_phi) hardly falls."""
        return 32

    def positive(self, point, setting):
        """What must stay above 0 at every point: the pressure."""
        return (point.p,)

    def inertial_number(self, point, setting):
        """I with the regularised shear rate, which the stress sees."""
        return setting.inertial * shear_rate(point, setting.rate_floor) / np.sqrt(point.p)

    def stress(self, point, setting):
        rate = shear_rate(point, setting.rate_floor)
        return viscous(point, self.friction(self.inertial_number(point, setting)) * point.p / rate)

    def rate(self, point, setting, deviator):
        """The shear rate, where the stress deviator (half the difference of the principal stresses) is known: 2 |D_dev|."""
        return shear_rate(point)

    def ill_posed(self, point, setting):
        """Whether a time-dependent flow would be ill posed at these points, C(I) > 0; bool, shape of the point."""
        return well_posedness(self.inertial_number(point, setting), self.friction) > 0.0
