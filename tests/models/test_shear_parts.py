import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from anisogran.models import displacement_gradient, finite_shear, in_axes_at_45_degrees, shear_increment
from anisogran.tensors import deviator_size, principal_angle, rotate, rotation, symmetric, trace

ROUNDING = 1e-14  # a few products of order one


def test_simple_shear_is_rotation_and_symmetric_shear():
    """As on the slide, with 2 eps_s = gamma; the strain has the opposite sign, since compression is positive."""
    gamma = 0.02
    strain, turned, turn = shear_increment(gamma)
    assert turned.tolist() == [[0.0, 0.01], [-0.01, 0.0]]
    assert strain.tolist() == [[0.0, -0.01], [-0.01, 0.0]]
    assert turn == -0.01  # clockwise
    assert (turned - strain).tolist() == displacement_gradient(gamma).tolist() == [[0.0, 0.02], [0.0, 0.0]]
    np.testing.assert_allclose(turned, turn * np.array([[0, -1], [1, 0]]), atol=ROUNDING)
    assert deviator_size(strain) == abs(turn) == 0.01


@pytest.mark.parametrize("sense", [1, -1])
def test_a_line_of_grains_at_minus_45_degrees_is_squeezed(sense):
    assert principal_angle(shear_increment(0.02 * sense).strain) == pytest.approx(-sense * np.pi / 4, rel=ROUNDING)
    for angle, longer in ((-np.pi / 4, -sense), (np.pi / 4, sense)):
        branch = np.array([np.cos(angle), np.sin(angle)])
        assert np.sign(np.linalg.norm(branch + displacement_gradient(0.02 * sense) @ branch) - 1) == longer


def test_the_45_degrees_of_the_lecture_turn_the_axes_and_not_the_tensor():
    e, s = 0.3, np.sqrt(0.5)
    shear = np.array([[0.0, e], [e, 0.0]])
    passive = np.array([[s, s], [-s, s]])
    np.testing.assert_allclose(in_axes_at_45_degrees(shear), passive @ shear @ passive.T, atol=ROUNDING)
    np.testing.assert_allclose(in_axes_at_45_degrees(shear), np.diag([e, -e]), atol=ROUNDING)
    np.testing.assert_allclose(rotate(shear, np.pi / 4), np.diag([-e, e]), atol=ROUNDING)
    np.testing.assert_allclose(in_axes_at_45_degrees(shear_increment(0.2).strain), np.diag([-0.1, 0.1]), atol=ROUNDING)
    assert in_axes_at_45_degrees(np.zeros((2, 2, 3))).shape == (2, 2, 3)


@settings(derandomize=True, max_examples=60, deadline=None)
@given(st.floats(-100, 100))
def test_finite_shear_is_stretch_then_rotation(gamma):
    turn, stretch, eps_D, axis = finite_shear(gamma)
    size = 1 + abs(gamma)
    np.testing.assert_allclose(rotation(turn) @ stretch, np.eye(2) + displacement_gradient(gamma), atol=ROUNDING * size)
    np.testing.assert_allclose(stretch, symmetric(stretch), atol=ROUNDING * size)
    assert np.linalg.eigvalsh(symmetric(stretch)) == pytest.approx(np.exp([-eps_D, eps_D]), abs=10 * ROUNDING * size)
    left = rotation(turn) @ symmetric(stretch) @ rotation(turn).T
    along = np.array([np.cos(axis), np.sin(axis)])
    assert along @ left @ along == pytest.approx(np.exp(-eps_D), abs=10 * ROUNDING * size)  # the smaller stretch
    assert -np.pi / 2 < axis <= np.pi / 2


def test_finite_shear_begins_as_the_increment_and_ends_across_the_flow():
    gamma = np.array([-1e-6, 0.0, 1e-6])
    small, finite = shear_increment(gamma), finite_shear(gamma)
    second_order = 1e-12  # gamma^2
    np.testing.assert_allclose(finite.turn, small.turn, atol=second_order)
    np.testing.assert_allclose(finite.stretch, np.eye(2)[:, :, None] - small.strain, atol=second_order)
    np.testing.assert_allclose(finite.eps_D, deviator_size(small.strain), atol=second_order)
    np.testing.assert_allclose(finite.axis, [np.pi / 4, -np.pi / 4, -np.pi / 4], atol=1e-6)
    assert finite_shear(1e6).axis == pytest.approx(-np.pi / 2, abs=2e-6)
    assert finite_shear(2.0).axis == pytest.approx(-3 * np.pi / 8, rel=ROUNDING)
    assert finite.stretch.shape == (2, 2, 3)


def test_many_small_shears_make_the_finite_strain_less_than_their_sum():
    """The strain increments of steady simple shear add to |gamma|/2, the true strain of the whole to arcsinh(|gamma|/2): axes turn."""
    gamma = 3.0
    steps = shear_increment(np.full(300, gamma / 300))
    assert np.sum(deviator_size(steps.strain)) == pytest.approx(1.5, rel=1e-12)
    assert finite_shear(gamma).eps_D == pytest.approx(np.log(1.5 + np.sqrt(3.25)), rel=ROUNDING)
    assert np.all(trace(steps.strain) == 0.0)
