"""Panels show all that they are given, each series in one colour and once in the legend; grains have the colour of their value."""

import numpy as np
import pytest
from matplotlib.collections import EllipseCollection

from anisogran import plots
from anisogran.dem import Grains, Linear, Periodic, Simulation
from anisogran.outcome import InputError


def test_a_series_has_one_colour_and_one_entry():
    x = np.linspace(0.0, 1.0, 5)
    panel = plots.Panel("x", "y", {"a": (x, x), "b": (x, 2 * x)}, {"b": ([0.5], [1.1], [0.1])}, {"a": (x, x + 0.1)}, title="told")
    fig = plots.panels_figure([panel, plots.Panel("x", "z", {}, {"c": ([1.0, 2.0], [3.0, np.nan], None)}, log="xy")])
    first, second = fig.axes
    a, b, points, dashed = first.get_lines()[0], first.get_lines()[1], first.containers[0][0], first.get_lines()[-1]
    assert a.get_color() == dashed.get_color() != b.get_color() == points.get_color()
    assert dashed.get_linestyle() == "--"
    assert [text.get_text() for text in first.get_legend().get_texts()] == ["a", "b"]
    assert first.get_ylim()[0] == 0.0
    assert (first.get_title(), first.get_ylabel()) == ("told", "y")
    assert (second.get_xscale(), second.get_yscale()) == ("log", "log")


def test_panels_stand_in_rows():
    one = plots.Panel("x", "y", {"a": ([0.0, 1.0], [-1.0, 1.0])})
    fig = plots.panels_figure([one] * 3, columns=2)
    assert len(fig.axes) == 4
    assert not fig.axes[3].axison
    assert fig.axes[0].get_ylim()[0] < -1.0  # what is negative is not cut off
    with pytest.raises(InputError, match="there is no panel"):
        plots.panels_figure([])


def grains(spin):
    """Three grains, of which the third is fast."""
    position, velocity = [[1.0, 2.0], [2.0, 2.0], [3.0, 3.5]], [[0.01, 0.0], [0.0, 0.1], [1.0, 0.0]]
    record = Grains(position, [0.5] * 3, mass=[2.0] * 3, velocity=velocity, spin=spin)
    return Simulation(record, Linear(1e3), boundary=Periodic(5.0, 5.0)).snapshot()


def test_grains_have_the_colour_of_their_energy_and_spin():
    fig = plots.biaxial_pictures([grains([0.0] * 3), grains([1.0, -2.0, 0.5])], ["before", "after"])
    shown = {axes: [c for c in axes.collections if isinstance(c, EllipseCollection)] for axes in fig.axes}
    energy, spin = (next(iter(shown[fig.axes[k]])).get_array() for k in (3, 5))
    np.testing.assert_allclose(energy, [1e-4, 1e-2, 1.0])  # m v^2/2; the first is at the end of four decades
    np.testing.assert_allclose(spin, [1.0, -1.97, 0.5], atol=0.05)  # the largest is cut to what 99 % of them reach
    assert len(plots.biaxial_pictures([grains([0.0] * 3)], ["no grain turns"]).axes) == 3  # chains, energy and its colours
