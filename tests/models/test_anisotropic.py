import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from anisogran.models import directional_stiffness, stiffness, stress_increment
from anisogran.outcome import InputError
from anisogran.tensors import direction, rotate, rotation

ROUNDING = 1e-12  # some ten products and sums of order one


def random_strain(rng, shape=()):
    t = rng.normal(size=(2, 2, *shape))
    return t + np.swapaxes(t, 0, 1)


def decomposed(eps, E, A, B, phi_C, two_G):
    """The law written with angles, as on the slide, an independent way to the same stress."""
    eps_V, eps_D = 0.5 * (eps[0, 0] + eps[1, 1]), np.hypot(0.5 * (eps[0, 0] - eps[1, 1]), eps[0, 1])
    phi = 0.5 * np.arctan2(eps[0, 1], 0.5 * (eps[0, 0] - eps[1, 1]))
    c = np.cos(2 * phi - 2 * phi_C)
    deviator = (A * eps_V + (B - two_G) * eps_D * c) * direction(phi_C) + two_G * eps_D * direction(phi)
    return (E * eps_V + A * eps_D * c) * np.eye(2) + deviator


def test_the_lecture_form_is_the_case_of_one_shear_modulus(rng):
    eps, E, A, B, phi_C = random_strain(rng), 2.0, 0.5, 0.8, 0.3
    np.testing.assert_allclose(stress_increment(eps, E, A, B, phi_C), decomposed(eps, E, A, B, phi_C, E - B), atol=ROUNDING)
    np.testing.assert_allclose(stress_increment(eps, E, A, B, phi_C, 0.9), decomposed(eps, E, A, B, phi_C, 1.8), atol=ROUNDING)


def test_components_along_the_structure_are_the_local_stiffnesses():
    strong, weak, lam, G = 5.0, 3.0, 0.7, 1.1
    C = stiffness((strong + weak + 2 * lam) / 2, (strong - weak) / 2, (strong + weak - 2 * lam) / 2, 0.0, G)
    exact = {(0, 0, 0, 0): strong, (1, 1, 1, 1): weak, (0, 0, 1, 1): lam, (0, 1, 0, 1): G, (0, 0, 0, 1): 0.0}
    for index, value in exact.items():
        assert C[index] == pytest.approx(value, abs=ROUNDING)
    for order in ("jikl", "ijlk", "klij"):
        np.testing.assert_allclose(C, np.einsum(f"ijkl->{order}", C), atol=ROUNDING)


@settings(derandomize=True, max_examples=40, deadline=None)
@given(st.floats(0.1, 10), st.floats(-3, 3), st.floats(0.1, 10), st.floats(0, 5), st.floats(-7, 7), st.floats(-7, 7))
def test_turning_the_sample_turns_the_stress(E, A, B, G, phi_C, turn):
    if A == 0.0:
        G = B / 2
    eps = np.array([[0.3, -0.4], [-0.4, 1.1]])
    turned = stress_increment(rotate(eps, turn), E, A, B, phi_C + turn, G)
    np.testing.assert_allclose(turned, rotate(stress_increment(eps, E, A, B, phi_C, G), turn), atol=50 * ROUNDING)  # moduli to 10


@pytest.mark.parametrize("unit", [1e-3, 1e9])
def test_a_change_of_unit_changes_nothing_else(unit):
    one = stiffness(2.0, 0.5, 0.8, 0.3, 0.4)
    np.testing.assert_allclose(stiffness(2 * unit, 0.5 * unit, 0.8 * unit, 0.3, 0.4 * unit) / unit, one, rtol=ROUNDING, atol=1e-15)


def test_positive_definite_exactly_if_E_B_exceeds_A_squared():
    for A, sign in ((0.99, 1.0), (1.01, -1.0)):
        C = stiffness(2.0, A, 0.5, 0.4, 0.3)
        basis = np.array([np.eye(2), direction(0.4), direction(0.4 + np.pi / 4)]) / np.sqrt(2)  # orthonormal
        matrix = np.einsum("aij,ijkl,bkl->ab", basis, C, basis)
        np.testing.assert_allclose(matrix, [[2.0, A, 0], [A, 0.5, 0], [0, 0, 0.6]], atol=ROUNDING)
        assert np.sign(np.linalg.eigvalsh(matrix)[0]) == sign


def test_without_anisotropy_no_angle_matters(rng):
    eps = random_strain(rng)
    answers = stress_increment(eps[:, :, None], 2.0, 0.0, 1.0, np.linspace(0, np.pi, 7))
    np.testing.assert_array_equal(answers, np.broadcast_to(answers[:, :, :1], answers.shape))
    rounded = stress_increment(eps[:, :, None], 2.0, 0.0, 1.0, np.linspace(0, np.pi, 7), G=0.5 * (1 + 1e-13))
    np.testing.assert_array_equal(rounded, np.broadcast_to(rounded[:, :, :1], rounded.shape))  # rounding of G brings no angle in
    for bad in ({"E": 3.0, "B": 1.0}, {"E": 2.0, "B": 1.0, "G": 0.6}):
        with pytest.raises(InputError, match="A = 0 needs B = 2G"):
            stiffness(A=[0.1, 0.0], **bad)


def test_a_tiny_deviator_is_no_special_case(rng):
    pure = stress_increment(-1e-3 * np.eye(2), 2.0, 0.5, 0.8, 0.3)
    noisy = stress_increment(-1e-3 * np.eye(2) + 1e-18 * random_strain(rng), 2.0, 0.5, 0.8, 0.3)
    np.testing.assert_allclose(noisy, pure, rtol=ROUNDING)
    assert np.all(stress_increment(np.zeros((2, 2)), 2.0, 0.5, 0.8) == 0.0)


def test_a_batch_equals_its_points_and_shapes_are_checked(rng):
    eps, A, phi_C = random_strain(rng, (3, 4)), rng.uniform(0.1, 0.9, 4), rng.normal(size=(3, 1))
    batch = stress_increment(eps, 2.0, A, 0.8, phi_C)
    assert stiffness(2.0, A, 0.8, phi_C).shape == (2, 2, 2, 2, 3, 4)
    for i, j in np.ndindex(3, 4):
        np.testing.assert_allclose(batch[:, :, i, j], stress_increment(eps[:, :, i, j], 2.0, A[j], 0.8, phi_C[i, 0]), atol=ROUNDING)
    with pytest.raises(InputError, match=r"shape \(3, 3\)"):
        stress_increment(np.eye(3), 2.0, 0.5, 0.8)


def test_the_polar_curve_is_the_stiffness_along_each_direction():
    theta = np.linspace(0, 2 * np.pi, 13)
    n = rotation(theta)[:, 0]
    along = np.einsum("i...,j...,ijkl,k...,l...->...", n, n, stiffness(2.0, 0.5, 0.8, 0.3, 0.25), n, n)
    np.testing.assert_allclose(directional_stiffness(theta, 2.0, 0.5, 0.8, 0.3, 0.25), along, rtol=ROUNDING)


def test_complex_step_gives_the_stiffness(rng):
    eps, h = random_strain(rng), 1e-30
    for i, j in np.ndindex(2, 2):
        column = np.imag(stress_increment(eps + 1j * h * np.eye(4).reshape(2, 2, 2, 2)[i, j], 2.0, 0.5, 0.8, 0.3)) / h
        np.testing.assert_allclose(column, stiffness(2.0, 0.5, 0.8, 0.3)[:, :, i, j], atol=ROUNDING)
