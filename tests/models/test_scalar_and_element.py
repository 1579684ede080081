import numpy as np
import pytest

from anisogran.models import ScalarParameters, ScalarState, isobaric_biaxial, scalar_step, softening
from anisogran.outcome import InputError, RunFailed

LAW = ScalarParameters(E=1e5, B=5e4, s_max=0.3, A_max=1e4, beta_F=40.0)
PRESSURE = 100.0


def test_softening_is_signed_clamped_when_loading_only_and_exact_at_no_strength():
    assert softening(0.15, 0.3) == 0.5
    assert softening(0.15, 0.3, sense=-1.0) == 1.5  # unloading is stiffer than virgin loading
    assert softening(0.4, 0.3) == 0.0
    assert softening(0.0, 0.0) == 0.0


def test_a_small_step_follows_the_rate_form():
    state, d = ScalarState(100.0, 12.0, 4e3), 1e-9
    for sense in (1.0, -1.0):
        S = 1.0 - sense * 0.12 / 0.3
        new, stress, tangent = scalar_step(state, (3 * d, sense * d), LAW)
        expected = [LAW.E * 3 * d + S * 4e3 * sense * d, 4e3 * 3 * d + S * LAW.B * sense * d]
        # second order terms are d E/(s_max sigma_V) = 3e-6 of the step
        np.testing.assert_allclose(stress - [100.0, 12.0], expected, rtol=2e-5)
        np.testing.assert_allclose(tangent, [[LAW.E, S * 4e3], [4e3, S * LAW.B]], rtol=2e-5)
        assert (new.sigma_V, new.sigma_D) == tuple(stress)


def test_the_tangent_is_that_of_the_step():
    state, step, h = ScalarState(100.0, 12.0, 4e3), np.array([2e-4, 8e-4]), 1e-8
    tangent = scalar_step(state, step, LAW)[2]
    for j in range(2):
        shift = h * np.eye(2)[j]
        difference = (scalar_step(state, step + shift, LAW)[1] - scalar_step(state, step - shift, LAW)[1]) / (2 * h)
        np.testing.assert_allclose(tangent[:, j], difference, rtol=1e-6)  # rounding 1e-14/1e-8 of the stress, times stress/modulus


def test_a_batch_equals_its_points(rng):
    state = ScalarState(*(rng.uniform(low, high, 5) for low, high in ((90, 110), (-20, 20), (-5e3, 5e3))))
    step = rng.normal(scale=1e-3, size=(2, 5))
    new, _, tangent = scalar_step(state, step, LAW)
    assert tangent.shape == (2, 2, 5)
    for i in range(5):
        one = scalar_step(ScalarState(*(value[i] for value in state)), step[:, i], LAW)[0]
        np.testing.assert_allclose([value[i] for value in new], one, rtol=1e-13)  # the same operations, vectorised


def test_no_strength_no_shear_stress_and_no_increment_no_change():
    weak = LAW._replace(s_max=0.0, A_max=0.0)
    new, *_ = scalar_step(ScalarState(100.0, 0.0, 0.0), (1e-4, 5e-3), weak)
    assert tuple(new) == (110.0, 0.0, 0.0)
    assert tuple(scalar_step(ScalarState(100.0, 5.0, 1e3), (0.0, 0.0), LAW)[0]) == (100.0, 5.0, 1e3)
    with pytest.raises(InputError, match="sigma_V = -1 must be above 0"):
        scalar_step(ScalarState(-1.0, 0.0, 0.0), (0.0, 0.0), LAW)


def test_the_isobaric_path_of_constant_A_has_its_closed_form():
    A, s_max = 1e4, LAW.s_max
    curves = isobaric_biaxial(np.linspace(0, 0.006, 1201), PRESSURE, LAW._replace(A_max=A), A_start=A)
    # d sigma_V/d eps_D = H (a + b/sigma_V), integrated by separation of variables
    H, a, b = (LAW.E * LAW.B - A**2) / (LAW.E - A), 1 - 1 / s_max, PRESSURE / s_max

    def integral(sigma_V):
        return sigma_V / a - b / a**2 * np.log(a * sigma_V + b)

    sigma_V = 0.5 * (curves.sigma_xx + curves.sigma_zz)
    strain = (integral(sigma_V) - integral(PRESSURE)) / H
    early = curves.s_D < 0.9 * s_max  # later the inverse of the closed form is ill-conditioned
    np.testing.assert_allclose(strain[early], curves.eps_D[early], atol=1e-7)  # measured 2e-8, falls with the square of the step
    np.testing.assert_allclose(curves.sigma_xx, PRESSURE, rtol=1e-10)


def test_second_order_in_the_strain_step():
    steps = np.array([50, 100, 200, 400])
    exact = isobaric_biaxial(np.linspace(0, 0.01, 6401), PRESSURE, LAW)
    errors = [np.max(np.abs(isobaric_biaxial(np.linspace(0, 0.01, n + 1), PRESSURE, LAW).s_D - exact.s_D[:: 6400 // n])) for n in steps]
    order = -np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert order == pytest.approx(2.0, abs=0.15)  # measured 2.05


@pytest.mark.parametrize("A", [2e4, 7e4])
def test_dilatancy_ratio_and_its_sign(A):
    law = LAW._replace(A_max=A)
    curves = isobaric_biaxial(np.linspace(0, 0.002, 401), PRESSURE, law, A_start=A)
    S = 1 - 0.5 * (curves.s_D[1:] + curves.s_D[:-1]) / law.s_max
    ratio = np.diff(curves.eps_V) / np.diff(curves.eps_D)
    np.testing.assert_allclose(ratio, S * (law.B - A) / (law.E - A), rtol=2e-3)  # S at mid-step, error of the square of the step
    assert np.sign(curves.eps_V[-1]) == (1 if law.B > A else -1)  # contraction for A < B, dilation for A > B


def test_reversals_keep_the_stress_ratio_inside_and_A_follows():
    path = np.concatenate([np.linspace(0, 0.02, 150), np.linspace(0.02, -0.02, 300)[1:]])
    curves = isobaric_biaxial(path, PRESSURE, LAW)
    assert curves.status
    assert np.all(np.abs(curves.s_D) <= LAW.s_max * (1 + 1e-12))
    assert curves.s_D[-1] == pytest.approx(-LAW.s_max, rel=1e-6)  # saturated: exp(-30)
    assert curves.A[149] > 0 > curves.A[-1]
    one_step = isobaric_biaxial([0.0, 1.0], PRESSURE, LAW)  # a huge increment stays finite and inside
    assert 0 < one_step.s_D[-1] <= LAW.s_max


def test_lost_definiteness_ends_the_path_by_name():
    curves = isobaric_biaxial(np.linspace(0, 0.1, 201), PRESSURE, LAW._replace(A_max=9e4))
    assert not curves.status
    assert "not positive definite: E B = 5e+09 <= A^2" in str(curves.status)
    assert len(curves.s_D) == len(curves.eps_zz) < 201
    assert curves.A[-1] ** 2 < LAW.E * LAW.B
    with pytest.raises(RunFailed, match="stopped at eps_zz"):
        curves.status.require()


def test_a_box_that_gives_way_sideways_is_named():
    curves = isobaric_biaxial(np.linspace(0, 0.1, 201), PRESSURE, LAW._replace(E=4e4, B=9e4, A_max=5.9e4, beta_F=400.0))
    assert "gives way sideways" in str(curves.status)


@pytest.mark.parametrize(
    ("change", "words"),
    [({"E": 0.0}, "E = 0 must be above 0"), ({"s_max": 1.0}, "s_max = 1 must be below 1"), ({"beta_F": -1.0}, "beta_F = -1")],
)
def test_bad_parameters_are_named(change, words):
    with pytest.raises(InputError, match=words):
        isobaric_biaxial([0.0, 0.1], PRESSURE, LAW._replace(**change))
    with pytest.raises(InputError, match="not positive definite"):
        isobaric_biaxial([0.0, 0.1], PRESSURE, LAW, A_start=8e4)
    with pytest.raises(InputError, match="at least two finite strains"):
        isobaric_biaxial([0.0, np.nan], PRESSURE, LAW)
