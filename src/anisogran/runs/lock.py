"""One process at a time in a folder: a lock that the system takes away when the process ends, however it ends."""

import errno
import os
import platform
import time
from contextlib import contextmanager, suppress
from pathlib import Path

from anisogran.outcome import InputError, RunFailed

try:
    import fcntl
except ImportError:  # Windows
    import msvcrt

    def _take(file, alone=True):
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
else:

    def _take(file, alone=True):
        fcntl.flock(file, (fcntl.LOCK_EX if alone else fcntl.LOCK_SH) | fcntl.LOCK_NB)


HELD = (errno.EWOULDBLOCK, errno.EACCES, errno.EDEADLK)  # what the systems say of a lock that another process has


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
        return file.read(200).decode(errors="replace").strip() or "another process"
    return "another process"


@contextmanager
def locked(folder):
    """Within the block this process alone has the folder. Raises InputError naming process and host if another one has it."""
    path = Path(folder) / "lock"
    while True:
        try:
            file = open(path, "a+b", buffering=0)  # noqa: SIM115
        except OSError as error:
            raise InputError(f"{path}: cannot be written ({error.strerror})") from None
        try:
            _take_soon(file)
        except OSError as error:
            holder = _holder(file)
            file.close()
            if error.errno not in HELD:
                raise InputError(f"{path}: cannot be locked ({error.strerror})") from None
            raise InputError(f"{folder}: {holder} is at work there") from None
        with suppress(OSError):  # the process that had it may have removed it just now
            if os.path.samestat(os.fstat(file.fileno()), path.stat()):
                break
        file.close()
    try:
        try:
            file.truncate(0)
            file.write(f"process {os.getpid()} on {platform.node()}\n".encode())
        except OSError as error:
            raise RunFailed(f"{path}: cannot be written ({error.strerror})") from None
        yield
    finally:
        with suppress(OSError):
            path.unlink()
        file.close()


def is_locked(folder):
    """Whether a process has the folder. Only looks: makes no file, and is in nobody's way who looks too."""
    try:
        with open(Path(folder) / "lock", "rb") as file:
            _take(file, alone=False)
    except FileNotFoundError:
        return False
    except OSError:
        return True
    return False
