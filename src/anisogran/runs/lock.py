"""One process at a time in a folder: a lock that the system takes away when the process ends, however it ends."""

import os
import platform
import time
from contextlib import contextmanager, suppress
from pathlib import Path

from anisogran.outcome import InputError

try:
    import fcntl
except ImportError:  # Windows
    import msvcrt

    def _take(file):
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
else:

    def _take(file):
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


def _take_soon(file, tries=5):
    """Takes the lock; another process that only looks whether it is free, see is_locked, has it for a moment."""
    for _ in range(tries - 1):
        with suppress(OSError):
            return _take(file)
        time.sleep(0.02)
    return _take(file)


def _holder(file):
    """Process and host that a lock file names."""
    with suppress(OSError):
        file.seek(0)
        return file.read(200).strip() or "another process"
    return "another process"


@contextmanager
def locked(folder):
    """Within the block this process alone has the folder. Raises InputError naming process and host if another one has it."""
    path = Path(folder) / "lock"
    while True:
        try:
            file = open(path, "a+", encoding="utf-8")  # noqa: SIM115
        except OSError as error:
            raise InputError(f"{path}: cannot be written ({error.strerror})") from None
        try:
            _take_soon(file)
        except OSError:
            holder = _holder(file)
            file.close()
            raise InputError(f"{folder}: {holder} is at work there") from None
        if path.exists() and os.path.samestat(os.fstat(file.fileno()), path.stat()):
            break
        file.close()  # the process that had it has just removed it
    try:
        file.truncate(0)
        file.write(f"process {os.getpid()} on {platform.node()}\n")
        file.flush()
        yield
    finally:
        with suppress(OSError):
            path.unlink()
        file.close()


def is_locked(folder):
    """Whether a process has the folder."""
    path = Path(folder) / "lock"
    if not path.exists():
        return False
    try:
        with open(path, "a+", encoding="utf-8") as file:
            _take(file)
    except OSError:
        return True
    return False
