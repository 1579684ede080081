"""Text files: numbers as JSON, replaced in one go, and whether a file can be written at all."""

import json
import math
import tempfile
from pathlib import Path

from anisogran.outcome import InputError
from anisogran.whole_file import write_whole


def check_writable(path, option=""):
    """Raises InputError if the file cannot be made, before any work is lost on it. An existing file is left as it is.

    `option` names the place in the message, such as "--json ".
    """
    try:
        path = Path(path)
        if path.is_dir():
            raise InputError(f"{option}{path}: is a folder")
        with tempfile.TemporaryFile(dir=path.parent):
            pass
    except OSError as error:
        raise InputError(f"{option}{path}: cannot be written ({error.strerror})") from None
    except TypeError:
        raise InputError(f"{option}{path!r}: is no path") from None


def json_text(numbers):
    """A dict, nested or with lists, as JSON; NaN and infinity, which JSON does not know, become null."""
    return json.dumps(plain(numbers), indent=2, allow_nan=False)


def plain(value):
    """The value with null for every number that is not finite."""
    if isinstance(value, dict):
        return {key: plain(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [plain(part) for part in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def write_text(path, text):
    """Writes a text file; an older file is replaced only when all is written. Raises as `write_whole` does."""
    write_whole(path, text.encode())


def write_json(path, numbers):
    """Writes a dict as a JSON file; an older file is replaced only when all is written."""
    write_text(path, json_text(numbers) + "\n")
