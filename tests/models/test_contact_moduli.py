import numpy as np
import pytest

from anisogran.models import network_moduli, stiffness
from anisogran.outcome import InputError
from anisogran.tensors import rotation

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
