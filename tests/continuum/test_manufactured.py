"""Orders of convergence on manufactured solutions, with every term of both laws, radial flow and inertia in play."""

import numpy as np
import pytest

from anisogran.continuum.balance import Point, Setting, balance, complex_step
from anisogran.continuum.laws import LocalMuI, Nonlocal
from anisogran.continuum.newton import System, newton
from anisogran.continuum.space import Space

SETTING = Setting(inertial=0.3, diameter=0.5, density=0.7, rate_floor=1e-2, inner=1.0)
LAWS = [LocalMuI(mu_s=0.4, b=0.8), Nonlocal(mu_s=0.4, b=0.8, amplitude=0.9)]
STEP = 1e-30


def chosen(r, law):
    """The Point of the chosen solution, for complex r too."""
    u_r, d_rr = 0.2 * np.sin(2.0 * r), 0.4 * np.cos(2.0 * r)
    u_phi, slope = 3.0 * np.exp(-r), -3.0 * np.exp(-r)
    values = [u_r, u_phi, d_rr, u_r / r, slope - u_phi / r, 1.5 + np.sin(3.0 * r) / 2.0]
    if "g" in law.fields:
        values += [2.0 + np.cos(2.0 * r), -2.0 * np.sin(2.0 * r)]
    return Point(*values)


def sources(r, law):
    """What must be taken from each row so that the chosen solution balances: the strong form of the weak rows."""

    def rows(radius):
        return balance(law, SETTING, chosen(radius, law), radius)

    q, grown = rows(r), rows(r + 1j * STEP).imag / STEP
    out = np.zeros_like(q)
    out[0] = q[0] + q[3] / r - grown[2] - q[2] / r
    out[1] = q[1] - 2.0 * q[4] / r - grown[4]
    out[5] = q[5]
    if "g" in law.fields:
        out[6] = q[6] - grown[7] - q[7] / r
    return out


def errors(law, elements):
    """L2 errors of u_r, u_phi, gamma, p (and g)."""
    space = Space(np.linspace(1.0, 2.0, elements + 1), law.fields)
    given = sources(space.r, law)
    load = np.zeros(space.size)
    end = np.array([2.0])
    load[space.at_end("u_r", outer=True)] = 2.0 * balance(law, SETTING, chosen(end, law), end)[2, 0]
    equations = System(space, lambda point, r: balance(law, SETTING, point, r) - given, lambda point: law.positive(point, SETTING), load)
    fixed = [space.at_end("u_r", outer=False)]
    fixed += [space.at_end(name, outer) for name in ("u_phi", "g") if name in law.fields for outer in (False, True)]
    exact = chosen(space.place, law)._asdict()
    x = np.concatenate([exact[name][part] for name, part in space.part.items()])
    free = np.setdiff1d(np.arange(space.size), fixed)
    x[free] *= 1.05
    x = newton(equations, x, free, [], 30)
    r = np.linspace(1.0, 2.0, 40 * elements + 1)[1::2]
    found, wanted = space.evaluated(x, r), np.array([field for field in chosen(r, law) if np.ndim(field)])
    size = np.sqrt(np.mean((found - wanted) ** 2 * r, axis=1))
    return size[[0, 1, 4, 5, 6]] if "g" in law.fields else size[[0, 1, 4, 5]]


@pytest.mark.parametrize("law", LAWS)
def test_orders(law):
    coarse, fine = errors(law, 32), errors(law, 64)
    orders = np.log2(coarse / fine)
    expected = [3.0, 3.0, 2.0, 2.0, 3.0][: len(orders)]
    # theory for P2-P1 with smooth data; 0.15 is what is left of higher orders at 32 elements
    np.testing.assert_allclose(orders, expected, atol=0.15)


@pytest.mark.parametrize("law", LAWS)
def test_complex_step_tangent_is_the_derivative(law, rng):
    z = np.array([field for field in chosen(np.linspace(1.0, 2.0, 7), law) if np.ndim(field)])
    r = np.linspace(1.0, 2.0, 7)
    slope = complex_step(lambda point: balance(law, SETTING, point, r), z)
    direction = rng.standard_normal(z.shape)
    step = 1e-6
    sides = [balance(law, SETTING, Point(*(z + s * direction)), r) for s in (step, -step)]
    # central difference: truncation 1e-12, rounding 1e-10, times the third derivative (gamma/rate^3, some hundred)
    np.testing.assert_allclose(np.einsum("abx,bx->ax", slope, direction), (sides[0] - sides[1]) / (2.0 * step), atol=1e-7)
