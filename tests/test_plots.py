"""The pictures hold what the data hold."""

import numpy as np
import pytest
from matplotlib.collections import EllipseCollection, LineCollection

from anisogran import plots
from anisogran.averaging import contact_directions, grain_chains
from anisogran.dem import Grains, Linear, Luding, Periodic, Simulation, contact_path
from anisogran.snapshot import Snapshot


def column():
    """Four unit discs pressed along y around a periodic cell, and a loose one beside them."""
    position = np.array([[0.5, 0.5], [0.5, 1.5], [0.5, 2.5], [0.5, 3.5], [2.5, 2.0]])
    rest = {"radius": np.full(5, 0.5), "mass": np.ones(5), "velocity": np.zeros((5, 2)), "spin": np.zeros(5), "overlap": np.zeros(4)}
    pairs, up = [(0, 1), (1, 2), (2, 3), (3, 0)], np.array([[0.0, 1.0]] * 4)
    return Snapshot(position, pairs=pairs, force=-up, point=position[:4] + 0.5 * up, cell=4.0 * np.eye(2), **rest)


def test_packing_shows_every_grain_and_every_strong_contact():
    grains = Grains([[0.8, 2.0], [1.75, 2.0], [3.9, 2.0]], [0.5, 0.5, 0.5], mass=[1.0] * 3)
    snapshot = Simulation(grains, Linear(1e3), boundary=Periodic(4.0, 4.0)).snapshot()
    _, axes = plots.figure(1)
    plots.draw_packing(axes[0, 0], snapshot, "two contacts, one across the border")
    discs = [c for c in axes[0, 0].collections if isinstance(c, EllipseCollection)]
    (chains,) = (c for c in axes[0, 0].collections if isinstance(c, LineCollection))
    assert sum(len(c.get_offsets()) for c in discs) == 3
    segments = np.array(chains.get_segments())
    assert len(segments) == 2
    lengths = np.hypot(*(segments[:, 1] - segments[:, 0]).T)
    np.testing.assert_allclose(np.sort(lengths), [0.9, 0.95])  # to the nearest image, not across the cell
    # wider where the force is stronger: overlaps 0.05 and 0.1
    width = chains.get_linewidths()
    assert max(width) / min(width) == pytest.approx(2.0)


def test_chains_lie_on_the_packing_with_a_colour_each():
    snapshot = column()
    fig = plots.chain_figure(snapshot, grain_chains(snapshot), "one chain, closed across the border")
    (axes,) = fig.axes
    everyone, members = (c for c in axes.collections if isinstance(c, EllipseCollection))
    forces, links = (c for c in axes.collections if isinstance(c, LineCollection))
    assert len(everyone.get_offsets()) == 5
    np.testing.assert_array_equal(members.get_offsets(), snapshot.position[:4])
    segments = np.array(links.get_segments())
    np.testing.assert_allclose(np.hypot(*(segments[:, 1] - segments[:, 0]).T), 1.0)  # none across the cell
    assert len(segments) == len(forces.get_segments()) == 4
    np.testing.assert_array_equal(links.get_colors()[0, :3], members.get_facecolors()[0, :3])


def test_packing_without_chains_or_contacts_is_drawn():
    loose = column()
    empty = Snapshot(loose.position, loose.radius, loose.mass, loose.velocity, loose.spin, [], [], [], [])
    (axes,) = plots.chain_figure(empty, grain_chains(empty)).axes
    (discs,) = axes.collections
    assert len(discs.get_offsets()) == 5


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


def test_contact_law_shows_branches_and_marks():
    """Each branch once in the legend, in its own colour and at its own place; the ticks are the marks of the lecture."""
    law = Luding(1.0, 2.0, 2.0)
    path = contact_path(law, np.concatenate([np.linspace(0.0, 0.5, 51), np.linspace(0.49, -0.1, 60)]))
    fig = plots.contact_law_figure(path, {"more": {"a": path, "b": path}})
    axes, more = fig.axes
    ticks = dict(zip(axes.get_xticks(), (text.get_text() for text in axes.get_xticklabels()), strict=True))
    assert ticks == {
        0.0: "0", 0.25: "$\\delta_\\mathrm{min}$\n0.25", 0.5: "$\\delta_0$\n0.5", 1.0: "$\\delta_\\mathrm{max}$\n1",
    }  # fmt: skip
    assert sorted(axes.get_yticks()) == pytest.approx([-0.25, 0.0, 0.5])  # f_min, 0, f_max by k2 delta_max
    colours = {
        text.get_text(): line.get_color() for text, line in zip(axes.get_legend().texts, axes.get_legend().legend_handles, strict=True)
    }
    assert list(colours) == ["loading", "elastic un- and reloading", "adhesive limit", "open"]
    loading, limit = (
        next(line for line in axes.lines if line.get_color() == colours[name] and line.get_linestyle() == "-")
        for name in ("loading", "adhesive limit")
    )
    np.testing.assert_allclose(loading.get_ydata(), 0.5 * loading.get_xdata(), atol=1e-12)
    np.testing.assert_allclose(limit.get_ydata()[1:], -limit.get_xdata()[1:], atol=1e-12)
    assert [text.get_text() for text in more.get_legend().texts] == ["a", "b"]


def test_marks_at_one_place_share_a_tick():
    """Without adhesion delta_min is delta_0."""
    assert plots.marks({"0": 0.0, "a": 0.5, "b": 0.5}) == ([0.0, 0.5], ["0", "a = b\n0.5"])


def test_figures_are_made_without_a_display(tmp_path):
    fig, axes = plots.figure(2, 3)
    assert axes.shape == (3, 2)
    fig.savefig(tmp_path / "empty.png")
    assert (tmp_path / "empty.png").stat().st_size > 1000
