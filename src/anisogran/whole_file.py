"""Files that are whole or not there: written beside the old one, brought to the disk, and only then given its name; read in one go.

A seal, the SHA-256 of the whole file in its last 64 bytes, tells whether a single bit of it has changed since.
"""

import errno
import hashlib
import os
from contextlib import suppress
from pathlib import Path

from anisogran.outcome import InputError, RunFailed

DIGITS = 64
LARGEST = 4 * 2**30  # bytes; no file above this is read into memory


def _path(path):
    """As a Path; InputError if it cannot be one."""
    try:
        if "\0" not in str(Path(path)):
            return Path(path)
    except TypeError:
        pass
    raise InputError(f"{path!r} is no path")


def check_target(path):
    """The path to write to, symbolic links followed. Raises InputError if no file can be made there."""
    path = _path(path)
    try:
        path = path.resolve() if path.is_symlink() else path
        reasons = {
            "it is a folder": path.is_dir(),
            "it is no regular file": path.exists() and not path.is_file(),
            "its folder does not exist": not path.parent.is_dir(),
            "no permission for its folder": not os.access(path.parent, os.W_OK),
        }
    except (OSError, RuntimeError) as error:  # a name that is too long, links that go round in a circle
        raise InputError(f"{path}: cannot be written ({error})") from None
    for reason, holds in reasons.items():
        if holds:
            raise InputError(f"{path}: cannot be written ({reason})")
    return path


def write_whole(path, content, previous=None):
    """Writes the bytes; at every moment, whatever stops the process, the new or the old file is there and whole.

    With `previous`, a suffix, the old file is kept as <path><previous>. Raises InputError if no file can be made at that path, RunFailed
    if the machine does not take it (disk full, file too large): then the old file is untouched.
    """
    path = check_target(path)
    temporary = Path(f"{path}.tmp")
    try:
        temporary.unlink(missing_ok=True)  # left by a process that was killed
        with open(temporary, "xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        if previous is None:
            os.replace(temporary, path)
        else:
            _replace(path, temporary, Path(f"{path}{previous}"))
        _synchronise(path.parent)
    except OSError as error:
        raise RunFailed(f"{path}: cannot be written ({error.strerror})") from None
    finally:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)


def _replace(path, temporary, previous):
    """Gives the new file its name, and the old one the name of the previous one."""
    spare = Path(f"{path}.old")
    spare.unlink(missing_ok=True)
    if path.exists():
        try:
            os.link(path, spare)
        except OSError:  # a file system without hard links: for a moment only the previous file has its name
            os.replace(path, previous)
    os.replace(temporary, path)
    if spare.exists():
        os.replace(spare, previous)


def _synchronise(folder):
    """Brings the names in a folder to the disk, where the system can."""
    if hasattr(os, "O_DIRECTORY"):
        number = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        try:
            os.fsync(number)
        except OSError as error:
            if error.errno not in (errno.EINVAL, errno.ENOTSUP):  # file systems that know no such thing for folders
                raise
        finally:
            os.close(number)


def check_no_folder(path, usual):
    """Raises InputError if the path is a folder; it asks for the file that is usual in such a folder if there is one."""
    path = _path(path)
    if os.path.isdir(path):  # unlike path.is_dir() it raises nothing, however long the name
        hint = f"; did you mean {path / usual}?" if (path / usual).is_file() else ""
        raise InputError(f"{path}: is a folder, not a file{hint}")


def read_whole(path):
    """The bytes of a file. Raises InputError, one line naming file and reason, if there is none or it is empty or too large."""
    path = _path(path)
    try:
        if path.is_dir():
            raise InputError(f"{path}: is a folder")
        if path.exists() and not path.is_file():
            raise InputError(f"{path}: is no regular file")
        if path.stat().st_size > LARGEST:
            raise InputError(f"{path}: has {path.stat().st_size} bytes, more than the {LARGEST} that are read")
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None
    if not content:
        raise InputError(f"{path}: is empty")
    return content


def seal(content):
    """The hex digits that belong in the last 64 bytes of this content of a file, whatever is there now.

    They are the SHA-256 of the whole with "0" in the place of each of these digits.
    """
    digest = hashlib.sha256(memoryview(content)[:-DIGITS])
    digest.update(b"0" * DIGITS)
    return digest.hexdigest().encode()
