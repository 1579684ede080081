"""`anisogran run` in trouble: no cache, no home, interrupted before it has begun, damaged files, folders at work."""

import os
import signal
import subprocess
import sys
import time

import pytest

from anisogran import SimpleShear, read_scene
from anisogran.outcome import Interrupted
from anisogran.runs.folder import run_in_folder, state_of
from anisogran.runs.lock import locked

SCENE = SimpleShear(inertial_number=0.2, n=60, strain=0.6, discard=0.1, frames=2)
TEXT = 'kind = "simple_shear"\ninertial_number = 0.2\nn = 60\nstrain = 0.6\ndiscard = 0.1\nframes = 2\n'


@pytest.fixture
def call(tmp_path, monkeypatch):
    """The command line in another process, in a folder that has scene.toml, with some of the environment changed."""
    (tmp_path / "scene.toml").write_text(TEXT)

    def start(*arguments, **changes):
        environment = {key: value for key, value in {**os.environ, **changes}.items() if value is not None}
        command = [sys.executable, "-m", "anisogran", *map(str, arguments)]
        return subprocess.Popen(command, text=True, stdout=-1, stderr=-1, cwd=tmp_path, env=environment)

    return start


def wait_until(condition, child):
    end = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < end
        assert child.poll() is None, child.communicate()
        time.sleep(0.01)


def test_neither_home_nor_cache_and_an_interrupt_while_it_compiles(call, tmp_path):
    """One line says that kernels are compiled anew; Ctrl-C is heard while they are, and the run can go on."""
    nowhere = str(tmp_path / "scene.toml" / "home")  # also for root no folder can be made there
    child = call("run", "scene.toml", "--out", "run", HOME=nowhere, NUMBA_CACHE_DIR=None, XDG_CACHE_HOME=None)
    wait_until((tmp_path / "run" / "state.json").exists, child)
    time.sleep(0.3)
    clock = time.monotonic()
    child.send_signal(signal.SIGINT)
    _, err = child.communicate(timeout=60)
    assert child.returncode == 130, err
    assert time.monotonic() - clock < 10
    *warnings, last = err.splitlines()
    assert last == "anisogran: interrupted in stage prepare, 0% done; run holds the run"
    for line in warnings:
        assert line.startswith(f"anisogran: warning: {nowhere}/.cache/anisogran/")
        assert line.endswith(" cannot be written (Not a directory): kernels are compiled anew in every process")
    assert warnings
    assert state_of(tmp_path / "run")["state"] == "interrupted"
    assert run_in_folder(read_scene(tmp_path / "run" / "scene.toml"), tmp_path / "run", resume=True).scene == SCENE


@pytest.mark.parametrize("delay", [0.15, 0.3, 0.6, 1.0])
def test_ended_while_it_is_imported(delay, call, tmp_path):
    """SIGTERM at any moment before the run begins leaves no folder, or one from which it goes on; one line, never a traceback."""
    child = call("run", "scene.toml", "--out", "run")
    time.sleep(delay)
    child.send_signal(signal.SIGTERM)
    _, err = child.communicate(timeout=60)
    # before there is a handler the system ends it; where Python was making a class, it ends itself by SIGINT, which a shell tells as 130
    assert child.returncode in (-signal.SIGTERM, 130, -signal.SIGINT, 0)
    assert "Traceback" not in err
    if child.returncode in (130, -signal.SIGINT):
        assert err.splitlines()[-1].startswith("anisogran: interrupted")
    if (tmp_path / "run").exists() and os.listdir(tmp_path / "run"):
        assert state_of(tmp_path / "run")["state"] in ("interrupted", "finished")


def test_a_damaged_checkpoint_is_one_line_of_warning(call, tmp_path):
    """What is lost and what is taken instead; no line of our sources."""

    def leave(session):
        if len(session.records.rows) == 8:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted):
        run_in_folder(SCENE, tmp_path / "run", listen=leave, every=0.0)
    (tmp_path / "run" / "checkpoint.npz").write_bytes(b"nothing")
    child = call("run", "--out", "run", "--resume")
    _, err = child.communicate(timeout=60)
    assert child.returncode == 0
    warning, *rest = err.splitlines()
    assert warning.startswith("anisogran: warning: run/checkpoint.npz: has no seal at its end; ")
    assert "; going on from run/checkpoint.npz.previous, step " in warning
    assert [line.split()[0] for line in rest] == ["stage"] * len(rest)


def test_a_folder_at_work_is_left_alone_even_by_force(call, tmp_path):
    """Another scene is not written over the one that is being run there."""
    with pytest.raises(Interrupted):
        run_in_folder(SCENE, tmp_path / "run", listen=lambda session: os.kill(os.getpid(), signal.SIGINT))
    before = {path.name: path.read_bytes() for path in (tmp_path / "run").iterdir()}
    with locked(tmp_path / "run"):
        child = call("run", "scene.toml", "--set", "seed=7", "--out", "run", "--force")
        _, err = child.communicate(timeout=60)
    assert child.returncode == 2
    assert err.startswith(f"anisogran: run: process {os.getpid()} on ")
    assert {path.name: path.read_bytes() for path in (tmp_path / "run").iterdir()} == before


def test_what_will_be_is_told_before_it_is(call, tmp_path):
    """Into a file too, where Python would keep it until the end."""
    child = call("run", "scene.toml", "--set", "strain=500", "--out", "run")
    assert child.stdout.readline().startswith("simple_shear: 60 grains, seed 0, in run")
    assert child.poll() is None
    child.send_signal(signal.SIGTERM)
    child.communicate(timeout=60)


def test_a_run_begun_from_python_goes_on_from_the_command_line(call, tmp_path):
    with pytest.raises(Interrupted):
        run_in_folder(SCENE, tmp_path / "run", listen=lambda session: os.kill(os.getpid(), signal.SIGINT))
    child = call("run", "--out", "run", "--resume")
    out, err = child.communicate(timeout=60)
    assert child.returncode == 0, err
    assert "30 rows" in out
