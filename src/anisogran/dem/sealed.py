"""A file of named arrays and a text, under seal: written whole or not at all, and found out if a single bit of it has changed.

It is an uncompressed .npz that numpy.load reads without pickle; the text is its member "text". The zip comment, which is the last 64
bytes of the file, holds in hex digits the SHA-256 of the whole file with "0" in the place of each of these digits.
A new file is written beside the old one, brought to the disk, and only then gets its name; the old one is kept as <path>.previous.
"""

import io
import zipfile
from pathlib import Path

import numpy as np
from numpy.lib import format as npy

from anisogran.outcome import InputError
from anisogran.whole_file import DIGITS, read_whole, seal, write_whole

PREVIOUS = ".previous"


def previous_of(path):
    """Where the file is kept that was replaced by the one at that path."""
    return Path(f"{path}{PREVIOUS}")


def _content(text, arrays):
    """The bytes of the file; the same for the same text and arrays, as no member carries a date."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_STORED) as archive:
        for name, array in {"text": np.array(text), **arrays}.items():
            with archive.open(zipfile.ZipInfo(f"{name}.npy"), "w", force_zip64=True) as member:
                npy.write_array(member, np.asarray(array, order="C"), version=(1, 0), allow_pickle=False)
        archive.comment = b"0" * DIGITS
    content = stream.getbuffer()
    content[-DIGITS:] = seal(content)
    return content


def write_sealed(path, text, arrays):
    """Writes the file; at every moment, whatever stops the process, the new or the old one is there and whole.

    Raises InputError if no file can be made at that path, RunFailed if the machine does not take it (disk full, file too large): then
    the old file is untouched. Takes about the memory of the arrays once more.
    """
    write_whole(path, _content(text, arrays), PREVIOUS)


def read_sealed(path):
    """(text, {name: read-only array}) of a file that was written by `write_sealed`.

    Raises InputError, one line naming file and reason, for everything else. Nothing is unpickled, and nothing is unpacked that is larger
    than the file itself.
    """
    content = read_whole(path)
    if set(content[-DIGITS:]) - set(b"0123456789abcdef"):
        raise InputError(f"{path}: has no seal at its end; it is cut short or damaged, or no checkpoint")
    if content[-DIGITS:] != seal(content):
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
