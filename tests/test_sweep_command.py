"""`anisogran sweep`: its words, its exit codes, and what is left when processes are killed or interrupted."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import anisogran as ag
from anisogran import cli
from anisogran.experiments import read_scene
from anisogran.outcome import Interrupted
from anisogran.runs.lock import is_locked
from anisogran.scenes import changed
from anisogran.sweeps.folder import fraction_of

TEXT = 'kind = "simple_shear"\ninertial_number = 0.2\nn = 60\nstrain = 0.6\ndiscard = 0.05\nframes = 0\n[quick]\nstrain = 0.55\n'
WAIT = 60.0  # s, for a machine that is busy
LONG = ("--set", "strain=8")  # work enough to be killed in, little enough to be done again
ENDLESS = ("--set", "strain=80")  # what is interrupted for good: however busy the machine, it is still at work


def run(capsys, *arguments):
    before = signal.getsignal(signal.SIGTERM)
    try:
        with pytest.raises(SystemExit) as end:
            cli.main(["sweep", *map(str, arguments)])
    finally:
        signal.signal(signal.SIGTERM, before)
    captured = capsys.readouterr()
    return end.value.code, captured.out, captured.err


def started(folder, *arguments):
    """The command in a process of its own, in a session of its own as in a terminal."""
    command = [sys.executable, "-m", "anisogran", "sweep", "s.toml", "--out", "s", *arguments]
    return subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)


def until(true):
    """Waits until something is true."""
    end = time.monotonic() + WAIT
    while not true():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.02)


def at_work(folder):
    """{name: process} of the cases whose first stage is done and saved."""
    found = {}
    for path in folder.glob("s/*/lock"):
        holder = re.match(r"process (\d+) on", path.read_text()) if fraction_of(path.parent) else None
        if holder:
            found[path.parent.name] = int(holder[1])
    return found


def is_alive(process):
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    return Path(f"/proc/{process}/stat").read_text().split(") ")[1][0] != "Z" if Path("/proc/self/stat").exists() else True


def states(folder):
    return [one["state"] for one in ag.sweep_status(folder / "s")]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "s.toml").write_text(TEXT)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_from_scene_to_collected_file(folder, capsys):
    """In a numbered folder, with what stands in [quick]; the group takes commands and scenes for what they are."""
    arguments = ["s.toml", "--vary", "seed=1,2", "--quick", "--set", "pressure=2", "--workers", "1", "--json", "a.json"]
    arguments += ["--set", "contact.stiffness=100"]
    code, out, err = run(capsys, *arguments)
    assert code == 0, err
    assert "2 cases in sweep-001 on 1 worker" in out
    assert out.count("warning: contact.stiffness = 100 N/m is 50 times the pressure of 2 N/m") == 1  # and not for each case
    assert "2 cases: 2 finished" in out
    told = json.loads((folder / "a.json").read_text())
    assert [(one["case"], one["values"], one["state"]) for one in told["cases"]] == [
        ("seed_1", {"seed": 1}, "finished"), ("seed_2", {"seed": 2}, "finished"),
    ]  # fmt: skip
    code, out, _ = run(capsys, "status", "sweep-001", "--json", "b.json")
    assert code == 0
    assert "seed_2  2     finished  100%" in out
    assert json.loads((folder / "b.json").read_text()) == told
    code, out, _ = run(capsys, "collect", "sweep-001")
    assert code == 0
    assert re.search(r"series/stress_ratio +1 +seed 2, sample 28", out)
    collected = ag.open(folder / "sweep-001" / "collected.h5")
    run_here = changed(read_scene(folder / "s.toml", ["pressure=2", "contact.stiffness=100"], quick=True), {"seed": 2}).run()
    assert collected["series"].stress_ratio.sel(seed=2).values.tolist() == run_here.series.stress_ratio.values.tolist()
    code, _, err = run(capsys, "collect", "sweep-001")
    assert (code, "the file is there; choose another or add --force" in err) == (2, True)
    assert run(capsys, "collect", "sweep-001", "--force")[0] == 0
    shutil.rmtree("sweep-001/seed_1")
    code, out, _ = run(capsys, "collect", "sweep-001", "--out", "c.h5")
    assert (code, "c.h5: 1 of 2 cases, the others are NaN" in out) == (0, True)


def test_a_failed_case_ends_with_3_after_the_others(folder, capsys):
    arguments = ["s.toml", "--vary", "pressure=1e4,1,2", "--out", "s", "--workers", "1", "--json", "a.json"]
    code, out, err = run(capsys, *arguments)
    assert code == 3
    last = err.splitlines()[-1]
    assert last.startswith("anisogran: s: 1 of 3 cases are not finished")
    assert "pressure_10000: failed, stopped at step" in last
    assert "3 cases: 1 failed, 2 finished" in out
    assert [one["state"] for one in json.loads((folder / "a.json").read_text())["cases"]] == ["failed", "finished", "finished"]


@pytest.mark.parametrize("everyone", [False, True], ids=["SIGTERM to the parent", "Ctrl-C in a terminal"])
def test_an_interrupt_saves_the_cases_at_work(everyone, folder):
    process = started(folder, "--vary", "seed=1..3", "--workers", "1", *ENDLESS)
    until(lambda: at_work(folder))
    worker = next(iter(at_work(folder).values()))
    if everyone:
        os.killpg(process.pid, signal.SIGINT)
    else:
        process.terminate()
    out, err = process.communicate(timeout=WAIT)
    assert process.returncode == 130
    assert "anisogran: interrupted: 0 of 3 cases are finished; s holds the sweep, which can go on" in err
    assert "Traceback" not in err
    assert "3 cases: 1 interrupted, 2 new" in out
    assert states(folder) == ["interrupted", "new", "new"]
    assert not is_alive(worker)
    assert not is_locked(folder / "s")


def test_what_was_killed_goes_on_bit_for_bit(folder, capsys):
    """First a worker, which costs its own case only, then the parent, whose workers save themselves and end."""
    process = started(folder, "--vary", "seed=1..2", "--workers", "2", *LONG)
    until(lambda: len(at_work(folder)) == 2)
    workers = at_work(folder)
    os.kill(workers["seed_1"], signal.SIGKILL)
    until(lambda: states(folder)[0] == "killed")
    assert is_alive(workers["seed_2"])
    process.kill()
    process.communicate()
    until(lambda: not is_alive(workers["seed_2"]))
    assert states(folder) == ["killed", "interrupted"]
    code, _, err = run(capsys, "s.toml", "--out", "s", "--vary", "seed=1..2", "--workers", "1", *LONG)
    assert code == 0, err
    scene = read_scene(folder / "s.toml", ["strain=8"])
    collected = ag.collect_sweep(folder / "s")["series"]
    for seed in (1, 2):
        series = changed(scene, {"seed": seed}).run().series
        for name in series.variables:
            assert collected[name].sel(seed=seed).values.tolist() == series[name].values.tolist()


def test_a_killed_worker_is_a_named_failure_and_the_next_case_runs(folder):
    process = started(folder, "--vary", "seed=1,2", "--vary", "strain=80,0.6", "--workers", "1")
    until(lambda: at_work(folder))
    os.kill(at_work(folder)["seed_1-strain_80"], signal.SIGKILL)
    until(lambda: states(folder)[1] == "finished")
    process.terminate()
    process.communicate(timeout=WAIT)
    assert states(folder)[:2] == ["killed", "finished"]


def test_dask_workers_run_the_cases(folder, capsys):
    """With a scheduler and a worker in processes of their own."""

    def interrupt(progress):
        if progress.fraction > 0.1:
            raise KeyboardInterrupt

    from distributed import Client, LocalCluster

    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None, local_directory=str(folder / "dask")) as cluster:
        arguments = ["s.toml", "--vary", "pressure=1,2,1e4", "--out", "s", "--scheduler", cluster.scheduler_address]
        code, out, err = run(capsys, *arguments)
        assert code == 3
        assert "3 cases in s on the workers of the scheduler" in out
        assert "pressure_10000: failed, stopped at step" in err
        assert states(folder) == ["finished", "finished", "failed"]
        shutil.rmtree("s/pressure_1")
        assert run(capsys, *arguments, "--retry")[0] == 3  # run again, not remembered
        assert states(folder) == ["finished", "finished", "failed"]
        scene = read_scene(folder / "s.toml", LONG[1:])
        with Client(cluster, set_as_default=False) as client:
            executor = client.get_executor(pure=False)
            with pytest.raises(Interrupted, match="0 of 2 cases are finished"):
                ag.sweep(scene, {"seed": [1, 2]}, "t", executor=executor, listen=interrupt)
        assert [one["state"] for one in ag.sweep_status("t")] == ["interrupted", "new"]  # heard in the threads of a dask worker
    series = changed(read_scene(folder / "s.toml"), {"pressure": 2.0}).run().series
    assert ag.collect_sweep(folder / "s")["series"].s_D.sel(pressure_asked=2.0).values.tolist() == series.s_D.values.tolist()


def test_without_dask_one_line_says_what_to_install(folder, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    code, _, err = run(capsys, "s.toml", "--vary", "seed=1", "--scheduler", "tcp://nowhere:1")
    assert (code, err) == (2, "anisogran: --scheduler needs dask.distributed: pip install 'anisogran[sweep]'\n")
    assert not (folder / "sweep-001").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["s.toml"], "sweep: --vary KEY=VALUES is missing; to look at a sweep: sweep status DIR, sweep collect DIR"),
        (["full", "--vary", "seed=1"], "full: is a folder, not a file"),
        (["status", "s.toml"], "s.toml: is no sweep, it has no sweep.json"),
        (["none.toml", "--vary", "seed=1"], "none.toml: cannot be read"),
        (["s.toml", "--vary", "seed"], "--vary seed: must be KEY=VALUES"),
        (["s.toml", "--vary", "sed=1"], "--vary sed: unknown key 'sed', did you mean 'seed'?"),
        (["s.toml", "--vary", "strain=0.1,1"], "--vary strain=0.1: strain = 0.1 must be at least discard + 0.5"),
        (["s.toml", "--vary", "seed=1", "--out", "."], "--out: name a folder of its own"),
        (["s.toml", "--vary", "seed=1", "--out", "full"], "full: is neither empty nor a sweep"),
        (["s.toml", "--vary", "seed=1", "--out", "s.toml"], "s.toml: "),
        (["s.toml", "--vary", "seed=1", "--workers", "0"], "--workers"),
        (["s.toml", "--vary", "seed=1", "--workers", "1", "--scheduler", "x"], "--workers are processes of this machine"),
        (["s.toml", "--vary", "seed=1", "--json", "no/a.json"], "--json no/a.json: cannot be written"),
        (["status", "full"], "full: is no sweep"),
        (["status", "none"], "none: is no sweep"),
        (["collect", "full"], "full: is no sweep"),
        (["collect"], "Missing argument"),
    ],
)
def test_what_cannot_be_used_is_one_line(arguments, message, folder, capsys):
    (folder / "full").mkdir()
    (folder / "full" / "mine.txt").touch()
    code, out, err = run(capsys, *arguments)
    assert (code, out) == (2, "")
    assert message in err
    assert err.count("\n") == 1
    assert sorted(path.name for path in folder.iterdir()) == ["full", "s.toml"]


def test_help_tells_of_scenes_and_of_both_commands(capsys):
    for arguments in ([], ["--help"]):
        code, out, _ = run(capsys, *arguments)
        assert code == 0
        assert out.startswith("Usage: anisogran sweep [OPTIONS]")
        for word in ("--vary", "--scheduler", "sweep status DIR", "sweep collect DIR"):
            assert word in " ".join(out.split())
    assert "Tells of each case" in run(capsys, "status", "--help")[1]
