"""All laws: at a point with normal deformation and a pressure other than 1, which no steady ring flow shows; hard cases in the ring."""

import dataclasses

import numpy as np
import pytest

from anisogran import tensors
from anisogran.continuum import Jop, LocalMuI, Nonlocal, Regularised, RingFlow
from anisogran.continuum.balance import Point, Setting
from anisogran.continuum.laws.coaxial import shear_rate
from anisogran.models import element_test, viscosity, well_posed_ranges
from anisogran.outcome import InputError, NotConverged
from continuum_cases import CASES, LOCAL, example, name

SETTING = Setting(inertial=0.3, diameter=0.1, density=0.0, rate_floor=1e-9, inner=1.0)


def state(law, rng):
    d_rr, d_ff, gamma = rng.standard_normal((3, 20))
    rate = np.sqrt((d_rr - d_ff) ** 2 + gamma**2)
    pressure = rng.uniform(0.2, 5.0, 20)
    mu = law.friction(SETTING.inertial * rate / np.sqrt(pressure))
    point = Point(0 * rate, 0 * rate, d_rr, d_ff, gamma, pressure, rate / mu, 0 * rate)
    return point, np.array([[d_rr, 0.5 * gamma], [0.5 * gamma, d_ff]]), mu


@pytest.mark.parametrize("law", CASES, ids=name)
def test_stress_is_coaxial_dissipates_and_has_the_ratio_mu(law, rng):
    point, deformation, mu = state(law, rng)
    s_rr, s_ff, s_rf = law.stress(point, SETTING)
    stress = np.array([[s_rr, s_rf], [s_rf, s_ff]])
    np.testing.assert_allclose(tensors.mean(stress), point.p, rtol=1e-12)
    # the rate floor, 1e-9, over rates and fluidities of order 0.1
    np.testing.assert_allclose(tensors.deviator_size(stress), mu * point.p, rtol=1e-6)
    # compression positive: the deviator of the stress opposes that of the rate of deformation
    work = np.einsum("ijn,ijn->n", tensors.deviator(stress), tensors.deviator(deformation))
    np.testing.assert_allclose(work, -mu * point.p * shear_rate(point), rtol=1e-6)


@pytest.mark.parametrize("law", CASES, ids=name)
def test_rate_from_the_stress_is_the_shear_rate(law, rng):
    point, _, mu = state(law, rng)
    np.testing.assert_allclose(law.rate(point, SETTING, mu * point.p), shear_rate(point), rtol=1e-6)


def test_uniform_fluidity_fulfils_its_equation_with_mu_of_i(rng):
    law = Nonlocal(0.3, 0.9, 0.8)
    point, _, mu = state(law, rng)
    np.testing.assert_allclose(mu, 0.3 + 0.9 * SETTING.inertial * shear_rate(point) / np.sqrt(point.p), rtol=1e-14)
    source, *flux = law.fluidity(point, SETTING)
    np.testing.assert_allclose(source, 0.0, atol=1e-12)
    np.testing.assert_array_equal(flux[0], 0.0)


@pytest.mark.parametrize(
    ("law", "parameters"),
    [(LocalMuI(0.28, 1.1), {"mu_s": 0.28, "b": 1.1}), (Jop(0.28, 0.6, 0.2), {"mu_s": 0.28, "mu_d": 0.6, "I0": 0.2})],
    ids=["local_mu_i", "jop"],
)
def test_a_quadrature_point_and_the_element_test_see_one_law(law, parameters):
    mass, rate, I = 3.0, 0.7, np.array([1e-4, 0.01, 0.15, 2.0])
    for number in I:
        given = parameters | {"phi_max": 0.82, "slope": 0.3, "grain_mass": mass}
        shear = {"eps_V": [0.0, 0.0], "eps_zz": [0.0, 0.0], "eps_xz": [0.0, -0.5 * rate], "time": [0.0, 1.0]}
        test = element_test("mu_of_I", given, shear, start={"area_fraction": 0.82 - 0.3 * number})
        stress = test.stress[..., -1]
        p = tensors.mean(stress)
        point = Point(0.0, 0.0, 0.0, 0.0, rate, np.array(p))
        s_rr, s_ff, s_rf = law.stress(point, Setting(inertial=np.sqrt(mass), diameter=1.0, density=0.0, rate_floor=1e-30, inner=1.0))
        assert rate * np.sqrt(mass / p) == pytest.approx(number, rel=1e-11)  # 0.82 - phi has lost four digits at I = 1e-4
        # I from phi and I from p differ by that rounding, and mu is known to it or better
        np.testing.assert_allclose([s_rr, s_ff, s_rf], [stress[0, 0], stress[1, 1], stress[0, 1]], rtol=1e-12)


@pytest.mark.parametrize("law", LOCAL, ids=name)
def test_a_quadrature_point_has_the_viscosity_of_a_curve(law, rng):
    rate, p, mass = np.geomspace(1e-6, 10.0, 8), rng.uniform(0.2, 5.0, 8), 2.0
    setting = Setting(inertial=np.sqrt(mass), diameter=1.0, density=0.0, rate_floor=1e-30, inner=1.0)
    shear = law.stress(Point(0.0, 0.0, 0.0, 0.0, rate, p), setting)[2]
    expected = viscosity(rate * np.sqrt(mass / p), p, mass, law.friction)
    np.testing.assert_allclose(-shear / rate, expected, rtol=1e-14)


FAST = {  # what the friction of each law tends to at large I, over I or as it is
    "local_mu_i": lambda law, I: law.b * I,
    "jop": lambda law, I: law.mu_2,
    "regularised": lambda law, I: law.mu_inf * I,
    "nonlocal": lambda law, I: law.b * I,
}


@pytest.mark.hard_case("M2")
@pytest.mark.parametrize("law", CASES, ids=name)
def test_friction_at_rest_and_at_any_speed(law, answer):
    I = np.array([0.0, 1e-300, 1e-12, 1.0, 1e300])
    mu = law.friction(I)
    assert np.isfinite(mu).all()
    assert np.all(np.diff(mu) >= 0.0)
    assert np.isnan(law.friction(np.nan))  # a NaN is not hidden
    slopes = law.friction(I[1:] * (1.0 + 1e-8j)).imag
    assert np.isfinite(slopes).all()
    error = abs(mu[-1] / FAST[law.kind](law, 1e300) - 1.0)
    assert error < 1e-14  # some roundings
    answer.computed(error, "limit of mu at I = 1e300")


def test_limits_of_the_friction():
    assert Jop(0.342, 0.557, 0.069).friction(1e300) == 0.557
    assert Jop(0.342, 0.557, 0.069).friction(0.0) == pytest.approx(0.342, rel=1e-15)
    assert Regularised(0.342, 0.557, 0.069).friction(0.0) == 0.0
    # values of a public implementation, digits as given there
    assert Regularised(0.342, 0.557, 0.069).friction(0.003972) == pytest.approx(0.35371, rel=2e-5)
    assert Regularised(0.342, 0.557, 0.069).friction(1e-6) == pytest.approx(0.2845, rel=2e-4)


@pytest.mark.hard_case("M1")
@pytest.mark.parametrize("law", CASES, ids=name)
@pytest.mark.parametrize("wall_speed", [1e-7, 1e-3, 0.3])
def test_slow_and_fast_rings_do_not_depend_on_the_rate_floor_or_say_so(law, wall_speed, answer):
    flows = [RingFlow(13.0, 33.0, law, wall_speed, 1.0, rate_floor=floor).solve() for floor in (law.floor, 0.1 * law.floor)]
    change = np.sqrt(np.sum((flows[0].v_phi - flows[1].v_phi) ** 2) / np.sum(flows[1].v_phi ** 2))
    assert change < 0.01 or "rate floor" in str(flows[0].status), change
    answer.computed(change, "v_phi against a tenth of the rate floor")
    if "rate floor" in str(flows[0].status):
        answer.named(flows[0].status)
    high = 1e-5 if "g" in law.fields else 0.1
    coarse = RingFlow(13.0, 33.0, law, wall_speed, 1.0, rate_floor=high).solve()
    change = np.sqrt(np.sum((coarse.v_phi - flows[1].v_phi) ** 2) / np.sum(flows[1].v_phi ** 2))
    assert (change < 0.02) == ("rate floor" not in str(coarse.status)), change


@pytest.mark.parametrize("law", LOCAL, ids=name)
@pytest.mark.parametrize(
    ("r_inner", "r_outer", "wall_speed", "elements"), [(0.3, 30.0, 1e-5, 65), (13.0, 33.0, 0.3, 65), (13.0, 33.0, 1e-3, 256)]
)
def test_low_floors_on_fine_meshes_are_reached(law, r_inner, r_outer, wall_speed, elements):
    """Where a floor that falls by a tenth at a time ends in a line search that stalls."""
    flow = RingFlow(r_inner, r_outer, law, wall_speed, 1.0, elements=elements, rate_floor=1e-6).solve()
    assert flow.torques.difference < 1e-8


@pytest.mark.hard_case("M2")
@pytest.mark.parametrize("law", CASES, ids=name)
def test_only_a_linear_law_is_flagged_above_its_range(law, answer):
    flow = RingFlow(13.0, 33.0, law, 0.6, 1.0).solve()
    assert flow.inertial_number.max() > 0.2
    assert ("meant for I <= 0.2" in str(flow.status)) == (law.valid_to < np.inf) == hasattr(law, "b")
    answer.named(flow.status if hasattr(law, "b") else "no upper end of its range")


@pytest.mark.hard_case("M5")
@pytest.mark.parametrize("law", CASES, ids=name)
def test_a_pressure_that_falls_to_nothing_is_no_answer(law, answer):
    """A centrifugal load far above the outer pressure, even if all the flow is within one element; history and last iterate are given.

    No pressure is cut off at a floor, and no share of the points is let go: the first one that would be pulled ends the search.
    """
    problem = RingFlow(13.0, 33.0, law, 1.0, 1.0, inertia=True, areal_density=1e4)
    with pytest.raises(
        NotConverged, match=r"^continuum: the pressure falls to \S+ of the outer one, and no grains can be pulled: "
    ) as caught:
        problem.solve()
    assert len(caught.value.history) > 0
    assert np.isfinite(caught.value.best.unknowns).all()
    assert not caught.value.best.status
    answer.named(caught)


def test_a_flow_thinner_than_an_element_is_told():
    """No ring exerts more than mu_2, and the speed of a fast one falls within a layer that no mesh resolves."""
    fast = RingFlow(13.0, 33.0, example(Jop), 10.0, 1.0).solve()
    assert "falls within one element" in str(fast.status)
    assert RingFlow(13.0, 33.0, example(Jop), 0.3, 1.0).solve().status.level == "ok"


@pytest.mark.hard_case("M3")
@pytest.mark.parametrize("law", CASES, ids=name)
def test_the_share_of_an_ill_posed_flow_is_that_of_its_law(law, answer):
    """C(I) = 4 n^2 - 4 n + mu^2 (1 - n/2)^2 > 0 with n = d ln mu/d ln I by differences, on fine radii; a nonlocal law has no C(I)."""
    flows = [RingFlow(13.0, 33.0, law, wall_speed, 1.0).solve() for wall_speed in (1e-5, 0.3)]
    shares = [flow.ill_posed_share for flow in flows]
    if "g" in law.fields:
        assert shares == [None, None]
        answer.named("C(I) is that of a local law: no share is told")
        return
    r = np.linspace(13.0, 33.0, 4001)
    for flow in flows:
        I = np.hypot(flow.at(r).inertial_number, flow.problem.setting().inertial * flow.problem.floor)  # as the stress sees it
        mu, step = law.friction(I), 1e-5
        n = (law.friction(I * (1.0 + step)) - law.friction(I * (1.0 - step))) / (2.0 * step * mu)
        ill_posed = 4.0 * n**2 - 4.0 * n + mu**2 * (1.0 - 0.5 * n) ** 2 > 0.0
        expected = np.trapezoid(ill_posed * r, r) / np.trapezoid(r, r)
        assert flow.ill_posed_share == pytest.approx(expected, abs=0.02)  # counted by quadrature points, five in an element of 1 at most
        answer.computed(abs(flow.ill_posed_share - expected), "ill-posed share of the area, absolute")
    answer.named("of the area {:.0%} at the wall speed 1e-5, {:.0%} at 0.3".format(*shares))


def test_where_a_flow_in_time_would_be_ill_posed():
    law = example(Jop)
    ((low, high),) = well_posed_ranges(law.friction)
    assert (low, high) == pytest.approx((0.00397, 0.280), rel=2e-3)
    slow, fast = (RingFlow(13.0, 33.0, law, wall_speed, 1.0).solve() for wall_speed in (1e-5, 0.1))
    assert slow.ill_posed_share == 1.0
    assert slow.status.level == "ok"  # a steady axisymmetric flow is not concerned
    edge = np.interp(-low, -fast.inertial_number, fast.r)  # I falls outward, and is below `high` everywhere
    assert fast.inertial_number.max() < high
    expected = (33.0**2 - edge**2) / (33.0**2 - 13.0**2)
    assert fast.ill_posed_share == pytest.approx(expected, abs=0.02)  # it is counted by quadrature points, five in an element of 1 at most
    assert RingFlow(13.0, 33.0, example(Regularised), 1e-5, 1.0).solve().ill_posed_share == 0.0
    assert RingFlow(13.0, 33.0, example(Nonlocal), 1e-5, 1.0).solve().ill_posed_share is None  # C(I) is that of a local law


def test_bad_keys_are_named():
    for law, changes, message in (
        (Jop, {"mu_2": 0.3}, r"Jop: mu_2 = 0\.3 must be above 0\.342 \(= mu_s\)"),
        (Jop, {"I_0": 0.0}, "Jop: I_0 = 0 must be above 0"),
        (Regularised, {"alpha": 2.0}, "Regularised: alpha = 2 must be below 2"),
        (Regularised, {"mu_s": 3.0, "mu_2": 3.1}, r"Regularised: mu_s = 3, mu_2 = 3\.1, I_0 = 0\.069 has no bounded well-posed range"),
        (Regularised, {"mu_2": 0.3}, r"Regularised: mu_2 = 0\.3 must be above 0\.342"),
    ):
        with pytest.raises(InputError, match=message):
            example(law, **changes)


@pytest.mark.parametrize("law", CASES, ids=name)
def test_records_are_frozen(law):
    problem = RingFlow(13.0, 33.0, law, 1e-3, 1.0)
    for record, key in ((problem, "wall_speed"), (law, "mu_s")):
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(record, key, 1.0)
