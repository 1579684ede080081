"""The scripts of the ring shear cell print and draw, from the data in fits/data/, what the README says of them. No grain is simulated."""

import shutil
from pathlib import Path

import numpy as np
import pytest

import anisogran as ag
from anisogran.files import save_results
from scripts import fits_script

FITS = Path(__file__).parents[1] / "fits"
DATA = FITS / "data"


@pytest.fixture
def figure(tmp_path):
    path = tmp_path / "figure.png"
    yield str(path)
    assert path.stat().st_size > 10_000


def test_friction_law(capsys):
    fit = fits_script("friction_law").main(DATA / "ring_friction_law.h5")
    assert fit.verdict
    assert fit.values["mu_s"] == pytest.approx(0.281, abs=1e-3)
    assert fit.values["b"] == pytest.approx(1.13, abs=0.01)
    told = capsys.readouterr().out
    assert "mu = mu_s + b I" in told
    assert "nu_max = 0.81458" in told


def test_averages_of_the_ring(figure):
    found = fits_script("ring_profiles").main(figure=figure)
    for name in ("gap of 8 d", "gap of 20 d"):
        one = found[name]
        assert one["torque_spread"] < 3e-3  # on circles the torque is the same
        assert one["force_misfit"] < 0.03
        assert one["exponent_rr"] == pytest.approx(one["hoop_over_radial"] - 1, abs=0.03)  # what equilibrium asks for
        assert one["area_fraction_far"] - one["area_fraction_wall"] > 0.05  # dilated at the inner ring
        assert one["bulk_over_trace"] == pytest.approx(1000 / (2 * np.pi), rel=0.05)  # k/2 pi: it checks the averages, not the grains
        stress, fabric = one["rate_to_stress_angle"], one["rate_to_fabric_angle"]
        assert stress[0] < -5 * stress[1]  # not collinear, far beyond the scatter of the seeds
        assert fabric[0] > 5 * fabric[1]
    assert found["gap of 8 d"]["rate_to_stress_angle"][1] > 0.5  # degrees, of three seeds; the blocks of one say 0.2 to 0.3


def test_predictions_beside_their_base_lines(figure, tmp_path, capsys):
    """One seed of the calibrated cell, of a smaller one and of a faster one: a part of what the README tells."""
    study = ag.open(DATA / "ring_reference.h5")
    kept = {}
    for cell in ("reference", "inner_4", "fast"):
        for part in ("cases", "series", "profiles", "blocks"):
            kept[f"{cell}/{part}"] = study[f"{cell}/{part}"].to_dataset().isel(seed=slice(1))
    save_results(tmp_path / "ring_reference.h5", kept, {})
    shutil.copy(DATA / "ring_friction_law.h5", tmp_path)
    parameters, predicted = fits_script("ring_comparison").main(tmp_path, figure)
    told = capsys.readouterr().out
    assert parameters.mu_s == pytest.approx(0.281, abs=0.001)
    assert 0.7 < parameters.amplitude < 0.95
    assert list(predicted) == ["inner_4", "fast"]
    l2 = {cell: dict(zip(tables[0].rival.values, tables[0].l2.values, strict=True)) for cell, tables in predicted.items()}
    for cell in l2:
        assert l2[cell]["nonlocal"] < 0.3 < l2[cell]["local"]
    assert l2["inner_4"]["copy"] > 1.5 * l2["inner_4"]["nonlocal"]  # mechanics pays where the geometry changes
    assert l2["fast"]["copy"] < l2["fast"]["nonlocal"]  # and not where it stays
    assert "nu = nu_max - a I: nu_max = 0.81458" in told


def test_the_cell_of_the_lecture_is_not_steady(figure):
    pressures = fits_script("ring_lecture").main(figure=figure)
    for _, pressure in pressures.values():
        assert pressure.max() > 3 * pressure.min()


def test_pictures_of_the_lectures_cell(figure):
    snapshot = fits_script("ring_pictures").main(DATA / "ring_lecture.h5", figure, "lecture")
    assert np.count_nonzero(snapshot.free) == 2939
