"""A file of named arrays and a text, under seal: written whole or not at all, and found out if a single bit of it has changed.

It is an uncompressed .npz that numpy.load reads without pickle; the text is its member "text". The zip comment, which is the last 64
bytes of the file, holds in hex digits the SHA-256 of the whole file with "0" in the place of each of these digits.
A new file is written beside the old one, brought to the disk, and only then gets its name; the old one is kept as <path>.previous.
"""

import hashlib
import io
import os
import zipfile
from contextlib import suppress
from pathlib import Path

import numpy as np
from numpy.lib import format as npy

from anisogran.outcome import InputError, RunFailed

DIGITS = 64
LARGEST = 4 * 2**30  # bytes; no file above this is read into memory


def previous_of(path):
    """Where the file is kept that was replaced by the one at that path."""
    return Path(f"{path}.previous")


def check_target(path):
    """The path to write to, symbolic links followed. Raises InputError if no file can be made there."""
    try:
        path = Path(path)
    except TypeError:
        raise InputError(f"checkpoint {path!r} is no path") from None
    path = path.resolve() if path.is_symlink() else path
    if path.exists() and not path.is_file():
        raise InputError(f"{path}: cannot be written (it is no regular file)")
    if not path.parent.is_dir():
        raise InputError(f"{path}: cannot be written (its folder does not exist)")
    if not os.access(path.parent, os.W_OK):
        raise InputError(f"{path}: cannot be written (no permission for its folder)")
    return path


def _seal(content):
    """The hex digits that belong at the end of this content of a file, whatever is there now."""
    digest = hashlib.sha256(content[:-DIGITS])
    digest.update(b"0" * DIGITS)
    return digest.hexdigest().encode()


def _content(text, arrays):
    """The bytes of the file; the same for the same text and arrays, as no member carries a date."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_STORED) as archive:
        for name, array in {"text": np.array(text), **arrays}.items():
            with archive.open(zipfile.ZipInfo(f"{name}.npy"), "w", force_zip64=True) as member:
                npy.write_array(member, np.asarray(array, order="C"), version=(1, 0), allow_pickle=False)
        archive.comment = b"0" * DIGITS
    content = stream.getbuffer()
    content[-DIGITS:] = _seal(content)
    return content


def write_sealed(path, text, arrays):
    """Writes the file; at every moment, whatever stops the process, the new or the old one is there and whole.

    Raises InputError if no file can be made at that path, RunFailed if the machine does not take it (disk full, file too large): then
    the old file is untouched. Takes about the memory of the arrays once more.
    """
    path = check_target(path)
    temporary = Path(f"{path}.tmp")
    try:
        temporary.unlink(missing_ok=True)  # left by a process that was killed
        with open(temporary, "xb") as file:
            file.write(_content(text, arrays))
            file.flush()
            os.fsync(file.fileno())
        _replace(path, temporary)
    except OSError as error:
        raise RunFailed(f"{path}: cannot be written ({error.strerror})") from None
    finally:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)


def _replace(path, temporary):
    """Gives the new file its name, and the old one the name of the previous one."""
    spare = Path(f"{path}.old")
    spare.unlink(missing_ok=True)
    if path.exists():
        try:
            os.link(path, spare)
        except OSError:  # a file system without hard links: for a moment only the previous file has its name
            os.replace(path, previous_of(path))
    os.replace(temporary, path)
    if spare.exists():
        os.replace(spare, previous_of(path))
    if hasattr(os, "O_DIRECTORY"):  # elsewhere a folder cannot be synchronised
        folder = os.open(path.parent, os.O_RDONLY | os.O_DIRECTORY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)


def read_sealed(path):
    """(text, {name: read-only array}) of a file that was written by `write_sealed`.

    Raises InputError, one line naming file and reason, for everything else. Nothing is unpickled, and nothing is unpacked that is larger
    than the file itself.
    """
    try:
        path = Path(path)
        if path.exists() and not path.is_file():
            raise InputError(f"{path}: is no regular file")
        if path.stat().st_size > LARGEST:
            raise InputError(f"{path}: has {path.stat().st_size} bytes, more than the {LARGEST} that are read")
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None
    except TypeError:
        raise InputError(f"checkpoint {path!r} is no path") from None
    if not content:
        raise InputError(f"{path}: is empty")
    if set(content[-DIGITS:]) - set(b"0123456789abcdef"):
        raise InputError(f"{path}: has no seal at its end; it is cut short or damaged, or no checkpoint")
    if content[-DIGITS:] != _seal(content):
        raise InputError(f"{path}: is damaged; it does not have the SHA-256 that it carries")
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            unpacked = sum(member.file_size for member in archive.infolist())
            if unpacked > len(content):
                raise InputError(f"{path}: would unpack to {unpacked} bytes, more than its own {len(content)}; it is no checkpoint")
            arrays = {member.filename.removesuffix(".npy"): _array(archive.read(member)) for member in archive.infolist()}
        return arrays.pop("text").item(), arrays
    except InputError:
        raise
    except (zipfile.BadZipFile, ValueError, LookupError, ArithmeticError, RuntimeError, EOFError) as error:
        raise InputError(f"{path}: is no checkpoint ({' '.join(str(error).split())})") from None


def _array(content):
    """The array in the bytes of an .npy file; ValueError if it holds objects, or another number of bytes than it says."""
    stream = io.BytesIO(content)
    if npy.read_magic(stream) != (1, 0):
        raise ValueError("an array in another format")
    shape, _, dtype = npy.read_array_header_1_0(stream)
    if dtype.hasobject:
        raise ValueError("an array of Python objects")
    return np.frombuffer(content, dtype, offset=stream.tell()).reshape(shape)
