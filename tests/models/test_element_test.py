"""The element test as a user meets it: controls, named ends, and the file that repeats a failure."""

import tomllib

import numpy as np
import pytest

import anisogran as ag
from anisogran.models import LAWS, biaxial, cyclic, element_test, isotropic_compression, pure_shear, simple_shear
from anisogran.outcome import InputError, RunFailed

SCALAR = {"E": 1e5, "B": 5e4, "s_max": 0.3, "A_max": 1e4, "beta_F": 40.0}
PLASTIC = {"E": 1e5, "G": 2.5e4, "phi": 0.4, "c": 5.0}


def test_every_control_is_met():
    tolerance = 1e-10  # ten times what Newton's method is asked for
    test = ag.element_test("scalar", SCALAR, biaxial([0.0, 0.01], 100.0), steps=50)
    np.testing.assert_allclose(test.sigma_xx, 100.0, rtol=tolerance)
    np.testing.assert_allclose(test.eps_zz, np.linspace(0, 0.01, 51), atol=1e-14)
    test = element_test("tensorial", SCALAR | {"G": 2.5e4}, simple_shear([0.0, 0.1], 100.0), steps=50)
    np.testing.assert_allclose(test.sigma_zz, 100.0, rtol=tolerance)
    np.testing.assert_allclose(test.strain[0, 1], -0.5 * np.linspace(0, 0.1, 51), atol=1e-14)
    np.testing.assert_allclose(test.spin, test.strain[0, 1], atol=1e-14)
    assert not np.any(test.eps_xx)
    test = element_test("tensorial", SCALAR | {"G": 2.5e4}, isotropic_compression([100.0, 200.0, 150.0]), steps=50)
    np.testing.assert_allclose(test.sigma_V, np.interp(np.arange(101), [0, 50, 100], [100, 200, 150]), rtol=tolerance)
    np.testing.assert_allclose(test.eps_V, (test.sigma_V - 100.0) / SCALAR["E"], atol=1e-14)  # an isotropic sample answers with E alone
    np.testing.assert_allclose(test.sigma_D, 0.0, atol=100 * tolerance)
    test = element_test("scalar", SCALAR, pure_shear(cyclic(0.01, 2)), 100.0, steps=20)
    assert not np.any(np.abs(test.eps_V) > 1e-16)
    np.testing.assert_allclose(test.eps_D[::20], [0.0, 0.01, -0.01, 0.01, -0.01, 0.0], atol=1e-16)
    table = {"sigma_zz": [100.0, 130.0, 120.0], "sigma_xx": [100.0, 90.0, 100.0], "sigma_xz": [0.0, 5.0, -5.0]}  # all by stress
    test = element_test("tensorial", SCALAR | {"G": 2.5e4}, table, steps=30)
    np.testing.assert_allclose(test.stress[:, :, [30, 60]].reshape(4, 2), [[90, 100], [5, -5], [5, -5], [130, 120]], rtol=tolerance)


def test_a_path_by_points_may_begin_anywhere():
    here = element_test("scalar", SCALAR, {"eps_zz": [0.02, 0.021, 0.022], "sigma_xx": 100.0})
    there = element_test("scalar", SCALAR, {"eps_zz": [0.0, 0.001, 0.002], "sigma_xx": 100.0})
    np.testing.assert_allclose(here.eps_zz, there.eps_zz + 0.02, atol=1e-15)
    np.testing.assert_allclose(here.stress, there.stress, rtol=1e-12)  # rounding of the shifted strains times E


def test_the_work_is_that_of_the_stress():
    test = element_test("scalar", SCALAR | {"A_max": 0.0, "s_max": 0.999}, isotropic_compression([100.0, 200.0]), steps=10)
    # 2 int sigma_V d eps_V, and the trapezoidal rule is exact for a straight line
    assert test.work[-1] == pytest.approx((200.0**2 - 100.0**2) / SCALAR["E"], rel=1e-10)


def test_mohr_coulomb_yields_at_the_peak_stress_of_its_line():
    test = element_test("mohr_coulomb", PLASTIC, biaxial([0.0, 0.05], 100.0), steps=100)
    assert test.sigma_zz[-1] == pytest.approx(ag.models.peak_stress(100.0, 0.4, 5.0), rel=1e-10)  # the control of the stress
    assert test.internal["kappa"][-1] > 0.0
    falling = element_test(
        "mohr_coulomb", PLASTIC | {"phi_residual": 0.3, "beta": 100.0, "psi": 0.1}, biaxial([0.0, 0.4], 100.0), steps=400
    )
    assert falling.sigma_zz.max() > falling.sigma_zz[-1]
    assert falling.sigma_zz[-1] == pytest.approx(ag.models.peak_stress(100.0, 0.3, 5.0), rel=1e-6)  # exp(-40) of the fall is left
    rates = np.diff(falling.eps_V)[-50:] / np.diff(falling.internal["kappa"])[-50:]
    np.testing.assert_allclose(rates, -np.sin(0.1), rtol=1e-6)  # plastic flow dilates by sin(psi)


def test_the_inertial_law_meets_a_prescribed_pressure_at_its_own_area_fraction():
    values = {"mu_s": 0.28, "b": 1.1, "phi_max": 0.82, "slope": 0.3, "grain_mass": 1e-5}
    pressure, rate = 100.0, 20.0
    control = simple_shear([0.0, 1.0], pressure) | {"time": [0.0, 1.0 / rate]}
    test = element_test("mu_of_I", values, control, {"area_fraction": 0.81}, steps=50)
    I = ag.models.inertial_number(rate, pressure, 1e-5)
    assert test.sigma_V[-1] == pytest.approx(pressure, rel=1e-10)
    assert test.stress[0, 1, -1] == pytest.approx(-ag.models.mu_linear(I, 0.28, 1.1) * pressure, rel=1e-9)
    assert test.internal["area_fraction"][-1] == pytest.approx(ag.models.area_fraction_of_I(I, 0.82, 0.3), rel=1e-9)
    assert np.isnan(test.s_D[0])  # no stress before the first step
    saturating = values | {"b": 0.0, "mu_d": 0.5, "I0": 0.1}
    test = element_test("mu_of_I", saturating, control, {"area_fraction": 0.81}, steps=5)
    assert test.stress_ratio[-1] == pytest.approx(ag.models.mu_of_I(I, 0.28, 0.5, 0.1), rel=1e-9)


FAILURES = {
    "positive definite": ("scalar", SCALAR | {"A_max": 9e4}, biaxial([0.0, 0.1], 100.0), 200),
    "gives way": ("scalar", SCALAR | {"E": 4e4, "B": 9e4, "A_max": 5.9e4, "beta_F": 400.0}, biaxial([0.0, 0.1], 100.0), 200),
    "tension": ("tensorial", SCALAR | {"G": 2.5e4}, {"eps_V": [0.0, -0.01], "eps_D": 0.0}, 100),
    "not reachable": ("scalar", SCALAR, {"sigma_D": [0.0, 60.0], "sigma_V": 100.0}, 100),
    "apex": ("mohr_coulomb", PLASTIC, {"eps_V": [0.0, -0.01], "eps_D": 0.0}, 100),
    "snap-back": ("mohr_coulomb", PLASTIC | {"phi_residual": 0.1, "beta": 1e4}, pure_shear([0.0, 0.01]), 100),
    "jams": ("mu_of_I", {"mu_s": 0.28, "phi_max": 0.82, "slope": 0.3, "grain_mass": 1e-5}, {"eps_V": [0.0, 0.1], "eps_D": 0.0}, 100),
    "sub-steps": ("scalar", SCALAR | {"E": 1e13, "B": 1e12}, pure_shear([0.0, 1.0]), 2),
}


@pytest.mark.parametrize("words", FAILURES)
def test_a_path_that_cannot_be_followed_ends_by_name_and_repeats_itself(words):
    law, values, control, steps = FAILURES[words]
    start = {"area_fraction": 0.8} if law == "mu_of_I" else 100.0
    test = element_test(law, values, control, start, steps)
    assert test.status.level == "failed"
    assert words in str(test.status)
    with pytest.raises(RunFailed, match="stopped at"):
        test.status.require()
    assert 1 <= len(test.eps_zz) < steps + 1  # up to the last state that was reached
    for curve in (test.strain, test.stress, *test.internal.values()):
        assert np.all(np.isfinite(curve))
    again = element_test(**tomllib.loads(test.reproduction))
    assert len(again.eps_zz) == 1
    np.testing.assert_allclose(
        again.stress[..., 0] if law != "mu_of_I" else 0.0, test.stress[..., -1] if law != "mu_of_I" else 0.0, rtol=1e-15
    )
    assert words in str(again.status)


def test_what_went_well_has_nothing_to_repeat_and_what_is_doubtful_says_so():
    test = element_test("scalar", SCALAR, biaxial([0.0, 0.01], 100.0), steps=10)
    assert (test.status.level, test.reproduction) == ("ok", "")
    test = element_test("tensorial", SCALAR | {"G": 2.5e4}, isotropic_compression([100.0, 0.05]), steps=100)
    assert "sigma_V falls to 0.05, below 1e-06 E" in str(test.status)
    elastic = {"E": 1e5, "B": 5e4, "s_max": 0.3, "A_max": 0.0, "beta_F": 0.0}
    loop = element_test("scalar", elastic, pure_shear([0.0, -1e-5, 0.0]), {"sigma_zz": 125.0, "sigma_xx": 75.0}, 500)
    assert "gave" in str(loop.status)  # it unloads from a stress that it bore before


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"law": "cubic"}, "law = 'cubic' must be one of scalar, tensorial"),
        ({"parameters": SCALAR | {"s_mx": 1.0}}, "unknown parameter 's_mx', did you mean 's_max'"),
        ({"parameters": {"E": 1.0}}, "B, s_max, A_max, beta_F missing"),
        ({"parameters": SCALAR | {"E": 0.0}}, "E = 0 must be above 0"),
        ({"parameters": SCALAR | {"s_max": 1.0}}, "s_max = 1 must be below 1"),
        ({"parameters": SCALAR | {"beta_F": -1.0}}, "beta_F = -1 must be at least 0"),
        ({"parameters": [1.0]}, "parameters must be a dict"),
        ({"start": {"A": 8e4}}, "must be below sqrt"),
        ({"start": {"sigma_yy": 8e4}}, "start has 'sigma_yy', did you mean"),
        ({"start": 50.0}, "sigma_xx is prescribed as 100 at the start, but the sample starts at 50"),
        ({"start": np.nan}, "must be a finite number"),
        ({"control": {"eps_zz": [0.0, np.nan], "sigma_xx": 100.0}}, "row of finite numbers"),
        ({"control": {"eps_zz": [0.0, 0.1]}}, "three components are needed"),
        ({"control": {"eps_zz": [0.0, 0.1], "sigma_zz": 100.0}}, "not independent"),
        ({"control": {"eps_zz": [0.0, 0.1], "sigma_xx": [1.0, 2.0, 3.0]}}, "as many in every key"),
        ({"control": {"eps_zz": 0.1, "sigma_xx": 100.0}}, "turning points must be two or more"),
        ({"control": {"eps_zz": [0.0, 0.1], "sigma_X": 100.0}}, "unknown key 'sigma_X', did you mean 'sigma_"),
        ({"control": {"eps_zz": "much", "sigma_xx": 100.0}}, "must be a number or a row of numbers"),
        (
            {"control": {"eps_zz": [0.0, 0.1], "sigma_xx": 100.0, "time": [1.0, 0.0]}},
            "time must have a value for each turning point and grow",
        ),
        ({"control": {"eps_zz": [0.0, 0.1], "eps_xx": 0.0}}, "sigma_V = 0 must be above 0"),
        ({"steps": 0}, "steps = 0 must be a whole number from 1"),
        ({"steps": 10**8}, "at most 10000000 in all"),
        ({"integrator": "magic"}, "integrator = 'magic' must be one of midpoint"),
    ],
)
def test_what_makes_no_sense_is_refused_by_name(change, words):
    with pytest.raises(InputError, match=words):
        element_test(**{"law": "scalar", "parameters": SCALAR, "control": biaxial([0.0, 0.1], 100.0), "steps": 10} | change)


def test_the_starts_of_the_other_laws_are_checked():
    inertial = {"mu_s": 0.28, "phi_max": 0.82, "slope": 0.3, "grain_mass": 1e-5}
    with pytest.raises(InputError, match="starts from area_fraction, its stress follows"):
        element_test("mu_of_I", inertial, pure_shear([0.0, 0.1]), 100.0)
    with pytest.raises(InputError, match=r"area_fraction = 0.9 must be below 0.82"):
        element_test("mu_of_I", inertial, pure_shear([0.0, 0.1]), {"area_fraction": 0.9})
    with pytest.raises(InputError, match="outside the yield line"):
        element_test("mohr_coulomb", PLASTIC, pure_shear([0.0, 0.1]), {"sigma_xx": 10.0, "sigma_zz": 100.0})
    with pytest.raises(InputError, match="too large for E B > A"):
        element_test("tensorial", SCALAR | {"G": 2.5e4}, pure_shear([0.0, 0.1]), {"sigma_xx": 10.0, "sigma_zz": 10.0, "A_2": 9e4})


@pytest.mark.parametrize("law", LAWS)
def test_the_parameters_that_a_law_tells_of_are_those_it_takes(law):
    values = {key: example for key, (_, _, example) in LAWS[law].KEYS.items()}
    assert ag.models.law_parameters(law, **values)


def test_curves_as_a_dataset():
    data = element_test("tensorial", SCALAR | {"G": 2.5e4}, simple_shear([0.0, 0.1], 100.0), steps=5).dataset()
    assert data.sizes == {"step": 6}
    assert data.sigma_xz.attrs["units"] == "N/m"
    assert data.attrs["parameter_E"] == 1e5
    assert set(data.data_vars) > {"A_1", "A_2", "eps_V", "stress_ratio", "rotation"}
