"""Orders of convergence on manufactured solutions: every term of both laws, radial flow, inertia, both meshes, eccentric rings."""

import numpy as np
import pytest
from scipy.sparse import csc_array

from anisogran.continuum.balance import Point, Setting, balance, complex_step, stacked
from anisogran.continuum.laws import Jop, LocalMuI, Nonlocal, Regularised
from anisogran.continuum.newton import newton
from anisogran.continuum.space import Space
from anisogran.continuum.system import System

SETTING = Setting(inertial=0.3, diameter=0.5, density=0.7, rate_floor=1e-2, inner=1.0)
LAWS = [LocalMuI(mu_s=0.4, b=0.8), Nonlocal(mu_s=0.4, b=0.8, amplitude=0.9)]
# mu grows enough at the I of about 1 that the chosen flow has: all but plastic flow has other orders on these meshes
MORE_LAWS = [Jop(mu_s=0.4, mu_2=2.0, I_0=2.0), Regularised(mu_s=0.342, mu_2=0.557, I_0=0.069, mu_inf=0.8)]
STEP = 1e-30


def chosen(r, phi, law, lobes):
    """The Point of the chosen solution, for complex r and phi too; it depends on phi if `lobes` is not 0."""
    waves, shift = 1.0 + lobes * 0.5 * np.cos(2.0 * phi), 1.0 + lobes * 0.3 * np.sin(phi)
    turned = -lobes * np.sin(2.0 * phi)  # d waves/dphi
    u_r, d_rr, turned_r = 0.2 * np.sin(2.0 * r) * waves, 0.4 * np.cos(2.0 * r) * waves, 0.2 * np.sin(2.0 * r) * turned
    u_phi, slope, turned_phi = 3.0 * np.exp(-r) * shift, -3.0 * np.exp(-r) * shift, 0.9 * lobes * np.exp(-r) * np.cos(phi)
    values = {
        "u_r": u_r,
        "u_phi": u_phi,
        "d_rr": d_rr,
        "d_ff": (turned_phi + u_r) / r,
        "gamma": turned_r / r + slope - u_phi / r,
        "p": 1.5 + np.sin(3.0 * r) / 2.0 + 0.3 * lobes * np.sin(2.0 * phi),
        "spin": 0.5 * (slope + u_phi / r - turned_r / r),
    }
    if "g" in law.fields:
        values |= {"g": 2.0 + np.cos(2.0 * r) * shift, "g_r": -2.0 * np.sin(2.0 * r) * shift}
        values["g_f"] = 0.3 * lobes * np.cos(2.0 * r) * np.cos(phi) / r
    return Point(**values)


def sources(r, phi, law, lobes):
    """{row: what must be taken from it} so that the chosen solution balances: the strong form of the weak rows."""

    def rows(radius, angle):
        return balance(law, SETTING, chosen(radius, angle, law, lobes))

    q = rows(r, phi)
    along = {row: np.imag(value) / STEP for row, value in rows(r + 1j * STEP, phi).items()}
    around = {row: np.imag(value) / STEP / r for row, value in rows(r, phi + 1j * STEP).items()}
    out = {
        "u_r": q["u_r"] - along["d_rr"] - q["d_rr"] / r + q["d_ff"] / r - around["gamma"],
        "u_phi": q["u_phi"] - around["d_ff"] - along["gamma"] - 2.0 * q["gamma"] / r,
        "p": q["p"],
    }
    if "g" in law.fields:
        out["g"] = q["g"] - along["g_r"] - q["g_r"] / r - around["g_f"]
    return out


def solution(space, law, lobes):
    """The discrete solution: velocity and fluidity prescribed on both rings, but for the traction sigma_rr on the outer one."""
    phi = np.zeros_like(space.r) if space.angles is None else quadrature_angles(space)
    given = stacked(sources(space.r, phi, law, lobes), space.rows, space.r)
    load = -space.residual(-given)  # of the sources, taken to the other side
    places = space.ring("u_r", outer=True)
    end = chosen(np.full(places.size, 2.0), space.angle[places], law, lobes)
    load[places] += space.arc(outer=True) * balance(law, SETTING, end)["d_rr"]
    fixed = [space.ring("u_r", outer=False)]
    fixed += [space.ring(name, outer) for name in ("u_phi", "g") if name in law.fields for outer in (False, True)]
    free = np.setdiff1d(np.arange(space.size), np.concatenate(fixed))
    trial = csc_array((np.ones(free.size), (free, np.arange(free.size))), shape=(space.size, free.size))
    nothing = csc_array((free.size, space.size))
    system = System(
        space,
        lambda point: balance(law, SETTING, point),
        lambda point: law.positive(point, SETTING),
        trial,
        trial.T.tocsr(),
        nothing,
        load[free],
    )
    x = np.empty(space.size)
    for name, part in space.part.items():
        r = space.polar(space.place[part], space.angle[part])[0]
        x[part] = getattr(chosen(r, space.angle[part], law, lobes), name)
    x[free] += 0.05 * np.sin(np.pi * (space.place[free] - 1.0))  # a start that is near, but wrong, and smooth up to the walls
    return newton(system, x, [], 30)


def quadrature_angles(space):
    """phi of the quadrature points [element, point]."""
    width = np.diff(space.angles)
    return np.tile(space.angles[:-1], len(space.vertices) - 1)[:, None] + space.local[1] * np.tile(width, len(space.vertices) - 1)[:, None]


def errors(law, elements, around, offset):
    """L2 errors of u_r, u_phi, gamma, p (and g) between the rings 1 and 2; on a line if `around` is 0."""
    angles = np.linspace(0.0, 2.0 * np.pi, around + 1) if around else None
    space = Space(np.linspace(1.0, 2.0, elements + 1), law.fields, angles, offset, inertia=True)
    lobes = 1.0 if around else 0.0
    x = solution(space, law, lobes)
    s = np.linspace(1.0, 2.0, 8 * elements + 1)[1::2, None]  # four places of each element, none of them on a mesh line
    phi = np.linspace(0.0, 2.0 * np.pi, 8 * around + 1)[1::2] if around else np.zeros(1)
    r = space.polar(s, phi)[0]
    found, wanted = space.evaluated(x, s, phi), chosen(r, phi, law, lobes)
    return np.array([np.sqrt(np.mean((getattr(found, name) - getattr(wanted, name)) ** 2 * r)) for name in measured(law)])


def measured(law):
    return ("u_r", "u_phi", "gamma", "p", "g") if "g" in law.fields else ("u_r", "u_phi", "gamma", "p")


@pytest.mark.hard_case("N1")
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(("elements", "around", "offset"), [(32, 0, 0.0), (8, 24, 0.0), (8, 24, 0.25)], ids=["line", "rings", "eccentric"])
def test_orders(law, elements, around, offset, answer):
    coarse, fine = errors(law, elements, around, offset), errors(law, 2 * elements, 2 * around, offset)
    orders = dict(zip(measured(law), np.log2(coarse / fine), strict=True))
    # theory for quadratic velocity and fluidity, linear pressure, smooth data: 3, 2, 3. Measured: on the line 3.0, 3.1, 2.2, 2.0, 3.0,
    # in 2D 3.4 to 3.7, 2.5 to 2.7, 2.0, 3.0, with one more refinement 3.1 to 3.5, 2.4 to 2.5, 2.0, 3.0
    for name, least in {"u_r": 3.0, "u_phi": 3.0, "gamma": 2.0, "p": 2.0, "g": 3.0}.items():
        assert name not in orders or least - 0.1 < orders[name] < least + 0.9, (orders, coarse, fine)
    answer.computed(fine[1], f"manufactured u_phi on {2 * elements}{f' x {2 * around}' if around else ''} elements, absolute")
    answer.named(f"its order {orders['u_phi']:.2f}{' in the plane' if around else ''}")


@pytest.mark.hard_case("N1")
@pytest.mark.parametrize("law", MORE_LAWS)
def test_orders_of_other_laws_on_the_line(law, answer):
    coarse, fine = errors(law, 64, 0, 0.0), errors(law, 128, 0, 0.0)
    orders = np.log2(coarse / fine)
    np.testing.assert_allclose(orders, [3.0, 3.0, 2.0, 2.0], atol=0.15)  # measured 3.0, 3.03 and 3.06, 2.04 and 2.08, 2.0
    answer.computed(fine[1], "manufactured u_phi on 128 elements, absolute")
    answer.named(f"its order {orders[1]:.2f}")


@pytest.mark.parametrize("law", LAWS + MORE_LAWS)
def test_complex_step_tangent_is_the_derivative(law, rng):
    space = Space(np.linspace(1.0, 2.0, 3), law.fields, np.linspace(0.0, 2.0 * np.pi, 5), inertia=True)
    r = np.linspace(1.0, 2.0, 7)
    point = chosen(r, 0.4, law, 1.0)
    z = np.array([np.broadcast_to(getattr(point, row), r.shape) for row in space.rows])

    def forms(values):
        return stacked(balance(law, SETTING, Point(**dict(zip(space.rows, values, strict=True)))), space.rows, r)

    slope = complex_step(lambda state: balance(law, SETTING, state), z, space.rows)
    direction = rng.standard_normal(z.shape)
    step = 1e-6
    sides = [forms(z + s * direction) for s in (step, -step)]
    # central difference: truncation 1e-12, rounding 1e-10, times the third derivative (gamma/rate^3, some hundred)
    np.testing.assert_allclose(np.einsum("abx,bx->ax", slope, direction), (sides[0] - sides[1]) / (2.0 * step), atol=1e-7)


def test_the_spin_turns_with_the_frame_and_advection_is_the_gradient_along_the_velocity():
    """(u . grad) u by differences of Cartesian components against the form with D and spin."""
    law, r, phi = LAWS[0], 1.4, 0.7

    def cartesian(x, y):
        radius, angle = np.hypot(x, y), np.arctan2(y, x)
        at = chosen(radius, angle, law, 1.0)
        return np.array([at.u_r * np.cos(angle) - at.u_phi * np.sin(angle), at.u_r * np.sin(angle) + at.u_phi * np.cos(angle)])

    x, y, step = r * np.cos(phi), r * np.sin(phi), 1e-5
    gradient = [(cartesian(x + a, y + b) - cartesian(x - a, y - b)) / (2.0 * step) for a, b in ((step, 0.0), (0.0, step))]
    advected = cartesian(x, y) @ np.array(gradient)
    point = chosen(np.array(r), np.array(phi), law, 1.0)
    q = balance(law, SETTING, point)
    turned = [q["u_r"] * np.cos(phi) - q["u_phi"] * np.sin(phi), q["u_r"] * np.sin(phi) + q["u_phi"] * np.cos(phi)]
    np.testing.assert_allclose(turned, SETTING.density * advected, rtol=1e-8)  # central difference
    assert point.spin == pytest.approx(0.5 * (gradient[0][1] - gradient[1][0]), rel=1e-8)
