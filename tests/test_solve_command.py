"""`anisogran solve`: a file in, a flow out; what is no solution is marked wherever it is written."""

import json
import tomllib

import numpy as np
import pytest

import anisogran as ag
from anisogran import cli
from anisogran.cli.solve_command import csv_text
from anisogran.continuum import LAWS, CoulombSlip, Jop, Nonlocal
from anisogran.glossary import GLOSSARY
from anisogran.keys import record_keys
from anisogran.scenes.flow_file import EXAMPLE, flow_template, read_flow
from anisogran.scenes.writing import scene_text


def run(capsys, *arguments):
    with pytest.raises(SystemExit) as end:
        cli.main(["solve", *map(str, arguments)])
    captured = capsys.readouterr()
    return end.value.code, captured.out, captured.err


@pytest.fixture
def file(tmp_path, capsys):
    path = tmp_path / "flow.toml"
    path.write_text(run(capsys, "--template")[1])
    return path


def test_the_template_is_the_example_with_every_key_and_law(file):
    assert read_flow(file) == EXAMPLE
    text = flow_template()
    for name in record_keys(ag.RingFlow):
        assert f"\n{name} = " in text or f"\n# {name} = " in text or f"[{name}]" in text, name
    for law in LAWS:
        assert f'law = "{law.kind}"' in text
    assert tomllib.loads(text)["law"]["law"] == "nonlocal"


def test_results_go_to_a_folder(file, tmp_path, capsys):
    out, numbers = tmp_path / "out", tmp_path / "flow.json"
    code, printed, error = run(capsys, file, "--out", out, "--json", numbers, "--set", "wall_speed=2e-3")
    assert (code, error) == (0, "")
    flow = ag.RingFlow(13.0, 33.0, Nonlocal(0.26, 1.0, 0.9), 2e-3, 1.0).solve()
    results = ag.open(out / "results.h5")
    data = results["flow"].to_dataset()
    np.testing.assert_array_equal(data.v_phi, flow.v_phi)
    np.testing.assert_array_equal(data.stress, flow.stress)
    assert data.v_phi.attrs["units"] == "m/s"
    assert (data.attrs["converged"], data.attrs["law"], data.attrs["law_amplitude"]) == (1, "nonlocal", 0.9)
    assert data.attrs["stress_ratio_wall"] == flow.stress_ratio_wall
    told = json.loads(numbers.read_text())
    assert told["stress_ratio_wall"] == flow.stress_ratio_wall
    assert told["converged"] is True
    assert told["profiles"]["fluidity"] == {"units": "1/s", "values": flow.fluidity.tolist()}
    head, *rows = (out / "profile.csv").read_text().splitlines()
    assert head.startswith("r [m],v_phi [m/s],")
    np.testing.assert_array_equal([float(row.split(",")[1]) for row in rows], flow.v_phi)
    assert (out / "flow.png").stat().st_size > 20_000
    assert f"{flow.stress_ratio_wall:.6g}" in printed
    assert read_flow(out / "flow.toml") == flow.problem
    assert run(capsys, file, "--out", out)[0] == 2  # not empty


@pytest.mark.hard_case("S9")
def test_a_table_holds_numbers_under_names_of_the_glossary(answer):
    """No word that a file has brought along, and no formula that a spreadsheet would run."""
    head, *rows = csv_text(ag.RingFlow(13.0, 33.0, Nonlocal(0.26, 1.0, 0.9), 2e-3, 1.0).solve()).splitlines()
    assert {name.split(" [")[0] for name in head.split(",")} <= set(GLOSSARY)
    assert np.isfinite([[float(number) for number in row.split(",")] for row in rows]).all()
    answer.named("tables hold numbers under names of the glossary")


@pytest.mark.hard_case("N6", of=[law.kind for law in LAWS])
def test_what_is_no_solution_is_marked_everywhere(file, tmp_path, capsys):
    out, numbers = tmp_path / "out", tmp_path / "flow.json"
    code, printed, error = run(capsys, file, "--out", out, "--json", numbers, "--set", "max_iterations=2")
    assert code == 4
    assert printed == ""
    assert "no solution after 2 iterations" in error
    assert f"{out} holds the last iterate, which is no solution" in error
    assert (out / "profile.csv").read_text().startswith("# NOT CONVERGED")
    assert json.loads(numbers.read_text())["converged"] is False
    data = ag.open(out / "results.h5")["flow"].to_dataset()
    assert data.attrs["converged"] == 0
    assert data.attrs["status"].startswith("failed: not converged")


def test_files_and_options_are_read_as_scenes_are(file, tmp_path):
    slips = read_flow(file, ["inner_wall.law=coulomb_slip", "inner_wall.friction=0.3", "outer=volume", "elements=32", "law.wall=0.1"])
    assert (slips.inner_wall, slips.outer, slips.elements, slips.law.wall) == (CoulombSlip(0.3), "volume", 32, 0.1)
    assert read_flow(file, ['law={law="jop", mu_s=0.3, mu_2=0.6, I_0=0.1}']).law == Jop(0.3, 0.6, 0.1)
    again = tmp_path / "again.toml"
    again.write_text(scene_text(slips))
    assert read_flow(again) == slips


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("r_inner = 13.0", "r_iner = 13.0"), "flow.toml: unknown key 'r_iner', did you mean 'r_inner'?"),
        (("r_inner = 13.0", ""), "flow.toml: r_inner is missing"),
        (('law = "nonlocal"', 'law = "nonlocl"'), "flow.toml: [law] law = 'nonlocl' must be one of local_mu_i, jop, regularised, nonlocal"),
        (("amplitude = 0.9", "amplitude = 0.0"), "flow.toml: [law] amplitude = 0 must be above 0 grain diameters"),
        (('kind = "ring_flow"', 'kind = "ring_shear"'), "flow.toml: kind = 'ring_shear' must be \"ring_flow\""),
        (("inertia = false", "inertia = 0"), "flow.toml: inertia = 0 must be true or false"),
        (("inertia = false", "inertia = true"), "flow.toml: inertia = True needs areal_density"),
        (("r_outer = 33.0", "r_outer = 12.0"), "flow.toml: r_inner = 13 must be below 12 m"),
        (("r_outer = 33.0", 'r_outer = "33 mm"'), "must have the unit m"),
    ],
)
def test_bad_files_are_refused_in_one_line(change, message, file, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    file.write_text(file.read_text().replace(*change, 1))
    code, printed, error = run(capsys, file)
    assert (code, printed) == (2, "")
    assert message in error
    assert error.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["flow.toml"]  # no folder is left behind


def test_one_of_file_and_template(file, capsys):
    assert run(capsys)[0] == 2
    assert run(capsys, file, "--template")[0] == 2
    assert run(capsys, "--help")[0] == 0
