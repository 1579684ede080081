"""Every integrator has its order, measured on every law along a path with a reversal, and its tangent is that of its step."""

import numpy as np
import pytest

from anisogran.models import (
    INTEGRATORS,
    LAWS,
    PointState,
    RungeKutta45,
    biaxial,
    element_test,
    law_parameters,
    pure_shear,
    simple_shear,
    updated,
)
from anisogran.outcome import InputError

ANISOTROPIC = {"E": 1e5, "B": 5e4, "s_max": 0.3, "A_max": 2e4, "beta_F": 80.0}
PARAMETERS = {
    "scalar": ANISOTROPIC,
    "tensorial": ANISOTROPIC | {"G": 3e4},
    "mohr_coulomb": {"E": 1e5, "G": 2.5e4, "phi": 0.4, "c": 2.0, "phi_residual": 0.3, "psi": 0.1, "beta": 30.0},
    "mu_of_I": {"mu_s": 0.28, "b": 1.1, "phi_max": 0.84, "slope": 0.3, "grain_mass": 1e-5},
}


def path(law, n):
    """(control, start) with n steps, short enough for no sub-steps."""
    t = np.linspace(0.0, 1.0, n + 1)
    # on the yield line from the start: how far Euler overshoots it later would be by chance
    shear = np.sqrt((85.0 * np.sin(0.4) + 2.0 * np.cos(0.4)) ** 2 - 15.0**2)
    there_and_back = np.where(t < 0.75, t, 1.5 - t)  # the reversal is a point of each path
    return {
        "scalar": (biaxial(0.003 * there_and_back, 100.0), None),
        "tensorial": (simple_shear(0.003 * there_and_back, 100.0), None),
        "mohr_coulomb": (simple_shear(0.02 * t, 100.0), {"sigma_xx": 70.0, "sigma_zz": 100.0, "sigma_xz": -shear}),
        "mu_of_I": (simple_shear(t + t**2, 100.0) | {"time": t}, {"area_fraction": 0.8399}),
    }[law]


# the return to the yield line is backward Euler, and a prescribed stress meets the mu(I) law at the end of a step: first order
ORDERS = {(law, "explicit"): 1.0 for law in LAWS} | {("scalar", "midpoint"): 2.0, ("tensorial", "midpoint"): 2.0}
ORDERS |= {("mohr_coulomb", "midpoint"): 1.0, ("mu_of_I", "midpoint"): 1.0}


def ends(law, steps, integrator):
    test = element_test(law, PARAMETERS[law], *path(law, steps), integrator=integrator)
    assert test.status, test.status
    return np.array([*test.stress[..., -1].ravel(), *(values[-1] for values in test.internal.values()), test.eps_V[-1]])


@pytest.mark.parametrize(("law", "integrator"), ORDERS)
def test_order(law, integrator):
    steps = 200 * 2 ** np.arange(4)
    fine, finest = (ends(law, n, RungeKutta45(1e-12)) for n in (12800, 25600))
    # a prescribed stress is met at the ends of steps, so the reference has an error of its own: extrapolated
    exact = finest + (finest - fine) / (2.0 ** (1.0 if law == "mu_of_I" else 2.0) - 1.0)
    scale = np.abs(exact)
    errors = [np.max(np.abs(ends(law, n, integrator) - exact) / np.where(scale > 0, scale, 1.0)) for n in steps.tolist()]
    order = -np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert order == pytest.approx(ORDERS[law, integrator], abs=0.15)


def some_state(law, rng, n):
    """(state, increment, spin) of n points well inside what the law knows, deviators far from zero."""
    sigma_V, angle = rng.uniform(90.0, 110.0, n), rng.uniform(0.0, 2 * np.pi, n)
    names = [name for name in LAWS[law].INTERNAL if name]
    inner = {name: rng.uniform(0.7, 0.8, n) if law == "mu_of_I" else rng.uniform(0.0, 0.01, n) for name in names}
    size = 15.0
    if law == "mohr_coulomb":  # some on the yield line, some reach it in this step, some do not
        inner["kappa"] = np.zeros(n)
        size = (sigma_V * np.sin(0.4) + 2.0 * np.cos(0.4)) * np.where(np.arange(n) < n // 2, 1.0, 0.95)
    s_1, s_2 = size * np.cos(angle), size * np.sin(angle)
    e_V, e_1, e_2 = rng.uniform(-1e-4, 1e-4, n), *(2e-4 * np.array([np.sin(3 * angle + 0.4), np.cos(3 * angle + 0.4)]))
    spin = rng.uniform(-0.01, 0.01, n)
    if law == "scalar":
        s_2, e_2, spin = 0.0 * s_2, 0.0 * e_2, 0.0 * spin
    state = PointState(np.array([[sigma_V + s_1, s_2], [s_2, sigma_V - s_1]]), inner)
    return state, np.array([[e_V + e_1, e_2], [e_2, e_V - e_1]]), spin


@pytest.mark.hard_case("C12")
@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("law", LAWS)
def test_the_tangent_is_that_of_the_step(law, integrator, rng, answer):
    parameters = law_parameters(law, **PARAMETERS[law])
    state, d_eps, spin = some_state(law, rng, 12)
    settings = {"d_spin": spin, "integrator": RungeKutta45(1e-10) if integrator == "rk45" else integrator}
    tangent = updated(state, d_eps, parameters, tangent=True, **settings).tangent
    # Runge-Kutta does not see how the moment of yielding shifts: the first five points begin on the line and stay on their side of it
    points = slice(5) if (law, integrator) == ("mohr_coulomb", "rk45") else slice(None)
    # rounding 1e-14 of the stress over 1e-8 against moduli of 1e4 to 1e5; Runge-Kutta chooses its steps anew, within its tolerance
    tolerance = 2.0 if integrator == "rk45" else 1e-6 * np.abs(tangent).max()
    h = 1e-8
    for i, j in ((0, 0), (1, 1)) if law == "scalar" else ((0, 0), (1, 1), (0, 1)):
        shift = np.zeros((2, 2, 1))
        shift[i, j] = shift[j, i] = h  # eps_01 and eps_10 together
        up, down = (updated(state, d_eps + sign * shift, parameters, **settings).stress for sign in (1.0, -1.0))
        column = tangent[:, :, i, j] + (tangent[:, :, j, i] if i != j else 0.0)
        difference = np.abs(column - (up - down) / (2 * h))[..., points].max()
        assert difference < tolerance
        answer.computed(difference / np.abs(tangent).max(), f"tangent of {integrator} against differences")


@pytest.mark.parametrize("law", LAWS)
def test_a_batch_equals_its_points(law, rng):
    parameters = law_parameters(law, **PARAMETERS[law])
    state, d_eps, spin = some_state(law, rng, 6)
    whole = updated(state, d_eps, parameters, d_spin=spin, tangent=True)
    for n in range(6):
        point = PointState(state.stress[..., n], {name: values[n] for name, values in state.internal.items()})
        one = updated(point, d_eps[..., n], parameters, d_spin=spin[n], tangent=True)
        np.testing.assert_array_equal(one.stress, whole.stress[..., n])
        np.testing.assert_array_equal(one.tangent, whole.tangent[..., n])
    grid = PointState(state.stress.reshape(2, 2, 2, 3), {name: values.reshape(2, 3) for name, values in state.internal.items()})
    shaped = updated(grid, d_eps.reshape(2, 2, 2, 3), parameters, d_spin=spin.reshape(2, 3), tangent=True)
    assert shaped.tangent.shape == (2, 2, 2, 2, 2, 3)
    np.testing.assert_array_equal(shaped.stress.reshape(2, 2, 6), whole.stress)


@pytest.mark.hard_case("C7")
@pytest.mark.parametrize("law", ["scalar", "tensorial"])
def test_a_huge_increment_is_cut_up(law, answer):
    """C7: one increment of 1 is 1e5 small ones within 1e-4."""
    soft = {"B": 60.0, "E": 1e3, "A_max": 30.0, "beta_F": 1.0} | ({"G": 30.0} if law == "tensorial" else {})
    for values in (PARAMETERS[law], PARAMETERS[law] | soft):  # the soft one is not yet relaxed at the end, beta_s = 2
        once = element_test(law, values, pure_shear([0.0, 1.0]), 100.0)
        many = element_test(law, values, pure_shear([0.0, 1.0]), 100.0, steps=100_000)
        assert once.status.level == many.status.level == "ok"
        assert once.s_D[-1] == pytest.approx(many.s_D[-1], abs=1e-4)
        assert once.stress[1, 1, -1] == pytest.approx(many.stress[1, 1, -1], rel=1e-4)
        answer.computed(abs(once.stress[1, 1, -1] / many.stress[1, 1, -1] - 1.0), "one step against 100,000")


def test_more_sub_steps_than_the_limit_are_a_named_failure():
    stiff = law_parameters("scalar", **(ANISOTROPIC | {"B": 1e12, "E": 1e13}))
    state = PointState(100.0 * np.eye(2), {"A": 0.0})
    with pytest.raises(InputError, match="needs more sub-steps than the integrator may take"):
        updated(state, np.diag([-1e-3, 1e-3]), stiff)
    kept = updated(state, np.diag([-1e-3, 1e-3]), stiff, on_failure="report")
    assert kept.outcome != 0
    np.testing.assert_array_equal(kept.stress, state.stress)
