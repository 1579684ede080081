"""Nonlocal fluidity in the ring: independent solutions, wall conditions, hard parameters."""

import numpy as np
import pytest
from scipy.integrate import solve_bvp
from scipy.linalg import eig

from anisogran.continuum import Nonlocal, RingFlow
from anisogran.outcome import InputError

LAW = Nonlocal(mu_s=0.26, b=1.0, amplitude=0.9)


def slow_stress_ratio(law, r_inner, r_outer, points=80):
    """Smallest S with (mu_s - A^2 lap) g = S (R_i/r)^2 g and the wall condition, by Chebyshev collocation: no element in it.

    As the wall speed goes to 0 the term in b vanishes, the shear rate is mu g, and mu = S (R_i/r)^2.
    """
    k = np.arange(points + 1)
    x = np.cos(np.pi * k / points)
    c = np.where((k == 0) | (k == points), 2.0, 1.0) * (-1.0) ** k
    slope = np.outer(c, 1.0 / c) / (x[:, None] - x[None, :] + np.eye(points + 1))
    slope -= np.diag(slope.sum(axis=1))
    slope *= 2.0 / (r_outer - r_inner)
    r = 0.5 * (r_outer + r_inner) + 0.5 * (r_outer - r_inner) * x  # from the outer ring to the inner one
    left = law.mu_s * np.eye(points + 1) - law.amplitude**2 * (slope @ slope + slope / r[:, None])
    right = np.diag((r_inner / r) ** 2)
    left[0], left[-1] = slope[0], slope[-1]
    left[-1, -1] += law.wall or 0.0
    right[0, 0] = right[-1, -1] = 0.0
    values = eig(left, right, right=False)
    finite = values[np.isfinite(values)]
    real = finite.real[(np.abs(finite.imag) < 1e-9 * np.abs(finite)) & (finite.real > 0.0)]
    return real.min()


@pytest.mark.parametrize("amplitude", [0.5, 0.9])
@pytest.mark.parametrize("wall", [None, 0.2, -0.5])
def test_slow_limit_is_the_eigenvalue(amplitude, wall):
    law = Nonlocal(0.26, 1.0, amplitude, wall)
    with np.errstate(all="ignore"):  # the eigenvalues of the wall rows are infinite
        expected = slow_stress_ratio(law, 13.0, 33.0)
    flow = RingFlow(13.0, 33.0, law, 1e-9, 1.0).solve()
    assert flow.stress_ratio_wall == pytest.approx(expected, rel=1e-5)  # mesh 5e-7 at A = 0.5; speed and floor below 1e-7


@pytest.mark.hard_case("N4", of="nonlocal")
def test_a_hundredth_of_the_radius_inside(answer):
    """Against the eigenvalue; a smaller ring than 1e-6 R_o is refused."""
    with np.errstate(all="ignore"):
        expected = slow_stress_ratio(LAW, 0.3, 30.0, points=160)
    flow = RingFlow(0.3, 30.0, LAW, 1e-9, 1.0, elements=512).solve()
    error = abs(flow.stress_ratio_wall / expected - 1.0)
    assert error < 1e-7
    answer.computed(error, "stress ratio at R_i = R_o/100")
    with pytest.raises(InputError, match=r"RingFlow: r_inner = 2e-05 must be at least 3e-05 m") as caught:
        RingFlow(2e-5, 30.0, LAW, 0.02, 1.0)
    answer.refused(caught)


def test_finite_speed_against_a_collocation_solver():
    """Uniform p and r^2 tau leave an equation for g alone, A^2 (g'' + g'/r) = mu_s g - mu (1 - b g) g, and v from mu g."""
    speed, inner, outer = 0.5, 13.0, 33.0

    def slopes(r, y, p):
        g, dg, _ = y  # the third is v/r
        mu = p[0] * (inner / r) ** 2
        return np.array([dg, (LAW.mu_s * g - mu * g * (1.0 - LAW.b * g)) / LAW.amplitude**2 - dg / r, -mu * g / r])

    def ends(a, b, p):
        return np.array([a[1], b[1], a[2] - speed / inner, b[2]])

    flow = RingFlow(inner, outer, LAW, speed, 1.0).solve()
    start = np.array([flow.fluidity * 1.1, np.gradient(flow.fluidity, flow.r), flow.v_phi / flow.r])
    other = solve_bvp(slopes, ends, flow.r, start, p=[0.4], tol=1e-9, max_nodes=20000)
    assert other.success
    g, _, w = other.sol(flow.r)
    assert flow.stress_ratio_wall == pytest.approx(other.p[0], rel=2e-6)  # mesh of 64: 2e-7, rate floor 1e-8
    np.testing.assert_allclose(flow.v_phi, w * flow.r, rtol=0.0, atol=2e-5 * speed)  # mesh error 4e-6 in L2
    np.testing.assert_allclose(flow.fluidity, g, rtol=0.0, atol=1e-4 * g.max())


def test_fluidity_and_shear_rate_agree_with_their_definition():
    flow = RingFlow(13.0, 33.0, LAW, 1e-3, 1.0, elements=256).solve()
    mu = np.abs(flow.stress[0, 1]) / flow.pressure
    np.testing.assert_allclose(flow.shear_rate, mu * flow.fluidity, rtol=1e-4)  # the floor, 1e-8 of V/gap, in the far tail
    slope = np.gradient(flow.v_phi / flow.r, flow.r)
    inside = slice(1, 150)
    # second-order difference of a third-order v on 512 nodes
    np.testing.assert_allclose(flow.shear_rate[inside], -(flow.r * slope)[inside], rtol=5e-3)


def test_width_does_not_depend_on_a_slow_speed():
    flows = [RingFlow(13.0, 33.0, LAW, speed, 1.0).solve() for speed in (1e-7, 1e-4)]
    np.testing.assert_allclose(flows[0].v_phi / 1e-7, flows[1].v_phi / 1e-4, atol=1e-4)  # b I: 1e-4/20 x the slope of S


def test_wall_condition_holds_and_orders_the_width():
    widths = []
    for wall in (-1.0, None, 0.3):
        flow = RingFlow(13.0, 33.0, Nonlocal(0.26, 1.0, 0.9, wall), 1e-3, 1.0, elements=256).solve()
        g = flow.at(13.0 + np.array([0.0, 1e-3])).fluidity
        # one-sided difference over 1e-3 d; natural condition, exact with h^2
        assert (g[1] / g[0] - 1.0) / 1e-3 == pytest.approx(-(wall or 0.0), abs=3e-3)
        widths.append(np.interp(0.5e-3, flow.v_phi[::-1], flow.r[::-1]) - 13.0)
    assert widths[0] > widths[1] > widths[2]


@pytest.mark.parametrize("amplitude", [0.3, 0.4, 0.5, 0.7, 0.9])
@pytest.mark.parametrize("wall_speed", [1e-7, 1e-5, 1e-3, 0.1, 3.0])
def test_hard_parameters_converge(amplitude, wall_speed):
    flow = RingFlow(13.0, 33.0, Nonlocal(0.25, 1.1, amplitude), wall_speed, 1.0).solve()
    assert flow.torques.difference < 1e-8  # a promise: the balance is that of the converged equations, on any mesh
    assert flow.status.level == ("warned" if wall_speed == 3.0 else "ok")  # I = 0.8 is out of the range of the linear law
    shear = flow.r**2 * flow.stress[0, 1]
    np.testing.assert_allclose(shear, 169.0 * flow.stress_ratio_wall, rtol=3e-3)  # recovered stress, h^2: measured 1e-3 at most
    assert np.all(np.diff(flow.v_phi[: flow.r.size // 2]) < 0.0)
    assert np.all(flow.fluidity + 1e-8 * wall_speed / 20.0 > 0.0)


@pytest.mark.parametrize(("mu_s", "b", "amplitude", "wall_speed"), [(0.1, 2.0, 0.2, 0.03), (0.6, 0.3, 0.2, 1e-7)])
def test_thin_layers_need_a_good_start(mu_s, b, amplitude, wall_speed):
    """Newton started after four Picard rounds stalls in the first."""
    flow = RingFlow(13.0, 33.0, Nonlocal(mu_s, b, amplitude), wall_speed, 1.0).solve()
    assert flow.torques.difference < 1e-8


@pytest.mark.parametrize(
    ("inner", "outer", "amplitude"),
    [(10.0, 200.0, 0.9), (13.0, 33.0, 0.1), (1e-3, 30.0, 0.9), (1e-6, 1.0, 0.9), (100.0, 101.0, 5.0)],
)
def test_extreme_geometries_converge(inner, outer, amplitude):
    flow = RingFlow(inner, outer, Nonlocal(0.25, 1.1, amplitude), 1e-4, 1.0).solve()
    assert flow.torques.difference < 1e-8


def test_a_wall_that_fluidises_at_rest_is_refused():
    with pytest.raises(InputError, match=r"Nonlocal: wall = 0.6 must be below 0.56"):
        Nonlocal(0.26, 1.0, 0.9, wall=0.6)
    with pytest.raises(InputError, match=r"RingFlow: law.wall = 0.5 must be below"):
        RingFlow(100.0, 101.0, Nonlocal(0.26, 1.0, 0.9, wall=0.5), 1e-3, 1.0)
