"""The cache of compiled kernels: keyed by the sources, and never a stale one."""

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
