"""C14: random parameters in their range and random paths of 200 steps, over every law of the list: finite or named, and inside the limits.

|A| <= A_max holds on any path that starts there. The stress ratio of the anisotropic laws stays below s_max where the rate form keeps it
there, which is not everywhere: at the limit (S = 0) a change of volume gives d s = (A - s_max E) d eps_V/sigma_V, so decompression raises s
whenever A < s_max E, and compression whenever A > s_max E, in these laws without a volumetric yield. It is bounded
 - at constant volume, coaxially, any parameters and steps: where S = 0, nothing changes;
 - at constant pressure and in the biaxial box, coaxially, any parameters: the volume rests at S = 0;
 - at growing pressure for |A| <= s_max E, coaxially;
 - in any direction, with rotation, at constant or growing pressure if A_max = 0 and B = 2G: else an anisotropy that is not coaxial to the
   stress pushes it sideways out, to second order.
A prescribed stress is met at the ends of steps; inside of a step the strain is straight, so these bounds are those of steps that relax s
by little (no sub-steps), or of the limit of small ones.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import PARAMETERS, laws, record, state, strain

from anisogran.models import LAWS, element_test, updated
from anisogran.models.point import FINEST, MEANING

ROUNDING = 1e-12  # some operations on numbers good to 2e-16, in units of the largest
STEPS = 200
seeds = st.integers(0, 2**32 - 1)
some = settings(derandomize=True, max_examples=25, deadline=None)


def random_parameters(law, rng):
    """(parameters, pressure) over decades of stiffness and of pressure beside it."""
    E = 10.0 ** rng.uniform(-3.0, 9.0)
    pressure = E * 10.0 ** rng.uniform(-5.0, -2.0)
    if law == "mohr_coulomb":
        phi = rng.uniform(0.0, 1.2)
        phi_r = phi * rng.uniform(0.0, 1.0)
        c = pressure * rng.uniform(0.0, 0.5)
        G, psi, beta = E * rng.uniform(0.05, 0.5), phi_r * rng.uniform(0.0, 1.0), 10.0 ** rng.uniform(-1.0, 3.0)
        return {"E": E, "G": G, "phi": phi, "c": c, "phi_residual": phi_r, "c_residual": 0.5 * c, "psi": psi, "beta": beta}, pressure
    if law == "mu_of_I":
        mu_s, phi_max = rng.uniform(0.0, 0.6), rng.uniform(0.7, 0.9)
        mu_d, I0, slope = rng.uniform(mu_s, 0.9), rng.uniform(0.1, 1.0), rng.uniform(0.05, 0.5)
        return {"mu_s": mu_s, "mu_d": mu_d, "I0": I0, "phi_max": phi_max, "slope": slope, "grain_mass": 1e-5}, 0.0
    B = E * rng.uniform(0.05, 1.0)
    A_max = rng.uniform(0.0, 0.95) * np.sqrt(E * B)
    values = {"E": E, "B": B, "s_max": rng.uniform(0.05, 0.8), "A_max": A_max, "beta_F": 10.0 ** rng.uniform(0.0, 3.0)}
    if law == "scalar":
        return values | {"A_max": A_max * rng.choice([-1.0, 1.0])}, pressure
    return values | {"G": E * rng.uniform(0.02, 0.5)}, pressure


def walk(rng, largest):
    """(STEPS + 1,) from zero: runs of one direction, with reversals."""
    turns = np.sign(rng.normal(size=20)) * rng.uniform(0.0, 1.0, 20)
    return largest * np.concatenate([[0.0], np.cumsum(np.repeat(turns, STEPS // 20))])


def start_of(law, rng, pressure, values):
    if law == "mu_of_I":
        return {"area_fraction": values["phi_max"] * rng.uniform(0.8, 0.999)}
    return {"sigma_xx": pressure, "sigma_zz": pressure}


def structure(test):
    """A >= 0 along the path."""
    return np.hypot(test.internal["A_1"], test.internal["A_2"]) if "A_1" in test.internal else np.abs(test.internal["A"])


def check(law, values, test):
    """What holds on any path."""
    if test.status.level == "failed":
        assert (
            any(meaning in str(test.status) for meaning in MEANING.values())
            or "reachable" in str(test.status)
            or "gives way" in str(test.status)
        )
    for array in (test.stress, test.strain, *test.internal.values()):
        assert np.all(np.isfinite(array))
    if law in ("scalar", "tensorial"):
        A = structure(test)
        assert np.all(test.sigma_V > 0.0)
        assert np.all(np.abs(values["A_max"]) * (1.0 + ROUNDING) >= A)
        two_G = 2.0 * values.get("G", 0.5 * values["B"])
        B = two_G + (values["B"] - two_G) * (A / np.abs(values["A_max"])) ** 2
        assert np.all(values["E"] * B - A**2 > 0.0)
    elif law == "mohr_coulomb":
        fall = np.exp(-values["beta"] * test.internal["kappa"])
        sine, c_cos = (
            first + (peak - first) * fall
            for peak, first in (
                (np.sin(values["phi"]), np.sin(values["phi_residual"])),
                (values["c"] * np.cos(values["phi"]), values["c_residual"] * np.cos(values["phi_residual"])),
            )
        )
        sigma_D = np.hypot(0.5 * (test.sigma_zz - test.sigma_xx), test.stress[0, 1])
        assert np.all(sigma_D <= test.sigma_V * sine + c_cos + 1e-9 * np.abs(test.stress).max())  # Newton's return
        assert np.all(np.diff(test.internal["kappa"]) >= 0.0)
    else:
        assert np.all(test.sigma_V >= 0.0)
        assert np.all(test.internal["area_fraction"] < values["phi_max"])


@pytest.mark.hard_case("C14")
@some
@given(seeds)
@pytest.mark.parametrize("law", LAWS)
def test_any_path_of_strain_is_finite_or_ends_by_name_and_keeps_the_structure_inside(law, seed):
    rng = np.random.default_rng(seed)
    values, pressure = random_parameters(law, rng)
    largest = 10.0 ** rng.uniform(-6.0, -1.5)
    control = {"eps_D": walk(rng, largest), "eps_V": walk(rng, 0.1 * largest)}
    if law != "scalar":
        control |= {"eps_xz": walk(rng, largest), "spin": walk(rng, largest)}
    test = element_test(law, values, control, start_of(law, rng, pressure, values))
    check(law, values, test)


@pytest.mark.hard_case("C13", "C14")
@some
@given(seeds)
@pytest.mark.parametrize("law", laws("C13"))
def test_any_path_with_a_prescribed_stress_is_finite_or_ends_by_name(law, seed):
    rng = np.random.default_rng(seed)
    values, pressure = random_parameters(law, rng)
    largest = 10.0 ** rng.uniform(-6.0, -1.5)
    stress = pressure * (1.0 + 0.1 * walk(rng, rng.uniform(0.0, 1.0)))
    control = {rng.choice(["sigma_xx", "sigma_V"]): stress, rng.choice(["eps_zz", "eps_D"]): walk(rng, largest)}
    if law != "scalar":
        control |= {"eps_xz": walk(rng, largest), "spin": walk(rng, largest)}
    start = {"sigma_xx": stress[0], "sigma_zz": stress[0]}
    test = element_test(law, values, control, start)
    check(law, values, test)
    key = next(key for key in control if key.startswith("sigma"))
    reached = getattr(test, key)
    np.testing.assert_allclose(reached, stress[: reached.size], rtol=0, atol=1e-10 * np.abs(stress).max())  # C13


@pytest.mark.hard_case("C6", "C14")
@some
@given(seeds)
@pytest.mark.parametrize("law", ["scalar", "tensorial"])
def test_the_stress_ratio_stays_below_its_limit_where_the_rate_form_keeps_it(law, seed):
    rng = np.random.default_rng(seed)
    values, pressure = random_parameters(law, rng)
    little = 0.5 * FINEST * values["s_max"] * pressure / max(values["B"], 2.0 * values.get("G", 0.0))  # sigma_V may fall by a half
    shear = walk(rng, little * 10.0 ** rng.uniform(-3.0, 0.0))
    growing = pressure * (1.0 + np.linspace(0.0, rng.uniform(0.0, 10.0), STEPS + 1))
    case = rng.integers(5)
    control = [
        {"eps_V": 0.0, "eps_D": walk(rng, 10.0 ** rng.uniform(-6.0, -1.5))},
        {"sigma_xx": pressure, "eps_D": shear},
        {"sigma_V": pressure, "eps_D": shear},
        {"sigma_V": growing, "eps_D": shear},
        {"sigma_V": growing, "eps_D": shear} | ({} if law == "scalar" else {"eps_xz": shear[::-1] - shear[-1], "spin": walk(rng, 0.1)}),
    ][case]
    if case >= 3:
        values["A_max"] *= min(1.0, values["s_max"] * values["E"] / abs(values["A_max"]))
    if case == 4:
        values |= {"A_max": 0.0} | ({} if law == "scalar" else {"G": 0.5 * values["B"]})
    test = element_test(law, values, control, pressure)
    assert test.status or case == 0  # a large anisotropy may take all the pressure away
    assert np.all(test.stress_ratio <= values["s_max"] * (1.0 + ROUNDING))


def test_decompression_raises_the_stress_ratio_beyond_its_limit():
    """Not a fault of the numbers: S < 0 then softens, but less stress than pressure is lost."""
    start = {"sigma_xx": 71.0, "sigma_zz": 129.0}
    test = element_test("scalar", PARAMETERS["scalar"], {"eps_V": [0.0, -2e-4], "eps_D": 0.0}, start, steps=20)
    assert test.s_D[-1] > 0.3 > test.s_D[0]


SYMMETRIC = {  # where each law promises a symmetric tangent: (change of its parameters, state of stress)
    "scalar": ({}, 0.0),  # at S = 1, no deviator of stress; the softening S stands on the columns of eps_D alone
    "tensorial": ({}, 0.0),  # likewise
    "mohr_coulomb": ({"psi": 0.3, "phi": 0.3, "phi_residual": 0.3}, -40.0),  # elastic, or with associated flow (psi = phi)
}
UNSYMMETRIC = {"scalar": ({}, -15.0), "tensorial": ({}, -15.0), "mohr_coulomb": ({}, -50.0), "mu_of_I": ({}, 0.0)}


def moduli(law, change, sigma_1):
    """The half/half moduli (3, 3) of a small step on from a state with anisotropy."""
    inner = {"A": 1e4} if law == "scalar" else {"A_1": -8e3, "A_2": 5e3} if law == "tensorial" else {}
    h = 1e-2 if law == "mu_of_I" else 1e-3 if sigma_1 < -30.0 else 1e-12
    d_eps = strain(0.2 * h, -h, 0.0 if law == "scalar" else 0.5 * h)
    tangent = updated(state(law, 100.0, sigma_1, **inner), d_eps, record(law, **change), tangent=True).tangent
    units = [strain(*unit) for unit in np.eye(3)]
    M = np.array([[np.einsum("ij,ijkl,kl", left, tangent, right) / np.sum(left * left) for right in units] for left in units])
    return M, np.abs(M).max()


@pytest.mark.hard_case("C12")
@pytest.mark.parametrize("law", SYMMETRIC)
def test_the_tangent_is_symmetric_where_promised(law):
    M, largest = moduli(law, *SYMMETRIC[law])
    np.testing.assert_allclose(M, M.T, atol=1e-6 * largest)  # the relaxation of the step of 1e-12, E h/(s_max sigma_V)
    assert np.count_nonzero(np.abs(M) > 1e-3 * largest) >= 4  # coupled


@pytest.mark.parametrize("law", LAWS)
def test_the_tangent_is_not_symmetric_elsewhere(law):
    """A solver has to know: softening, non-associated flow and a friction of the rate give other moduli above than below the diagonal."""
    M, largest = moduli(law, *UNSYMMETRIC[law])
    assert np.abs(M - M.T).max() > 1e-2 * largest
