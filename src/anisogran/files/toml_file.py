"""TOML files that somebody wrote: read with limits, so that a hostile one costs a line and not the machine."""

import re
import tomllib

from anisogran.outcome import InputError
from anisogran.whole_file import check_no_folder

LARGEST = 1_000_000  # bytes
DEEPEST = 20  # tables and lists inside each other
LARGEST_WHOLE = 2**63 - 1  # whole numbers of TOML have 64 bits

# a hundred parts of a key with dots: the parser would need time with the square of their number
_LONG_KEY = re.compile(r"""(?:\.[ \t]*+(?:"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+'|[^\s.,="'\[\]{}]++)[ \t]*+){100}""")


def read_toml(path):
    """The content of a TOML file as a dict. Raises InputError, one line with the file and the reason, if it cannot be had."""
    check_no_folder(path, "scene.toml")
    try:
        with open(path, "rb") as file:
            data = file.read(LARGEST + 1)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None
    if len(data) > LARGEST:
        raise InputError(f"{path}: larger than {LARGEST} bytes, nothing that somebody wrote")
    try:
        return parsed_toml(data.decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: not a TOML file ({reason_of(error)})") from None


def parsed_toml(text):
    """The content of a text as a dict. Raises ValueError or RecursionError if it is no TOML or beyond the limits."""
    if _LONG_KEY.search(text):
        raise RecursionError
    content = tomllib.loads(text)
    level, depth = [content], 0
    while level:
        if depth > DEEPEST:
            raise RecursionError
        if any(isinstance(value, int) and abs(value) > LARGEST_WHOLE for value in level):
            raise ValueError("a whole number needs more than 64 bits")
        level = [part for value in level for part in _parts(value)]
        depth += 1
    return content


def reason_of(error):
    """Why a text is no TOML, in words: of a ValueError or RecursionError."""
    if isinstance(error, RecursionError):
        return "nested too deeply"
    if isinstance(error, UnicodeDecodeError):
        return "no text in UTF-8"
    reason = " ".join(str(error).split())
    unquoted = reason.startswith(("Invalid value", "Expected newline"))  # biaxial, 100 kPa
    return reason + '; words, and numbers with units, stand in quotes: "100 N/m"' * unquoted


def _parts(value):
    """What a table or a list holds; nothing for anything else."""
    return value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
