import numpy as np
import pytest

from anisogran import tensors

EPS = 1e-14  # a few roundings of numbers of order one


def test_half_half_split_of_a_diagonal_tensor():
    t = np.diag([3.0, 1.0])
    assert tensors.mean(t) == 2.0
    assert tensors.deviator_size(t) == 1.0
    assert tensors.principal_angle(t) == 0.0
    assert tensors.principal_angle(np.diag([1.0, 3.0])) == pytest.approx(np.pi / 2)
    assert tensors.principal_angle(np.array([[2.0, 2.0], [0.0, 1.0]])) == pytest.approx(0.5 * np.arctan(2.0))  # of the symmetric part


def test_split_and_sum_give_the_tensor_back(rng):
    t = tensors.symmetric(rng.normal(size=(2, 2, 50)))
    back = tensors.mean(t) * np.eye(2)[:, :, None] + tensors.deviator_size(t) * tensors.direction(tensors.principal_angle(t))
    np.testing.assert_allclose(back, t, atol=EPS)


def test_rotation_is_active_and_keeps_invariants(rng):
    # a tensor stretched along x, turned by +30 degrees, is stretched along +30 degrees
    turned = tensors.rotate(np.diag([3.0, 1.0]), np.pi / 6)
    assert tensors.principal_angle(turned) == pytest.approx(np.pi / 6, abs=EPS)
    t, angle = rng.normal(size=(2, 2, 20)), rng.uniform(-4, 4, 20)
    np.testing.assert_allclose(tensors.trace(tensors.rotate(t, angle)), tensors.trace(t), atol=EPS)
    np.testing.assert_allclose(tensors.deviator_size(tensors.rotate(t, angle)), tensors.deviator_size(t), atol=EPS)
    np.testing.assert_allclose(tensors.rotate(tensors.rotate(t, angle), -angle), t, atol=EPS)


def test_polar_frame():
    """Uniaxial stress along y is radial at azimuth 90 degrees, and hoop at 0."""
    t = np.diag([0.0, 1.0])
    np.testing.assert_allclose(tensors.in_polar_frame(t, np.pi / 2), np.diag([1.0, 0.0]), atol=EPS)
    np.testing.assert_allclose(tensors.in_polar_frame(t, 0.0), t, atol=EPS)


def test_deviator_in_three_dimensions(rng):
    t = rng.normal(size=(3, 3, 7))
    np.testing.assert_allclose(tensors.trace(tensors.deviator(t)), 0, atol=EPS)


def test_simple_shear_has_its_engineering_rate():
    gradient = np.array([[0.0, 0.3], [0.0, 0.0]])
    assert 2 * tensors.deviator_size(gradient) == pytest.approx(0.3)


def test_a_plane_tensor_is_its_three_parts(rng):
    parts = rng.normal(size=(3, 4))
    t = tensors.plane_tensor(parts)
    assert t.shape == (2, 2, 4)
    np.testing.assert_allclose(tensors.plane_parts(t), parts, rtol=1e-14, atol=1e-15)  # sums of two numbers
    np.testing.assert_allclose(parts[0], tensors.mean(t), rtol=1e-14, atol=1e-15)
    np.testing.assert_allclose(np.hypot(*parts[1:]), tensors.deviator_size(t), rtol=1e-14)
    skew = np.array([[0.0, 1.0], [-1.0, 0.0]])[:, :, None]
    np.testing.assert_allclose(tensors.plane_parts(t + skew), parts, rtol=1e-13, atol=1e-15)  # only the symmetric part counts
