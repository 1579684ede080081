"""`anisogran run`: what it says, what it leaves, and how it ends."""

import json
import os
import signal
import tomllib

import pytest

from anisogran import SimpleShear, cli, read_scene
from anisogran import open as open_results
from anisogran.runs import estimates
from anisogran.runs import folder as run_folder
from anisogran.runs.folder import state_of

SCENE = """
kind = "simple_shear"
inertial_number = 0.2
n = 100
strain = 0.6
discard = 0.1
frames = 2

[quick]
n = 60
"""


@pytest.fixture
def call(tmp_path, monkeypatch, capsys):
    """The command line in a folder of its own that has scene.toml; gives (exit code, stdout, stderr)."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scene.toml").write_text(SCENE)

    def run(*arguments):
        with pytest.raises(SystemExit) as end:
            cli.main(["run", *map(str, arguments)])
        captured = capsys.readouterr()
        return end.value.code, captured.out, captured.err

    return run


def test_a_run_from_a_file(call, tmp_path):
    """What it will take, its stages with what is active and absent, and how it ended; the folder holds scene, results and checkpoint."""
    code, out, err = call("scene.toml", "--quick", "--set", "friction.mu=0.3", "--set", "seed=5", "--json", "run.json")
    assert code == 0
    begin, cost, end, last = out.splitlines()[:4]
    assert begin == "simple_shear: 60 grains, seed 5, in simple_shear-001"
    assert cost.startswith(
        "stages: prepare, relax, shear; about 4 million grain-steps, 1 s at 50 million a second on one core; about 0.3 GB"
    )
    assert end.startswith("simple_shear-001/results.h5: 30 rows, 3 snapshots; ")
    assert last.startswith("at the end: strain 0.596")
    stages = [line for line in err.splitlines() if line.startswith("stage ")]
    assert [line.split(":")[0] for line in stages] == ["stage prepare", "stage relax", "stage shear"]
    assert stages[0].endswith("absent: friction, rolling, gravity, wall_friction")
    assert "friction: Friction(stiffness=500.0, mu=0.3" in stages[2]
    assert stages[2].endswith("absent: rolling, gravity, wall_friction, drag")
    folder = tmp_path / "simple_shear-001"
    assert sorted(path.name for path in folder.iterdir()) == ["checkpoint.npz", "results.h5", "scene.toml", "state.json"]
    scene = read_scene(folder / "scene.toml")
    assert (scene.n, scene.friction.mu, scene.seed) == (60, 0.3, 5)
    tree, numbers = open_results(folder / "results.h5"), json.loads((tmp_path / "run.json").read_text())
    assert tomllib.loads(tree.attrs["scene"]) == tomllib.loads((folder / "scene.toml").read_text())
    assert numbers["last"]["strain"] == float(tree["series"].strain[-1])
    assert numbers["status"]["level"] in ("ok", "warned")
    assert numbers["provenance"]["grain_steps"] == tree.attrs["grain_steps"] > 0
    for name in ("commit", "sources", "numpy", "dt"):
        assert tree.attrs[name]


def test_a_run_is_interrupted_and_goes_on(call, tmp_path, monkeypatch):
    """130 and one line; --resume needs no scene, and leaves what the straight run leaves; once more it has nothing to do."""
    hear = run_folder.Keeper.hear

    def interrupted(self, stop, listen):
        if len(self.session.records.rows) == 8:
            os.kill(os.getpid(), signal.SIGTERM)
        hear(self, stop, listen)

    with monkeypatch.context() as patch:
        patch.setattr(run_folder.Keeper, "hear", interrupted)
        code, _, err = call("scene.toml", "--out", "run")
    assert code == 130
    assert err.splitlines()[-1].startswith("anisogran: interrupted in stage shear, ")
    assert err.splitlines()[-1].endswith("% done; run holds the run")
    assert call("--out", "run", "--resume")[0] == 0
    assert state_of(tmp_path / "run")["state"] == "finished"
    written = (tmp_path / "run" / "results.h5").stat().st_mtime_ns
    code, out, err = call("scene.toml", "--out", "run", "--resume")
    assert (code, err) == (0, "")
    assert "30 rows" in out
    assert (tmp_path / "run" / "results.h5").stat().st_mtime_ns == written
    assert call("scene.toml", "--out", "straight")[0] == 0
    resumed, straight = (open_results(tmp_path / name / "results.h5")["series"].to_dataset() for name in ("run", "straight"))
    assert resumed.identical(straight)


@pytest.mark.hard_case("S6")
def test_a_folder_in_use_is_kept(call, tmp_path, answer):
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "thing").write_text("mine")
    code, out, err = call("scene.toml", "--quick", "--out", "run")
    assert (code, out) == (2, "")
    answer.refused(err.removeprefix("anisogran: "))
    assert err == "anisogran: --out run: the folder is not empty; choose another or add --force\n"
    assert call("scene.toml", "--quick", "--out", "run", "--force")[0] == 0
    assert (tmp_path / "run" / "thing").read_text() == "mine"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "run: SCENE is missing; `anisogran new biaxial > scene.toml` writes one"),
        (["nothing.toml"], "nothing.toml: cannot be read (No such file or directory)"),
        (["scene.toml", "--set", "sede=5"], "--set sede=5: unknown key 'sede', did you mean 'seed'?"),
        (["scene.toml", "--set", "friction.mu=-1"], "--set friction.mu=-1: [friction] mu = -1 must be at least 0"),
        (["scene.toml", "--resume"], "run: --resume needs the folder of the run, --out FOLDER"),
        (["scene.toml", "--resume", "--out", "nowhere"], "--out nowhere: there is no such folder to resume"),
        (["--resume", "--out", "empty"], "empty/scene.toml: cannot be read (No such file or directory)"),
        (["scene.toml", "--resume", "--force", "--out", "empty"], "run: --resume goes on and --force begins anew; give one of them"),
        (["scene.toml", "--json", "nowhere/x.json"], "--json nowhere/x.json: cannot be written (No such file or directory)"),
        (["scene.toml", "--out", "scene.toml"], "--out scene.toml: is not a folder"),
        (["scene.toml", "--set", "n=10000000"], "simple_shear: n = 10000000 take about"),
    ],
)
def test_mistakes_are_one_line_and_leave_nothing(arguments, message, call, tmp_path, monkeypatch):
    monkeypatch.setattr(estimates, "free_memory", lambda: 4e9)
    (tmp_path / "empty").mkdir()
    code, out, err = call(*arguments)
    assert (code, out) == (2, "")
    assert err.startswith(f"anisogran: {message}")
    assert err.count("\n") == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["empty", "scene.toml"]


def test_a_run_that_never_began_leaves_no_folder(call, tmp_path, monkeypatch):
    """Interrupted while it is told what will be."""

    def interrupted(*arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr("anisogran.cli.run_display.opening", interrupted)
    assert call("scene.toml", "--out", "run") == (130, "", "anisogran: interrupted\n")
    assert [path.name for path in tmp_path.iterdir()] == ["scene.toml"]


def test_a_refused_stage_is_a_failed_run(call, tmp_path, monkeypatch):
    """Exit code 3, the name of the stage, and nothing that could be taken for a result."""
    monkeypatch.setattr("anisogran.experiments.simple_shear.ATTEMPTS", 1)
    code, _, err = call("scene.toml", "--quick", "--out", "run")
    assert code == 3
    assert err.splitlines()[-1].startswith("anisogran: stage relax: no equilibrium after ")
    assert state_of(tmp_path / "run")["state"] == "failed"
    assert not (tmp_path / "run" / "results.h5").exists()


def test_an_implausible_scene_is_warned_of(call):
    """A stiffness in N/mm is a thousand times too soft; it runs, but the user is told before it starts."""
    (text, *_) = [line for line in call("scene.toml", "--quick", "--set", "contact.stiffness=50")[1].splitlines() if "warning" in line]
    assert "stiffness" in text


def test_a_run_says_how_it_is_where_there_is_no_terminal(call, monkeypatch):
    monkeypatch.setattr("anisogran.cli.run_display.PLAIN_EVERY", 0.0)
    monkeypatch.setattr("anisogran.cli.run_display.FIGURES_EVERY", 0.0)
    _, _, err = call("scene.toml", "--quick")
    (line, *_) = [line for line in err.splitlines() if line.startswith("shear ")]
    for word in ("%", "million grain-steps/s", "I 2.0e-01", "unbalanced ", "E_kin "):
        assert word in line


def test_the_same_from_python(tmp_path):
    """The front door: a scene is run in a folder by its own method."""
    scene = SimpleShear(inertial_number=0.2, n=60, strain=0.6, discard=0.1, frames=2)
    seen = []
    run = scene.run(folder=tmp_path / "run", progress=seen.append)
    assert seen[-1] == 1.0
    assert state_of(tmp_path / "run")["state"] == "finished"
    assert open_results(tmp_path / "run" / "results.h5")["series"].to_dataset().equals(run.series)
