from math import inf, isnan, pi, sqrt

import numpy as np
import pytest

from anisogran.models import critical_flow, stiffness
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
