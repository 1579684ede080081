"""Every grain, contact and chain is drawn, and at its place."""

import numpy as np
import pytest
from matplotlib.collections import EllipseCollection, LineCollection

from anisogran import plots
from anisogran.averaging import grain_chains
from anisogran.dem import Grains, Linear, Periodic, Simulation
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


def test_figures_are_made_without_a_display(tmp_path):
    fig, axes = plots.figure(2, 3)
    assert axes.shape == (3, 2)
    fig.savefig(tmp_path / "empty.png")
    assert (tmp_path / "empty.png").stat().st_size > 1000


def test_a_contact_across_the_seam_of_a_sector_is_short():
    """Two discs near the seam of a quarter of a ring, pressed together across it: drawn to the image, as links of chains are."""
    azimuth, radius = np.array([0.1, np.pi / 2 - 0.1, np.pi / 4]), 5.0
    position = radius * np.stack([np.cos(azimuth), np.sin(azimuth)], axis=1)
    rest = {"radius": np.full(3, 0.5), "mass": np.ones(3), "velocity": np.zeros((3, 2)), "spin": np.zeros(3), "overlap": np.zeros(1)}
    point = [[radius * np.cos(0.1), 0.0]]
    snapshot = Snapshot(position, pairs=[(0, 1)], force=[[0.0, 1.0]], point=point, sector=np.pi / 2, **rest)
    image = radius * np.array([np.cos(0.1), -np.sin(0.1)])
    (axes,) = plots.chain_figure(snapshot, grain_chains(snapshot, least_grains=2)).axes
    forces, links = (c for c in axes.collections if isinstance(c, LineCollection))
    for lines in (forces, links):
        np.testing.assert_allclose(lines.get_segments(), [[position[0], image]], atol=1e-12)  # rounding


def test_forces_of_walls_are_drawn_to_the_contact_point():
    """A free grain, the first of its pair or not, on a wall and between wall grains; what wall grains exert on each other is not drawn."""
    position = np.array([[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [-2.0, 0.0]])
    rest = {"radius": np.full(4, 0.5), "mass": np.ones(4), "velocity": np.zeros((4, 2)), "spin": np.zeros(4), "overlap": np.zeros(4)}
    pairs, point = [(0, 1), (2, 0), (2, 3), (0, -1)], [[0.5, 0.0], [-0.5, 0.0], [-1.5, 0.0], [0.0, -0.5]]
    force = [[-1.0, 0.0], [-1.0, 0.0], [-1.0, 0.0], [0.0, 1.0]]
    snapshot = Snapshot(position, pairs=pairs, force=force, point=point, fixed=[False, True, True, True], **rest)
    _, axes = plots.figure(1)
    plots.draw_packing(axes[0, 0], snapshot)
    (forces,) = (c for c in axes[0, 0].collections if isinstance(c, LineCollection))
    np.testing.assert_array_equal(forces.get_segments(), [[[0, 0], [0.5, 0]], [[0, 0], [-0.5, 0]], [[0, 0], [0, -0.5]]])
