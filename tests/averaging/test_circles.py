"""The stress on circles: force networks whose stress is known, and the balance of forces and torques that it has to keep."""

import numpy as np
import pytest
from clusters import make

from anisogran.averaging import circle_sums

RADII = np.array([1.2, 1.5, 2.0, 2.5, 2.9])


def test_spokes_press_with_what_they_bear():
    """Twelve contacts along the radius, from r = 1 to 3, each with the force 2 along it and 0.3 across, the outside held back."""
    angle = 2 * np.pi * np.arange(12) / 12
    out = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    along = np.stack([-out[:, 1], out[:, 0]], axis=1)
    pairs = np.arange(24).reshape(2, 12).T
    snapshot = make(np.concatenate([out, 3 * out]), np.ones(24), pairs, -2.0 * out - 0.3 * along)
    sums = circle_sums(snapshot, np.append(RADII, 3.5))
    np.testing.assert_allclose(sums["cut_pressure"], np.append(12 * 2.0 / (2 * np.pi * RADII), 0), rtol=1e-12)
    # the contact points are at r = 2
    np.testing.assert_allclose(sums["cut_shear_stress"], np.append(12 * 0.3 * 2.0 / (2 * np.pi * RADII**2), 0), rtol=1e-12)


def test_it_does_not_matter_which_grain_comes_first(rng):
    position = rng.uniform(-3, 3, (40, 2))
    pairs, force, point = rng.permuted(np.arange(40)).reshape(20, 2), rng.normal(size=(20, 2)), rng.uniform(-3, 3, (20, 2))
    one = circle_sums(make(position, np.ones(40), pairs, force, point=point), RADII)
    other = circle_sums(make(position, np.ones(40), pairs[:, ::-1], -force, point=point), RADII)
    for name, values in one.items():
        np.testing.assert_allclose(other[name], values, rtol=1e-12, atol=1e-13)


def test_a_chord_crosses_twice():
    """A contact from (-1, 1) to (1, 1) with the force 1 along it: on the circle r = 1.2 both crossings press, and no torque is left."""
    snapshot = make([[-1.0, 1.0], [1.0, 1.0]], [1.0, 1.0], [(0, 1)], [(-1.0, 0.0)])
    half = np.sqrt(1.2**2 - 1)  # of the chord within the circle
    sums = circle_sums(snapshot, np.array([0.9, 1.2, 1.5]))
    np.testing.assert_allclose(sums["cut_pressure"] * 2 * np.pi, [0, 2 * half / 1.2 / 1.2, 0], atol=1e-12)
    np.testing.assert_allclose(sums["cut_shear_stress"], 0, atol=1e-12)


def test_between_circles_the_hoop_stress_bears_the_difference(rng):
    """r2 sigma_rr(r2) - r1 sigma_rr(r1) = int sigma_phiphi dr for lines of force that neither begin nor end between the circles."""
    r1, r2, n = 1.5, 3.0, 200
    ends = rng.uniform(-5, 5, (50 * n, 2, 2))
    r = np.hypot(ends[..., 0], ends[..., 1])
    start, end = np.moveaxis(ends[((r < 1.4) | (r > 3.1)).all(axis=1) & (r > 0.1).all(axis=1)][:n], 1, 0)
    branch = end - start
    force = branch * rng.uniform(-1, 1, (n, 1))
    snapshot = make(np.concatenate([start, end]), np.ones(2 * n), np.arange(2 * n).reshape(2, n).T, force, point=start)
    pressure = circle_sums(snapshot, np.array([r1, r2]))["cut_pressure"]
    share = (np.arange(20_000) + 0.5) / 20_000
    x = start[:, :, None] + branch[:, :, None] * share
    r = np.hypot(x[:, 0], x[:, 1])
    hoop = (
        -(force[:, 1, None] * x[:, 0] - force[:, 0, None] * x[:, 1]) * (branch[:, 1, None] * x[:, 0] - branch[:, 0, None] * x[:, 1]) / r**2
    )
    between = (r > r1) & (r < r2)
    integral = np.sum(hoop[between] / r[between]) / 20_000 / (2 * np.pi)
    assert abs(integral) > 1
    assert r2 * pressure[1] - r1 * pressure[0] == pytest.approx(integral, abs=2e-3)  # steps of 1/20,000 that end at the circles


def test_the_contact_with_a_smooth_wall_ends_at_its_point():
    snapshot = make([[2.0, 0.0]], [0.5], [(0, -1)], [(-3.0, 0.4)], point=[[2.5, 0.0]])
    sums = circle_sums(snapshot, np.array([1.9, 2.2, 2.6]))
    np.testing.assert_allclose(sums["cut_pressure"], [0, 3.0 / (2 * np.pi * 2.2), 0], atol=1e-15)
    np.testing.assert_allclose(sums["cut_shear_stress"], [0, -0.4 * 2.5 / (2 * np.pi * 2.2**2), 0], atol=1e-15)
