import numpy as np
import pytest

from anisogran import tensors
from anisogran.models import PointState, element_test, law_parameters, pure_shear, relax, relax_tensor, simple_shear, stiffness, updated
from anisogran.outcome import InputError

VALUES = {"E": 1e5, "B": 6e4, "G": 2.5e4, "s_max": 0.3, "A_max": 2e4, "beta_F": 40.0}
LAW = law_parameters("tensorial", **VALUES)
ROUNDING = 1e-12  # some operations on numbers good to 2e-16, in units of the largest


def state(stress, A=0.0, phi_C=0.0):
    return PointState(np.asarray(stress), {"A_1": A * np.cos(2 * phi_C), "A_2": A * np.sin(2 * phi_C)})


def structure(updated_state):
    A_1, A_2 = updated_state.internal["A_1"], updated_state.internal["A_2"]
    return np.array([[A_1, A_2], [A_2, -A_1]])


def random_stress(rng, n=()):
    return 100.0 * np.eye(2).reshape(2, 2, *(1,) * len(n)) + tensors.symmetric(rng.uniform(-15, 15, (2, 2, *n)))


def random_strain(rng, size, n=()):
    return tensors.symmetric(rng.normal(scale=size, size=(2, 2, *n)))


def test_without_softening_it_is_the_anisotropic_law_with_the_same_moduli(rng):
    phi_C, d_eps = 0.3, random_strain(rng, 1e-9)
    free = LAW._replace(s_max=1e30, beta_F=0.0)  # no stress ratio is large then
    new = updated(state(random_stress(rng), LAW.A_max, phi_C), d_eps, free, tangent=True)
    expected = stiffness(VALUES["E"], LAW.A_max, VALUES["B"], phi_C, VALUES["G"])
    np.testing.assert_allclose(new.tangent, expected, atol=ROUNDING * 2e5)


def test_coaxial_loading_is_the_scalar_law(rng):
    scalar = {key: VALUES[key] for key in ("E", "s_max", "A_max", "beta_F")} | {"B": 5e4}
    control = {"eps_zz": [0.0, 0.01, -0.003, 0.02], "sigma_xx": 100.0}
    one = element_test("scalar", scalar, control, steps=100)
    two = element_test("tensorial", scalar | {"G": 2.5e4}, control, steps=100)
    np.testing.assert_allclose(two.stress, one.stress, atol=1e-8)  # two Newton methods to 1e-11 of 200, amplified by E/sigma
    np.testing.assert_allclose(two.strain, one.strain, atol=1e-12)
    np.testing.assert_allclose(two.internal["A_1"], -one.internal["A"], rtol=1e-9)
    assert not np.any(two.internal["A_2"])


def test_without_anisotropy_the_axis_has_no_say(rng):
    """C3: at A = 0 the response is isotropic, also in the lecture's form 2G = E - B with E != 2B."""
    lecture = law_parameters("tensorial", **(VALUES | {"G": None}))
    for law, two_G in ((LAW, 5e4), (lecture, 4e4)):
        d_eps = random_strain(rng, 1e-10)
        new = updated(state(100.0 * np.eye(2)), d_eps, law).stress - 100.0 * np.eye(2)
        expected = law.E * tensors.mean(d_eps) * np.eye(2) + two_G * tensors.deviator(d_eps)
        np.testing.assert_allclose(new, expected, atol=5e-12)  # the softening begins: 1e-10 E/(s_max sigma_V) of 1e-5
    with pytest.raises(InputError, match="A_max = 0 needs B = 2G"):
        law_parameters("tensorial", **(VALUES | {"A_max": 0.0}))
    with pytest.raises(InputError, match="2G, since no G is given"):
        law_parameters("tensorial", **(VALUES | {"G": None, "B": 2e5}))


@pytest.mark.parametrize("integrator", ["midpoint", "rk45", "explicit"])
def test_a_turned_sample_gives_the_turned_answer(rng, integrator):
    n = (20,)
    stress, d_eps, spin = random_stress(rng, n), random_strain(rng, 1e-4, n), rng.normal(scale=1e-2, size=n)
    A, phi_C, angle = rng.uniform(0, LAW.A_max, n), rng.uniform(0, np.pi, n), rng.uniform(0, np.pi, n)
    here = updated(state(stress, A, phi_C), d_eps, LAW, d_spin=spin, integrator=integrator)
    turned_start = state(tensors.rotate(stress, angle), A, phi_C + angle)
    there = updated(turned_start, tensors.rotate(d_eps, angle), LAW, d_spin=spin, integrator=integrator)
    np.testing.assert_allclose(there.stress, tensors.rotate(here.stress, angle), rtol=0, atol=ROUNDING * np.abs(here.stress).max())
    np.testing.assert_allclose(structure(there.state), tensors.rotate(structure(here.state), angle), rtol=0, atol=ROUNDING * LAW.A_max)


@pytest.mark.parametrize("angle", [1e-3, 0.7, 3.0])
def test_a_rigid_rotation_turns_everything_and_changes_nothing_else(rng, angle):
    stress = random_stress(rng)
    new = updated(state(stress, 1e4, 0.4), np.zeros((2, 2)), LAW, d_spin=angle)
    np.testing.assert_allclose(new.stress, tensors.rotate(stress, angle), atol=ROUNDING * 200)
    np.testing.assert_allclose(structure(new.state), 1e4 * tensors.direction(0.4 + angle), atol=ROUNDING * 1e4)


def test_units_do_not_matter(rng):
    d_eps = random_strain(rng, 3e-3)
    stress = random_stress(rng)
    here = updated(state(stress, 1e4, 0.4), d_eps, LAW, d_spin=0.01)
    for scale in (1e-3, 1e9):
        other = law_parameters("tensorial", **(VALUES | {key: scale * VALUES[key] for key in ("E", "B", "G", "A_max")}))
        there = updated(state(scale * stress, scale * 1e4, 0.4), d_eps, other, d_spin=0.01)
        np.testing.assert_allclose(there.stress / scale, here.stress, rtol=ROUNDING)


def test_the_evolution_of_the_structure_is_the_scalar_one_along_one_axis_and_exact_in_simple_shear(rng):
    a = relax_tensor(0.1 * tensors.direction(0.3), 0.4, 50.0, 0.02 * tensors.direction(0.3) + 7.0 * np.eye(2))
    np.testing.assert_allclose(a, relax(0.1, 0.4, 50.0, 0.02) * tensors.direction(0.3), rtol=ROUNDING)
    back = relax_tensor(0.1 * tensors.direction(0.3), 0.4, 50.0, -0.02 * tensors.direction(0.3))
    np.testing.assert_allclose(back, relax(0.1, 0.4, 50.0, -0.02) * tensors.direction(0.3), rtol=ROUNDING)
    # simple shear: one step is many; and steps of any size meet at the closed form, also where it would cancel
    strain, spin = 0.05 * tensors.direction(-0.25 * np.pi), -0.05
    once = relax_tensor(0.1 * tensors.direction(0.3), 0.4, 50.0, strain, spin)
    for parts in (7, 1000):
        many = 0.1 * tensors.direction(0.3)
        for _ in range(parts):
            many = relax_tensor(many, 0.4, 50.0, strain / parts, spin / parts)
        np.testing.assert_allclose(many, once, atol=1e-13 * parts**0.5)  # rounding of each part
    # in the end it lags behind the strain by atan(2/beta)/2 and is smaller by 1/sqrt(1 + (2/beta)^2)
    last = relax_tensor(np.zeros((2, 2)), 0.4, 50.0, 100 * strain, 100 * spin)
    assert tensors.principal_angle(last) == pytest.approx(-0.25 * np.pi - 0.5 * np.arctan(2 / 50.0), rel=ROUNDING)
    assert tensors.deviator_size(last) == pytest.approx(0.4 / np.hypot(1.0, 2 / 50.0), rel=ROUNDING)


def test_batches_of_any_shape(rng):
    a = relax_tensor(np.zeros((2, 2, 4, 1)), 0.4, 50.0, random_strain(rng, 0.1, (3,)), rng.normal(size=(4, 3)))
    assert a.shape == (2, 2, 4, 3)
    for bad in ({"a": np.zeros((3, 3))}, {"beta": -1.0}, {"a_max": np.nan}):
        with pytest.raises(InputError, match="relax_tensor"):
            relax_tensor(**{"a": np.zeros((2, 2)), "a_max": 0.4, "beta": 50.0, "d_eps": np.zeros((2, 2))} | bad)


def test_steady_simple_shear_is_isochoric_and_lags_behind_the_strain_rate():
    """At constant pressure and B = 2G the stress ratio obeys the same law as the structure, with beta_s = B/(sigma_V s_max)."""
    values = VALUES | {"B": 5e4, "A_max": 0.0}
    test = element_test("tensorial", values, simple_shear([0.0, 0.3], sigma_zz=100.0), steps=3000)
    assert test.status.level == "ok"
    beta = values["B"] / (test.sigma_V[-1] * values["s_max"])
    lag = 0.5 * np.arctan(2.0 / beta)
    angle = tensors.principal_angle(test.stress[..., -1])
    assert angle == pytest.approx(-0.25 * np.pi - lag, abs=1e-6)  # second order in the relaxation of 0.08 in a step, of a lag of 6e-4
    assert test.stress_ratio[-1] == pytest.approx(values["s_max"] / np.hypot(1.0, 2.0 / beta), rel=1e-6)
    assert abs(test.eps_V[-1] - test.eps_V[-300]) < 1e-9  # no change of volume any more


def test_the_stress_of_a_steady_critical_state_does_not_depend_on_the_moduli():
    ends = []
    for change in ({}, {"E": 3e5, "B": 1e5, "G": 4e4}, {"A_max": 5e4, "beta_F": 200.0}):
        test = element_test("tensorial", VALUES | change, pure_shear([0.0, 0.5]), 100.0, steps=500)
        ends.append(test.s_D[-1])
    np.testing.assert_allclose(ends, 0.3, rtol=1e-9)  # exp(-beta) of a large beta is left


def test_opposite_shear_gives_the_mirrored_answer():
    one = element_test("tensorial", VALUES, simple_shear([0.0, 0.05, 0.0], 100.0), steps=50)
    two = element_test("tensorial", VALUES, simple_shear([0.0, -0.05, 0.0], 100.0), steps=50)
    np.testing.assert_allclose(two.stress[0, 1], -one.stress[0, 1], atol=1e-9)  # control of the stress to 1e-11 of 100, amplified
    np.testing.assert_allclose(two.sigma_xx, one.sigma_xx, atol=1e-9)
