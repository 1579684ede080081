"""Rings: exact weights first, then fields that are known in closed form."""

import numpy as np
import pytest
import xarray as xr
from clusters import make

from anisogran import average
from anisogran.averaging import drift, mean_and_error, ring_densities, ring_profiles, ring_weights
from anisogran.averaging.weights import area_inside_circle

EDGES = np.arange(5.0, 13.0)


def test_lens_in_closed_form():
    # two unit circles, centres 1 apart: 2 pi/3 - sqrt(3)/2
    assert area_inside_circle(1.0, 1.0, 1.0) == pytest.approx(2 * np.pi / 3 - np.sqrt(3) / 2, abs=1e-14)
    assert area_inside_circle(5.0, 1.0, 4.0) == 0.0  # touches from outside
    assert area_inside_circle(3.0, 1.0, 4.0) == pytest.approx(np.pi)  # touches from inside
    assert area_inside_circle(0.0, 2.0, 0.5) == pytest.approx(np.pi * 0.25)  # the circle lies in the disc
    assert area_inside_circle(1.0, 1.0, 0.0) == 0.0


def test_area_against_counting(rng):
    """A disc cut by a circle, against a fine grid of points."""
    grid = (np.arange(1500) + 0.5) / 1500 * 2 - 1
    x, y = np.meshgrid(grid, grid)
    disc = x**2 + y**2 < 1
    for distance, circle in [(3.0, 3.4), (0.7, 1.2), (1.1, 0.4), (0.2, 1.1)]:
        counted = np.mean(disc & ((x + distance) ** 2 + y**2 < circle**2)) * 4
        assert area_inside_circle(distance, 1.0, circle) == pytest.approx(counted, abs=3e-4)  # points on the rim


def test_weights_of_a_disc_add_up_to_one(rng):
    position = rng.uniform(-20, 20, (300, 2))
    radius = rng.uniform(0.01, 3.0, 300)
    weights = ring_weights(position, radius, np.linspace(0, 40, 50))
    np.testing.assert_allclose(weights.sum(axis=0), 1.0, atol=1e-12)
    assert weights.min() > -1e-12


def crowd(rng, count=4000):
    """Many discs at random in the annulus, overlapping or not: only for averages that do not ask for contacts."""
    r = np.sqrt(rng.uniform(3.0**2, 15.0**2, count))
    phi = rng.uniform(-np.pi, np.pi, count)
    position = np.stack([r * np.cos(phi), r * np.sin(phi)], axis=1)
    return position


def test_rigid_rotation(rng):
    """v = Omega x r: v_phi proportional to r, no shear, and spin equal to the continuum's."""
    position = crowd(rng)
    omega = 0.3
    velocity = omega * np.stack([-position[:, 1], position[:, 0]], axis=1)
    snapshot = make(position, np.full(4000, 0.2), [], [], velocity=velocity, spin=np.full(4000, omega))
    densities = ring_densities(snapshot, EDGES)
    # the mean over a ring is that over its grains; their mean radius differs from the middle by sampling, 3 standard errors
    profile = average(snapshot, on="rings", edges=EDGES, fields=["v_phi", "spin"])
    np.testing.assert_allclose(profile.v_phi, omega * profile.r, rtol=0.01)
    np.testing.assert_allclose(profile.spin, omega, rtol=1e-12)
    np.testing.assert_allclose(densities["momentum"][0], 0, atol=1e-12)
    np.testing.assert_allclose(densities["stress"], 0, atol=1e-3 * omega**2)  # a rigid rotation is no agitation, but for curvature


def test_mass_is_counted_once(rng):
    position = crowd(rng)
    snapshot = make(position, np.full(4000, 0.2), [], [], mass=rng.uniform(1, 2, 4000))
    edges = np.linspace(0.0, 20.0, 41)
    densities = ring_densities(snapshot, edges)
    area = np.pi * np.diff(edges**2)
    assert np.sum(densities["mass"] * area) == pytest.approx(snapshot.mass.sum(), rel=1e-12)
    assert np.sum(densities["area_fraction"] * area) == pytest.approx(4000 * np.pi * 0.04, rel=1e-12)


def test_polar_components_of_one_contact():
    """Two discs that touch along the radius at azimuth 90 degrees press radially only; along the circle, in hoop direction only."""
    radial = make([[0, 8.0], [0, 9.0]], [0.5, 0.5], [(0, 1)], [(0, -2.0)])
    stress = ring_densities(radial, EDGES)["stress"]
    total = np.einsum("ijk,k->ij", stress, np.pi * np.diff(EDGES**2))
    np.testing.assert_allclose(total, np.diag([2.0 * 1.0, 0]), atol=1e-12)
    angle = 1.0 / 8.0
    hoop = make([[8.0, 0], [8 * np.cos(angle), 8 * np.sin(angle)]], [0.5, 0.5], [(0, 1)], [(np.sin(angle / 2), -np.cos(angle / 2))])
    total = np.einsum("ijk,k->ij", ring_densities(hoop, EDGES)["stress"], np.pi * np.diff(EDGES**2))
    length = 2 * 8 * np.sin(angle / 2)
    # each end sees the contact under half the angle between the grains
    assert total[1, 1] == pytest.approx(length * np.cos(angle / 2) ** 2, rel=1e-12)


def test_gradient_of_a_couette_profile(rng):
    """v = a r + b/r: shear rate 2 b/r^2 and continuum spin a, at second order in the ring width."""
    a, b = 0.1, 2.0
    errors = []
    for count in (32, 64):
        edges = np.linspace(5.0, 13.0, count + 1)
        r = 0.5 * (edges[1:] + edges[:-1])
        nu = np.full(count, 0.8)
        densities = {
            "area_fraction": nu, "momentum": np.stack([0 * r, nu * (a * r + b / r)]), "rotation": nu * a, "mass": nu, "grains": nu,
            "stress": np.ones((2, 2, count)) * np.eye(2)[:, :, None], "fabric": np.ones((2, 2, count)),
        }  # fmt: skip
        profile = ring_profiles(densities, edges)
        errors.append(float(np.abs(profile.shear_rate - 2 * b / r**2).max()))
        np.testing.assert_allclose(profile.continuum_spin, a, atol=errors[-1])
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.3)  # the outermost rings move towards the steep end


def test_block_errors_know_the_spread(rng):
    blocks = xr.Dataset({"v": (("block", "r"), rng.normal(3.0, 2.0, (400, 5)))})
    mean = mean_and_error(blocks)
    np.testing.assert_allclose(mean.v_error, 2.0 / np.sqrt(400), rtol=0.2)  # 1/sqrt(2*400) = 4 % each, five of them
    assert mean.attrs["blocks"] == 400
    assert np.isnan(mean_and_error(blocks.isel(block=[0])).v_error).all()


def test_drift_is_measured_in_standard_errors(rng):
    steady = rng.normal(0, 1, 100)
    assert abs(drift(steady)) < 3.5
    assert drift(steady + np.linspace(0, 5, 100)) > 5
    assert drift(np.ones(10)) == 0.0
