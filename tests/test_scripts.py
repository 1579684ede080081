"""Every script in data_generation/ and fits/ runs in its small version and gives numbers of the right size."""

import importlib.util
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


def script(path):
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_friction_law(tmp_path, capsys):
    path = str(tmp_path / "friction_law.h5")
    script(ROOT / "data_generation" / "friction_law.py").main([path, "--quick"])
    fit = script(ROOT / "fits" / "friction_law.py").main(path)
    assert fit.values["mu_s"] == pytest.approx(0.28, abs=0.05)  # 100 grains, 10 short runs: errors of 0.013
    assert "mu = mu_s + b I" in capsys.readouterr().out


def test_biaxial_evolution(tmp_path, capsys):
    path = str(tmp_path / "biaxial.h5")
    script(ROOT / "data_generation" / "biaxial.py").main([path, "--quick"])
    fits = script(ROOT / "fits" / "biaxial_evolution.py").main(path)
    assert 0.3 < fits["s_D"].values["s_max"] < 0.55
    assert fits["s_D"].values["beta"] > fits["anisotropy"].values["beta"] > 0  # structure lags behind stress


def test_every_script_is_tested():
    here = Path(__file__).read_text() + (Path(__file__).parent / "fitting" / "test_lecture_cohesion.py").read_text()
    for path in [*(ROOT / "data_generation").glob("*.py"), *(ROOT / "fits").glob("*.py")]:
        assert path.name in here or path.stem in here, f"{path.name} is not tested"
