"""The path of a contact is drawn with its branches and marks."""

import numpy as np
import pytest

from anisogran import plots
from anisogran.dem import Luding, contact_path
from anisogran.plots.contact_law import marks


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
    assert marks({"0": 0.0, "a": 0.5, "b": 0.5}) == ([0.0, 0.5], ["0", "a = b\n0.5"])
