"""Shares of discs and spheres: closed forms against quadrature, and nothing lost between cells."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from anisogran.averaging.overlap_areas import disc_in_circle, disc_in_corner, grid_shares, ring_shares, sphere_in_cylinder


def half_disc_quadrature(x, y):
    """Area of the unit disc left of x and below y, by quadrature over its vertical chords."""
    if x <= -1 or y <= -1:
        return 0.0

    def chord(u):
        half = np.sqrt(1 - u * u)
        return max(0.0, min(y, half) + half)

    corners = [c for c in (np.sqrt(max(1 - y * y, 0.0)), -np.sqrt(max(1 - y * y, 0.0))) if -1 < c < min(x, 1)]
    return quad(chord, -1, min(x, 1), points=corners or None, epsabs=1e-12, epsrel=1e-12, limit=200)[0]


@pytest.mark.parametrize("x", [-1.0, -0.7, -0.1, 0.0, 0.4, 0.95, 1.0, 3.0])
@pytest.mark.parametrize("y", [-2.0, -0.9, -0.3, 0.0, 0.2, 0.8, 1.0])
def test_disc_in_a_corner_against_quadrature(x, y):
    # the integrand has a square root at the rim, where the quadrature is good to some 1e-9
    assert disc_in_corner(x, y) == pytest.approx(half_disc_quadrature(x, y), abs=1e-8)


def test_a_corner_in_the_middle_takes_a_quarter():
    assert disc_in_corner(0.0, 0.0) == pytest.approx(np.pi / 4, abs=1e-15)
    assert disc_in_corner(1.0, 1.0) == pytest.approx(np.pi, abs=1e-15)
    assert disc_in_corner(0.5, 9.0) + disc_in_corner(-0.5, 9.0) == pytest.approx(np.pi, abs=1e-15)


@given(st.floats(-3, 3), st.floats(-3, 3))
def test_a_corner_is_symmetric_and_bounded(x, y):
    area = disc_in_corner(x, y)
    assert -1e-15 <= area <= np.pi + 1e-15
    assert area == pytest.approx(disc_in_corner(y, x), abs=1e-14)


def test_sphere_in_a_cylinder_against_quadrature(rng):
    worst = 0.0
    for _ in range(150):
        distance, a, cylinder = rng.uniform(0, 3), rng.uniform(0.2, 2), rng.uniform(0, 3)
        low, high = np.sort(rng.uniform(-a, a, 2))
        heights = [s * np.sqrt(a * a - h * h) for h in (cylinder - distance, cylinder + distance) if abs(h) < a for s in (-1, 1)]
        breaks = sorted(z for z in heights if low < z < high)

        def slice_area(z, distance=distance, a=a, cylinder=cylinder):
            return disc_in_circle(distance, np.sqrt(a * a - z * z), cylinder)

        exact = quad(slice_area, low, high, points=breaks or None, epsabs=1e-13, epsrel=1e-12, limit=200)[0]
        worst = max(worst, abs(sphere_in_cylinder(distance, a, cylinder, low, high) - exact) / (4 / 3 * np.pi * a**3))
    assert worst < 1e-8  # measured 6e-10: twelve Gauss points on each smooth piece


def test_sphere_on_the_axis_in_closed_form():
    """A cylinder of radius c through the middle of a unit sphere: 4/3 pi (1 - (1 - c^2)^(3/2))."""
    for c in (0.2, 0.7, 0.999):
        assert sphere_in_cylinder(0.0, 1.0, c, -1.0, 1.0) == pytest.approx(4 / 3 * np.pi * (1 - (1 - c * c) ** 1.5), rel=1e-9)
    assert sphere_in_cylinder(0.0, 1.0, 2.0, 0.0, 5.0) == pytest.approx(2 / 3 * np.pi, rel=1e-14)


def test_nothing_is_lost_between_cells(rng):
    """The shares of a body add up to 1, whatever the edges, in the plane and in space."""
    n = 400
    position, radius = rng.uniform(-5, 5, (n, 3)), rng.uniform(0.01, 1.5, n)
    flat = np.ascontiguousarray(position[:, :2])
    edges, levels = np.sort(np.append(rng.uniform(0, 9, 25), [0, 9])), np.sort(np.append(rng.uniform(-7, 7, 20), [-7, 7]))
    free = np.ones(n, bool)
    for indptr, _, shares in (
        ring_shares(flat, radius, free, edges, None),
        ring_shares(position, radius, free, edges, levels),
        grid_shares(flat, radius, levels, levels),
    ):
        np.testing.assert_allclose(np.add.reduceat(shares, indptr[:-1]), 1.0, atol=1e-12)
        assert shares.min() > -1e-12


def test_grid_shares_against_counting(rng):
    """One disc over cells of a grid, against a fine grid of points."""
    fine = (np.arange(1200) + 0.5) / 1200 * 2 - 1
    x, y = np.meshgrid(fine, fine, indexing="ij")
    disc = x**2 + y**2 < 1
    centre = np.array([[0.3, -0.2]])
    edges = np.array([-1.2, -0.5, 0.1, 0.35, 2.0])
    indptr, indices, shares = grid_shares(centre, np.array([1.0]), edges, edges)
    for cell, share in zip(indices, shares, strict=True):
        i, j = divmod(cell, 4)
        inside = (x + 0.3 >= edges[i]) & (x + 0.3 < edges[i + 1]) & (y - 0.2 >= edges[j]) & (y - 0.2 < edges[j + 1])
        assert share == pytest.approx(np.mean(disc & inside) * 4 / np.pi, abs=4e-4)  # points on the rim
    assert indptr[-1] == len(shares) == 16


def test_bodies_outside_have_no_share():
    far = np.array([[50.0, 50.0]])
    assert ring_shares(far, np.ones(1), np.ones(1, bool), np.array([0.0, 1.0, 2.0]), None)[0][-1] == 0
    assert grid_shares(far, np.ones(1), np.array([0.0, 1.0]), np.array([0.0, 1.0]))[0][-1] == 0
    assert ring_shares(far * 0, np.ones(1), np.zeros(1, bool), np.array([0.0, 1.0, 2.0]), None)[0][-1] == 0  # not free
