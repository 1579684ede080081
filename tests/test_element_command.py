"""`anisogran element`: a file in, curves out, and one line for what does not fit."""

import json
import tomllib

import numpy as np
import pytest

import anisogran as ag
from anisogran import cli
from anisogran.models import LAWS, element_test


def run(capsys, *arguments):
    with pytest.raises(SystemExit) as end:
        cli.main(["element", *map(str, arguments)])
    captured = capsys.readouterr()
    return end.value.code, captured.out, captured.err


@pytest.fixture
def scalar_file(tmp_path, capsys):
    path = tmp_path / "law.toml"
    path.write_text(run(capsys, "--template", "scalar")[1])
    return path


@pytest.mark.parametrize("law", LAWS)
def test_the_template_of_every_law_runs_as_it_is(law, tmp_path, capsys):
    code, text, _ = run(capsys, "--template", law)
    assert code == 0
    path = tmp_path / "law.toml"
    path.write_text(text)
    code, table, error = run(capsys, path, "--steps", 100)
    assert (code, error) == (0, "")
    assert len(table.strip().splitlines()) == 12
    assert set(tomllib.loads(text)["parameters"]) == set(LAWS[law].KEYS)


def test_curves_go_to_hdf5_json_and_a_picture(scalar_file, tmp_path, capsys):
    out, numbers = tmp_path / "out", tmp_path / "J.json"
    code, printed, _ = run(capsys, scalar_file, "--out", out, "--json", numbers, "--integrator", "rk45", "--steps", 50)
    assert code == 0
    saved, data = ag.open(out / "element.h5")["element"].to_dataset(), json.loads(numbers.read_text())
    content = tomllib.loads(scalar_file.read_text())
    control = {"eps_zz": content["control"]["eps_zz"], "sigma_xx": content["control"]["pressure"]}
    expected = element_test("scalar", content["parameters"], control, steps=50, integrator="rk45")
    np.testing.assert_array_equal(saved.sigma_zz, expected.sigma_zz)
    np.testing.assert_array_equal(data["curves"]["sigma_zz"]["values"], expected.sigma_zz)
    assert data["curves"]["sigma_zz"]["units"] == "N/m"
    assert data["status"]["level"] == "ok"
    assert (out / "element.png").stat().st_size > 20_000
    assert f"{expected.sigma_zz[-1]:.6g}" in printed
    assert run(capsys, scalar_file, "--out", out)[0] == 2  # not empty


def test_a_failure_leaves_the_file_that_repeats_it_and_overwrites_nothing(scalar_file, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scalar_file.write_text(scalar_file.read_text().replace("A_max = 4000.0", "A_max = 3e4"))
    for name in ("element-failure.toml", "element-failure-2.toml"):
        code, _, error = run(capsys, scalar_file, "--steps", 100)
        assert code == 3
        assert error.count("\n") == 1
        assert "not positive definite" in error
        assert f"{name} repeats the step" in error
    code, _, again = run(capsys, "element-failure.toml")
    assert code == 3
    assert "not positive definite" in again
    assert (tmp_path / "element-failure-3.toml").exists()


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('law = "scalar"', 'law = "scaler"', "law = 'scaler' must be one of scalar, tensorial"),
        ('law = "scalar"', 'low = "scalar"', "unknown key 'low', did you mean 'law'"),
        ('law = "scalar"', "", "law is missing"),
        ("[parameters]", "[parameter]", "unknown key 'parameter', did you mean 'parameters'"),
        ("s_max = 0.3", "s_max = 1.5", "s_max = 1.5 must be below 1"),
        ("s_max = 0.3", "smax = 0.3", "unknown parameter 'smax', did you mean 's_max'"),
        ("s_max = 0.3", "s_max = ", "not a TOML file"),
        ('kind = "biaxial"', 'kind = "triaxial"', "kind = 'triaxial' must be one of biaxial"),
        ("pressure = 100.0", "presure = 100.0", "unknown key 'presure', did you mean 'pressure'"),
        ("pressure = 100.0", "", "pressure missing"),
        ("pressure = 100.0", "pressure = -100.0", "sigma_V = -100 must be above 0"),
        ("[parameters]", "start = 3\n[parameters]", "start must be a table"),
    ],
)
def test_a_bad_file_gives_one_line_that_names_it(scalar_file, old, new, words, capsys):
    text = scalar_file.read_text()
    assert old in text
    scalar_file.write_text(text.replace(old, new))
    code, printed, error = run(capsys, scalar_file)
    assert (code, printed) == (2, "")
    assert error.count("\n") == 1
    assert words in error
    assert scalar_file.name in error


def test_files_that_cannot_be_read(tmp_path, capsys):
    assert "cannot be read" in run(capsys, tmp_path / "none.toml")[2]
    assert "is a folder, not a file" in run(capsys, tmp_path)[2]
    binary = tmp_path / "binary.toml"
    binary.write_bytes(bytes(range(128, 256)))
    assert "not a TOML file" in run(capsys, binary)[2]
    large = tmp_path / "large.toml"
    large.write_text("# " + "x" * 1_000_000)
    assert "larger than 1000000 bytes" in run(capsys, large)[2]
    assert "give one of a file and --template" in run(capsys)[2]
    assert "must be one of scalar" in run(capsys, "--template", "cubic")[2]
