"""E, A, B and G from strain increments: from probes, from the start of a curve and from a whole curve."""

from math import isnan

import numpy as np
import pytest

from anisogran import models
from anisogran.fitting import compared_B, initial_moduli, path_moduli, probed_moduli, relaxation
from anisogran.models import ScalarParameters, biaxial, element_test
from anisogran.outcome import InputError
from anisogran.tensors import rotate

TRUTH = {"E": 1000.0, "A": 150.0, "B": 400.0, "G": 180.0}
ROUNDING = 1e-9  # of a least-squares problem of condition 10, with room
LAW = ScalarParameters(E=2e4, B=1e4, s_max=0.4, A_max=5e3, beta_F=30.0)


def probes(rng, count, phi_C=0.3, noise=0.0, **moduli):
    d_eps = 1e-5 * rng.normal(size=(2, 2, count))
    d_eps = 0.5 * (d_eps + np.swapaxes(d_eps, 0, 1))
    error = noise * rng.normal(size=(2, 2, count))
    return d_eps, models.stress_increment(d_eps, **{**TRUTH, **moduli}, phi_C=phi_C) + 0.5 * (error + np.swapaxes(error, 0, 1))


def close(result, rel=ROUNDING, **truth):
    assert {name: result.values[name] for name in truth} == pytest.approx(truth, rel=rel)


def test_probes_give_the_moduli_they_were_made_with(rng):
    d_eps, d_sigma = probes(rng, 9)
    known = probed_moduli(d_eps, d_sigma, phi_C=0.3)
    close(known, **TRUTH)
    assert known.verdict
    fitted = probed_moduli(d_eps, d_sigma)
    close(fitted, rel=1e-6, **TRUTH, phi_C=0.3)  # the minimiser finds the angle to the root of rounding
    assert fitted.verdict
    np.testing.assert_allclose(fitted.predict(d_eps), d_sigma, atol=1e-6 * np.abs(d_sigma).max())  # as the angle
    across = probed_moduli(d_eps, d_sigma, phi_C=0.3 + 0.5 * np.pi)  # the soft axis: A changes its sign and nothing else
    close(across, **{**TRUTH, "A": -150.0})
    assert not probed_moduli(d_eps[:, :, :3], d_sigma[:, :, :3]).verdict  # three probes: the values, but no trust
    close(probed_moduli(d_eps[:, :, :3], d_sigma[:, :, :3]), rel=1e-6, **TRUTH)


@pytest.mark.parametrize("angle", [-1.57, -0.4, -0.001, 0.9, 1.57])
def test_a_turned_sample_has_the_same_moduli_and_a_turned_axis(rng, angle):
    d_eps, d_sigma = probes(rng, 9, phi_C=0.0)
    turned = probed_moduli(rotate(d_eps, angle), rotate(d_sigma, angle))
    close(turned, rel=1e-6, **TRUTH)  # as above
    assert turned.values["phi_C"] == pytest.approx(angle, abs=1e-6)


@pytest.mark.parametrize("phi_C", [0.3, None])
def test_errors_of_probes_cover_the_truth(rng, phi_C):
    trials, inside, angles = 100, 0, []
    truth = TRUTH if phi_C is not None else TRUTH | {"phi_C": 0.3}
    for _ in range(trials):
        result = probed_moduli(*probes(rng, 12, noise=2e-4), phi_C=phi_C)
        for name, value in truth.items():
            low, high = result.interval(name)
            inside += low < value < high
        angles += [(result.values["phi_C"], result.errors["phi_C"])] if phi_C is None else []
    assert 0.9 < inside / (trials * len(truth)) < 0.99  # 95 % expected, 400 trials: standard deviation 1.1 %
    if angles:
        found, errors = np.transpose(angles)
        assert np.mean(errors) == pytest.approx(np.std(found), rel=0.25)  # 100 trials: standard deviation 7 %


def test_given_errors_are_believed_unless_the_scatter_is_larger(rng):
    d_eps, d_sigma = probes(rng, 30, noise=2e-4)
    free = probed_moduli(d_eps, d_sigma, phi_C=0.3)
    large = probed_moduli(d_eps, d_sigma, phi_C=0.3, errors=1e-3)
    small = probed_moduli(d_eps, d_sigma, phi_C=0.3, errors=np.full(30, 1e-6))
    assert small.errors["E"] == pytest.approx(free.errors["E"], rel=1e-9)  # rounding of the weights
    assert large.errors["E"] / free.errors["E"] == pytest.approx(1e-3 / free.residuals["rms"], rel=0.05)  # n or n - p


def test_probes_that_leave_a_modulus_open_are_refused_by_its_name():
    isotropic = 1e-5 * np.eye(2)[:, :, None] * np.ones(4)
    with pytest.raises(InputError, match="these 4 probes leave B open"):
        probed_moduli(isotropic, models.stress_increment(isotropic, **TRUTH), phi_C=0.0)
    uniaxial = 1e-5 * np.diag([1.0, 0.0])[:, :, None] * np.ones(4)
    with pytest.raises(InputError, match="leave E, A, B open"):
        probed_moduli(uniaxial, models.stress_increment(uniaxial, **TRUTH), phi_C=0.0)
    coaxial = 1e-5 * np.stack([np.diag([1.0, k]) for k in (0.0, 0.5, -1.0, 1.0, 0.2, -0.3)], axis=-1)
    with pytest.raises(InputError, match="probes of 2 independent strains leave phi_C open"):
        probed_moduli(coaxial, models.stress_increment(coaxial, **TRUTH))
    with pytest.raises(InputError, match=r"must be \(2, 2, n\), have shapes \(2, 2\)"):
        probed_moduli(np.eye(2), np.eye(2))
    with pytest.raises(InputError, match="no finite probe with a strain"):
        probed_moduli(0.0 * coaxial, 0.0 * coaxial)
    with pytest.raises(InputError, match="errors must be above 0"):
        probed_moduli(coaxial, coaxial, phi_C=0.0, errors=0.0)


def test_coaxial_probes_give_all_but_the_shear_modulus():
    coaxial = 1e-5 * np.stack([np.diag([1.0, k]) for k in (0.0, 0.5, -1.0, 1.0, 0.2, -0.3)], axis=-1)
    result = probed_moduli(coaxial, models.stress_increment(coaxial, **TRUTH), phi_C=0.0)
    close(result, E=1000.0, A=150.0, B=400.0)
    assert "G" not in result.values
    assert "G is not determined" in str(result.verdict)
    shear = np.array([[0.0, 1e-5], [1e-5, 0.0]])
    assert np.isnan(result.predict(shear)[0, 1])
    assert result.predict(coaxial[:, :, 0]) == pytest.approx(models.stress_increment(coaxial[:, :, 0], **TRUTH), rel=1e-9)  # rounding


def test_an_isotropic_state_has_no_axis_and_says_so(rng):
    d_eps, d_sigma = probes(rng, 12, noise=2e-4, A=0.0, B=360.0)  # B = 2G
    result = probed_moduli(d_eps, d_sigma)
    assert not result.verdict
    assert isnan(result.errors["phi_C"])
    assert probed_moduli(d_eps, d_sigma, phi_C=0.0).verdict  # no axis is needed for the moduli; A = 0 is an answer


def test_two_different_couplings_are_no_anisotropic_law(rng):
    d_eps, d_sigma = probes(rng, 12, noise=2e-4)
    assert "A_in_sigma_V" in probed_moduli(d_eps, d_sigma).residuals
    c = 0.5 * (rotate(d_eps, -0.3)[0, 0] - rotate(d_eps, -0.3)[1, 1])
    wrong = d_sigma + 400.0 * c * np.eye(2)[:, :, None]
    result = probed_moduli(d_eps, wrong, phi_C=0.3)
    assert result.residuals["A_in_sigma_V"] == pytest.approx(550.0, rel=0.05)  # the noise
    assert result.residuals["A_in_sigma_D"] == pytest.approx(150.0, rel=0.1)
    assert not result.verdict
    assert "in d sigma_V and" in result.verdict.reasons[0]


def test_a_probe_that_failed_is_dropped_and_counted(rng):
    d_eps, d_sigma = probes(rng, 9)
    d_sigma[0, 1, 4] = np.nan
    result = probed_moduli(d_eps, d_sigma, phi_C=0.3)
    close(result, **TRUTH)
    assert (result.dropped, result.points) == (1, 24)


# ---- curves


def driven(path, start=(100.0, 0.0, 0.0), law=LAW):
    """eps_V, eps_D, sigma_V, sigma_D and A along strains (n, 2) from the `start` state."""
    sigma_V, sigma_D, A = start
    begin = {"sigma_xx": sigma_V - sigma_D, "sigma_zz": sigma_V + sigma_D, "A": A}
    test = element_test("scalar", law._asdict(), {"eps_V": path[:, 0], "eps_D": path[:, 1]}, begin)
    return test.eps_V, test.eps_D, test.sigma_V, test.sigma_D, test.internal["A"]


def isobaric(points=400, end=0.1):
    test = element_test("scalar", LAW._asdict(), biaxial(np.linspace(0.0, end, points), 100.0))
    return test.eps_V, test.eps_D, test.sigma_V, test.sigma_D, test.internal["A"]


def test_a_whole_curve_gives_back_its_moduli():
    errors = []
    for points in (200, 400):
        *rows, A = isobaric(points)
        result = path_moduli(*rows, s_max=0.4, structure=A / LAW.A_max)
        errors.append(abs(result.values["A_max"] / LAW.A_max - 1.0))
    assert result.verdict, str(result)
    close(result, rel=1e-3, E=LAW.E, B=LAW.B, A_max=LAW.A_max, sigma_V_0=100.0)  # trapezoids
    assert errors[0] > 3.0 * errors[1]  # second order: a factor 4
    np.testing.assert_allclose(result.predict(rows[1]), rows[2:], atol=0.02)  # stresses to 100, trapezoids


def test_the_limit_of_the_stress_ratio_is_found_too(rng):
    *rows, A = isobaric()
    exact = path_moduli(*rows, structure=A / LAW.A_max)
    close(exact, rel=5e-3, E=LAW.E, B=LAW.B, A_max=LAW.A_max, s_max=LAW.s_max)  # trapezoids
    truth, trials, inside = {"E": LAW.E, "A_max": LAW.A_max, "B": LAW.B, "s_max": LAW.s_max}, 40, 0
    for _ in range(trials):
        noise = 0.3 * rng.normal(size=400)
        result = path_moduli(rows[0], rows[1], rows[2] + noise, rows[3] + noise, structure=A / LAW.A_max)
        for name, value in truth.items():
            low, high = result.interval(name)
            inside += low < value < high
    assert 0.87 < inside / (4 * trials) < 0.999  # 95 % expected; 40 trials of correlated parameters: standard deviation 3.4 %


def test_a_cycle_is_a_curve_too():
    turn = np.concatenate([np.linspace(0.0, 0.004, 400), np.linspace(0.004, -0.002, 600)[1:]])
    *rows, A = driven(np.column_stack([0.001 * np.sin(1000 * turn), turn]), start=(100.0, 0.0, 1e3))
    result = path_moduli(*rows, s_max=0.4, structure=A / LAW.A_max)
    close(result, rel=2e-3, E=LAW.E, B=LAW.B, A_max=LAW.A_max)  # trapezoids, and the corner of the reversal
    with pytest.raises(InputError, match="a path along which eps_D only grows"):
        result.predict(0.01)
    constant = ScalarParameters(E=2e4, B=1e4, s_max=0.4, A_max=2e3, beta_F=0.0)
    *rows, _ = driven(np.column_stack([0.001 * np.sin(1000 * turn), turn]), start=(100.0, 0.0, 2e3), law=constant)
    close(path_moduli(*rows, s_max=0.4), rel=2e-3, E=2e4, B=1e4, A=2e3)  # as above


def test_errors_of_a_whole_curve_cover_the_truth(rng):
    """In the isobaric box both stresses have the same noise, since their difference is held."""
    *rows, A = isobaric()
    truth, trials, inside = {"E": LAW.E, "A_max": LAW.A_max, "B": LAW.B}, 60, 0
    for _ in range(trials):
        noise = 0.3 * rng.normal(size=400)
        result = path_moduli(rows[0], rows[1], rows[2] + noise, rows[3] + noise, s_max=0.4, structure=A / LAW.A_max)
        for name, value in truth.items():
            low, high = result.interval(name)
            inside += low < value < high
    assert 0.87 < inside / (3 * trials) < 0.995  # 95 % expected; 60 trials of correlated parameters: standard deviation 2.8 %


def test_mixed_strain_measures_are_found_out(rng):
    """eps_V as the whole trace beside half a deviator: the two A then differ by a factor 2 (and E comes out half)."""
    turn = np.linspace(0.0, 0.004, 400)
    *rows, A = driven(np.column_stack([0.001 * np.sin(1000 * turn), turn]), start=(100.0, 0.0, 1e3))
    result = path_moduli(2.0 * rows[0], *rows[1:], s_max=0.4, structure=A / LAW.A_max)
    assert not result.verdict
    assert result.residuals["A_in_sigma_V"] / result.residuals["A_in_sigma_D"] == pytest.approx(2.0, rel=0.01)  # trapezoids


def test_curves_that_leave_a_modulus_open_are_refused_by_its_name():
    turn = np.linspace(0.0, 0.02, 100)
    isochoric = driven(np.column_stack([0.0 * turn, turn]))[:4]
    pressed = driven(np.column_stack([turn, 0.0 * turn]))[:4]
    with pytest.raises(InputError, match="path_moduli: E cannot be had"):
        path_moduli(*isochoric, s_max=0.4)
    with pytest.raises(InputError, match="initial_moduli: E cannot be had"):
        initial_moduli(*isochoric)
    with pytest.raises(InputError, match="path_moduli: B cannot be had"):
        path_moduli(*pressed, s_max=0.4)
    with pytest.raises(InputError, match="initial_moduli: B cannot be had"):
        initial_moduli(*pressed)
    straight = turn, 2.0 * turn, 100.0 + 5.0 * turn, 7.0 * turn
    with pytest.raises(InputError, match="initial_moduli: E, B, A cannot be had"):
        initial_moduli(*straight, A=None)
    with pytest.raises(InputError, match="sigma_V = -1 must be above 0"):
        path_moduli(turn, turn, turn - 1.0, turn, s_max=0.4)
    with pytest.raises(InputError, match="s_max = 0 must be above 0"):
        path_moduli(*straight, s_max=0.0)
    with pytest.raises(InputError, match=r"rows of one length, are eps_V \(100,\), eps_D \(3,\)"):
        initial_moduli(turn, turn[:3], turn, turn)
    with pytest.raises(InputError, match="the strains do not change"):
        initial_moduli(0 * turn, 0 * turn, turn, turn)
    with pytest.raises(InputError, match=r"strain = 0\.0001 holds 1 points"):
        initial_moduli(*straight, strain=1e-4)


def test_straight_lines_have_their_slopes():
    turn = np.linspace(0.0, 0.01, 50)
    lines = turn, 3.0 * turn, 100.0 + 2e4 * turn + 300.0 * 3.0 * turn, 5.0 + 300.0 * turn + 1e4 * 3.0 * turn
    result = initial_moduli(*lines, A=300.0)
    close(result, E=2e4, B=1e4, sigma_V_0=100.0, sigma_D_0=5.0)
    assert result.verdict
    np.testing.assert_allclose(result.predict(lines[1]), lines[2:], rtol=1e-9)  # rounding
    wave = 0.002 * np.sin(1000 * turn)
    bent = wave, turn, 100.0 + 2e4 * wave + 300.0 * turn, 300.0 * wave + 1e4 * turn
    free = initial_moduli(*bent, A=None)
    close(free, E=2e4, A=300.0, B=1e4)
    assert free.verdict


def test_the_range_is_chosen_against_the_bend_and_told():
    *rows, _ = isobaric(2000)
    result = initial_moduli(*rows)
    assert result.verdict, str(result)
    assert result.values["B"] == pytest.approx(LAW.B, rel=0.1)  # a line over the first 10 points lies below the first slope
    assert abs(result.values["B"] - LAW.B) < 2.0 * result.errors["B"]
    assert result.x_range[1] < 1e-3
    assert f"strain range 0 .. {result.x_range[1]:.3g} chosen" in str(result.verdict)
    assert result.points == 2 * (2000 - result.cut)
    given = initial_moduli(*rows, strain=0.01)
    assert given.x_range[1] == pytest.approx(0.01, rel=0.02)  # the spacing of the points
    assert given.values["B"] < 0.9 * LAW.B  # far too long a range...
    assert isnan(given.errors["B"])  # ... and known to be
    assert "given" in str(given.verdict)


def test_errors_of_an_initial_slope_cover_the_truth(rng):
    *rows, _ = isobaric(1000, end=0.02)
    inside, counts, trials = 0, [], 60
    for noise in np.repeat([0.05, 0.5], trials // 2):
        jitter = noise * rng.normal(size=1000)
        result = initial_moduli(rows[0], rows[1], rows[2] + jitter, rows[3] + jitter)
        inside += abs(result.values["B"] - LAW.B) < 2.0 * result.errors["B"]
        counts.append(1000 - result.cut)
    assert inside > 0.9 * trials  # the bend is a systematic error, taken in full: more than 95 %
    assert np.median(counts[: trials // 2]) < np.median(counts[trials // 2 :])  # more noise, longer range


def test_the_errors_of_a_linear_law_are_those_of_its_profile(rng):
    result = probed_moduli(*probes(rng, 12, noise=2e-4), phi_C=0.3)
    assert result.profile("B")[:2] == result.interval("B")
    assert result.profile("B").outcome == ""
    with pytest.raises(InputError, match="bootstrap: not for moduli"):
        result.bootstrap()
    with pytest.raises(InputError, match="needs one of E, A, B, G"):
        result.profile("K")


# ---- the modulus that the evolution of the stress ratio implies


def test_B_of_the_evolution_is_the_direct_one_at_constant_mean_stress():
    law = ScalarParameters(E=1e6, B=1e4, s_max=0.4, A_max=0.0, beta_F=0.0)
    turn = np.linspace(0.0, 0.05, 1000)
    *rows, _ = driven(np.column_stack([1e-9 * turn, turn]), law=law)  # next to no volume strain, no coupling
    fit = relaxation(rows[1], rows[3] / rows[2])
    found = compared_B(path_moduli(*rows, s_max=0.4), fit, rows[2])
    assert found.implied == pytest.approx(1e4, rel=2e-5)  # midpoint rule: (beta d eps_D)^2/12 = 1.3e-5
    assert found.direct == pytest.approx(1e4, rel=1e-3)  # trapezoids
    assert found.remarks == ()
    assert "B = 1e+04" in str(found)


def test_an_isobaric_box_is_told_not_to_have_a_constant_mean_stress():
    *rows, A = isobaric()
    fit = relaxation(rows[1], rows[3] / rows[2])
    found = compared_B(path_moduli(*rows, s_max=0.4, structure=A / LAW.A_max), fit, rows[2])
    assert found.lowest == found.implied < LAW.B < 1.05 * found.highest
    assert found.highest / found.lowest == pytest.approx(1.0 / (1.0 - 0.4), rel=0.01)  # p/(1 - s_D) at the plateau
    assert "sigma_V is not constant (largest over smallest 1.67; p/(1 - s_D)" in str(found)
    relative = found.implied_error / found.implied
    b, s = (fit.errors[name] / fit.values[name] for name in ("beta", "s_max"))
    assert relative == pytest.approx(np.sqrt(b**2 + s**2 + 2 * fit.correlations["s_max", "beta"] * b * s), rel=1e-12)  # by hand
    assert found.apart == pytest.approx(abs(found.direct - found.implied) / np.hypot(found.direct_error, found.implied_error))


def test_comparing_what_has_no_B_is_refused():
    *rows, _ = isobaric()
    moduli, fit = initial_moduli(*rows), relaxation(rows[1], rows[3] / rows[2])
    with pytest.raises(InputError, match="first fit must have B, has s_0"):
        compared_B(fit, fit, 100.0)
    with pytest.raises(InputError, match="second fit must have beta and s_max, has E"):
        compared_B(moduli, moduli, 100.0)
    with pytest.raises(InputError, match="finite stresses above 0"):
        compared_B(moduli, fit, [100.0, -1.0])
    poor = relaxation(rows[1][:8], rows[3][:8] / rows[2][:8])
    assert isnan(compared_B(moduli, poor, 100.0).apart)
    assert "the relaxation is not trustworthy" in str(compared_B(moduli, poor, 100.0))
