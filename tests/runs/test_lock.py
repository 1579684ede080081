"""The lock of a folder: held by one, seen by all, and no trace of it afterwards."""

import errno
import fcntl
import os
import subprocess
import sys

import pytest

from anisogran.outcome import InputError
from anisogran.runs import lock
from anisogran.runs.lock import is_locked, locked


@pytest.mark.hard_case("F6")
def test_to_look_leaves_no_trace_and_hinders_nobody(tmp_path):
    """Two that look at the same moment both see it free; a file that may only be read will do."""
    assert not is_locked(tmp_path)
    assert list(tmp_path.iterdir()) == []
    path = tmp_path / "lock"
    path.write_text("process 1 on nowhere\n")
    with open(path, "rb") as other:
        fcntl.flock(other, fcntl.LOCK_SH)
        assert not is_locked(tmp_path)
        fcntl.flock(other, fcntl.LOCK_EX)
        assert is_locked(tmp_path)
    path.chmod(0o400)
    assert not is_locked(tmp_path)
    assert path.read_text() == "process 1 on nowhere\n"


def test_whoever_only_looks_is_waited_for(tmp_path, monkeypatch):
    """The first try meets one that looks."""
    path = tmp_path / "lock"
    path.touch()
    with open(path, "rb") as other:
        fcntl.flock(other, fcntl.LOCK_SH)
        monkeypatch.setattr(lock.time, "sleep", lambda seconds: fcntl.flock(other, fcntl.LOCK_UN))
        with locked(tmp_path):
            assert is_locked(tmp_path)
    assert not path.exists()


@pytest.mark.hard_case("F6")
@pytest.mark.parametrize("again", [False, True])
def test_a_lock_that_is_removed_while_it_is_taken_is_made_anew(again, tmp_path, monkeypatch):
    """The process that had it ends just then, and perhaps a third one has a new one already."""
    path, take, tries = tmp_path / "lock", lock._take, []

    def removed(file, alone=True):
        take(file, alone)
        if not tries:
            path.unlink()
            if again:
                path.touch()
        tries.append(file)

    monkeypatch.setattr(lock, "_take", removed)
    with locked(tmp_path):
        assert len(tries) == 2
        assert os.path.samestat(os.fstat(tries[-1].fileno()), path.stat())
    assert not path.exists()


def test_a_system_that_does_not_lock_is_named(tmp_path, monkeypatch):
    """Such as some file systems of networks; that is no other process."""

    def without(file, alone=True):
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(lock, "_take", without)
    with pytest.raises(InputError, match=r"lock: cannot be locked \(No locks available\)$"), locked(tmp_path):
        pass


FULL = """
import resource, sys
from anisogran.outcome import RunFailed
from anisogran.runs.lock import locked
resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))
try:
    with locked(sys.argv[1]):
        print("taken")
except RunFailed as error:
    print(error)
"""


def test_a_full_disk_is_named(tmp_path):
    done = subprocess.run([sys.executable, "-c", FULL, str(tmp_path)], capture_output=True, text=True, check=True)
    assert done.stdout == f"{tmp_path / 'lock'}: cannot be written ({os.strerror(errno.EFBIG)})\n"
    assert list(tmp_path.iterdir()) == []
