"""The algebra of the anisotropic law that its docstrings claim, for random moduli, strains and angles."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from anisogran.models import critical_flow, relax, shear_increment, stiffness, stress_increment
from anisogran.tensors import deviator_size, direction, mean, principal_angle

ROUNDING = 1e-12  # some twenty operations with numbers up to ten
TOLERANCE = {"rtol": ROUNDING, "atol": 20 * ROUNDING}
MODULUS, ANGLE, STRAIN = st.floats(0.1, 10.0), st.floats(-4.0, 4.0), st.floats(-1.0, 1.0)
STRONG = st.floats(0.1, 10.0) | st.floats(-10.0, -0.1)  # an anisotropy that is none of rounding
repeated = settings(derandomize=True, max_examples=60, deadline=None)


def lecture(eps_V, eps_D, phi_eps, E, A, B, phi_C):
    """(sigma_V, deviator) of the second, written-out line of the slide "Constitutive model - tensorial"."""
    c = np.cos(2 * phi_eps - 2 * phi_C)
    deviator = A * eps_V * direction(phi_C) + (2 * B - E) * eps_D * c * direction(phi_C) + (E - B) * eps_D * direction(phi_eps)
    return E * eps_V + A * eps_D * c, deviator


@repeated
@given(MODULUS, STRONG, MODULUS, MODULUS, ANGLE, ANGLE, STRAIN, st.floats(0.0, 1.0))
def test_the_lecture_is_exact_if_and_only_if_the_shear_modulus_is_lambda(E, A, B, G, phi_C, phi_eps, eps_V, eps_D):
    eps = eps_V * np.eye(2) + eps_D * direction(phi_eps)
    sigma_V, deviator = lecture(eps_V, eps_D, phi_eps, E, A, B, phi_C)
    lam = (E - B) / 2
    sigma = stress_increment(eps, E, A, B, phi_C, lam)
    np.testing.assert_allclose(sigma, sigma_V * np.eye(2) + deviator, **TOLERANCE)
    # any other G adds stress against the non-coaxial part of the strain alone, along the axes turned by 45 degrees
    other = stress_increment(eps, E, A, B, phi_C, G)
    extra = 2 * (G - lam) * eps_D * np.sin(2 * phi_eps - 2 * phi_C) * direction(phi_C + np.pi / 4)
    np.testing.assert_allclose(other - sigma, extra, **TOLERANCE)


@repeated
@given(MODULUS, STRONG, MODULUS, MODULUS, ANGLE, ANGLE, STRAIN, st.floats(0.0, 1.0))
def test_half_and_half_measures_are_a_pair_for_work(E, A, B, G, phi_C, phi_eps, eps_V, eps_D):
    """sigma : eps = 2 (sigma_V eps_V + sigma_D eps_D cos of twice the angle between), and the coupling A is symmetric in it."""
    eps = eps_V * np.eye(2) + eps_D * direction(phi_eps)
    sigma = stress_increment(eps, E, A, B, phi_C, G)
    between = np.cos(2 * principal_angle(sigma) - 2 * phi_eps)
    work = np.einsum("ij,ij", sigma, eps)
    assert work == pytest.approx(2 * (mean(sigma) * eps_V + deviator_size(sigma) * eps_D * between), abs=20 * ROUNDING)
    x, y = eps_D * np.cos(2 * phi_eps - 2 * phi_C), eps_D * np.sin(2 * phi_eps - 2 * phi_C)
    assert work == pytest.approx(2 * (E * eps_V**2 + 2 * A * eps_V * x + B * x**2 + 2 * G * y**2), abs=40 * ROUNDING)


@repeated
@given(MODULUS, STRONG, MODULUS, MODULUS, ANGLE)
def test_the_operator_in_the_frame_of_the_structure(E, A, B, G, phi_C):
    C = stiffness(E, A, B, phi_C, G)
    basis = np.array([np.eye(2), direction(phi_C), direction(phi_C + np.pi / 4)])
    operator = 0.5 * np.einsum("aij,ijkl,bkl->ab", basis, C, basis)
    np.testing.assert_allclose(operator, [[E, A, 0], [A, B, 0], [0, 0, 2 * G]], **TOLERANCE)
    expected = critical_flow(E, A, B, G).tensor_determinant
    assert np.linalg.det(operator) == pytest.approx(expected, rel=1e-9, abs=1e-9)  # a difference of numbers up to 2000


@repeated
@given(st.floats(0.5, 10), st.floats(0.5, 10), st.floats(-0.4, 0.4), MODULUS)
def test_the_isobaric_modulus_is_that_of_the_local_stiffnesses(strong, weak, lam, G):
    """d sigma_zz/d eps_zz at constant sigma_xx = C_s - lam^2/C_w, with the stiff axis along z."""
    E, A, B = (strong + weak + 2 * lam) / 2, (strong - weak) / 2, (strong + weak - 2 * lam) / 2
    if strong == weak:
        G = B / 2
    C = stiffness(E, A, B, np.pi / 2, G)
    eps_xx = -C[0, 0, 1, 1] / C[0, 0, 0, 0]
    sigma = np.einsum("ijkl,kl->ij", C, np.diag([eps_xx, 1.0]))
    assert sigma[0, 0] == pytest.approx(0.0, abs=20 * ROUNDING)
    assert sigma[1, 1] == pytest.approx(strong - lam**2 / weak, rel=1e-11)


def test_softening_of_B_in_the_lecture_form_would_stiffen_other_shear():
    """Why S stands on every eps_D term: with S on B alone, 2G = E - S B grows as the material softens."""
    E, A, B, phi_C = 2.0, 0.3, 1.0, 0.2
    across = direction(phi_C + np.pi / 4)  # strain at 45 degrees to the structure
    answers = [deviator_size(stress_increment(across, E, A, S * B, phi_C)) for S in (1.0, 0.5, 0.0)]
    assert answers == pytest.approx([1.0, 1.5, 2.0], rel=ROUNDING)
    along = [deviator_size(stress_increment(direction(phi_C), E, A, S * B, phi_C)) for S in (1.0, 0.5, 0.0)]
    assert along == pytest.approx([1.0, 0.5, 0.0], abs=ROUNDING)


@repeated
@given(MODULUS, STRONG, MODULUS, MODULUS, ANGLE, st.lists(STRAIN, min_size=3, max_size=3))
def test_with_tension_positive_the_law_is_the_same_and_its_angle_the_other(E, A, B, G, phi_C, parts):
    """Both signs flip, so no row changes; but the axis of the larger strain is then that of extension, which is turned by 90 degrees."""
    eps = np.array([[parts[0], parts[2]], [parts[2], parts[1]]])
    np.testing.assert_array_equal(-stress_increment(eps, E, A, B, phi_C, G), stress_increment(-eps, E, A, B, phi_C, G))
    size = deviator_size(eps)
    turned = np.cos(2 * principal_angle(-eps) - 2 * principal_angle(eps))
    assert size * turned == pytest.approx(-size, abs=ROUNDING)
    # the same material, its axis named by the soft direction: A and the angle change together
    np.testing.assert_allclose(stiffness(E, -A, B, phi_C + np.pi / 2, G), stiffness(E, A, B, phi_C, G), **TOLERANCE)


def test_the_evolution_does_not_care_for_the_factor_in_the_anisotropy():
    """A = C_2 - C_1 of one slide and (C_2 - C_1)/2 of the coupled law evolve alike."""
    steps = np.array([0.01, -0.3, 2.0])
    np.testing.assert_allclose(relax(2 * 0.1, 2 * 0.7, 5.0, steps), 2 * relax(0.1, 0.7, 5.0, steps), rtol=ROUNDING)


@repeated
@given(MODULUS, STRONG, MODULUS, MODULUS, st.floats(-1.0, 1.0))
def test_simple_shear_meets_the_structure_that_it_made_coaxially(E, A, B, G, gamma):
    """A structure whose stiff axis is that of compression of the shear, -45 degrees, answers with A and B alone."""
    sigma = stress_increment(shear_increment(abs(gamma)).strain, E, A, B, -np.pi / 4, G)
    eps_D = abs(gamma) / 2
    np.testing.assert_allclose(sigma, A * eps_D * np.eye(2) + B * eps_D * direction(-np.pi / 4), **TOLERANCE)
    # one that lies along the flow answers with 2G alone
    sigma = stress_increment(shear_increment(gamma).strain, E, A, B, 0.0, G)
    np.testing.assert_allclose(sigma, -G * gamma * np.array([[0, 1], [1, 0]]), **TOLERANCE)
