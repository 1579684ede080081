"""Every script in fits/ that has data in fits/data/ prints and draws what the README says of them. No grain is simulated here."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

import anisogran as ag

FITS = Path(__file__).parents[1] / "fits"


def script(name):
    spec = importlib.util.spec_from_file_location(name, FITS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def figure(tmp_path):
    path = tmp_path / "figure.png"
    yield str(path)
    assert path.stat().st_size > 10_000


def test_cohesion_follows_the_lecture(figure, capsys):
    """c0 and the peaks with adhesion; without it the lecture's peaks are not reached, and the table says so."""
    module = script("cohesion")
    lines, c0 = module.main(figure=figure)
    told = capsys.readouterr().out
    assert c0 / module.K2 == pytest.approx(1.8e-3, rel=0.1)
    for ratio, c in module.COHESION.items():
        outside = ratio in (0.0, 4.0)
        assert (abs(lines[ratio][1][0] - c) > module.C_WITHIN) == outside
    assert told.count("NOT") == 5  # the heading, both peaks and c at kc = 0, c at kc = 4
    assert lines[0.0][0][0] == pytest.approx(9.2, abs=0.3)
    assert "none N/m: c =   0.3 +- 1.5 N/m" in told


def test_modulus_and_yield_stress_rise_with_pressure_and_adhesion(figure):
    found = script("modulus_and_yield_stress").main(figure=figure)
    slope = {key: float(np.mean(slopes)) for key, (slopes, _) in found.items()}
    peak = {key: float(np.mean(peaks)) for key, (_, peaks) in found.items()}
    for p, more in (("p100", "p300"), ("p300", "p500")):
        for kc in (0.0, 1e5, 4e5):
            assert peak[more, kc] > peak[p, kc]
    for p in ("p100", "p300", "p500"):
        assert slope[p, 0.0] < slope[p, 1e5] < slope[p, 4e5]
        assert peak[p, 0.0] < peak[p, 5e4] < peak[p, 1e5] < peak[p, 2e5] < peak[p, 4e5]


def test_mohr_circles(figure):
    fits = script("mohr_circles").main(figure=figure)
    assert [np.degrees(fit.values["phi"]) for fit in fits.values()] == sorted(np.degrees(fit.values["phi"]) for fit in fits.values())
    assert fits[1e5].values["c"] == pytest.approx(42.0, abs=1.0)


def test_what_holds_no_data_is_told(tmp_path):
    with pytest.raises(ag.InputError, match=r"none of biaxial_friction.h5, biaxial_pressure.h5"):
        script("evolution").main(tmp_path)
