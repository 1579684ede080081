"""The published table of the lecture: five pairs of peak stresses, their angles and cohesions."""

import importlib.util
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[2] / "fits" / "lecture_cohesion.py"


def test_the_table_of_the_lecture_is_found_again(capsys, tmp_path):
    spec = importlib.util.spec_from_file_location("lecture_cohesion", SCRIPT)
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    lines, c0 = script.main(tmp_path / "circles.png")
    for ratio, (phi, c) in lines.items():
        assert phi == pytest.approx(13.0, abs=1.0)  # the slide says about 13 degrees
        assert c == pytest.approx(script.COHESION[ratio], abs=1.2)  # read off by eye on the slide
    assert [round(phi, 1) for phi, _ in lines.values()] == [12.2, 12.4, 13.8, 12.9, 13.2]
    assert c0 == pytest.approx(176.0, abs=0.5)
    assert (tmp_path / "circles.png").stat().st_size > 20_000  # a picture with content
    printed = capsys.readouterr().out
    assert "c0 = 176 N/m" in printed
    assert "+- 5 N/m, one standard error from 4 points with 3 degrees of freedom" in printed  # by hand: 4.8
    assert "c0 = 174.58 +- 7.9; trustworthy" in printed  # the ten peaks themselves
    assert "c = 0 at kc = 0, where the table has 11" in printed
    together = script.all_at_once()
    assert together.verdict, str(together)
    assert together.values["phi"] == pytest.approx(0.2301, abs=1e-4)  # 13.2 degrees
    assert together.values["c0"] == pytest.approx(176.0, abs=together.errors["c0"])  # that of the five cohesions of the slide
    assert together.errors["c0"] == pytest.approx(7.9, abs=0.1)
    assert str(together.table) in printed
