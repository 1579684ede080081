"""The hard cases of a law at a point, over every law of the list: its limits, and what does not matter to it."""

import numpy as np
import pytest
from law_cases import (
    INTERNAL_OF_STRESS,
    NO_MEANING,
    PARAMETERS,
    START,
    laws,
    record,
    scaled,
    shearing,
    state,
    strain,
)

from anisogran import tensors
from anisogran.models import LAWS, biaxial, element_test, law_parameters, pure_shear, updated
from anisogran.outcome import InputError

ROUNDING = 1e-12  # some operations on numbers good to 2e-16, in units of the largest


def largest(difference, values):
    """The largest difference in units of the largest value."""
    return np.abs(difference).max() / np.abs(values).max()


def test_every_case_has_a_law_and_every_exception_is_of_one():
    assert set(PARAMETERS) == set(START) == set(LAWS)
    for case, law in NO_MEANING:
        assert law in LAWS
        assert laws(case)


@pytest.mark.parametrize("law", laws("C1"))
@pytest.mark.parametrize(
    "above", [pytest.param(1.0 + 1e-15, marks=pytest.mark.hard_case("C1")), pytest.param(1.5, marks=pytest.mark.hard_case("C2"))]
)
def test_a_stiffness_that_is_not_positive_definite_is_refused_at_the_start(law, above, answer):
    """E B = A^2 and below."""
    change = {"A_max": 2.0 * np.sqrt(5e9)} | ({"G": 2.5e4} if law == "tensorial" else {})  # B = 2G: the limit is sqrt(E B)
    name = "A" if law == "scalar" else "A_2"
    A = above * np.sqrt(5e9)
    with pytest.raises(InputError, match="not positive definite") as caught:
        element_test(law, PARAMETERS[law] | change, pure_shear([0.0, 0.01]), {"sigma_xx": 100.0, "sigma_zz": 100.0, name: A})
    with pytest.raises(InputError, match=r"not positive definite \(E B <= A\^2\)"):
        updated(state(law, **{name: A}), strain(0.0, 1e-6), record(law, **change))
    answer.refused(caught)


@pytest.mark.hard_case("C3", "C11")
@pytest.mark.parametrize("law", laws("C3"))
@pytest.mark.parametrize("tangent", [False, True])
def test_a_turned_sample_gives_the_turned_answer(law, tangent, rng, answer):
    """C3, C11: nothing but its own structure gives a law an axis; without one (A = 0) the answer to a strain turns with the strain."""
    n, A = 50, np.repeat([0.0, 1e4], 25)
    angle, phi, way = rng.uniform(0.0, 2 * np.pi, (3, n))
    d_eps = tensors.symmetric(rng.normal(scale=1e-4, size=(2, 2, n)))
    stress = 100.0 * np.eye(2)[..., None] + 20.0 * tensors.direction(way)

    def start(turn):
        structure = {"A_1": A * np.cos(2 * (phi + turn)), "A_2": A * np.sin(2 * (phi + turn))} if law == "tensorial" else {}
        return state(law, **structure)._replace(stress=tensors.rotate(stress, turn))

    p = record(law)
    here = updated(start(0.0 * angle), d_eps, p, d_spin=1e-3, tangent=tangent)
    there = updated(start(angle), tensors.rotate(d_eps, angle), p, d_spin=1e-3, tangent=tangent)
    error = largest(there.stress - tensors.rotate(here.stress, angle), here.stress)
    assert error < ROUNDING
    answer.computed(error, "stress of a turned sample")
    if tangent:
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        expected = np.einsum("ian,jbn,kcn,ldn,abcdn->ijkln", turn, turn, turn, turn, here.tangent)
        # the loss of a softened tangent is sigma/(s_max sigma_V) of it: some roundings more
        error = largest(there.tangent - expected, expected)
        assert error < 10 * ROUNDING
        answer.computed(error, "tangent of a turned sample")


@pytest.mark.hard_case("C11")
@pytest.mark.parametrize("law", LAWS)
def test_axes_may_be_swapped(law, answer):
    """C11: x for z; an anisotropy that is stiffer along z then is so along x."""
    control = shearing(law)
    swap = str.maketrans("xz", "zx")
    other = {key.translate(swap) if key[-2:] in ("xx", "zz") else key: values for key, values in control.items()}
    if law == "mu_of_I":
        other["eps_D"] = -np.asarray(control["eps_D"])
    one = element_test(law, PARAMETERS[law], control, START[law], steps=50)
    two = element_test(law, PARAMETERS[law], other, START[law], steps=50)
    assert one.status.level == two.status.level == "ok"
    np.testing.assert_allclose(two.sigma_xx, one.sigma_zz, rtol=1e-9)  # control of the stress to 1e-11, amplified
    np.testing.assert_allclose(two.sigma_zz, one.sigma_xx, rtol=1e-9)
    answer.computed(largest(two.sigma_xx - one.sigma_zz, one.sigma_zz), "path with x for z")
    np.testing.assert_allclose(two.eps_V, one.eps_V, atol=1e-9 * np.abs(one.strain).max())
    for name, values in one.internal.items():
        sign = -1.0 if name in INTERNAL_OF_STRESS else 1.0
        np.testing.assert_allclose(two.internal[name], sign * values, rtol=1e-9, atol=1e-9 * np.abs(values).max())


@pytest.mark.hard_case("C11")
@pytest.mark.parametrize("scale", [1e-3, 1.0 / 3.0, 1e9])
@pytest.mark.parametrize("law", LAWS)
def test_units_do_not_matter(law, scale, rng, answer):
    n = 20
    d_eps = strain(*rng.normal(scale=3e-4, size=(3, n)) * (np.array([[1], [1], [0]]) if law == "scalar" else 1))
    sigma_1 = rng.uniform(-15.0, 15.0, n)
    inner = {name: rng.uniform(0.0, 1e4, n) for name in INTERNAL_OF_STRESS.intersection(LAWS[law].INTERNAL)}
    here = updated(state(law, 100.0, sigma_1, **inner), d_eps, record(law))
    other = law_parameters(law, **scaled(law, scale))
    start = state(law, scale * 100.0, scale * sigma_1, **{name: scale * values for name, values in inner.items()})
    there = updated(start, d_eps, other)
    error = largest(there.stress / scale - here.stress, here.stress)
    assert error < ROUNDING
    answer.computed(error, "stress in other units")
    # along a path with a prescribed stress
    control = shearing(law)
    bigger = {key: scale * np.asarray(values) if key.startswith("sigma") else values for key, values in control.items()}
    begin = START[law] if isinstance(START[law], dict) else scale * START[law]
    one = element_test(law, PARAMETERS[law], control, START[law], steps=20)
    two = element_test(law, scaled(law, scale), bigger, begin, steps=20)
    np.testing.assert_allclose(two.stress / scale, one.stress, rtol=0, atol=1e-9 * one.stress.max())  # control to 1e-11, amplified
    np.testing.assert_allclose(two.strain, one.strain, rtol=0, atol=1e-11)


@pytest.mark.hard_case("C4")
@pytest.mark.parametrize("law", LAWS)
def test_compression_without_shear_knows_no_direction(law, rng, answer):
    """C4: no deviator appears, a shear of 1e-18 does not matter, and neither does the sign of zero."""
    p = record(law)
    quiet = updated(state(law), strain(1e-4, 0.0), p, tangent=True)
    assert np.all(np.isfinite(quiet.tangent))
    np.testing.assert_allclose(tensors.deviator(quiet.stress), 0.0, atol=1e-180)  # the square of the complex step is left
    for zeros in ((-0.0, 0.0), (0.0, -0.0), (-0.0, -0.0)):
        np.testing.assert_array_equal(updated(state(law), strain(1e-4, *zeros), p, tangent=True).tangent, quiet.tangent)
    noise = rng.normal(scale=1e-18, size=(2, 10)) * ([[1.0], [0.0]] if law == "scalar" else 1.0)
    noisy = updated(state(law), strain(1e-4 + 0.0 * noise[0], *noise), p)
    np.testing.assert_allclose(noisy.stress, np.repeat(quiet.stress[..., None], 10, axis=2), atol=ROUNDING * 110.0)
    test = element_test(law, PARAMETERS[law], {"eps_V": [0.0, 0.01], "eps_D": [0.0, 1e-18]}, START[law], steps=20)
    assert test.status.level == "ok"
    shear = np.abs(0.5 * (test.sigma_zz - test.sigma_xx)).max() / 1100.0
    assert shear <= ROUNDING
    answer.computed(shear, "deviator of the stress")


@pytest.mark.hard_case("C10")
@pytest.mark.parametrize("law", LAWS)
def test_no_increment_changes_nothing(law, answer):
    """C10: the state, from a state of stress, stays to the last digit; so does a path whose start is its end."""
    begin = state(law, 100.0, -10.0)
    new = updated(begin, strain(0.0, 0.0), record(law))
    for name, value in begin.internal.items():
        assert new.state.internal[name] == value
    expected = begin.stress if LAWS[law].STRESS_IS_STATE else np.zeros((2, 2))  # at rest it has none: also I -> 0 (M1)
    error = np.abs(new.stress - expected).max() / 110.0
    assert error <= 1e-14  # one product with the direction of the stress
    answer.computed(error, "stress after no increment")
    test = element_test(law, PARAMETERS[law], pure_shear([0.0, 0.0]), START[law], steps=3)
    assert test.status.level == "ok"
    np.testing.assert_array_equal(test.stress[..., -1], test.stress[..., 0])
    assert test.work[-1] == 0.0


@pytest.mark.hard_case("C10")
@pytest.mark.parametrize(
    ("law", "change"),
    [
        ("scalar", {"beta_F": 0.0}),
        ("scalar", {"s_max": 0.0}),
        ("scalar", {"A_max": 0.0}),
        ("scalar", {"A_max": -2e4}),
        ("tensorial", {"beta_F": 0.0}),
        ("tensorial", {"s_max": 0.0}),
        ("tensorial", {"A_max": 0.0, "B": 4e4}),
        ("mohr_coulomb", {"beta": 0.0}),
        ("mohr_coulomb", {"phi": 0.0, "phi_residual": 0.0, "psi": 0.0}),
        ("mohr_coulomb", {"phi": 0.0, "phi_residual": 0.0, "psi": 0.0, "c": 0.0}),
        ("mu_of_I", {"mu_s": 0.0, "mu_d": 0.0}),
    ],
)
def test_parameters_at_their_limits_divide_by_nothing(law, change):
    """C10."""
    test = element_test(law, PARAMETERS[law] | change, pure_shear([0.0, 0.05, -0.05]), START[law], steps=50)
    assert test.status.level == "ok"
    assert np.all(np.isfinite(test.stress))
    if change in ({"s_max": 0.0}, {"mu_s": 0.0, "mu_d": 0.0}) or len(change) == 4:
        np.testing.assert_allclose(test.sigma_zz, test.sigma_xx, rtol=ROUNDING)  # bears no shear
    if "beta_F" in change:
        assert not any(np.any(values) for values in test.internal.values())
    if change.get("A_max") == -2e4:
        assert test.internal["A"].min() < -1e4  # softer along the compression


@pytest.mark.hard_case("C10", of="tensorial")
def test_a_negative_limit_of_the_tensorial_anisotropy_is_refused(answer):
    """C10: an axis says which way it points; the size has no sign."""
    with pytest.raises(InputError, match="A_max = -20000 must be at least 0") as caught:
        record("tensorial", A_max=-2e4)
    answer.refused(caught)


@pytest.mark.hard_case("C6")
@pytest.mark.parametrize("law", laws("C6"))
def test_a_stress_above_the_limit_comes_down_or_is_refused(law, answer):
    """C6: without NaN and monotonically; the yield line takes it back at once, and a path may not start there."""
    control, start = biaxial([0.0, 0.02], 100.0), {"sigma_xx": 100.0, "sigma_zz": 250.0}  # s_D = 0.43
    if law == "mohr_coulomb":
        with pytest.raises(InputError, match="outside the yield line") as caught:
            element_test(law, PARAMETERS[law], control, start)
        answer.refused(caught)
        new = updated(state(law, 175.0, -90.0), strain(0.0, 0.0), record(law))
        kappa = new.state.internal["kappa"]
        limit = np.sin(0.3) + (np.sin(0.4) - np.sin(0.3)) * np.exp(-30.0 * kappa), 2.0 * np.cos(0.3)
        fallen = limit[1] + (2.0 * np.cos(0.4) - limit[1]) * np.exp(-30.0 * kappa)
        sigma_V, sigma_D = tensors.mean(new.stress), tensors.deviator_size(new.stress)
        assert sigma_D == pytest.approx(limit[0] * sigma_V + fallen, rel=ROUNDING)
        answer.computed(abs(sigma_D / (limit[0] * sigma_V + fallen) - 1.0), "return to the yield line")
        return
    test = element_test(law, PARAMETERS[law], control, start, steps=200)
    assert test.status.level == "ok"
    assert np.all(np.diff(test.s_D) <= 1e-12)  # ten roundings of a stress ratio
    assert test.s_D[-1] == pytest.approx(0.3, rel=1e-6)
    answer.computed(abs(test.s_D[-1] / 0.3 - 1.0), "monotonically down to s_max")


@pytest.mark.parametrize("law", laws("M2"))
def test_a_fast_flow_has_the_largest_friction_and_no_overflow(law):
    """M2: I -> infinity by a slope of the area fraction that vanishes."""
    for slope in (1e-6, 1e-300):
        new = updated(state(law), strain(0.0, -0.1), record(law, slope=slope), d_time=1e-3)
        sigma_V, sigma_D = tensors.mean(new.stress), tensors.deviator_size(new.stress)
        assert sigma_V >= 0.0
        assert sigma_D == pytest.approx(0.5 * sigma_V, rel=1e-5)  # 1/(1 + I0/I)
