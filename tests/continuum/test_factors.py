"""The factorisation: pivots on the diagonal where they serve, and others where they do not,"""

import numpy as np
import pytest
from scipy.sparse import csc_array

from anisogran.continuum.factors import Factors


def saddle(rng):
    """A block matrix like that of velocity and pressure."""
    stiffness, divergence = rng.standard_normal((30, 30)) + 10.0 * np.eye(30), rng.standard_normal((12, 30))
    return np.block([[stiffness, divergence.T], [divergence, np.zeros((12, 12))]])


def unpivoted(rng):
    """Pivots on this diagonal leave nothing of the rest."""
    matrix = rng.standard_normal((200, 200))
    np.fill_diagonal(matrix, 1e-14)
    return matrix


@pytest.mark.parametrize("kind", [saddle, unpivoted])
@pytest.mark.parametrize("decades", [0.0, 8.0])
def test_solutions_are_right_whatever_the_diagonal_and_the_scales(kind, decades, rng):
    matrix = kind(rng)
    scales = 10.0 ** rng.uniform(-decades, decades, (2, len(matrix)))
    matrix = scales[0][:, None] * matrix * scales[1]
    wanted = rng.standard_normal(len(matrix)) / scales[1]
    found = Factors(csc_array(matrix)).solve(matrix @ wanted)
    # the condition of a random matrix of this size, some 1e3, times rounding
    np.testing.assert_allclose(found * scales[1], wanted * scales[1], atol=1e-10)


def test_a_singular_matrix_is_an_error():
    with pytest.raises(RuntimeError, match="singular"):
        Factors(csc_array(np.array([[0.0, 0.0], [1.0, 2.0]])))
