"""What a picture of fits looks like."""

import numpy as np

from anisogran.plots import FittedCurve, fit_figure

X = np.linspace(0.0, 1.0, 11)


def line(label="run", y_name="s_D", used=8, trustworthy=True, errors=None):
    fitted = np.where(np.arange(11) < used, 2.0 * X, np.nan)
    return FittedCurve(label, "eps_D", y_name, X, 2.0 * X + 0.1, errors, fitted, X[:used], 2.0 * X[:used], trustworthy)


def test_data_and_fit_stand_above_what_is_left(tmp_path):
    fig = fit_figure([line(errors=np.full(11, 0.05))])
    above, below = fig.axes
    points, left_out, curve = (drawn.get_xydata() for drawn in above.lines)
    np.testing.assert_array_equal(points, np.column_stack([X, 2.0 * X + 0.1])[:8])
    np.testing.assert_array_equal(left_out, np.column_stack([X, 2.0 * X + 0.1])[8:])
    np.testing.assert_array_equal(curve, np.column_stack([X, 2.0 * X])[:8])
    rest = next(drawn for drawn in below.lines if len(drawn.get_xdata()) == 8)
    np.testing.assert_allclose(rest.get_ydata(), 0.1, rtol=1e-12)  # rounding
    assert [text.get_text() for text in above.get_legend().get_texts()] == ["left out", "fit", "data"]
    assert (above.get_ylabel(), below.get_ylabel(), below.get_xlabel()) == ("$s_D$", "$s_D$ - fit", r"$\epsilon_D$")
    fig.savefig(tmp_path / "fit.png")


def test_what_lies_far_off_is_not_drawn():
    above, _ = fit_figure([line(used=3)]).axes
    left_out = above.lines[1].get_xdata()
    assert left_out.max() <= 0.4 + 1e-12  # used 0 to 0.2, as much again beside it; rounding


def test_several_data_sets_share_a_panel_and_two_stresses_have_two():
    fig = fit_figure([line("a"), line("b", trustworthy=False), line("a", y_name="column")])
    assert len(fig.axes) == 4
    words = [text.get_text() for text in fig.axes[0].get_legend().get_texts()]
    assert words == ["(not trustworthy)", "a", "b"]
    assert fig.axes[1].get_ylabel() == "column"  # no quantity of the glossary


def test_on_a_logarithmic_axis_the_rest_is_that_of_the_logarithms():
    curve = line()
    curve = curve._replace(y=np.where(X == 0.5, -1.0, 3.0 * np.maximum(curve.fitted, 0.1)), fitted=curve.fitted + 0.1)
    above, below = fit_figure([curve], "xy").axes
    assert (above.get_xscale(), above.get_yscale(), below.get_xscale()) == ("log", "log", "log")
    rest = max(below.lines, key=lambda drawn: len(drawn.get_xdata()))
    assert len(rest.get_xdata()) == 7  # not the negative one
    np.testing.assert_allclose(rest.get_ydata()[1], np.log(3.0 * 0.2 / 0.3), rtol=1e-12)  # rounding
    assert "ln" in below.get_ylabel()
