"""Mistakes get one line and exit code 2, and nothing is written."""

import os
import subprocess
import sys

import pytest

from anisogran import __version__, cli
from anisogran.outcome import InputError, Interrupted, NotConverged, RunFailed


def run(capsys, *arguments):
    with pytest.raises(SystemExit) as end:
        cli.main(list(arguments))
    captured = capsys.readouterr()
    return end.value.code, captured.out, captured.err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["demo", "--seed", "abc"], "'--seed'"),
        (["demo", "--seed", "-3"], "'--seed'"),
        (["demo", "--sed", "3"], "--sed"),
        (["demo", "extra"], "extra"),
        (["nonsense"], "nonsense"),
        (["demo", "--out", "file.txt"], "--out file.txt: is not a folder"),
        (["demo", "--out", "full"], "--out full: the folder is not empty; choose another or add --force"),
        (["demo", "--out", "file.txt/below"], "--out file.txt/below: cannot be written (Not a directory)"),
        (["demo", "--json", "nowhere/numbers.json"], "--json nowhere/numbers.json: cannot be written (No such file or directory)"),
        (["demo", "--out", ""], "--out: name a folder of its own"),
        (["demo", "--json", "full"], "--json full: is a folder"),
    ],
)
def test_bad_input_is_one_line(arguments, message, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file.txt").write_text("mine")
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "thing").write_text("mine")
    code, out, err = run(capsys, *arguments)
    assert code == 2
    assert err.startswith("anisogran: ")
    assert err.count("\n") == 1
    assert message in err
    assert not out
    assert sorted(p.name for p in tmp_path.rglob("*")) == ["file.txt", "full", "thing"]
    assert (tmp_path / "file.txt").read_text() == "mine"


@pytest.mark.skipif(os.geteuid() == 0 if hasattr(os, "geteuid") else True, reason="root may write anywhere")
def test_read_only_folder_is_refused(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "locked").mkdir(mode=0o500)
    code, _, err = run(capsys, "demo", "--out", "locked/below")
    assert code == 2
    assert "cannot be written (Permission denied)" in err


@pytest.mark.parametrize(
    ("error", "code"),
    [(InputError("a\nb"), 2), (RunFailed("x"), 3), (NotConverged("x"), 4), (Interrupted("x"), 130), (KeyboardInterrupt(), 130)],
)
def test_every_outcome_has_its_exit_code(error, code, monkeypatch, capsys):
    def fail(**_):
        raise error

    monkeypatch.setattr(cli.application, "app", fail)
    given, _, err = run(capsys, "demo")
    assert given == code
    assert err.count("\n") == 1


def test_what_is_no_mistake_of_the_user_is_not_hidden(monkeypatch):
    def fail(**_):
        raise TypeError("a bug")

    monkeypatch.setattr(cli.application, "app", fail)
    with pytest.raises(TypeError, match="a bug"):
        cli.main(["demo"])


def test_a_failed_run_leaves_no_empty_folder(tmp_path, monkeypatch, capsys):
    def fail(*_):
        raise RunFailed("stopped at step 3")

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(cli.demo_command, "run_and_report", fail)
    code, _, err = run(capsys, "demo")
    assert (code, err) == (3, "anisogran: stopped at step 3\n")
    assert list(tmp_path.iterdir()) == []


def test_an_interrupt_says_that_nothing_was_written(tmp_path, monkeypatch, capsys):
    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(cli.demo_command, "run_and_report", interrupt)
    code, _, err = run(capsys, "demo")
    assert (code, err) == (130, "anisogran: interrupted; nothing was written\n")
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_not_empty_is_used_if_forced(tmp_path, monkeypatch, capsys):
    def fail(*_):
        raise RunFailed("x")

    monkeypatch.setattr(cli.demo_command, "run_and_report", fail)
    (tmp_path / "thing").write_text("mine")
    assert run(capsys, "demo", "--out", str(tmp_path))[0] == 2
    assert run(capsys, "demo", "--out", str(tmp_path), "--force")[0] == 3  # it got as far as the run
    assert (tmp_path / "thing").read_text() == "mine"


def test_numbered_folders_count_up(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "demo-001").write_text("a file in the way")
    assert cli.numbered_folder("demo").name == "demo-002"
    assert cli.numbered_folder("demo").name == "demo-003"


def test_version_and_module(capsys):
    assert run(capsys, "--version")[:2] == (0, f"anisogran {__version__}\n")
    done = subprocess.run([sys.executable, "-m", "anisogran", "--version"], capture_output=True, text=True, check=True)
    assert done.stdout == f"anisogran {__version__}\n"


def test_help_is_light_and_is_what_a_bare_call_shows():
    code = "import sys; from anisogran.cli import main\ntry: main([])\nexcept SystemExit as end: code = end.code\nprint(code, *sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    text, loaded = done.stdout.rsplit("\n", 2)[0], done.stdout.splitlines()[-1].split()
    assert "demo" in text
    assert loaded[0] == "0"
    assert not {"numpy", "numba", "lmfit", "xarray", "matplotlib"} & set(loaded)
