"""The slopes of whole curves by the parameters of a law are those of the curves."""

import numpy as np
import pytest

from anisogran.models import controls, element_test, law_parameters
from anisogran.models.path_slopes import slopes_along
from anisogran.models.prepared_path import PreparedPath

SCALAR = {"E": 2e4, "B": 1e4, "s_max": 0.3, "A_max": 4e3, "beta_F": 50.0}
TENSORIAL = SCALAR | {"G": 4e3}
PLASTIC = {"E": 2e4, "G": 4e3, "phi": 0.4, "c": 2.0, "phi_residual": 0.3, "beta": 30.0, "psi": 0.05}
INERTIAL = {"mu_s": 0.28, "phi_max": 0.82, "slope": 0.3, "grain_mass": 1e-5, "b": 1.1}
LINE = np.linspace(0.0, 0.05, 60)
FLOW = {"eps_xz": 20.0 * LINE, "spin": 20.0 * LINE, "eps_xx": 0.0, "eps_zz": 0.1 * LINE, "time": 1.0 + LINE}
CASES = {
    "biaxial": ("scalar", SCALAR, controls.biaxial(LINE, 100.0), None),
    "turned round": ("scalar", SCALAR, controls.biaxial(np.interp(np.arange(60), [0, 30, 45, 59], [0, 0.02, -0.02, 0.0]), 100.0), None),
    "compression": ("scalar", SCALAR, controls.isotropic_compression(np.linspace(100.0, 300.0, 60)), {"A": 2e3}),
    "tensorial biaxial": ("tensorial", TENSORIAL, controls.biaxial(LINE, 100.0), None),
    "simple shear": ("tensorial", TENSORIAL, controls.simple_shear(2.0 * LINE, 100.0), None),
    "constant volume": ("tensorial", TENSORIAL, controls.simple_shear(LINE), 100.0),
    "plastic": ("mohr_coulomb", PLASTIC, controls.biaxial(LINE, 100.0), None),
    "flow": ("mu_of_I", INERTIAL, FLOW, {"area_fraction": 0.78}),
}


@pytest.mark.parametrize("case", CASES)
def test_slopes_are_differences_of_curves(case):
    law, parameters, control, start = CASES[case]
    path, values = PreparedPath(law, control, start), np.array(list(parameters.values()))

    def record(numbers):
        return law_parameters(law, **dict(zip(parameters, numbers, strict=True)))

    directions, differences = [], []
    for step in 1e-5 * np.diag(values):
        high, low = record(values + step), record(values - step)
        directions.append((np.array(high) - np.array(low)) / 2e-5)
        differences.append([(a - b) / 2e-5 for a, b in zip(path.driven(high)[:2], path.driven(low)[:2], strict=True)])
    driven = path.driven(record(values))
    assert len(driven.states) == path.size == 60
    slopes = slopes_along(path, record(values), directions, driven)
    inner = max(np.max(np.abs(driven.states[:, 3:])), 1e-12)
    sizes = np.repeat([np.max(np.abs(driven.states[:, :3])), inner], [3, 2]), np.max(np.abs(driven.strains))
    for k, size in enumerate(sizes):
        for slope, difference in zip(slopes[k], differences, strict=True):
            # differences: curvature 1e-10, rounding 1e-8, and jumps of 1e-8 where a sub-step comes or goes
            np.testing.assert_allclose(slope / size, difference[k] / size, atol=1e-6)
    assert max(np.max(np.abs(slope)) for slope in slopes[0]) > 0.0


def test_a_prepared_path_is_the_element_test():
    law, parameters, control, start = CASES["simple shear"]
    test = element_test(law, parameters, control, start)
    driven = PreparedPath(law, control, start).driven(law_parameters(law, **parameters))
    np.testing.assert_array_equal(driven.states[:, 0], test.sigma_V)
    np.testing.assert_array_equal(driven.strains[:, 0] - driven.strains[:, 1], test.eps_zz)
