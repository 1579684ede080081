"""The hard cases of a law along a path, over every law of the list: huge steps, loops, stresses that cannot be, and how it ends."""

import tomllib

import numpy as np
import pytest
from law_cases import PARAMETERS, START, failures, laws, record, state, strain

from anisogran.models import LAWS, RungeKutta45, biaxial, cyclic, element_test, isotropic_compression, pure_shear, updated
from anisogran.models.point import MEANING
from anisogran.outcome import InputError


@pytest.mark.hard_case("C7")
@pytest.mark.parametrize("law", LAWS)
def test_a_huge_increment_is_many_small_ones(law, answer):
    """C7: eps_D = 1 in one step within 1e-4 of many; what is too large for the sub-steps is named elsewhere."""
    time = {"time": [0.0, 1.0]}
    once = element_test(law, PARAMETERS[law], pure_shear([0.0, 1.0]) | time, START[law])
    many = element_test(law, PARAMETERS[law], pure_shear([0.0, 1.0]) | time, START[law], steps=10_000)
    assert once.status.level == many.status.level == "ok"
    np.testing.assert_allclose(once.stress[..., -1], many.stress[..., -1], rtol=1e-4, atol=1e-10)
    error = np.abs(once.stress - many.stress[..., [0, -1]]).max() / np.abs(many.stress[..., -1]).max()
    answer.computed(error, "one step against 10,000")


@pytest.mark.hard_case("C8")
@pytest.mark.parametrize("law", laws("C8"))
def test_a_pressure_that_vanishes_is_flagged(law, answer):
    """C8: below 1e-6 E; the stress is the state, so that the ratio is found from it and never kept."""
    down = element_test(law, PARAMETERS[law], isotropic_compression([100.0, 0.05]), steps=100)
    assert down.status.level == "warned"
    assert "below 1e-06 E: stress ratios are not accurate" in str(down.status)
    answer.named(down.status)
    assert element_test(law, PARAMETERS[law], isotropic_compression([100.0, 0.2]), steps=100).status.level == "ok"


@pytest.mark.hard_case("C9")
@pytest.mark.parametrize("integrator", ["midpoint", "explicit"])
@pytest.mark.parametrize("law", laws("C9"))
def test_tension_is_named_and_never_passed_on(law, integrator, answer):
    """C9: by a strain, through `updated` (raised or reported, with the old state) and along a path."""
    begin, leap = state(law), strain(-0.01, 0.0)
    with pytest.raises(InputError, match=f"{law} law: point 0 of 1: .*tension") as caught:
        updated(begin, leap, record(law), integrator=integrator)
    answer.refused(caught)
    kept = updated(begin, leap, record(law), integrator=integrator, on_failure="report")
    assert "tension" in MEANING[int(kept.outcome)]
    np.testing.assert_array_equal(kept.stress, begin.stress)
    path = element_test(law, PARAMETERS[law], {"eps_V": [0.0, -0.01], "eps_D": 0.0}, START[law], steps=100, integrator=integrator)
    assert path.status.level == "failed"
    assert "tension" in str(path.status)
    assert path.sigma_V[-1] > -2.0 / np.tan(0.4) if law == "mohr_coulomb" else np.all(path.sigma_V > 0.0)


def loops(law):
    """Closed strain paths, six times round, a dict of (control, steps)."""
    turn = np.linspace(0.0, 12.0 * np.pi, 121)
    round_ = {"eps_D": 1e-3 * np.sin(turn), "eps_V": 2e-4 * (1.0 - np.cos(turn))}
    box = {"eps_D": 1e-3 * np.array([0.0, 1, 1, 0] * 6 + [0.0]), "eps_V": 2e-4 * np.array([0.0, 0, 1, 1] * 6 + [0.0])}
    back = {key: values[::-1] for key, values in box.items()}
    return {"there and back": (pure_shear(cyclic(1e-3, 6)), 100), "circle": (round_, 20), "box": (box, 100), "box back": (back, 100)}


@pytest.mark.hard_case("C5")
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("loop", ["there and back", "circle", "box", "box back"])
def test_a_closed_loop_of_strain_costs_work(law, loop, answer):
    """C5: after the first round."""
    control, steps = loops(law)[loop]
    test = element_test(law, PARAMETERS[law], control, START[law], steps=steps)
    assert test.status.level == "ok"
    edge = np.flatnonzero(np.abs(test.strain - test.strain[..., :1]).max(axis=(0, 1)) < 1e-15)  # where each round begins and ends
    assert edge.size >= 7
    gain = -np.diff(test.work[edge])[2:].min() / np.abs(np.diff(test.work)).sum()
    assert gain <= 1e-10
    answer.named("closed loops of strain gain no work, to 1e-10 of it")


@pytest.mark.hard_case("C5")
@pytest.mark.parametrize("law", ["scalar", "tensorial"])
def test_a_law_that_makes_work_is_reported(law, answer):
    """C5: an anisotropy near its limit that follows the strain fast gives work in small loops of volume and shear."""
    values = {"E": 1e5, "B": 6e4, "s_max": 0.25, "A_max": 4e4, "beta_F": 800.0} | ({"G": 3e4} if law == "tensorial" else {})
    box = {"eps_D": -6e-5 * np.array([0, 1, 1, 0, 0.0]), "eps_V": 1e-3 * np.array([0, 0, 1, 1, 0.0])}
    back = {key: values[::-1] for key, values in box.items()}
    told = [element_test(law, values, control, 100.0, steps=50).status for control in (box, back)]
    (work,) = (status for status in told if "made by the law" in str(status))
    answer.named(work)


@pytest.mark.hard_case("C5", "C12")
@pytest.mark.parametrize("law", laws("C6"))
def test_the_tangent_at_a_reversal_is_that_of_its_side(law, answer):
    """C12: one-sided derivatives of the step, whichever way it goes; none of a step of nothing is NaN."""
    begin, p, h = state(law, 100.0, -15.0), record(law), 1e-9
    assert np.all(np.isfinite(updated(begin, strain(0.0, 0.0), p, tangent=True).tangent))
    moduli = []
    for eps_1 in (-h, h):  # on along z, and back
        new = updated(begin, strain(0.0, eps_1), p, tangent=True)
        expected = np.einsum("ijkl,kl->ij", new.tangent, strain(0.0, eps_1))
        # the step bends by its relaxation E h/(s_max sigma_V) = 3e-6; differences of 100 are good to 3e-14
        np.testing.assert_allclose(new.stress - begin.stress, expected, atol=1e-5 * np.abs(expected).max() + 1e-13)
        moduli.append((new.stress - begin.stress)[0, 0] / eps_1)
    softer = (1.0 - 0.15 / 0.3) / (1.0 + 0.15 / 0.3) if "s_max" in PARAMETERS[law] else 1.0  # S on loading over S on unloading
    assert moduli[0] / moduli[1] == pytest.approx(softer, rel=1e-4)
    answer.computed(abs(moduli[0] / moduli[1] / softer - 1.0), "stiffness of loading over that of unloading")


@pytest.mark.hard_case("C13")
@pytest.mark.parametrize("law", laws("C13"))
def test_a_prescribed_stress_is_met(law, answer):
    """C13: to less than 1e-10 of the pressure in each step, also when a step is a whole path of the strength."""
    for steps, share in ((1, 0.9), (200, 0.99)):
        limit = 30.0 if "s_max" in PARAMETERS[law] else 100.0 * np.sin(0.4) + 2.0 * np.cos(0.4)
        test = element_test(law, PARAMETERS[law], {"sigma_V": 100.0, "sigma_D": [0.0, share * limit]}, steps=steps)
        assert test.status.level == "ok"
        np.testing.assert_allclose(test.sigma_V, 100.0, rtol=1e-10)
        sigma_D = 0.5 * (test.sigma_zz - test.sigma_xx)
        error = np.abs(sigma_D - np.linspace(0.0, share * limit, steps + 1)).max() / 100.0
        assert error < 1e-10
        answer.computed(error, "prescribed stress")
    biaxial_test = element_test(law, PARAMETERS[law], biaxial([0.0, 0.02, 0.0], 100.0), steps=300)
    assert biaxial_test.status.level == "ok"
    np.testing.assert_allclose(biaxial_test.sigma_xx, 100.0, rtol=1e-10)


def in_words(test):
    """The reason for a failure, without its place."""
    return test.status.reasons[-1].partition(": ")[2]


CASES = {
    "extension": pytest.mark.hard_case("C9"),
    "prescribed tension": pytest.mark.hard_case("C9"),
    "unreachable stress": pytest.mark.hard_case("C13"),
    "not positive definite": pytest.mark.hard_case("C2"),
    "huge": pytest.mark.hard_case("C7"),
}
FAILURES = [pytest.param(law, name, marks=CASES.get(name, ())) for law in LAWS for name in failures(law)]


@pytest.mark.hard_case("C15")
@pytest.mark.parametrize("integrator", ["midpoint", "explicit"])
@pytest.mark.parametrize(("law", "name"), FAILURES)
def test_each_failure_is_named_keeps_the_last_good_state_and_can_be_repeated(law, name, integrator, answer):
    """C2, C13, C15."""
    control, start, change, words = failures(law)[name]
    test = element_test(law, PARAMETERS[law] | change, control, START[law] if start is None else start, steps=50, integrator=integrator)
    assert test.status.level == "failed"
    if integrator == "midpoint":
        assert words in in_words(test)
        answer.named(f"{name}: {in_words(test)}")
    assert np.all(np.isfinite(test.stress))
    assert np.all(np.isfinite(test.strain))
    assert test.strain.shape[-1] == test.time.size <= 50
    whole = element_test(law, PARAMETERS[law] | change, control, START[law] if start is None else start, steps=50, integrator=integrator)
    np.testing.assert_array_equal(whole.stress, test.stress)
    file = tomllib.loads(test.reproduction)
    again = element_test(file["law"], file["parameters"], file["control"], file["start"], integrator=file["integrator"])
    assert again.status.level == "failed"
    # an unreachable stress may show before or after the last good state: at the tangent, or in Newton's method
    assert (words if name == "unreachable stress" else in_words(test)) in in_words(again)
    assert again.time.size == 1  # fails in its only step
    np.testing.assert_allclose(again.stress[..., 0], test.stress[..., -1], rtol=1e-14, atol=1e-14)
    answer.computed(np.abs(again.stress[..., 0] - test.stress[..., -1]).max() / 100.0, "last good state in the file that repeats it")


@pytest.mark.hard_case("C15", of="scalar")
def test_a_failure_is_repeated_with_the_settings_of_its_integrator():
    """C15."""
    control, _, _, words = failures("scalar")["extension"]
    test = element_test("scalar", PARAMETERS["scalar"], control, 100.0, steps=50, integrator=RungeKutta45(1e-6, 500.0))
    file = tomllib.loads(test.reproduction)
    assert file["integrator"] == {"name": "rk45", "tolerance": 1e-6, "most": 500.0}
    again = element_test(file["law"], file["parameters"], file["control"], file["start"], integrator=file["integrator"])
    assert in_words(again) == in_words(test)
    assert words in in_words(test)
    for bad, message in (
        ({"name": "rk4"}, "must be one of"),
        ({"name": "rk45", "most": 0.0}, "above 0"),
        ({"name": "rk45", "x": 1}, "'x'"),
    ):
        with pytest.raises(InputError, match=message):
            element_test("scalar", PARAMETERS["scalar"], control, 100.0, integrator=bad)


@pytest.mark.parametrize("law", laws("O11"))
def test_stress_ratio_and_anisotropy_are_closed_exponentials(law):
    """O11: at constant volume, hence pressure, without coupling; the anisotropy always. Steps of 1e-5, no sub-steps."""
    values = PARAMETERS[law] | {"B": 5e4, "E": 1e5} | ({"G": 2.5e4} if law == "tensorial" else {})
    uncoupled = element_test(law, values | {"A_max": 0.0}, pure_shear([0.0, 0.01]), 1e4, steps=1000)
    beta = 5e4 / (1e4 * 0.3)  # physics of the law: beta_s = B/(sigma_V s_max); second order: z^2/12 of the relaxation z = 1.7e-4 in a step
    np.testing.assert_allclose(uncoupled.s_D, 0.3 * -np.expm1(-beta * uncoupled.eps_D), atol=1e-8)
    coupled = element_test(law, values, pure_shear([0.0, 0.01]), 1e4, steps=1000)
    (A,) = (np.abs(found) for name, found in coupled.internal.items() if name != "A_2")
    np.testing.assert_allclose(A, 2e4 * -np.expm1(-80.0 * coupled.eps_D), atol=1e-8)


@pytest.mark.parametrize("A", [2e4, 6e4])
@pytest.mark.parametrize("law", laws("O11"))
def test_the_isobaric_path_has_the_dilatancy_of_the_moduli(law, A):
    """O11: eps_V/eps_D = S (B - A)/(E - A) with S at mid-step, exact for the midpoint: contraction for A < B, dilation for A > B."""
    values = PARAMETERS[law] | {"A_max": A} | ({"G": 2.5e4} if law == "tensorial" else {})
    start = {"A": A} if law == "scalar" else {"A_1": -A}
    test = element_test(law, values, biaxial([0.0, 0.002], 1e3), start, steps=200)
    middle = 0.5 * (test.stress[..., 1:] + test.stress[..., :-1])
    S = 1.0 - (middle[1, 1] - middle[0, 0]) / (middle[1, 1] + middle[0, 0]) / 0.3
    # control of the stress to 1e-11 of 1e3 against increments of strain of 1e-5
    np.testing.assert_allclose(np.diff(test.eps_V) / np.diff(test.eps_D), S * (5e4 - A) / (1e5 - A), atol=1e-8)


def test_a_law_that_pulls_along_one_axis_says_so():
    """M2: a friction above 1, here of the linear law at large I, is a tensile principal stress."""
    fast = {"mu_s": 0.28, "b": 1.1, "phi_max": 0.84, "slope": 0.3, "grain_mass": 1e-5}
    test = element_test("mu_of_I", fast, pure_shear([0.0, 0.01]), {"area_fraction": 0.5})
    assert "principal stress is tensile: sigma_D/sigma_V reaches 1.53" in str(test.status)  # I = 1.133


def test_a_step_that_empties_the_sample_is_named():
    p = record("mu_of_I")
    assert float(updated(state("mu_of_I"), strain(-0.6, 1e-3), p).state.internal["area_fraction"]) == pytest.approx(0.8 * np.exp(-1.2))
    with pytest.raises(InputError, match="area fraction falls to zero"):
        updated(state("mu_of_I"), strain(-0.6, 1e-3), p, integrator="explicit")
    with pytest.raises(InputError, match="d_time = 0 must be above 0 s"):
        updated(state("mu_of_I"), strain(0.0, 1e-3), p, d_time=[1.0, 0.0])
    with pytest.raises(InputError, match="on_failure = 'warn' must be raise or report"):
        updated(state("mu_of_I"), strain(0.0, 1e-3), p, on_failure="warn")


@pytest.mark.hard_case("C9", of="mohr_coulomb")
def test_a_fluid_bears_no_tension():
    """C9: without friction and cohesion the yield line has no apex."""
    fluid = record("mohr_coulomb", phi=0.0, phi_residual=0.0, psi=0.0, c=0.0)
    with pytest.raises(InputError, match="goes into tension"):
        updated(state("mohr_coulomb"), strain(-0.01, 1e-3), fluid)


@pytest.mark.parametrize(("integrator", "tolerance"), [("midpoint", 1e-9), ("rk45", 1e-9), ("explicit", 2e-3)])
def test_a_yield_within_a_step_is_met_by_every_integrator(integrator, tolerance):
    """C13: no tangent of Runge-Kutta tells how the moment of yielding shifts, so Newton's method goes on along the secant."""
    ends = [
        element_test("mohr_coulomb", PARAMETERS["mohr_coulomb"], biaxial([0.0, 0.01], 100.0), None, n, integrator) for n in (3, 10, 100)
    ]
    for test in ends:
        assert test.status.level == "ok"
        kappa = test.internal["kappa"][-1]
        sine = np.sin(0.3) + (np.sin(0.4) - np.sin(0.3)) * np.exp(-30.0 * kappa)
        c_cos = 2.0 * np.cos(0.3) + 2.0 * (np.cos(0.4) - np.cos(0.3)) * np.exp(-30.0 * kappa)
        # on the yield line in the box: sigma_D = sine (100 + sigma_D) + c_cos
        assert test.sigma_zz[-1] == pytest.approx(100.0 + 2.0 * (100.0 * sine + c_cos) / (1.0 - sine), rel=tolerance)
        assert test.sigma_zz[-1] == pytest.approx(221.8434932861, rel=tolerance)  # all integrators and 1e4 steps meet there
