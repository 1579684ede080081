"""Stress circles with their lines, and the polar curve of the stiffness."""

import numpy as np
import pytest

from anisogran import plots
from anisogran.models import directional_stiffness, failure_lines, network_moduli, peak_stress
from anisogran.outcome import InputError


def test_stress_circles_are_drawn_with_the_lines_that_touch_them(tmp_path):
    p = np.array([100.0, 300.0])
    peak, residual = peak_stress(p, 0.5, 40.0), peak_stress(p, 0.35, 5.0)
    lines = failure_lines(p, peak, residual)
    fig = plots.mohr_circles_figure({"peak": (p, peak), "residual": (p, residual)}, {"peak": lines.peak, "residual": lines.residual})
    (axes,) = fig.axes
    assert axes.get_aspect() == 1.0
    texts = [text.get_text() for text in axes.get_legend().texts]
    assert texts == [r"peak: $\phi$ = 28.6°, $c$ = 40 N/m", r"residual: $\phi$ = 20.1°, $c$ = 5 N/m"]
    first, second, line, points = axes.lines[:4]
    assert (first.get_xdata().min(), first.get_xdata().max()) == pytest.approx((100.0, peak[0]))
    assert second.get_ydata().max() == pytest.approx(0.5 * (peak[1] - 300.0))
    np.testing.assert_allclose(line.get_ydata(), 40.0 + line.get_xdata() * np.tan(0.5), atol=1e-9)  # N/m, of some hundred
    assert line.get_ydata()[0] == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(points.get_ydata(), 40.0 + points.get_xdata() * np.tan(0.5), rtol=1e-9)
    assert len({first.get_color(), second.get_color(), line.get_color(), points.get_color()}) == 1
    fig.savefig(tmp_path / "circles.png")
    without = plots.mohr_circles_figure({"peak": (p, peak)})
    np.testing.assert_allclose(without.axes[0].lines[2].get_ydata(), line.get_ydata(), atol=1e-9)  # its own tangent is the same
    only = plots.mohr_circles_figure({"one": (100, 300)}, {})
    assert only.axes[0].get_legend() is None
    with pytest.raises(InputError, match="tests is empty"):
        plots.mohr_circles_figure({})


def test_a_line_that_falls_or_reaches_far_begins_at_the_border():
    for line in (
        plots.mohr_circles_figure({"falling": ([100, 300], [200, 380])}),
        plots.mohr_circles_figure({"flat": ([100, 300], [200, 401])}),
    ):
        ends = line.axes[0].lines[2].get_xdata()
        assert ends[0] == pytest.approx(-0.35 * ends[1])


def test_the_stiffness_is_drawn_along_every_direction(tmp_path):
    states = {}
    for name, a2, phi_C in (("isotropic", 0.0, 0.0), ("sheared", 0.8, -np.pi / 4)):
        moduli = network_moduli(a2, 0.0, 2.0, 0.4)
        states[name] = {"E": moduli.E, "A": moduli.A, "B": moduli.B, "phi_C": phi_C, "G": moduli.G}
    fig = plots.stiffness_figure(states)
    (axes,) = fig.axes
    assert axes.name == "polar"
    round_, sheared, stiff, soft = (line.get_ydata() for line in axes.lines)
    np.testing.assert_allclose(round_, round_[0], rtol=1e-12)
    assert sheared.max() == pytest.approx(1.0)  # over the largest
    angle = axes.lines[1].get_xdata()
    assert np.cos(2 * (angle[sheared.argmax()] + np.pi / 4)) == pytest.approx(1.0)
    assert (stiff[0], soft[0]) == pytest.approx((sheared.max(), sheared.min()))
    expected = directional_stiffness(np.array([-np.pi / 4, np.pi / 4]), **states["sheared"])
    assert soft[0] / stiff[0] == pytest.approx(expected[1] / expected[0])
    assert [text.get_text() for text in axes.texts] == ["$C_2$", "$C_1$"]
    assert axes.texts[0].xy == pytest.approx((-np.pi / 4, 1.0))
    fig.savefig(tmp_path / "stiffness.png")
    turned = plots.stiffness_figure({"turned": {**states["sheared"], "A": -states["sheared"]["A"]}})
    assert turned.axes[0].texts[0].xy[0] == pytest.approx(np.pi / 4)  # A < 0: the stiff axis lies across
    assert not plots.stiffness_figure({"isotropic": states["isotropic"]}).axes[0].texts
