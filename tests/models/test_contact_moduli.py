import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from anisogran.models import fabric_moduli, fabric_of_moduli, network_moduli, network_of_moduli, stiffness, stress_increment
from anisogran.outcome import InputError
from anisogran.tensors import direction, rotation

ROUNDING = 1e-12


@pytest.mark.parametrize("k_t", [0.0, 0.7])
def test_moduli_are_those_of_the_sum_over_contacts(k_t):
    a2, a4, k_n, scale = 0.6, -0.2, 2.0, 3.0
    theta = 2 * np.pi * np.arange(64) / 64  # exact for trigonometric polynomials up to order 63
    weight = scale * (1 + a2 * np.cos(2 * theta) + a4 * np.cos(4 * theta)) / 64
    n, t = rotation(theta)[:, 0], rotation(theta)[:, 1]
    tn = 0.5 * (np.einsum("ic,jc->ijc", t, n) + np.einsum("ic,jc->ijc", n, t))
    nn = np.einsum("ic,jc->ijc", n, n)
    exact = np.einsum("c,ijc,klc->ijkl", weight * k_n, nn, nn) + np.einsum("c,ijc,klc->ijkl", weight * k_t, tn, tn)
    E, A, B, G, lam = network_moduli(a2, a4, k_n, k_t, scale)
    np.testing.assert_allclose(stiffness(E, A, B, 0.0, G), exact, atol=ROUNDING)
    assert lam == pytest.approx((E - B) / 2, rel=ROUNDING)
    assert lam == pytest.approx(exact[0, 0, 1, 1], rel=ROUNDING)


def test_one_shear_modulus_needs_frictionless_contacts():
    for a4 in (0.0, 0.3):
        normal = network_moduli(0.4, a4, 1.0, 0.0)
        assert normal.lam == pytest.approx(normal.G, rel=ROUNDING)
    tangential = network_moduli(0.4, 0.0, 1.0, 0.5)
    assert tangential.lam < tangential.G
    assert tangential.A == network_moduli(0.4, 0.0, 1.0, 0.0).A  # A does not depend on k_t
    assert pytest.approx(0.4 / 2, rel=ROUNDING) == tangential.A / tangential.E


def test_isotropic_limit():
    E, A, B, G, _ = network_moduli(0.0, 0.0, 2.0, 0.4, 5.0)
    assert (0.0, 5.0, pytest.approx(3.0)) == (A, E, B)
    assert pytest.approx(B, rel=ROUNDING) == 2 * G
    stiffness(E, A, B, 0.7, G)  # accepted: no angle matters


def test_springs_never_reach_critical_flow(rng):
    a2 = rng.uniform(-1, 1, 1000)
    moduli = network_moduli(a2, 0.0, 1.0, 0.0)
    np.testing.assert_allclose(moduli.E * moduli.B - moduli.A**2, 1 / 8 - a2**2 / 16, rtol=ROUNDING)
    aligned = network_moduli(2.0, 2.0, 1.0, 0.0)  # all contacts in one direction
    assert pytest.approx(0.0, abs=ROUNDING) == aligned.E * aligned.B - aligned.A**2
    with pytest.raises(InputError, match="k_t = -1 must be at least 0"):
        network_moduli(0.1, 0.0, 1.0, -1.0)


def test_contacts_that_move_with_the_strain_bear_the_stress_of_the_moduli(rng):
    """Forces on single contacts of random direction and length, and their sum; the structure is turned, the strain is any."""
    phi_C, k_n, k_t, volume = 0.4, 3.0, 0.8, 7.0
    half, length = rng.normal(0.0, 0.5, 200), rng.uniform(0.5, 1.5, 200)
    theta, length = phi_C + np.concatenate([half, -half]), np.tile(length, 2)  # mirrored about the axis, as the density is
    weight = length**2 / np.sum(length**2)
    a2, a4 = (2 * np.sum(weight * np.cos(n * (theta - phi_C))) for n in (2, 4))
    n, t = rotation(theta)[:, 0], rotation(theta)[:, 1]
    eps = rng.normal(size=(2, 2))
    eps = eps + eps.T
    squeezed = np.einsum("ij,jc->ic", eps, length * n)  # how far the ends come together
    force = k_n * np.sum(squeezed * n, axis=0) * n + k_t * np.sum(squeezed * t, axis=0) * t
    stress = np.einsum("ic,jc->ij", force, length * n) / volume
    E, A, B, G, _ = network_moduli(a2, a4, k_n, k_t, np.sum(length**2) / volume)
    # k_t acts against the turning of the branch: the grains do not spin, and the mean of t n is symmetrised
    np.testing.assert_allclose(stress_increment(eps, E, A, B, phi_C, G), 0.5 * (stress + stress.T), rtol=1e-10, atol=1e-10 * E)


@settings(derandomize=True, max_examples=50, deadline=None)
@given(st.floats(-2, 2), st.floats(-2, 2), st.floats(1e-3, 1e6), st.floats(0.0, 0.9))
def test_the_network_comes_back_from_its_moduli(a2, a4, k_n, ratio):
    E, A, B, G, _ = network_moduli(a2, a4, k_n, ratio * k_n, 3.0)
    found = network_of_moduli(E, A, B, G)
    tolerance = {"rel": 1e-11, "abs": 1e-11}  # a4 divides by 0.1 k_n
    assert (found.a2, found.a4) == pytest.approx((a2, a4), **tolerance)
    assert (found.k_n / k_n, found.k_t / k_n) == pytest.approx((3.0, 3.0 * ratio), **tolerance)


def test_what_moduli_do_not_tell_is_named(rng):
    equal = network_of_moduli(*network_moduli([0.1, 0.2], 0.3, 2.0, 2.0)[:4])
    assert np.isnan(equal.a4).all()  # springs alike in all directions do not show a4
    np.testing.assert_allclose(equal.a2, [0.1, 0.2], rtol=ROUNDING)
    lecture = network_of_moduli(2.0, 0.4, 0.7)  # 2G = E - B: contacts without friction
    assert tuple(lecture) == pytest.approx((0.4, -0.6, 4.0, 0.0), rel=ROUNDING)
    E = rng.uniform(1.0, 2.0, 1000)
    assert np.all(network_of_moduli(E, 0.1, rng.uniform(0.1, 0.9) * E).k_t == 0.0)  # and not rounding of either sign
    with pytest.raises(InputError, match=r"B \+ 2G - E = -0\.1 must be at least 0"):
        network_of_moduli(2.0, 0.4, 0.9, [0.6, 0.5])
    with pytest.raises(InputError, match="E = 0 must be above 0"):
        network_of_moduli(0.0, 0.4, 0.9)


def test_a_fabric_tensor_gives_the_moduli_and_their_axis():
    trace, a2, phi_C = np.array([3.0, 2.5]), np.array([0.6, 0.3]), np.array([0.4, -1.2])
    fabric = trace / 2 * (np.eye(2)[:, :, None] + a2 / 2 * direction(phi_C))
    moduli, axis = fabric_moduli(fabric, 2.0, 0.5, a4=0.1, scale=1.7)
    np.testing.assert_allclose(axis, phi_C, rtol=ROUNDING)
    np.testing.assert_allclose(moduli, network_moduli(a2, 0.1, 2.0, 0.5, 1.7), rtol=ROUNDING)
    np.testing.assert_allclose(fabric_of_moduli(moduli.E, moduli.A, axis, trace), fabric, rtol=1e-11)
    isotropic, _ = fabric_moduli(np.eye(2), 2.0, 0.5)
    assert isotropic.A == 0.0
    for bad, words in ((np.zeros((2, 2)), "tr F = 0 must be above 0"), (np.eye(3), r"shape \(3, 3\)")):
        with pytest.raises(InputError, match=words):
            fabric_moduli(bad, 1.0, 0.0)
    for E, size, words in ((0.0, 1.0, "E = 0 must be above 0"), (1.0, -1.0, "size = -1 must be above 0")):
        with pytest.raises(InputError, match=words):
            fabric_of_moduli(E, 0.1, size=size)


def test_the_moduli_of_equal_discs_need_the_fabric_alone():
    """A triangular lattice of discs: 2 tr F/pi is (1/V) sum l^2, hence 2 z nu k/pi; its moduli are known (a4 = 0 by symmetry)."""
    diameter, k = 0.7, 5.0
    n = rotation(np.pi / 3 * np.arange(6))[:, 0]
    cell = np.sqrt(3) / 2 * diameter**2  # of one disc
    fabric = np.pi / 4 * diameter**2 / cell * np.einsum("ic,jc->ij", n, n)
    moduli, _ = fabric_moduli(fabric, k, 0.0)
    once = 3 * diameter**2 / cell  # three contacts a disc, each once
    np.testing.assert_allclose([moduli.E, moduli.B, 2 * moduli.G], [once * k / 2, once * k / 4, once * k / 4], rtol=ROUNDING)
    lam = np.sqrt(3) / 4 * k  # Lame constants of a triangular lattice of springs, lam = G
    assert (float(moduli.lam), float(moduli.G)) == pytest.approx((lam, lam), rel=ROUNDING)
    assert pytest.approx(0.0, abs=1e-14) == moduli.A  # rounding of the sum over six directions
