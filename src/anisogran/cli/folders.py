"""Where the commands write: new folders and files, never over what is there unless told so."""

import contextlib
import itertools
import tempfile
from pathlib import Path

from anisogran.outcome import InputError


def output_folder(out, name, force):
    """The folder to write to: `out`, or the first free of name-001, name-002, ...; made, empty (unless forced) and writable.

    Raises InputError otherwise; nothing in it is touched.
    """
    try:
        if out is None:
            folder = numbered_folder(name)
        elif str(out) in ("", "."):
            raise InputError("--out: name a folder of its own for the report")
        elif out.exists() and not out.is_dir():
            raise InputError(f"--out {out}: is not a folder")
        else:
            folder = out
            folder.mkdir(parents=True, exist_ok=True)
            if any(folder.iterdir()) and not force:
                raise InputError(f"--out {out}: the folder is not empty; choose another or add --force")
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise InputError(f"--out {out if out is not None else name + '-NNN'}: cannot be written ({error.strerror})") from None
    return folder


@contextlib.contextmanager
def folder_to_fill(out, name, force):
    """The folder of `output_folder` for a block; if the block fails, one that was made for it and is still empty is removed."""
    was_there = out is not None and out.exists()
    folder = output_folder(out, name, force)
    try:
        yield folder
    except BaseException:
        if not was_there:
            with contextlib.suppress(OSError):
                folder.rmdir()
        raise


def numbered_folder(name):
    """Makes the first folder of name-001, name-002, ... that does not exist yet."""
    for k in itertools.count(1):
        folder = Path(f"{name}-{k:03d}")
        with contextlib.suppress(FileExistsError):
            folder.mkdir()
            return folder


def check_new_file(option, path, force):
    """Raises InputError if the file cannot be made, or is there already and not to be replaced; None is no file."""
    if path is None:
        return
    from anisogran.files.numbers import check_writable

    check_writable(path, f"{option} ")
    if path.exists() and not force:
        raise InputError(f"{option} {path}: the file is there; choose another or add --force")
