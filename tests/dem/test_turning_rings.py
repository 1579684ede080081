"""The ring shear cell in exact cases: rough and smooth rings, turning and breathing."""

import math

import numpy as np
import pytest

from anisogran.dem import Friction, Grains, Luding, Pressure, Ring, Simulation
from anisogran.dem.boundaries import advance, touch
from anisogran.dem.rows import grain_rows
from anisogran.dem.stepping import body_of
from anisogran.dem.walls import WallList, wall_contact
from anisogran.outcome import InputError

SEAM = [0.3, math.pi - 1e-15, -math.pi + 1e-15, 0.0, -1e-15, 0.5 * math.pi]  # angles, on both sides of the seams too


def body(position, **values):
    """The arrays of the kernel for a few grains of radius 0.5 and mass 1."""
    grains = Grains(position, np.full(len(position), 0.5), mass=np.ones(len(position)), **values)
    return body_of(grain_rows(grains, np.arange(len(position))))


@pytest.mark.hard_case("D21")
@pytest.mark.parametrize("wall", [0, 1])
@pytest.mark.parametrize("angle", SEAM)
def test_what_turns_with_a_ring_does_not_slip(wall, angle):
    """A grain that turns with a smooth ring as one rigid body feels its overlap alone, the same at every angle, across 2 pi too.

    A difference of 1e-3 in its spin is felt by the friction dashpot, with the lever arm of the contact.
    """
    omega, overlap, k, g_t = 3.0, 0.02, 1e3, 2.0
    state = Ring(4.0, inner_radius=2.0, outer_omega=omega if wall == 0 else 7.0, omega=omega if wall == 1 else 7.0).state()
    distance = (3.5 + overlap, 2.5 - overlap)[wall]
    n = np.array([math.cos(angle), math.sin(angle)])
    place = distance * n
    grain = body([place], velocity=[omega * np.array([-place[1], place[0]])])
    law, friction = Luding(k, k).parameters(), Friction(1e3, 10.0, damping=g_t).parameters()
    candidates = WallList(np.array([0]), np.array([wall]), np.array([1]))

    def contact(spin):
        memory = np.zeros((2, 1)), np.zeros((2, 1))
        return wall_contact.py_func(state, grain, np.array([spin]), 0, candidates, law, friction, *memory, 0.0)

    _, _, found, nx, ny, fn, ft = contact(omega)
    sense = (1.0, -1.0)[wall]
    np.testing.assert_allclose([nx, ny], sense * n, atol=1e-12)
    assert found == pytest.approx(overlap, abs=1e-14)
    assert fn == pytest.approx(k * overlap, rel=1e-12)
    assert abs(ft) < 1e-14 * k  # rounding of velocities of order 10
    assert contact(omega + 1e-3)[6] == pytest.approx(g_t * 1e-3 * (0.5 - overlap / 2), rel=1e-9)


def test_a_ring_moves_its_surface():
    """A breathing and turning outer ring: radial speed outwards, angular velocity times distance of the contact along it."""
    state = Ring(4.0, rim=Pressure(1.0, mass=1.0, damping=0.0), outer_omega=2.0).state()
    state.velocity[0] = 0.25
    overlap, nx, ny, vx, vy = touch(state, 0, 0.0, 3.6, 0.5)
    assert (overlap, nx, ny) == (pytest.approx(0.1), 0.0, 1.0)
    assert (vx, vy) == (pytest.approx(-2.0 * 4.05), pytest.approx(0.25))  # middle of the overlap


def test_a_grain_between_two_turning_rings_is_a_planet():
    """Epicyclic gear: without slip v + a w = Omega_o R_o and v - a w = Omega_i R_i at the contacts, from rest, by friction alone."""
    k, inner, outer = 1e3, 2.0, 2.99
    friction = Friction(1e3, 0.5, damping=20.0)
    # a piston too heavy to move keeps its radius
    ring = Ring(outer, rim=Pressure(1.0, mass=1e12, damping=0.0), inner_radius=inner, omega=-0.01, outer_omega=0.03)
    middle = 0.5 * (inner + outer)
    sim = Simulation(
        Grains([[middle, 0.0]], [0.5], mass=[1.0]), Luding(k, k, damping=20.0), friction=friction, boundary=ring, wall_friction=friction
    )
    sim.run(20_000)
    surface = np.array([-0.01 * inner, 0.03 * outer])  # contact points: half the overlap of 0.005 lies behind the surface
    surface *= [1 - 0.0025 / inner, 1 + 0.0025 / outer]
    arm = 0.5 - 0.0025
    (x, y), (u, v) = sim.position[0], sim.velocity[0]
    along = (x * v - y * u) / math.hypot(x, y)
    # the centrifugal force of 4e-4 shifts the grain by 1e-7
    assert along == pytest.approx(surface.mean(), rel=1e-4)
    assert sim.spin[0] == pytest.approx(0.5 * (surface[1] - surface[0]) / arm, rel=1e-4)
    np.testing.assert_allclose(sim.walls.force, k * 0.005, rtol=1e-3)
    turned = math.atan2(y, x)
    assert turned == pytest.approx(surface.mean() / middle * sim.time, rel=0.02)  # less the spin-up


def test_outer_grains_turn_and_breathe_with_their_ring():
    """Position, velocity and spin of the driven grains are those of their ring; without a spin that takes part none is set."""
    dt, omega, outer_omega = 0.01, 0.5, -0.2
    boundary = Ring(2.0, rim=Pressure(1.0, mass=4.0, damping=3.0), inner=1, omega=omega, outer_omega=outer_omega)
    for spin in (np.full(3, 9.0), None):
        state, grains = boundary.state(), body([[0.5, 0.0], [1.0, 0.0], [1.2, 1.6]])
        for step in range(100):
            advance(state, grains, spin, 1, 1.0, step * dt, dt)
        radius, speed = state.position[0], state.velocity[0]
        assert radius < 1.95
        assert speed < -0.05
        place = np.stack([grains.x, grains.y], axis=1)
        for i, distance, start, turning, radial in ((1, 1.0, 0.0, omega, 0.0), (2, radius, math.atan2(4, 3), outer_omega, speed)):
            n = np.array([math.cos(start + turning), math.sin(start + turning)])  # after one second
            np.testing.assert_allclose(place[i], distance * n, atol=1e-13)
            velocity = radial * n + turning * distance * np.array([-n[1], n[0]])
            np.testing.assert_allclose([grains.vx[i], grains.vy[i]], velocity, atol=1e-13)
        assert spin is None or spin.tolist() == [9.0, omega, outer_omega]
        assert (grains.x[0], grains.y[0]) == (0.5, 0.0)


def test_the_piston_bears_what_its_grains_bear():
    """Force on the wall and radial force on the driven grains of the outer ring, by the length of the ring."""
    ring = Ring(2.0, rim=Pressure(3.0, mass=1.0, damping=0.0), inner=1)
    state, grains = ring.state(), body([[0.5, 0.0], [1.0, 0.0], [1.2, 1.6], [0.0, -2.0]])
    state.force[0] = 5.0
    grains.fx[:], grains.fy[:] = [9.0, 9.0, 3.0, 1.0], [9.0, 9.0, 4.0, -20.0]
    assert ring.held(state, grains, 1) == [("outer ring", pytest.approx((5.0 + 5.0 + 20.0) / (4 * math.pi)), 3.0)]
    assert Ring(2.0).held(Ring(2.0).state(), grains, 4) == []


def test_the_rings_enclose_an_annulus():
    ring = Ring(3.0, inner_radius=1.0)
    assert ring.extent(ring.state()) == {"volume": pytest.approx(8 * math.pi)}
    plain = Ring(3.0)
    assert plain.extent(plain.state()) == {"volume": pytest.approx(9 * math.pi)}
    assert (plain.walls, ring.walls) == (1, 2)
    assert plain.state().position.tolist() == [3.0]  # no inner wall, no memory and no loop for it


def test_a_ring_without_a_gap_is_refused():
    with pytest.raises(InputError, match="Ring: inner_radius = 3 must be below 3 m"):
        Ring(3.0, inner_radius=3.0)
    with pytest.raises(InputError, match="Ring: inner_radius = 0 must be above 0 m"):
        Ring(3.0, inner_radius=0.0)
    with pytest.raises(InputError, match="Ring: outer_omega = nan"):
        Ring(3.0, outer_omega=float("nan"))
    with pytest.raises(InputError, match=r"grain 0 at .* has its centre beyond a wall at the start"):
        Simulation(Grains([[0.9, 0.0]], [0.2]), Luding(1e3, 1e3), boundary=Ring(3.0, inner_radius=1.0))
