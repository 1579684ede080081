"""The JSON schema of scene files, for editors that complete and check TOML, and for other programs that write scenes."""

import re

from anisogran.keys import REQUIRED
from anisogran.scenes.keys import keys_of, name_of
from anisogran.scenes.tables import NONE, NUMBER

LIMITS = {"above": "exclusiveMinimum", "at_least": "minimum", "below": "exclusiveMaximum", "at_most": "maximum"}
OFF = {"const": NONE}


def scene_schema(experiment):
    """The JSON schema (draft 2020-12) of the scene files of an experiment, a class; a dict; "unit" stands beside each description.

    It knows what concerns one key; what concerns several, as k2 >= k1, only `read_scene` does.
    """
    quick = table_schema(experiment, whole=False) | {"description": "what replaces the keys above in a quick run"}
    schema = table_schema(experiment, whole=True)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": experiment.kind,
        "description": experiment.__doc__.splitlines()[0],
        **schema,
        "properties": {"kind": {"const": experiment.kind}, **schema["properties"], "quick": quick},
        "required": ["kind", *schema["required"]],
    }


def table_schema(record, whole, law=None):
    """The schema of a table; `whole`: with what it must have; `law`: the name that it says, where there is a choice."""
    keys = keys_of(record)
    properties = {name: key_schema(one, whole) for name, one in keys.items()}
    required = [name for name, one in keys.items() if one.default is REQUIRED]
    if law is not None:
        properties, required = {"law": {"const": law}, **properties}, ["law", *required]
    return {"type": "object", "properties": properties, "required": required if whole else [], "additionalProperties": False}


def key_schema(one, whole):
    """The schema of one key: a number, the same with its unit as text, a switch, one of some words, a table, or "none"."""
    if one.records:
        choice = len(one.records) > 1
        forms = [table_schema(record, whole, name_of(record) if choice else None) for record in one.records]
        about = {"description": one.meaning}
    elif one.switch:
        forms, about = [{"type": "boolean"}], {"description": one.meaning, "default": one.default}
    elif one.words:
        forms, about = [{"enum": list(one.words)}], {"description": one.meaning, "default": one.default}
    else:
        limits = {LIMITS[name]: bound for name, bound in one.bounds.items() if bound is not None}
        forms = [{"type": "integer" if one.whole else "number", **limits}]
        if one.suffix:
            forms.append({"type": "string", "pattern": rf"^\s*{NUMBER}\s*{re.escape(one.unit)}\s*$"})
        about = {"description": one.meaning, "unit": one.unit}
        if one.default not in (REQUIRED, None):
            about["default"] = one.default
    return about | {"anyOf": forms + [OFF] * one.optional}
