"""What a user may write for each key of a record: unit, meaning, range and default, declared once, where the record stands.

The checks of the records, the messages about scene files, their templates and their JSON schema are all made from this.
"""

from dataclasses import MISSING, dataclass, field, fields, is_dataclass, replace
from types import NoneType
from typing import Any, get_args

from anisogran.outcome import InputError, checked, closest, shown

REQUIRED = ...  # the default of a key that must be given


@dataclass(frozen=True)
class Key:
    """One key of a record: its unit ("1" if it has none), meaning, and bounds (None: unbounded).

    `example` is what a template shows where there is no default to show. From the annotation of the field come `default` (REQUIRED if
    it must be given), `whole` (a whole number), `switch` (true or false), `optional` (None switches it off), `records`, the classes of a
    key that is a table, and `words`, of which a key that is no number is one.
    """

    unit: str
    meaning: str
    above: float | None = None
    at_least: float | None = None
    below: float | None = None
    at_most: float | None = None
    example: float | None = None
    default: Any = REQUIRED
    whole: bool = False
    switch: bool = False
    optional: bool = False
    records: tuple = ()
    words: tuple = ()

    @property
    def bounds(self):
        """The bounds as `checked` takes them."""
        return {"above": self.above, "at_least": self.at_least, "below": self.below, "at_most": self.at_most}

    @property
    def range(self):
        """The bounds in words, "above 0, at most 1", or the words that it may be; empty without any."""
        if self.switch:
            return "true or false"
        if self.words:
            return f"one of {', '.join(self.words)}"
        return ", ".join(f"{name.replace('_', ' ')} {bound:g}" for name, bound in self.bounds.items() if bound is not None)

    @property
    def suffix(self):
        """The unit as it follows a number, empty if there is none."""
        return "" if self.unit == "1" else self.unit


def key(unit, meaning, default=MISSING, *, example=None, **bounds):
    """The field of a dataclass with a Key: above, at_least, below, at_most as in `checked`."""
    return field(default=default, metadata={"key": Key(unit, meaning, example=example, **bounds)})


def typed(annotation):
    """`whole`, `switch`, `optional`, `records` and `words` of a Key, from the annotation of its field; words are a Literal of texts."""
    parts = get_args(annotation) or (annotation,)
    return {
        "whole": int in parts,
        "switch": bool in parts,
        "optional": NoneType in parts,
        "records": tuple(part for part in parts if is_dataclass(part)),
        "words": tuple(part for part in parts if isinstance(part, str)),
    }


def record_keys(record):
    """{name: Key} of a dataclass (or an instance of it) whose fields were declared with `key`."""
    return {
        one.name: replace(one.metadata["key"], default=REQUIRED if one.default is MISSING else one.default, **typed(one.type))
        for one in fields(record)
    }


def check_keys(record):
    """Raises InputError for the first key of a dataclass that is no number or out of its bounds."""
    for name, one in record_keys(record).items():
        check_value(type(record).__name__, name, one, getattr(record, name))


def check_value(where, name, one, value):
    """The value of a key: int, float, bool, one of its words, or None. Raises InputError naming where, key, value and the broken bound."""
    if one.switch:
        if not isinstance(value, bool):
            raise InputError(f"{where}: {name} = {shown(value)} must be {one.range}")
        return value
    if one.words:
        if not isinstance(value, str) or value not in one.words:
            guess = f"; did you mean {closest(value, one.words)!r}?" if isinstance(value, str) else ""
            raise InputError(f"{where}: {name} = {shown(value)} must be {one.range}{guess}")
        return value
    if value is None and one.optional:
        return None
    if isinstance(value, bool | str):  # Python would take both for numbers
        raise InputError(f"{where}: {name} = {shown(value)} is not a number")
    number = checked(where, name, value, unit=one.suffix, **one.bounds)
    if one.whole and number != int(number):
        raise InputError(f"{where}: {name} = {number:g} is not a whole number")
    return int(value) if one.whole else number


def unknown_key(where, name, owner, known, elsewhere=()):
    """An InputError that asks for this key where else it is known, or for the one most like it; `owner` is what has the known ones."""
    meant = " or ".join(elsewhere) or repr(closest(name, known))
    return InputError(f"{where} unknown key {shown(name)}, did you mean {meant}? {owner} has {', '.join(known)}")
