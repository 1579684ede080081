"""Laws, boundaries and motions in terms of JSON and back, and in words where two of them differ.

A record is {"Friction": {"stiffness": 2e4, "mu": 0.5, ...}}. Only records that anisogran.dem offers by name are made again, each by its own
constructor with all its checks, so that a forged text can make nothing else.
"""

from dataclasses import fields, is_dataclass

import numpy as np

from anisogran.outcome import InputError


def packed(value):
    """A record of this room, a number or a tuple of such, in terms of JSON. Raises InputError for anything else."""
    if is_dataclass(value) and record_class(type(value).__name__) is type(value):
        return {type(value).__name__: {field.name: packed(getattr(value, field.name)) for field in fields(value) if field.init}}
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, (tuple, list)):
        return [packed(part) for part in value]
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise InputError(f"Simulation.save: {value!r} is neither a record of anisogran.dem nor a number")


def unpacked(value):
    """The inverse of `packed`; lists become tuples."""
    if isinstance(value, dict):
        ((name, parts),) = value.items()
        kind = record_class(name)
        if kind is None:
            raise InputError(f"there is no record dem.{name}")
        return kind(**{key: unpacked(part) for key, part in parts.items()})
    return tuple(unpacked(part) for part in value) if isinstance(value, list) else value


def record_class(name):
    """The record of that name that anisogran.dem offers, or None."""
    from anisogran import dem  # it imports this file

    kind = getattr(dem, name) if name in dem.__all__ else None
    return kind if isinstance(kind, type) and is_dataclass(kind) else None


def differences(name, asked, stored):
    """In words, where two packed values differ."""
    if isinstance(asked, dict) and isinstance(stored, dict) and asked.keys() == stored.keys():
        for key in asked:
            yield from differences(f"{name}.{key}" if key[0].islower() else name, asked[key], stored[key])
    elif asked != stored:
        yield f"{name} = {_shown(asked)}, in the file {_shown(stored)}"


def _shown(value):
    """A packed value as the user writes it."""
    if isinstance(value, dict):
        ((name, parts),) = value.items()
        return f"{name}({', '.join(f'{key}={_shown(part)}' for key, part in parts.items())})"
    return f"({', '.join(map(_shown, value))})" if isinstance(value, list) else repr(value)
