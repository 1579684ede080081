"""The keys of a scene: declared on the experiments, read from them, and checked with the sentences that contact laws use too."""

import dataclasses

from pydantic import Field
from pydantic_core import PydanticUndefined

from anisogran.keys import REQUIRED, Key, check_value, record_keys, typed, unknown_key
from anisogran.outcome import InputError, closest, shown

BOUNDS = {"gt": "above", "ge": "at_least", "lt": "below", "le": "at_most"}  # pydantic's names and ours
LENGTH = {"at_least": 1e-9, "at_most": 1e9}  # in m: squares and masses stay far from the ends of the floating-point numbers
MANY = 1_000_000  # samples, snapshots
LARGEST_SEED = 2**53  # every program that reads such a file keeps it exactly


def scene_key(unit, meaning, default, *, example=None, **bounds):
    """The field of an experiment: unit ("1" if it has none), meaning, default; above, at_least, below, at_most as in `checked`.

    An annotation Literal["a", "b"] makes it one of these words.

    `example` is what a template shows if the default is None.
    """
    limits = {theirs: bounds.pop(ours) for theirs, ours in BOUNDS.items() if ours in bounds}
    if bounds:
        raise TypeError(f"scene_key: unknown bound {', '.join(bounds)}")
    return Field(default, description=meaning, json_schema_extra={"unit": unit, "example": example}, **limits)


def scene_table(meaning, default):
    """The field of an experiment that is a record of its own, a table in the file."""
    return Field(default, description=meaning, json_schema_extra={"unit": "1"})


def keys_of(record):
    """{name: Key} of a contact effect or an experiment (the class, or an instance of it)."""
    if dataclasses.is_dataclass(record):
        return record_keys(record)
    record = record if isinstance(record, type) else type(record)
    return {name: _key(field) for name, field in record.model_fields.items()}


def _key(field):
    """The Key of a field of pydantic's."""
    limits = {ours: getattr(part, theirs) for part in field.metadata for theirs, ours in BOUNDS.items() if hasattr(part, theirs)}
    default = REQUIRED if field.default is PydanticUndefined else field.default
    return Key(meaning=field.description, default=default, **field.json_schema_extra, **limits, **typed(field.annotation))


def name_of(record):
    """The name of a class of records in a file: the kind of an experiment, the law of a contact."""
    return getattr(record, "kind", record.__name__.lower())


def homes(experiment, name):
    """Where an experiment has a key of that name, in words for a message; a list."""
    keys = keys_of(experiment)
    tables = [table for table, one in keys.items() if any(name in keys_of(record) for record in one.records)]
    return [f"{name} above all tables"] * (name in keys) + [f"{table}.{name}" for table in tables]


def checked_values(experiment, values):
    """The values (a dict) of an experiment, each checked by itself; raises InputError with one line for the first that is wrong.

    A table may come as its record or as a dict, with "law" where its keys leave a choice.
    """
    where, keys, result = experiment.__name__, keys_of(experiment), {}
    for name, value in values.items():
        if name not in keys:
            raise unknown_key(f"{where}:", name, name_of(experiment), keys)
        one = keys[name]
        if not one.records:
            result[name] = check_value(where, name, one, value)
        elif isinstance(value, dict):
            result[name] = built(_likely(one.records, value), value, f"{where}: [{name}]")
        elif isinstance(value, one.records) or (value is None and one.optional):
            result[name] = value
        else:
            names = [record.__name__ for record in one.records] + ["None"] * one.optional
            raise InputError(f"{where}: {name} = {shown(value)} must be {' or '.join(names)}")
    return result


def _likely(records, table):
    """The record that a dict without a law is meant to be: the first that has all its keys."""
    if "law" in table:
        return chosen(records, table["law"], "law")
    return next((record for record in records if set(table) <= set(keys_of(record))), records[0])


def chosen(records, name, where):
    """The record with that name in a file, None if it is not given. Raises InputError with the nearest one."""
    known = {name_of(record): record for record in records}
    if name is None:
        raise InputError(f"{where} is missing; it must be one of {', '.join(known)}")
    if not isinstance(name, str) or name not in known:
        guess = f"; did you mean {closest(name, known)!r}?" if isinstance(name, str) else ""
        raise InputError(f"{where} = {shown(name)} must be one of {', '.join(known)}{guess}")
    return known[name]


def built(record, values, where):
    """The record with these values (a dict, "law" apart); its complaints begin with `where` instead of its own name."""
    keys = keys_of(record)
    values = {name: value for name, value in values.items() if name != "law" or name in keys}
    for name in values:
        if name not in keys:
            raise unknown_key(where, name, name_of(record), keys)
    for name, one in keys.items():
        if one.default is REQUIRED and name not in values:
            raise InputError(f"{where} {name} is missing; {name_of(record)} has {', '.join(keys)}")
    try:
        return record(**values)
    except InputError as error:
        raise InputError(f"{where} {str(error).removeprefix(f'{record.__name__}: ')}") from None
