"""Which software made a file, told in every case in which it is run: from a clone, installed from git or a wheel, without git."""

import json
import os
import re
import shutil
import subprocess
import time
from importlib.metadata import PackageNotFoundError
from types import SimpleNamespace

import pytest

import anisogran
from anisogran import open as open_results
from anisogran.files import provenance, save_results, software


def git(folder, *words):
    """Runs git with a made-up author and no settings of the user."""
    nothing = {"GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_SYSTEM": os.devnull, "PATH": os.environ["PATH"]}
    author = ["-c", "user.name=A", "-c", "user.email=a@example.org"]
    return subprocess.run(["git", *author, *words], cwd=folder, env=nothing, check=True, capture_output=True, text=True).stdout.strip()


@pytest.fixture
def package(tmp_path):
    """The folder "package" of a repository, with one source in it."""
    if shutil.which("git") is None:
        pytest.skip("there is no git")
    folder = tmp_path / "package"
    folder.mkdir()
    (folder / "__init__.py").write_text("x = 1\n")
    git(tmp_path, "init", "-q")
    git(folder, "add", ".")
    git(folder, "commit", "-qm", "Begin")
    return folder


def test_software_is_told_in_plain_words():
    told = software()
    assert all(isinstance(value, str) and value for value in told.values())
    assert told["anisogran"] == anisogran.__version__
    assert re.fullmatch(r"[0-9a-f]{40}(\+changes)?|unknown", told["commit"])
    assert re.fullmatch("[0-9a-f]{16}", told["sources"])
    assert not set("/\\") & set("".join(told.values()))  # no path of the machine
    told["commit"] = "changed by the caller"
    assert software()["commit"] != "changed by the caller"


def test_it_is_asked_once():
    software()
    clock = time.perf_counter()
    for _ in range(1000):
        software()
    assert time.perf_counter() - clock < 0.05  # 1000 calls in the time that one may take


def test_every_results_file_tells_it(tmp_path):
    save_results(tmp_path / "a.h5", {}, {"seed": 3})
    attributes = open_results(tmp_path / "a.h5").attrs
    assert {name: attributes[name] for name in software()} == software()
    assert attributes["seed"] == 3


def test_the_commit_is_that_of_the_sources(package, monkeypatch):
    commit = git(package, "rev-parse", "HEAD")
    assert provenance._commit_of_tree(package) == commit
    monkeypatch.setenv("GIT_DIR", "/nowhere")  # as set by a hook
    assert provenance._commit_of_tree(package) == commit
    (package.parent / "elsewhere").write_text("no source")
    assert provenance._commit_of_tree(package) == commit
    (package / "more.py").write_text("y = 2\n")
    assert provenance._commit_of_tree(package) == f"{commit}+changes"
    (package / "more.py").unlink()
    (package / "__init__.py").write_text("x = 2\n")
    assert provenance._commit_of_tree(package) == f"{commit}+changes"


def test_a_repository_around_it_is_not_its_own(package):
    """As of an environment inside somebody's project."""
    inner = package / "site-packages" / "anisogran"
    inner.mkdir(parents=True)
    (inner / "__init__.py").touch()
    assert provenance._commit_of_tree(inner) is None


def test_git_may_be_missing_fail_or_hang(package, monkeypatch, tmp_path):
    tool = tmp_path / "bin" / "git"
    tool.parent.mkdir()
    monkeypatch.setenv("PATH", str(tool.parent))
    assert provenance._commit_of_tree(package) is None
    monkeypatch.setattr(provenance, "PATIENCE", 0.1)
    for script in ("exit 1", "exec /bin/sleep 30"):
        tool.write_text(f"#!/bin/sh\n{script}\n")
        tool.chmod(0o755)
        clock = time.perf_counter()
        assert provenance._commit_of_tree(package) is None
        assert time.perf_counter() - clock < 5.0  # not the 30 s; starting a process takes its time on a busy machine


def test_pip_remembers_the_commit(monkeypatch):
    def installed(text):
        monkeypatch.setattr(provenance, "distribution", lambda name: SimpleNamespace(read_text=lambda file: text))
        return provenance._commit_of_install()

    commit = "0123456789abcdef0123456789abcdef01234567"
    assert installed(json.dumps({"url": "https://example.org", "vcs_info": {"vcs": "git", "commit_id": commit}})) == commit
    for text in (None, "", "{}", "[]", "3", "no JSON", json.dumps({"vcs_info": {"commit_id": "/home/user"}}), '{"vcs_info": null}'):
        assert installed(text) is None

    def missing(name):
        raise PackageNotFoundError(name)

    monkeypatch.setattr(provenance, "distribution", missing)
    assert provenance._commit_of_install() is None


def test_the_digest_sees_names_and_contents(tmp_path):
    (tmp_path / "a.py").write_text("x")
    (tmp_path / "b.py").write_text("y")
    first = provenance._digest(tmp_path)
    (tmp_path / "notes.txt").write_text("of no account")
    assert provenance._digest(tmp_path) == first
    (tmp_path / "b.py").rename(tmp_path / "c.py")
    second = provenance._digest(tmp_path)
    (tmp_path / "c.py").write_text("z")
    assert len({first, second, provenance._digest(tmp_path)}) == 3
