from math import inf, isnan, pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from anisogran.models import critical_flow, distance_from_flow, stiffness
from anisogran.outcome import InputError
from anisogran.tensors import direction

ROUNDING = 1e-12  # a handful of operations


def test_the_scalar_critical_state_dilates():
    flow = critical_flow(2.0, 1.0, 0.5)
    assert flow.flows
    assert flow.case == "dilating"
    assert flow.dilatancy == pytest.approx(-1.0 / 2.0, rel=ROUNDING)  # -A/E = -B/A
    assert flow.determinant == 0.0
    assert flow.directions == [pytest.approx((-1 / sqrt(5), 2 / sqrt(5)), rel=ROUNDING)]
    assert critical_flow(2.0, -1.0, 0.5).case == "contracting"


@pytest.mark.parametrize(
    "moduli", [(2.0, 1.0, 0.5, 0.3, 1.0), (2.0, 0.3, 2.0, None, 1.0), (3.0, 0.7, 1.0, 0.5, 0.0), (1.0, 0, 0, 0.2, 1.0)]
)
def test_every_direction_changes_no_stress(moduli):
    E, A, B, G, S = moduli
    flow = critical_flow(E, A, B, G, softening=S)
    assert flow.flows
    G = (E - B) / 2 if G is None else G
    for (eps_V, eps_D), angle in zip(flow.directions, flow.angles, strict=True):
        assert np.hypot(eps_V, eps_D) == pytest.approx(1.0, rel=ROUNDING)
        c, s = np.cos(2 * angle), np.sin(2 * angle)
        operator = np.array([[E, S * A, 0], [A, S * B, 0], [0, 0, 2 * G * S]])
        np.testing.assert_allclose(operator @ [eps_V, eps_D * c, eps_D * s], 0.0, atol=ROUNDING)
        if S == 1.0 and A:  # and in the tensorial law, at any angle of the structure
            eps = eps_V * np.eye(2) + eps_D * direction(0.3 + angle)
            np.testing.assert_allclose(np.einsum("ijkl,kl->ij", stiffness(E, A, B, 0.3, G), eps), 0.0, atol=ROUNDING)


def test_full_softening_gives_isochoric_flow_for_any_stable_moduli():
    flow = critical_flow(3.0, 0.7, 1.0, 0.5, softening=0.0)
    assert (flow.case, flow.dilatancy, flow.angles) == ("free", 0.0, [0.0, pi / 4])


def test_the_other_cases():
    assert critical_flow(3.0, 0.5, 1.0).case == "stiff"
    assert critical_flow(2.0, 1.0, 0.4).case == "unstable"
    assert not critical_flow(2.0, 1.0, 0.4).flows
    assert critical_flow(2.0, 0.3, 2.0).case == "non-coaxial"  # 2G = E - B = 0: isochoric, at 45 degrees to the structure
    assert critical_flow(2.0, 2.0, 2.0).case == "dilating and non-coaxial"
    assert critical_flow(1.0, 0.0, 0.0).case == "isochoric"
    assert critical_flow(0.0, 0.0, 1.0).dilatancy == inf
    assert critical_flow(0.0, 0.0, 0.0).case == "no stiffness"
    assert isnan(critical_flow(3.0, 0.5, 1.0).dilatancy)
    with pytest.raises(InputError, match="softening = -1 must be at least 0"):
        critical_flow(1.0, 0.1, 1.0, softening=-1.0)


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e9])
def test_rounding_and_units_do_not_hide_the_critical_state(unit):
    E, A = 0.3 * unit, 0.1 * unit
    assert critical_flow(E, A, A * A / E).case == "dilating"
    assert critical_flow(E, A, A * A / E * (1 + 1e-9)).case == "stiff"


POSITIVE, SENSE, SOFTENING = st.floats(1e-3, 1e3), st.sampled_from([-1.0, 1.0]), st.floats(0.05, 2.0)


@settings(derandomize=True, max_examples=60, deadline=None)
@given(POSITIVE, POSITIVE, POSITIVE, SENSE, SOFTENING)
def test_random_critical_moduli_flow_with_the_dilatancy_of_the_moduli(E, B, G, sense, S):
    A = sense * sqrt(E * B)
    flow = critical_flow(E, A, B, G, softening=S)
    assert flow.flows
    assert flow.dilatancy == pytest.approx(-S * A / E, rel=1e-9)
    ((eps_V, eps_D),) = flow.directions
    size = E + abs(A) + B
    assert (E * eps_V + S * A * eps_D, A * eps_V + S * B * eps_D) == pytest.approx((0.0, 0.0), abs=ROUNDING * size)
    assert flow.distance == pytest.approx(0.0, abs=ROUNDING)
    if A > 0:
        assert critical_flow(E, 0.9 * A, B, G, softening=S).case == "stiff"
        assert critical_flow(E, 1.1 * A, B, G, softening=S).case == "unstable"


@settings(derandomize=True, max_examples=60, deadline=None)
@given(POSITIVE, POSITIVE, POSITIVE, st.floats(-0.99, 0.99), st.sampled_from([0.0, 1e-17]) | st.floats(1e-3, 2.0))
def test_determinants_and_distance_are_those_of_the_operator(E, B, G, share, S):
    A = share * sqrt(E * B)
    flow = critical_flow(E, A, B, G, softening=S)
    operator = np.array([[E, S * A, 0], [A, S * B, 0], [0, 0, 2 * G * S]])
    assert flow.tensor_determinant == pytest.approx(np.linalg.det(operator), rel=1e-10, abs=1e-15 * E * B * G)  # E B - A^2 loses two digits
    assert flow.determinant == pytest.approx(np.linalg.det(operator[:2, :2]), rel=1e-10, abs=1e-15 * E * B)
    # at constant mean stress, coaxial: eps_V = -S A/E eps_D, and what is left of B
    left = (S * B - A * S * A / E) / B
    assert flow.distance == pytest.approx(min(left, 2 * G * S / B), rel=1e-10, abs=1e-15)
    assert (flow.distance == 0.0) == flow.flows == (S < 1e-3)


def test_distance_falls_from_one_to_zero_and_below():
    assert distance_from_flow(2.0, 0.0, 1.0) == 1.0
    distance = distance_from_flow(2.0, np.sqrt(2.0) * np.array([0.0, 0.5, 1.0, 1.1]), 1.0, 0.5)
    assert distance.tolist() == pytest.approx([1.0, 0.75, 0.0, -0.21], abs=ROUNDING)
    assert distance_from_flow(2.0, 0.1, 2.0) == 0.0  # 2G = E - B = 0: non-coaxial flow
    assert distance_from_flow(2.0, 0.0, 1.0, softening=np.array([0.0, 0.5])).tolist() == [0.0, 0.5]
    assert isnan(critical_flow(1.0, 0.0, 0.0).distance)
    with pytest.raises(InputError, match="B = 0 must be above 0"):
        distance_from_flow(1.0, 0.0, [1.0, 0.0])


def test_softening_of_B_alone_would_flow_too_early_and_dilate():
    """Why S stands on the whole eps_D column: on B alone the material flows at S = A^2/(E B), where it bears more yet."""
    E, A, B, G = 3.0, 1.0, 1.0, 0.5
    early = A**2 / (E * B)
    assert critical_flow(E, A, early * B, G).case == "dilating"
    assert critical_flow(E, A, 0.9 * early * B, G).case == "unstable"
    for S in (early, 0.9 * early, 1e-6):
        assert critical_flow(E, A, B, G, softening=S).case == "stiff"
    assert critical_flow(E, A, B, G, softening=0.0).directions[0] == (0.0, 1.0)
