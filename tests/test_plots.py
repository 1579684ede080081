"""The pictures hold what the data hold."""

import numpy as np
import pytest
from matplotlib.collections import EllipseCollection, LineCollection

from anisogran import plots
from anisogran.dem import Grains, Linear, Periodic, Simulation


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


def test_figures_are_made_without_a_display(tmp_path):
    fig, axes = plots.figure(2, 3)
    assert axes.shape == (3, 2)
    fig.savefig(tmp_path / "empty.png")
    assert (tmp_path / "empty.png").stat().st_size > 1000
