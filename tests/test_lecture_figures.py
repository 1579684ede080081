"""Every script in fits/ that has data in fits/data/ prints and draws what the README says of them. No grain is simulated here."""

import shutil
from pathlib import Path

import numpy as np
import pytest

import anisogran as ag
from scripts import fits_script

FITS = Path(__file__).parents[1] / "fits"


@pytest.fixture
def figure(tmp_path):
    path = tmp_path / "figure.png"
    yield str(path)
    assert path.stat().st_size > 10_000


def test_cohesion_follows_the_lecture(figure, capsys):
    """c0 and the peaks with adhesion; without it the lecture's peaks are not reached, and the table says so."""
    module = fits_script("cohesion")
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
    found = fits_script("modulus_and_yield_stress").main(figure=figure)
    slope = {key: float(np.mean(slopes)) for key, (slopes, _) in found.items()}
    peak = {key: float(np.mean(peaks)) for key, (_, peaks) in found.items()}
    for p, more in (("p100", "p300"), ("p300", "p500")):
        for kc in (0.0, 1e5, 4e5):
            assert peak[more, kc] > peak[p, kc]
    for p in ("p100", "p300", "p500"):
        assert slope[p, 0.0] < slope[p, 1e5] < slope[p, 4e5]
        assert peak[p, 0.0] < peak[p, 5e4] < peak[p, 1e5] < peak[p, 2e5] < peak[p, 4e5]


def test_mohr_circles(figure):
    fits = fits_script("mohr_circles").main(figure=figure)
    assert [np.degrees(fit.values["phi"]) for fit in fits.values()] == sorted(np.degrees(fit.values["phi"]) for fit in fits.values())
    assert fits[1e5].values["c"] == pytest.approx(42.0, abs=1.0)


def test_friction_angle(figure, capsys):
    """Internal angles grow with mu; the lecture's 27 degrees are met, its 31 degrees of a line through the origin only at p = 500."""
    lines = fits_script("friction_angle").main(figure=figure)
    phi = {mu: np.degrees(line.values["phi"]) for mu, line in lines.items()}
    assert list(phi.values()) == sorted(phi.values())
    assert phi[0.5] == pytest.approx(27.8, abs=0.1)
    assert phi[0.0] == pytest.approx(9.6, abs=0.1)
    told = capsys.readouterr().out
    assert told.count("NOT") == 2  # the heading, and the total angle at p = 100
    assert "0.100 kg/s" in told


def test_evolution_with_pressure(figure, tmp_path):
    """Structure lags behind stress, and both follow the slower the higher the pressure is."""
    shutil.copy(FITS / "data" / "biaxial_pressure.h5", tmp_path)
    result = fits_script("evolution").main(tmp_path, figure)
    means = {case.conditions["p"]: {name: of.mean(axis=1) for name, of in values.items()} for _, case, values in result}
    assert list(means) == [200.0, 1000.0]
    for name in ("s_D", "anisotropy"):
        beta = [of[name][1] for of in means.values()]
        assert beta == sorted(beta, reverse=True)
    assert all(of["s_D"][1] > 2 * of["anisotropy"][1] for of in means.values())


def test_scalar_model_at_unseen_pressures(figure):
    """Between the fitted pressures the law is as near as the error bars; its A follows several times faster than the fabric."""
    fits, unseen = fits_script("scalar_model").main(figure=figure)
    assert fits[100].values["s_max"] == pytest.approx(fits[500].values["s_max"], rel=0.2)
    assert set(unseen) == {200, 1000}
    assert max(unseen[200].values()) < 0.1
    assert 0.1 < max(unseen[1000].values()) < 0.2
    assert fits[100].values["beta_F"] > 3 * 121
    assert fits[500].values["beta_F"] > 2 * 63


def test_cycles(figure, capsys):
    _, moved = fits_script("cycles").main(figure=figure)
    assert "eps_V a cycle" in capsys.readouterr().out
    assert len(moved["grains"]) == len(moved["model"]) == 9
    assert np.abs(moved["grains"]).max() < 1e-3


@pytest.mark.parametrize("name", ["cohesion", "mohr_circles", "friction_angle", "cycles", "stiffness", "tablet_vibration"])
def test_a_file_of_another_study_is_told_in_one_line(name):
    with pytest.raises(
        ag.InputError, match=r"cohesive_gas.h5: has no group \w+(/series)?, so it was made for something else; it has gases"
    ):
        fits_script(name).main(FITS / "data" / "cohesive_gas.h5")


def test_what_holds_no_data_is_told(tmp_path):
    with pytest.raises(ag.InputError, match=r"none of biaxial_friction.h5, biaxial_pressure.h5"):
        fits_script("evolution").main(tmp_path)
