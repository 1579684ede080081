"""Crosses of the stress lie along its axes, in proportion to the principal stresses."""

import numpy as np

from anisogran.plots import stress_crosses
from anisogran.plots.ring import down_to


def test_crosses_by_hand():
    """Uniaxial along x, isotropic of half the size, and one that is not known, two apart: half lengths 1 and 0.5; no line for no stress."""
    position = np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 5.0]])
    stress = np.zeros((2, 2, 3))
    stress[0, 0, 0] = 4.0
    stress[[0, 1], [0, 1], 1] = 2.0
    stress[..., 2] = np.nan
    segments = stress_crosses(position, stress)
    assert segments.shape == (3, 2, 2)
    length = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
    np.testing.assert_allclose(np.sort(length), [1.0, 1.0, 2.0])
    longest = segments[np.argmax(length)]
    np.testing.assert_allclose(np.sort(longest, axis=0), [[-1.0, 0.0], [1.0, 0.0]], atol=1e-12)


def test_a_cross_turns_with_the_stress():
    """Shear stress sigma_xy > 0, compression positive: the large compression lies along (1, 1)."""
    position = np.array([[0.0, 0.0], [1.0, 0.0]])
    stress = np.tile(np.array([[1.0, 0.5], [0.5, 1.0]])[..., None], 2)
    lines = stress_crosses(position, stress)
    along = lines[:, 1] - lines[:, 0]
    size = np.linalg.norm(along, axis=1)
    np.testing.assert_allclose(np.sort(size), [1 / 3, 1 / 3, 1.0, 1.0])
    for line in along[size > 0.9]:
        np.testing.assert_allclose(line[0], line[1])


def test_a_curve_that_falls_at_once_is_still_a_line():
    np.testing.assert_array_equal(down_to(0.1, np.array([3.0, 1.0, 0.05, 0.2])), [3.0, 1.0, 0.1, np.nan])
    np.testing.assert_array_equal(down_to(0.1, np.array([3.0, 1e-9, 1e-12])), [3.0, 0.1, np.nan])
    np.testing.assert_array_equal(down_to(0.1, np.array([3.0, np.nan, np.nan])), [3.0, np.nan, np.nan])
