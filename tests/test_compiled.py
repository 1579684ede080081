"""The cache of compiled kernels: keyed by the sources, and never a stale one."""

import os
import subprocess
import sys

import pytest

import anisogran.compiled as compiled


@pytest.mark.hard_case("S8")
def test_folder_is_keyed_by_the_sources(tmp_path, monkeypatch):
    """Any change in a source file of the room leads to another folder; a room has its own."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    fresh = compiled.cache_folder.__wrapped__
    before = fresh("dem")
    assert before.startswith(str(tmp_path / "anisogran" / "dem-"))
    assert fresh("averaging").startswith(str(tmp_path / "anisogran" / "averaging-"))
    copied = tmp_path / "dem"
    copied.mkdir()
    (copied / "rows.py").write_text("# another source")
    monkeypatch.setattr(compiled, "PACKAGE", tmp_path)
    assert fresh("dem") != before


@pytest.mark.hard_case("S8")
@pytest.mark.skipif(not hasattr(os, "getuid"), reason="this system has no owners of files")
def test_the_cache_is_private_and_that_of_another_user_is_not_run(tmp_path, monkeypatch, answer):
    """Its files are pickles."""
    monkeypatch.setattr(compiled, "cache_folder", lambda room: str(tmp_path / room))
    assert compiled.cache_is_usable.__wrapped__("dem")
    assert (tmp_path / "dem").stat().st_mode & 0o777 == 0o700
    monkeypatch.setattr(os, "getuid", lambda: tmp_path.stat().st_uid + 1)
    with pytest.warns(UserWarning, match="dem belongs to another user: kernels are compiled anew in every process") as caught:
        assert not compiled.cache_is_usable.__wrapped__("dem")
    answer.named(f"warned: {caught[0].message}")


@pytest.mark.hard_case("F8")
def test_without_a_writable_cache_it_compiles_and_says_so():
    """Numba alone would fall back to a cache that knows nothing of changes in other files."""
    code = """
import warnings
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    from anisogran.dem import *
    s = Simulation(Grains([[0, 0], [0.9, 0]], [0.5, 0.5], mass=[1.0, 1.0]), Linear(1e3))
print(len(caught), str(caught[0].message).split(":")[0].split(" cannot")[1], round(s.net_force[1, 0], 9))
"""
    environment = {"PATH": "/usr/bin:/bin", "NUMBA_CACHE_DIR": "/dev/null/nowhere"}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ["1", "be", "written", "(Not", "a", "directory)", "100.0"]
