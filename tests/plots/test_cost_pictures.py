"""What a cost table looks like."""

import numpy as np

from anisogran.plots import cost_figure


def test_each_knob_with_an_error_has_a_panel_with_its_default_ringed(tmp_path):
    rows = [
        {"knob": "width: scatter", "value": 0.5, "error": 0.3, "seconds": 0.01, "default": False},
        {"knob": "width: scatter", "value": 1.0, "error": 0.15, "seconds": 0.03, "default": True},
        {"knob": "kernel: scatter", "value": "lucy", "error": 0.2, "seconds": 0.02, "default": False},
        {"knob": "price", "value": "stress", "error": None, "seconds": 0.02, "default": False},
    ]
    fig = cost_figure(rows)
    panels = [ax for ax in fig.axes if ax.axison]
    assert [ax.get_title() for ax in panels] == ["width\nscatter", "kernel\nscatter"]
    curve, ring = panels[0].lines
    np.testing.assert_array_equal(curve.get_xydata(), [[0.01, 0.3], [0.03, 0.15]])
    np.testing.assert_array_equal(ring.get_xydata(), [[0.03, 0.15]])
    assert [text.get_text() for text in panels[0].texts] == ["0.5", "1"]
    assert len(panels[1].lines) == 1
    assert panels[0].get_xlim() == (0.01, 0.1)
    fig.savefig(tmp_path / "cost.png")
