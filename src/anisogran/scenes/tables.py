"""A scene as nested tables of plain values: what files, options and sweeps say is merged into them, and a scene built from the whole.

Every value is checked where it is said, so that a complaint names the place; what concerns several keys is checked on the whole.
"""

import re
from typing import NamedTuple

from anisogran.keys import check_value, unknown_key
from anisogran.outcome import InputError, shown
from anisogran.scenes.keys import built, chosen, homes, keys_of, name_of

NONE = "none"  # what a file says for None
NUMBER = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"  # also in the JSON schema


class Place(NamedTuple):
    """Where something is said: a file (or an option, or a class), and the table in it."""

    file: str
    table: str = ""

    def __str__(self):
        return f"{self.file}:" + f" [{self.table}]" * bool(self.table)

    def key(self, name):
        """The key as it follows the file in a message."""
        return f"[{self.table}] {name}" if self.table else name

    def inside(self, table):
        """The place of a table inside."""
        return Place(self.file, f"{self.table}.{table}" if self.table else table)


def tables_of(record):
    """Nested tables of an experiment or a contact effect, nothing left out; a table has its "law" where there is a choice."""
    tables = {}
    for name, one in keys_of(record).items():
        value = getattr(record, name)
        tables[name] = table_of(one, value) if one.records and value is not None else value
    return tables


def table_of(one, record):
    """The table of a record that is the value of the Key `one`."""
    return ({"law": name_of(type(record))} if len(one.records) > 1 else {}) | tables_of(record)


def merged(experiment, tables, changes, place, absent=None):
    """The tables with the changes (nested, as a file has them) in place of what they replace; raises InputError for the first bad one.

    A table that is changed but not there starts from that of `absent`. Without `absent` this is a whole file: each table stands for
    itself, and says its law if there are several.
    """
    result, keys = dict(tables), keys_of(experiment)
    for name, value in changes.items():
        if name == "kind":
            raise InputError(f"{place} kind cannot be changed, it is {experiment.kind}")
        if name == "quick":
            raise InputError(f"{place} quick is a table of scene files, which the option --quick takes")
        if name not in keys:
            known = [*keys, "quick"] if absent is None else keys
            raise unknown_key(place, name, experiment.kind, known, homes(experiment, name))
        one = keys[name]
        if not one.records:
            result[name] = plain_value(one, name, value, place)
        elif one.optional and (value is None or value == NONE):
            result[name] = None
        elif isinstance(value, one.records):
            result[name] = table_of(one, value)
        elif isinstance(value, dict):
            start = None if absent is None else tables.get(name, absent[name])
            result[name] = _merged_table(experiment, one.records, start or {}, value, place.inside(name))
        else:
            off = f', or "{NONE}"' * one.optional
            raise InputError(f"{place} {name} = {shown(value)} must be a table, [{place.inside(name).table}]{off}")
    return result


def _merged_table(experiment, records, start, changes, place):
    """As `merged`, for a table inside; another law begins anew."""
    choice, record = {}, records[0]
    if len(records) > 1:
        law = changes.get("law", start.get("law"))
        record = chosen(records, law, f"{place} law")
        changes = {name: value for name, value in changes.items() if name != "law"}
        choice, start = {"law": law}, start if start.get("law") == law else {}
    keys, values = keys_of(record), {}
    for name, value in changes.items():
        if name not in keys:
            raise unknown_key(place, name, name_of(record), keys, homes(experiment, name))
        values[name] = plain_value(keys[name], name, value, place)
    return choice | start | values


def plain_value(one, name, value, place):
    """What a file says for a Key: a number, or text with its unit, a switch, a word, or None. Raises InputError for what it may not be."""
    if isinstance(value, dict | list):
        wanted = one.range if one.words or one.switch else "a number"
        raise InputError(f"{place} {name} must be {wanted}, not a {'table' if isinstance(value, dict) else 'list'}")
    if isinstance(value, str) and not one.words and not one.switch:
        if value == NONE and one.optional:
            return None
        said = re.fullmatch(rf"\s*({NUMBER})\s*((?:[^\W\d]|%).*)?\s*", value)  # what begins with a comma is no unit
        if said is None:
            raise InputError(f"{place} {name} = {shown(value)} is not a number")
        number, unit = said[1], said[2] or ""
        if not one.suffix:
            raise InputError(f"{place} {name} = {shown(value)} must be a number without quotes or unit")
        if unit.strip() != one.unit:
            raise InputError(f"{place} {name} = {shown(value)} must have the unit {one.unit}, or none and no quotes")
        value = float(number)
    return check_value(place.file, place.key(name), one, value)


def scene_of(experiment, tables, where):
    """The experiment with these tables; raises InputError where they do not fit each other or lack a key."""
    keys = keys_of(experiment)
    values = {}
    for name, value in tables.items():
        if isinstance(value, dict):
            record = chosen(keys[name].records, value["law"], where) if "law" in value else keys[name].records[0]
            value = built(record, value, f"{where}: [{name}]")
        values[name] = value
    return built(experiment, values, f"{where}:")
