"""`anisogran fit law`: a whole law from files of whole curves."""

import json

import numpy as np
import pytest

import anisogran as ag
from anisogran import cli

LAW = {"E": 2e4, "B": 1.2e4, "s_max": 0.3, "A_max": 4e3, "beta_F": 50.0}


def run(capsys, *arguments):
    with pytest.raises(SystemExit) as end:
        cli.main(["fit", "law", *map(str, arguments)])
    captured = capsys.readouterr()
    return end.value.code, captured.out, captured.err


def table(path, columns, p, rng=None):
    """A text file with a header line, at the pressure p, with noise of 1 % of the range on what is measured."""
    rows = dict(columns)
    for name in () if rng is None else ("sigma_zz", "eps_V"):
        rows[name] = rows[name] + 0.01 * np.ptp(rows[name]) * rng.normal(size=rows[name].size)
    lines = [" ".join(f"{value:.15g}" for value in row) for row in zip(*rows.values(), strict=True)]
    path.write_text("\n".join([f"# p = {p}", " ".join(rows), *lines]) + "\n")
    return path


def biaxial(path, law, p, rng=None, **changes):
    test = ag.element_test(law, LAW | changes, ag.models.biaxial(np.linspace(0.0, 0.1, 80), p))
    return table(path, {name: getattr(test, name) for name in ("eps_zz", "sigma_zz", "eps_V")}, p, rng)


def test_biaxial_files_are_fitted_at_once(rng, tmp_path, capsys):
    files = [biaxial(tmp_path / f"b{p:g}.txt", "scalar", p, rng) for p in (100.0, 500.0)]
    numbers, picture, out = (tmp_path / name for name in ("J.json", "fit.png", "fit.h5"))
    outputs = "--json", numbers, "--figure", picture, "--out", out
    code, printed, error = run(capsys, *files, "--law", "scalar", "--fixed", "beta_F=50", *outputs)
    assert (code, error) == (0, ""), printed
    assert printed.startswith("data set")  # the table of parameter x curve comes first
    assert "b500: eps_V: rms" in printed
    data = json.loads(numbers.read_text())
    assert data["values"]["s_max"] == pytest.approx(0.3, rel=0.01)  # noise
    assert data["law_figures"]["parameters"]["b100"]["beta_F"] == 50.0
    assert data["law_figures"]["columns"]["b100"]["sigma_zz"]["points"] == 80
    assert picture.stat().st_size > 10_000
    saved = ag.open(out)
    assert len([name for name in saved.children if name.startswith("curve")]) == 4
    assert saved["curve-1"].attrs["x"] == "eps_zz"


def test_a_parameter_can_follow_a_condition_and_a_wrong_law_leaves_with_5(rng, tmp_path, capsys):
    files = [biaxial(tmp_path / f"b{p:g}.txt", "scalar", p, rng, s_max=s_max) for p, s_max in ((100.0, 0.25), (500.0, 0.35))]
    code, printed, _ = run(capsys, *files, "--law", "scalar", "--fixed", "beta_F=50")
    assert code == 5
    assert "not trustworthy" in printed
    numbers = tmp_path / "J.json"
    code, printed, _ = run(capsys, *files, "--law", "scalar", "--fixed", "beta_F=50", "--shared", "s_max=p", "--json", numbers)
    assert code == 0, printed
    values = json.loads(numbers.read_text())["values"]
    assert values["s_max[p=100]"] == pytest.approx(0.25, rel=0.01)  # noise
    assert values["s_max[p=500]"] == pytest.approx(0.35, rel=0.01)


def test_simple_shear_rows_are_those_of_the_results(tmp_path, capsys):
    gamma, p = np.linspace(0.0, 0.2, 80), 100.0
    test = ag.element_test("tensorial", LAW, ag.models.simple_shear(gamma, p))
    columns = {"strain": gamma, "pressure": test.sigma_V, "sigma_yy": test.sigma_zz, "stress_ratio": -test.stress[0, 1] / test.sigma_V}
    columns["area_fraction"] = 0.8 * np.exp(2.0 * test.eps_V)  # mass is kept
    numbers = tmp_path / "J.json"
    files = [table(tmp_path / "shear.txt", columns, p), biaxial(tmp_path / "b.txt", "tensorial", 300.0)]
    code, printed, error = run(capsys, *files, "--law", "tensorial", "--json", numbers)
    assert (code in (0, 5), error) == (True, ""), printed
    for name, value in json.loads(numbers.read_text())["values"].items():
        assert value == pytest.approx(LAW[name], rel=1e-6)  # 15 digits in the file
