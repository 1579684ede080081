"""Every script in data_generation/ and fits/ runs in its small version and gives numbers of the right size."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import anisogran as ag
from scripts import script

ROOT = Path(__file__).parents[1]


def test_biaxial_evolution(tmp_path, capsys):
    path = str(tmp_path / "biaxial.h5")
    script(ROOT / "data_generation" / "biaxial.py").main([path, "--quick"])
    fits = script(ROOT / "fits" / "biaxial_evolution.py").main(path)
    assert 0.3 < fits["s_D"].values["s_max"] < 0.55
    assert fits["s_D"].values["beta"] > fits["anisotropy"].values["beta"] > 0  # structure lags behind stress


def test_biaxial_pictures(tmp_path):
    path, picture = str(tmp_path / "biaxial.h5"), tmp_path / "pictures.png"
    script(ROOT / "data_generation" / "biaxial.py").main([path, "--quick"])
    titles = script(ROOT / "fits" / "biaxial_pictures.py").main(path, str(picture))
    assert [re.search(r"[\d.]+ %", title).group() for title in titles] == ["0.0 %", "1.1 %", "4.2 %"]  # the quick run ends at 6 %
    assert picture.stat().st_size > 50_000


def test_biaxial_calibration(tmp_path, capsys):
    path = str(tmp_path / "biaxial.h5")
    script(ROOT / "data_generation" / "biaxial.py").main([path, "--quick"])
    fit = script(ROOT / "fits" / "biaxial_calibration.py").main("scalar", path)
    assert 0.3 < fit.values["s_max"] < 0.55
    assert fit.tests[path].status
    assert "sigma_zz: rms" in capsys.readouterr().out


STUDIES = (
    "biaxial_cohesion", "biaxial_friction", "biaxial_pressure", "biaxial_density", "biaxial_cycles", "simple_shear", "ring_friction_law",
    "ring_reference", "ring_paper", "ring_lecture",
)  # fmt: skip


@pytest.mark.parametrize("name", STUDIES)
def test_a_study_makes_one_file_and_does_nothing_twice(tmp_path, name):
    path = tmp_path / f"{name}.h5"
    made = script(ROOT / "data_generation" / f"{name}.py").main([str(path), "--quick"])
    states = [str(state) for group in made.children for state in made[f"{group}/cases"].state.values.ravel()]
    assert states
    assert set(states) == {"finished"}
    begun = {file: file.stat().st_mtime_ns for file in (tmp_path / name).rglob("results.h5")}
    assert len(begun) == len(states)
    script(ROOT / "data_generation" / f"{name}.py").main([str(path), "--quick"])
    assert {file: file.stat().st_mtime_ns for file in begun} == begun
    kept = ag.open(path)
    assert kept.attrs["sources"]
    for group in made.children:
        assert 'kind = "' in kept[f"{group}/cases"].attrs["scene"]
        series = kept[f"{group}/series"].to_dataset()
        assert series.equals(made[f"{group}/series"].to_dataset())
        assert all(values.dtype == np.float32 and np.isfinite(values).all() for values in series.data_vars.values())


def test_ring_rotations(tmp_path, capsys):
    path, picture = tmp_path / "ring.h5", tmp_path / "rotations.png"
    ag.RingShear(n=250, inner_radius=4.0, travel=10.0, discard=2.0, block=2.0, seed=1).run().save(path)
    found = script(ROOT / "fits" / "ring_rotations.py").main(path, picture)
    assert list(found) == ["ring"]
    assert found["ring"][0].share < 3e-3  # the stress of grains is symmetric
    assert not found["ring"][1].verdict  # four blocks tell no length
    assert "not determined" in capsys.readouterr().out
    assert picture.stat().st_size > 10_000


def test_tablet_strength(tmp_path, capsys):
    path, picture = str(tmp_path / "strength.h5"), tmp_path / "strength.png"
    script(ROOT / "data_generation" / "tablet_strength.py").main([path, "--quick"])
    found, laws = script(ROOT / "fits" / "tablet_strength.py").main(path, str(picture))
    assert (found > 0).all()
    assert (found.sel(contact_kc=4e5) > found.sel(contact_kc=5e4)).all()
    assert (found.sel(pressing_pressure=200) > found.sel(pressing_pressure=50)).all()
    assert laws["compression"][0] > laws["tension"][0] > 0.2
    assert "crushed over torn" in capsys.readouterr().out
    assert picture.stat().st_size > 10_000


def test_tablet_vibration(tmp_path, capsys):
    path, picture = str(tmp_path / "vibration.h5"), tmp_path / "vibration.png"
    script(ROOT / "data_generation" / "tablet_vibration.py").main([path, "--quick"])
    shares = script(ROOT / "fits" / "tablet_vibration.py").main(path, str(picture))
    assert shares[100.0][0] > 0.8 > 0.5 > shares[10.0][0]  # 60 grains, three periods: the one holds together, the other does not
    assert "held together" in capsys.readouterr().out
    assert picture.stat().st_size > 10_000


def test_cohesive_gas(tmp_path, capsys):
    path, picture = str(tmp_path / "gas.h5"), tmp_path / "gas.png"
    script(ROOT / "data_generation" / "cohesive_gas.py").main([path, "--quick"])
    ends = script(ROOT / "fits" / "cohesive_gas.py").main(path, str(picture))
    assert ends[0.0][0] > 90  # of 100 grains
    assert ends[4.0][0] < 30
    assert "Haff" in capsys.readouterr().out
    assert picture.stat().st_size > 10_000


def test_stiffness(tmp_path, capsys):
    path = str(tmp_path / "stiffness.h5")
    script(ROOT / "data_generation" / "stiffness.py").main([path, "--quick"])
    exponents = script(ROOT / "fits" / "stiffness.py").main(path, str(tmp_path / "stiffness.png"))
    assert exponents["E, mu = 0.5"][0] == pytest.approx(0.06, abs=0.06)  # linear springs: only the number of contacts grows
    assert (tmp_path / "stiffness.png").stat().st_size > 50_000
    data = ag.open(path)["rough"].to_dataset().isel(state=0)
    for name in ("E", "B", "G"):  # Voigt's bound
        assert (data[name].sel(source="back") < data[name].sel(source="fabric")).all()
    assert "Shear modulus against fabric, mu = 0.5" in capsys.readouterr().out


def test_stiffness_of_the_full_run(capsys):
    """The shipped data: grains with friction stiffen with pressure as their contacts do, those without far more in shear."""
    exponents = script(ROOT / "fits" / "stiffness.py").main(str(ROOT / "fits" / "data" / "stiffness.h5"))
    assert exponents["E, mu = 0.5"][0] < 0.1
    assert exponents["G, mu = 0"][0] > exponents["G, mu = 0.5"][0] + 3 * exponents["G, mu = 0"][1]
    assert "E B < A^2 in 0 of 18 states" in capsys.readouterr().out


def test_contact_law(tmp_path, capsys):
    adhesive, growing = script(ROOT / "fits" / "contact_law.py").main(str(tmp_path / "law.png"))
    assert (tmp_path / "law.png").stat().st_size > 10_000
    for ratio, path in adhesive.items():  # f_min of the lecture: -(1 - k1/k2)/(1 + k2/kc) k2 delta_max
        assert path.f_min == pytest.approx(-0.5 * ratio / (1 + ratio), rel=1e-12)
    assert [path.stiffness for path in growing.values()] == pytest.approx([6.25e4, 7.5e4, 8.75e4, 1e5, 1e5])
    assert "kc/k2 = 4     10.000      5.000      1.000    -0.4000" in capsys.readouterr().out


def test_accuracy_cost(tmp_path, capsys):
    """One room anew in a file, the others are kept; tables and picture of what is there."""
    path, picture, readme = (tmp_path / name for name in ("cost.json", "cost.png", "README.md"))
    make, show = script(ROOT / "data_generation" / "accuracy_cost.py"), script(ROOT / "fits" / "accuracy_cost.py")
    shipped = json.loads(show.DATA.read_text())
    shipped["about"]["processor"] = make.processor()
    path.write_text(json.dumps(shipped))
    made = make.main([str(path), "averaging", "--quick"])
    written = json.loads(path.read_text())
    assert written["about"]["quick"]
    assert written["averaging"] == made["averaging"] != shipped["averaging"]
    assert written["models"] == shipped["models"]
    readme.write_text(f"before\n{show.BEGIN}\nold\n{show.END}\nafter\n")
    text = show.main([str(path), str(picture), "--readme", str(readme)])
    assert readme.read_text() == f"before\n{show.BEGIN}\n{text}\n{show.END}\nafter\n"
    assert "| snapshots of a run | scatter of s_D | 1: " in capsys.readouterr().out
    assert picture.stat().st_size > 10_000
    shipped["about"]["processor"] = "abacus"
    path.write_text(json.dumps(shipped))
    with pytest.raises(ag.InputError, match="was made on abacus"):
        make.main([str(path), "averaging", "--quick"])
    with pytest.raises(ag.InputError, match="room = kitchen: must be one of dem, "):
        make.main([str(path), "kitchen"])
    readme.write_text("no marks")
    with pytest.raises(ag.InputError, match="has no lines"):
        show.put_into(str(readme), "text")


def test_the_tables_of_the_readme_are_those_of_the_shipped_data():
    """Of a full run, with the defaults of today."""
    show = script(ROOT / "fits" / "accuracy_cost.py")
    data = json.loads(show.DATA.read_text())
    assert not data["about"]["quick"]
    assert f"{show.BEGIN}\n{show.text_of(data)}\n{show.END}" in (ROOT / "README.md").read_text()
    assert "(fits/accuracy_cost.png)" in (ROOT / "README.md").read_text()
    assert (ROOT / "fits" / "accuracy_cost.png").stat().st_size < 150_000
    [floor] = [row["value"] for row in show.shown("continuum", data["continuum"])["rate floor, local"] if row["default"]]
    assert floor == ag.continuum.LocalMuI.floor
    [grains] = [row["value"] for row in show.shown("dem", data["dem"])["grains: mu"] if row["default"]]
    assert grains == ag.SimpleShear().n


def test_code_of_the_readme_runs(tmp_path, monkeypatch):
    """As printed, only on fewer grains."""
    monkeypatch.chdir(tmp_path)
    script(ROOT / "data_generation" / "biaxial.py").main(["biaxial.h5", "--quick"])
    text = (ROOT / "README.md").read_text()
    smaller = {"travel=100.0": "n=250, inner_radius=4.0, travel=6.0, discard=2.0, block=1.0", "n=500": "n=60"}
    assert all(text.count(words) == 1 for words in smaller)
    for words, fewer in smaller.items():
        text = text.replace(words, fewer)
    names = {}
    blocks = re.findall(r"```python\n(.*?)```", text, re.S)
    assert len(blocks) == 3
    for block in blocks:
        exec(block, names)
    assert 0.3 < names["fit"].values["s_max"] < 0.55  # of 150 grains; whether it may be trusted depends on the last bits
    assert names["sim"].step == 1000
    assert (tmp_path / "cohesion.h5").exists()


def test_commands_of_the_readme_run(tmp_path):
    """Scene, run, resume, sweep and collection as printed."""
    (block,) = (part for part in re.findall(r"```sh\n(.*?)```", (ROOT / "README.md").read_text(), re.S) if "anisogran new" in part)
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    subprocess.run(["bash", "-e", "-c", block], cwd=tmp_path, env={**os.environ, "PATH": path}, check=True, capture_output=True)
    collected = ag.open(tmp_path / "cohesion" / "collected.h5")
    assert collected["series"].sizes == {"contact_kc": 3, "seed": 2, "sample": 101}
    assert (collected["cases"].state == "finished").all()
    assert ag.open(tmp_path / "box" / "results.h5").attrs["status"] == "ok"


def test_ci_runs_the_test_command_of_the_readme():
    """.ci/run takes the first line of the README that names the environment of the tests."""
    (line,) = (line for line in (ROOT / "README.md").read_text().splitlines() if "venv-test" in line)
    assert line.startswith("python3 -m venv .venv-test && ")
    assert line.endswith(".venv-test/bin/pytest")
    assert "grep -m1 'venv-test' README.md" in (ROOT / ".ci" / "run").read_text()


def test_every_script_is_tested():
    tests = (
        Path(__file__),
        Path(__file__).with_name("test_lecture_figures.py"),
        Path(__file__).with_name("test_ring_figures.py"),
        Path(__file__).with_name("test_whole_way.py"),
        Path(__file__).parent / "fitting" / "test_lecture_cohesion.py",
    )
    here = "".join(path.read_text() for path in tests)
    for path in [*(ROOT / "data_generation").glob("*.py"), *(ROOT / "fits").glob("*.py")]:
        assert path.name in here or path.stem in here, f"{path.name} is not tested"


def test_fit_coverage(tmp_path, capsys):
    path = tmp_path / "coverage.h5"
    rows, sizes = script(ROOT / "data_generation" / "fit_coverage.py").main([str(path), "--quick"])
    assert len(rows) == 12  # two noises, two kinds of fit, three ways
    assert all(0.0 <= lowest <= highest <= 1.0 and trusted > 0.5 for lowest, highest, trusted, _ in rows.values())
    assert np.mean([highest for _, highest, _, _ in rows.values()]) > 0.9  # 4 trials of 95 %, the best of the parameters
    assert list(sizes) == [50, 100]
    assert path.stat().st_size > 1000
    assert "remembering  three share beta" in capsys.readouterr().out
