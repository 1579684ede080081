"""`anisogran fit`: files in, values with errors and a verdict out, and one line for what does not fit."""

import json

import numpy as np
import pytest
import xarray as xr
from scipy.special import erf

import anisogran as ag
from anisogran import cli
from anisogran.cli.fit_command import NAMES
from anisogran.cli.fit_kinds import KINDS
from anisogran.files import read_columns, save_results
from anisogran.models import macro_cohesion, peak_stress
from anisogran.scenes import scene_text


def run(capsys, *arguments):
    with pytest.raises(SystemExit) as end:
        cli.main(["fit", *map(str, arguments)])
    captured = capsys.readouterr()
    return end.value.code, captured.out, captured.err


def table(path, columns, conditions=None, separator=" "):
    """A text file with a header line."""
    head = [f"# {key} = {value}" for key, value in (conditions or {}).items()]
    rows = [separator.join(f"{value:.12g}" for value in row) for row in zip(*columns.values(), strict=True)]
    path.write_text("\n".join([*head, separator.join(columns), *rows]) + "\n")
    return path


def evolution(rng, s_max=0.4, beta=60.0, points=300):
    eps_D = np.linspace(0.0, 0.1, points)
    return {"eps_D": eps_D, "s_D": s_max * (1.0 - np.exp(-beta * eps_D)) + 0.004 * rng.normal(size=points)}


@pytest.fixture(scope="module")
def compressed(tmp_path_factory):
    path = tmp_path_factory.mktemp("run") / "biaxial.h5"
    friction = ag.Friction(stiffness=2e4, mu=0.5)
    ag.Biaxial(n=150, strain=0.06, duration=0.02, samples=100, seed=1, friction=friction).run().save(path)
    return path


def test_a_table_gives_what_the_library_gives(rng, tmp_path, capsys):
    rows = evolution(rng)
    path, numbers, picture, out = (tmp_path / name for name in ("run.txt", "J.json", "fit.png", "fit.h5"))
    table(path, rows)
    code, printed, error = run(capsys, "relaxation", path, "--json", numbers, "--figure", picture, "--out", out)
    assert (code, error) == (0, "")
    written = {name: np.array([float(f"{value:.12g}") for value in row]) for name, row in rows.items()}
    expected = ag.fit.relaxation(written["eps_D"], written["s_D"])
    data = json.loads(numbers.read_text())
    assert data["values"] == expected.values
    assert data["errors"] == expected.errors
    assert data["verdict"] is True
    assert data["intervals_95"]["beta"] == list(expected.interval("beta"))
    assert f"s_max = {expected.values['s_max']:.6g}  +- {expected.errors['s_max']:.2g}" in printed
    assert "\n  trustworthy" in printed
    assert picture.stat().st_size > 10_000
    saved = ag.open(out)
    np.testing.assert_allclose(saved["curve-1"].fitted, expected.predict(written["eps_D"]), rtol=1e-12)  # rounding of the file
    assert json.loads(saved.attrs["fits"])[0]["values"] == expected.values
    code, _, error = run(capsys, "relaxation", path, "--out", out)
    assert code == 2
    assert "the file is there; choose another or add --force" in error
    assert run(capsys, "relaxation", path, "--out", out, "--force", "--json", numbers)[0] == 0


def test_a_fit_that_is_not_trustworthy_says_why_and_leaves_with_5(rng, tmp_path, capsys):
    rows = evolution(rng)
    short = table(tmp_path / "short.txt", {name: row[:30] / (10.0 if name == "eps_D" else 1.0) for name, row in rows.items()})
    numbers = tmp_path / "J.json"
    code, printed, error = run(capsys, "relaxation", short, "--json", numbers)
    assert (code, error) == (5, "")
    assert "not trustworthy:" in printed
    assert "not determined" in printed
    data = json.loads(numbers.read_text())
    assert data["verdict"] is False
    assert data["reasons"]
    assert data["errors"]["beta"] is None


def test_a_results_file_knows_its_columns(compressed, tmp_path, capsys):
    numbers = tmp_path / "J.json"
    series = ag.open(compressed)["series"].to_dataset()
    code, _, error = run(capsys, "relaxation", compressed, "--json", numbers)
    expected = ag.fit.relaxation(series.eps_D.values, series.s_D.values)
    assert (code, error) == (0 if expected.verdict else 5, "")
    assert json.loads(numbers.read_text())["values"] == expected.values
    run(capsys, "relaxation", compressed, "--y", "series/anisotropy", "--json", numbers)
    assert json.loads(numbers.read_text())["values"] == ag.fit.relaxation(series.eps_D.values, series.anisotropy.values).values


@pytest.mark.parametrize("kind", ["moduli", "path_moduli"])
def test_moduli_of_a_run_stand_beside_what_the_evolution_implies(compressed, tmp_path, capsys, kind):
    numbers, picture = tmp_path / "J.json", tmp_path / "fit.png"
    code, printed, error = run(capsys, kind, compressed, "--json", numbers, "--figure", picture)
    assert (code in (0, 5), error) == (True, "")
    data = json.loads(numbers.read_text())
    assert {"E", "B"} <= set(data["values"])
    assert data["compared_B"]["implied"] > 0.0
    assert "sigma_V is not constant" in printed
    assert picture.stat().st_size > 10_000
    if kind == "moduli":
        series = ag.open(compressed)["series"].to_dataset()
        half = 0.5 * (series.sigma_zz + series.sigma_xx).values, 0.5 * (series.sigma_zz - series.sigma_xx).values
        assert data["values"] == ag.fit.initial_moduli(series.eps_V.values, series.eps_D.values, *half).values


def test_every_kind_fits_a_table_of_its_own_columns(rng, tmp_path, capsys):
    I, r = np.geomspace(1e-3, 0.2, 20), np.linspace(0.07, 0.11, 60)
    p = np.repeat([100.0, 200.0, 300.0, 400.0, 500.0], 4)
    kc = np.tile([0.0, 5e4, 1e5, 2e5], 5)
    c = np.array([macro_cohesion(180.0, 5e4, 1e5, one) for one in kc])
    turn = np.linspace(0.0, 0.004, 400)
    wave = 0.001 * np.sin(1000 * turn)
    law = {"E": 2e4, "B": 1e4, "s_max": 0.4, "A_max": 0.0, "beta_F": 0.0}
    test = ag.element_test("scalar", law, {"eps_V": wave, "eps_D": turn}, 100.0)
    curve = {"eps_V": wave, "eps_D": turn, "sigma_V": test.sigma_V, "sigma_D": test.sigma_D}
    law = law | {"A_max": 5e3, "beta_F": 30.0}
    test = ag.element_test("scalar", law, ag.models.biaxial(np.linspace(0.0, 0.1, 400), 100.0))
    structure = test.internal["A"] / 5e3
    box = {"eps_V": test.eps_V, "eps_D": test.eps_D, "sigma_zz": test.sigma_zz, "sigma_xx": test.sigma_xx, "anisotropy": structure}
    tables = {
        "relaxation": (evolution(rng), {"s_max": 0.4}),
        "mohr_coulomb": ({"p": p, "sigma_zz": peak_stress(p, 0.23, 40.0) + rng.normal(size=20)}, {"phi": 0.23}),
        "cohesion": ({"p": p, "kc": kc, "sigma_zz": peak_stress(p, 0.23, c) + rng.normal(size=20)}, {"phi": 0.23, "c0": 180.0}),
        "mu_of_I": ({"I": I, "mu": 0.26 + I + 1e-3 * rng.normal(size=20)}, {"mu_s": 0.26, "b": 1.0}),
        "area_fraction": ({"I": I, "nu": 0.81 - 0.3 * I + 1e-4 * rng.normal(size=20)}, {"nu_max": 0.81, "a": 0.3}),
        "shear_band": ({"r": r, "omega": 0.05 * np.tanh((r - 0.085) / 0.005) + 5e-4 * rng.normal(size=60)}, {"centre": 0.085}),
        "exponential_decay": ({"x": 200 * r - 14, "v": np.exp(7 - 100 * r + 0.05 * rng.normal(size=60))}, {"length": 2.0}),
        "moduli": (curve, {"E": 2e4, "B": 1e4}),
        "path_moduli": (box, {"B": 1e4}),
        "law": ({"eps_zz": test.eps_zz, "sigma_zz": test.sigma_zz, "eps_V": test.eps_V}, {"E": 2e4, "B": 1e4, "s_max": 0.4}),
    }
    more = {"law": ["--law", "scalar", "--fixed", "beta_F=30,A_max=5e3"]}  # one path at constant pressure does not tell E and A apart
    assert set(tables) == set(KINDS)
    assert all(kind in NAMES for kind in KINDS)  # the help names them all
    for kind, (columns, truth) in tables.items():
        path, numbers, picture = tmp_path / f"{kind}.csv", tmp_path / "J.json", tmp_path / "fit.png"
        table(path, columns, {"k1": 5e4, "k2": 1e5} | ({"p": 100.0} if kind == "law" else {}), separator=",")
        code, printed, error = run(capsys, kind, path, "--json", numbers, "--figure", picture, *more.get(kind, []))
        assert code == 0, (kind, printed, error)
        values = json.loads(numbers.read_text())["values"]
        for name, value in truth.items():
            assert values[name] == pytest.approx(value, rel=0.1), kind  # noise


def test_columns_are_named_and_errors_found(rng, tmp_path, capsys):
    I = np.geomspace(1e-3, 0.2, 20)
    errors = 0.002 * (1 + 5 * I)
    mu = 0.26 + I + errors * rng.normal(size=20)
    table(tmp_path / "a.txt", {"number": I, "ratio": mu, "ratio_error": errors, "sigma": errors / 2})
    expected = ag.fit.mu_of_I(I, mu, errors)
    numbers = tmp_path / "J.json"
    code, _, _ = run(capsys, "mu_of_I", tmp_path / "a.txt", "--x", "number", "--y", "ratio", "--json", numbers)
    assert code == 0
    assert json.loads(numbers.read_text())["errors"] == pytest.approx(expected.errors, rel=1e-6)  # 12 digits in the file
    run(capsys, "mu_of_I", tmp_path / "a.txt", "--x", "number", "--y", "ratio", "--y-error", "sigma", "--json", numbers)
    half = json.loads(numbers.read_text())
    assert half["residuals"]["chi_square"] == pytest.approx(4.0 * expected.residuals["chi_square"], rel=1e-6)  # as above


def test_rows_are_made_of_others_where_a_file_has_only_these(rng, tmp_path, capsys):
    r = np.linspace(0.07, 0.11, 60)
    omega, errors = 0.05 * erf((r - 0.085) / 0.005) + 5e-4 * rng.normal(size=60), np.full(60, 5e-4)
    numbers, found = tmp_path / "J.json", []
    for rows in ({"r": r, "omega": omega, "omega_error": errors}, {"r": r, "v_phi": r * omega, "v_phi_error": r * errors}):
        run(capsys, "shear_band", table(tmp_path / "band.txt", rows), "--json", numbers)
        found.append(json.loads(numbers.read_text()))
    assert found[0]["residuals"]["chi_square"] == pytest.approx(found[1]["residuals"]["chi_square"], rel=1e-6)  # 12 digits in the file
    assert found[0]["residuals"]["chi_square"] == pytest.approx(60.0, rel=0.5)  # weighted: 56 expected, standard deviation 11


def test_tables_of_other_programs_are_read(tmp_path, capsys):
    rows = "0.001 0.261\n0.01 0.27\n0.05 0.311\n0.1 0.359\n0.02 0.28\n0.03 0.291\n0.04 0.3\n0.15 0.41\n0.07 0.33\n0.002 0.262\n"
    numbers = tmp_path / "J.json"
    found = []
    for name, text in {
        "plain.txt": "I mu\n" + rows,
        "savetxt.txt": "# I mu\n" + rows,
        "commas.csv": "\ufeffI [1], mu (1)\r\n" + rows.replace(" ", ", ").replace("\n", "\r\n"),
        "quoted.csv": '"I";"mu"\n' + rows.replace(" ", ";"),
        "empty.csv": "I\tmu\n" + rows.replace(" ", "\t") + "0.3\t\n",
    }.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
        code, _, error = run(capsys, "mu_of_I", tmp_path / name, "--json", numbers)
        assert code == 0, (name, error)
        found.append(json.loads(numbers.read_text()))
    assert all(one["values"] == found[0]["values"] for one in found)
    assert found[-1]["dropped"] == 1


def test_files_of_runs_are_one_data_set_and_files_of_curves_are_several(rng, tmp_path, capsys):
    p = np.array([100.0, 200.0, 300.0, 400.0, 500.0, 600.0])
    sigma_zz = peak_stress(p, 0.23, 40.0) + rng.normal(size=6)
    halves = [table(tmp_path / f"{k}.txt", {"p": p[k::2], "sigma_zz": sigma_zz[k::2]}) for k in (0, 1)]
    runs = [table(tmp_path / f"{at:g}.txt", {"sigma_zz": [value]}, {"p": at}) for at, value in zip(p, sigma_zz, strict=True)]
    numbers = tmp_path / "J.json"
    for files in (halves, runs):
        run(capsys, "mohr_coulomb", *files, "--json", numbers)
        values = json.loads(numbers.read_text())["values"]
        assert values["phi"] == pytest.approx(ag.fit.mohr_coulomb(p, sigma_zz).values["phi"], rel=1e-6)  # minimiser; 12 digits
    curves = [table(tmp_path / f"b{beta}.txt", evolution(rng, beta=beta)) for beta in (40.0, 80.0)]
    code, printed, _ = run(capsys, "relaxation", *curves, "--json", numbers)
    assert code == 0
    fits = json.loads(numbers.read_text())["fits"]
    assert [one["label"] for one in fits] == ["b40.0", "b80.0"]
    assert [one["values"]["beta"] for one in fits] == pytest.approx([40.0, 80.0], rel=0.1)  # noise
    assert printed.count("trustworthy") == 2


def test_the_peak_of_a_biaxial_run_is_a_point_of_the_yield_line(compressed, tmp_path, capsys):
    numbers, out = tmp_path / "J.json", tmp_path / "fit.h5"
    p = np.array([50.0, 150.0, 200.0, 300.0])
    other = table(tmp_path / "other.txt", {"p": p, "sigma_zz": 2.5 * p})
    code, _, _ = run(capsys, "mohr_coulomb", compressed, other, "--json", numbers, "--out", out)
    assert code == 5  # five points
    peak = ag.open(out)["curve-1"].to_dataset()
    series = ag.open(compressed)["series"].to_dataset()
    assert float(peak.x[0]) == 100.0
    assert 0.8 * float(series.sigma_zz.max()) < float(peak.y[0]) < float(series.sigma_zz.max())


def test_shared_parameters_are_fitted_at_once(rng, tmp_path, capsys):
    files = [
        table(tmp_path / f"p{p:g}-mu{mu:g}.txt", evolution(rng, s_max=s_max, beta=beta), {"p": p, "mu": mu})
        for mu, s_max in ((0.0, 0.25), (0.5, 0.45))
        for p, beta in ((100.0, 80.0), (500.0, 40.0))
    ]
    numbers, picture = tmp_path / "J.json", tmp_path / "fit.png"
    code, printed, error = run(capsys, "relaxation", *files, "--shared", "s_max=mu,beta=p", "--json", numbers, "--figure", picture)
    assert code == 0, error
    values = json.loads(numbers.read_text())["values"]
    assert values["s_max[mu=0]"] == pytest.approx(0.25, rel=0.02)  # noise
    assert values["beta[p=500]"] == pytest.approx(40.0, rel=0.05)  # noise
    assert len(values) == 4 + 2 + 2
    assert printed.startswith("data set")  # the table of parameter x data set comes first
    assert picture.stat().st_size > 10_000


def test_errors_come_in_three_steps(rng, tmp_path, capsys):
    rows = evolution(rng, points=80)
    path, numbers = table(tmp_path / "run.txt", rows), tmp_path / "J.json"
    found = {}
    for way in ("covariance", "profile", "bootstrap"):
        code, printed, error = run(capsys, "relaxation", path, "--errors", way, "--json", numbers)
        assert (code, error) == (0, "")
        found[way] = json.loads(numbers.read_text())
        low, high = found[way]["intervals_95"]["beta"]
        assert f"(95 %: {low:.5g} .. {high:.5g})" in printed
    assert found["profile"]["intervals_95"]["beta"] != found["covariance"]["intervals_95"]["beta"]
    assert found["bootstrap"]["errors"]["beta"] != found["covariance"]["errors"]["beta"]
    for way in ("profile", "bootstrap"):  # white noise, little curvature: they agree but for the 200 samples
        np.testing.assert_allclose(found[way]["intervals_95"]["beta"], found["covariance"]["intervals_95"]["beta"], rtol=0.05)


def test_the_scene_in_a_results_file_states_the_conditions(compressed, tmp_path):
    assert read_columns(compressed).conditions == {"p": 100.0, "k1": 5e4, "k2": 1e5, "kc": 0.0, "mu": 0.5}
    for scene in (ag.SimpleShear(friction=None), ag.Biaxial()):  # switched off in words, and left out
        save_results(tmp_path / "a.h5", {}, {"scene": scene_text(scene)})
        assert read_columns(tmp_path / "a.h5").conditions["mu"] == 0.0
    save_results(tmp_path / "b.h5", {}, {"scene": ""})
    assert read_columns(tmp_path / "b.h5").conditions == {}


def test_what_does_not_fit_is_one_line(rng, tmp_path, capsys, compressed):
    good = table(tmp_path / "good.txt", evolution(rng), {"p": 100})
    other = table(tmp_path / "other.txt", evolution(rng), {"p": 200})
    flow = table(tmp_path / "flow.txt", {"I": [-0.1, 0.2, 0.3], "mu": [0.3, 0.4, 0.5]})
    texts = {
        "word.txt": "eps_D s_D\n0.0 0.0\n0.1 x\n",
        "ragged.txt": "eps_D s_D\n0.0 0.0\n0.1\n",
        "bare.txt": "0.0 0.0\n0.1 0.1\n",
        "twice.txt": "eps_D eps_D\n0.0 0.0\n",
        "empty.txt": "# p = 100\n",
        "head.txt": "eps_D s_D\n",
    }
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "binary.txt").write_bytes(b"\xff\xfe\x00\x80")
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "results.h5").touch()
    save_results(tmp_path / "sweep.h5", {}, {"vary": "{}"})
    save_results(tmp_path / "rings.h5", {"blocks": xr.Dataset({"inertial_number": ("r", [0.1, 0.2])})}, {})
    save_results(tmp_path / "forged.h5", {}, {"scene": "{"})
    for arguments, message in [
        (["relaxatoin", good], "fit relaxatoin: must be one of relaxation, mohr_coulomb"),
        (["relaxation", tmp_path / "none.txt"], "none.txt: cannot be read as text (No such file or directory)"),
        (["relaxation", tmp_path / "none.h5"], "none.h5: cannot be read (No such file"),
        (["relaxation", tmp_path], "is a folder, not a file\n"),
        (["relaxation", tmp_path / "run"], f"is a folder, not a file; did you mean {tmp_path / 'run' / 'results.h5'}?"),
        (["relaxation", tmp_path / "sweep.h5"], "sweep.h5: holds all cases of a sweep; give the results.h5 in the folders"),
        (["relaxation", tmp_path / "forged.h5"], "forged.h5: its scene is no TOML"),
        (["relaxation", tmp_path / "binary.txt"], "binary.txt: cannot be read as text (not UTF-8)"),
        (["relaxation", tmp_path / "word.txt"], "word.txt: line 3: s_D = 'x' is not a number"),
        (["relaxation", tmp_path / "ragged.txt"], "ragged.txt: line 3: 1 fields for 2 columns (eps_D, s_D)"),
        (["relaxation", tmp_path / "bare.txt"], "bare.txt: line 1: the columns have no names"),
        (["relaxation", tmp_path / "twice.txt"], "twice.txt: 2 columns have the name 'eps_D'"),
        (["relaxation", tmp_path / "empty.txt"], "empty.txt: holds no table"),
        (["relaxation", tmp_path / "head.txt"], "head.txt: no numbers below the names eps_D, s_D"),
        (["relaxation", good, "--y", "s_d"], "good.txt: no column 's_d'; did you mean s_D?"),
        (["relaxation", good, "--y-error", "ds"], "good.txt: no column 'ds'"),
        (["mu_of_I", good], "good.txt: no column 'inertial_number'; there are eps_D, s_D"),
        (["mu_of_I", flow], "flow.txt: mu_of_I: I = -0.1 must be at least 0"),
        (["mu_of_I", tmp_path / "rings.h5"], "rings.h5: no column 'inertial_number'; did you mean blocks/inertial_number?"),
        (["relaxation", compressed, "--y", "series/s_DD"], "biaxial.h5: no column 'series/s_DD'; did you mean series/s_D?"),
        (["moduli", compressed, "--x", "eps_D"], "fit moduli: takes eps_V, eps_D, sigma_V, sigma_D; no --x"),
        (["relaxation", good, good], "good.txt: is given 2 times"),
        (["relaxation", good, "--json", tmp_path / "no" / "J.json"], "--json"),
        (["relaxation", good, "--json", good], "good.txt: is one of the files to be fitted"),
        (["relaxation", good, "--figure", tmp_path / "a.gif"], "must end in .png, .pdf or .svg"),
        (["relaxation", good, "--errors", "jackknife"], "--errors jackknife: must be one of covariance, profile, bootstrap"),
        (["moduli", compressed, "--errors", "bootstrap"], "bootstrap: not for moduli"),
        (["relaxation", good, other, "--shared", "s_max"], "--shared s_max: 's_max' must be PARAMETER=all"),
        (["relaxation", good, other, "--shared", "s_mx=all"], "shared parameter 's_mx' is unknown; did you mean 's_max'?"),
        (["relaxation", good, other, "--shared", "s_max=kc"], "s_max is shared by 'kc', which data set 'good' does not state"),
        (["moduli", compressed, "--shared", "E=all"], "fit moduli: has no parameters to share; --shared is for relaxation, mohr_coulomb"),
        (["relaxation", good, "--law", "scalar"], "fit relaxation: takes no --law and no --fixed"),
        (["law", compressed], "fit law: --law must be one of scalar, tensorial"),
        (["law", compressed, "--law", "scalr"], "calibrate: law = 'scalr'; did you mean 'scalar'"),
        (["law", compressed, "--law", "scalar", "--x", "eps_D"], "fit law: takes paths; no --x or --y-error"),
        (["law", compressed, "--law", "scalar", "--y", "s_D"], "biaxial.h5: --y s_D: must be among sigma_zz, eps_V"),
        (["law", compressed, "--law", "scalar", "--fixed", "E"], "--fixed E: 'E' must be PARAMETER=NUMBER"),
        (["law", good, "--law", "scalar"], "good.txt: no column 'eps_zz'"),
        (["relaxation"], "Missing argument 'files'"),
    ]:
        code, printed, error = run(capsys, *arguments)
        assert code == 2, (arguments, printed, error)
        assert message in error
        assert error.count("\n") == 1
        assert printed == ""
