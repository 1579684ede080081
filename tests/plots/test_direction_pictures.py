"""The polar histogram holds the density of the contacts and the curves their coefficients."""

import numpy as np
import pytest

from anisogran import plots
from anisogran.averaging import contact_directions
from anisogran.snapshot import Snapshot


def test_directions_are_a_polar_histogram_with_their_harmonics(tmp_path):
    """Four contacts with walls in three directions: the bars are the density, and the curves the coefficients and the law of force."""
    theta = np.array([0.05, 0.05, 0.05 + np.pi / 3, 0.05 + np.pi / 2])
    normal = np.stack([np.cos(theta), np.sin(theta)], axis=1)
    position = np.zeros((4, 2)) + np.arange(4)[:, None] * [2.0, 0.0]
    rest = {"radius": np.full(4, 0.5), "mass": np.ones(4), "velocity": np.zeros((4, 2)), "spin": np.zeros(4), "overlap": np.zeros(4)}
    force = -normal * (1 + 0.5 * np.cos(2 * theta))[:, None]
    pairs = [(k, -1) for k in range(4)]
    directions = contact_directions(Snapshot(position, pairs=pairs, force=force, point=position + 0.5 * normal, **rest))
    fig = plots.direction_figure(directions, "four contacts")
    polar, forces = fig.axes
    assert polar.name == "polar"
    np.testing.assert_allclose([bar.get_height() for bar in polar.patches], directions.contact_density)
    np.testing.assert_allclose([bar.get_x() + bar.get_width() / 2 for bar in polar.patches], directions.angle)
    angle, curve = polar.lines[0].get_xdata()[:-1], polar.lines[0].get_ydata()[:-1]
    assert curve.mean() == pytest.approx(1 / (2 * np.pi))
    for n, name in ((2, "a2"), (4, "a4")):  # evenly spaced points recover the coefficients exactly
        along = 2 * np.mean(2 * np.pi * curve * np.cos(n * (angle - float(directions.axis))))
        assert along == pytest.approx(float(directions[name]))
    points, wave = forces.lines[:2]
    assert np.isfinite(points.get_ydata()).sum() == 3
    mean = (2 * (1 + 0.5 * np.cos(0.1)) + sum(1 + 0.5 * np.cos(2 * theta[2:]))) / 4
    np.testing.assert_allclose(wave.get_ydata(), (1 + 0.5 * np.cos(2 * np.radians(wave.get_xdata()))) / mean, rtol=1e-9)
    fig.savefig(tmp_path / "four.png")
    nothing = contact_directions(Snapshot(position, pairs=[], force=[], point=[], **{**rest, "overlap": []}))
    fig = plots.direction_figure(nothing)
    assert fig.axes[0].get_title() == "no contacts"
    fig.savefig(tmp_path / "nothing.png")
