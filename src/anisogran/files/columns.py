"""Named rows of numbers, with the conditions they were measured under: from a text or CSV table, or from a results file of ours."""

import re
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

import numpy as np

from anisogran.files.results import open as open_results
from anisogran.files.toml_file import parsed_toml, reason_of
from anisogran.outcome import InputError
from anisogran.whole_file import check_no_folder

_CONDITION = re.compile(r"#\s*([A-Za-z_]\w*)\s*=\s*(.+?)\s*$")
_UNITS = re.compile(r"\[[^\]]*\]|\([^)]*\)")
_OF_SCENE = {"pressure": "p", "contact.k1": "k1", "contact.k2": "k2", "contact.kc": "kc", "friction.mu": "mu"}


@dataclass(frozen=True)
class Columns:
    """`rows` {name: (n,) array} and `conditions` {key: number or word} of the file `path`.

    Rows of a results file are named "group/variable".
    """

    path: str
    rows: dict
    conditions: dict

    def row(self, name, groups=()):
        """The row `name`; of a results file "group/variable", or a variable of one of the groups, the first that has it.

        A condition that is a number serves as a row of one value. Raises InputError naming file, column and the nearest known name.
        """
        for candidate in (name, *(f"{group}/{name}" for group in groups)):
            if candidate in self.rows:
                return self.rows[candidate]
        if isinstance(self.conditions.get(name), float):
            return np.array([self.conditions[name]])
        known = {row.rsplit("/", 1)[-1]: row for row in self.rows} | {one: one for one in [*self.rows, *self.conditions]}
        close = get_close_matches(name, known, n=1, cutoff=0.5)
        hint = f"did you mean {known[close[0]]}?" if close else f"there are {', '.join(self.rows) or 'none'}"
        raise InputError(f"{self.path}: no column {name!r}; {hint}")

    def has(self, name, groups=()):
        """Whether `row` finds it."""
        return any(candidate in self.rows for candidate in (name, *(f"{group}/{name}" for group in groups))) or isinstance(
            self.conditions.get(name), float
        )


def read_columns(path):
    """The `Columns` of a results file (.h5, .hdf5) or of a text table.

    A text table has a header line with the names, which may stand behind a #, and below it numbers with commas, semicolons, tabs or
    blanks between; an empty field is nan. Units in brackets behind a name are skipped. Lines `# key = value` are conditions. The scene
    in a results file gives p, mu, k1, k2 and kc. Raises InputError naming file, line, column and value.
    """
    path = Path(path)
    check_no_folder(path, "results.h5")
    return _of_results(path) if path.suffix.lower() in (".h5", ".hdf5") else _of_text(path)


def _of_results(path):
    tree = open_results(path)
    if "vary" in tree.attrs:
        raise InputError(f"{path}: holds all cases of a sweep; give the results.h5 in the folders of the cases")
    rows = {}
    for node in tree.subtree:
        if not node.path.startswith("/snapshots"):
            for name, variable in node.variables.items():
                if variable.ndim == 1 and variable.dtype.kind in "iuf":
                    rows[f"{node.path}/{name}".lstrip("/")] = variable.values.astype(float)
    return Columns(str(path), rows, _scene_conditions(path, tree.attrs.get("scene")))


def _scene_conditions(path, text):
    """The conditions that a scene, a text in TOML, states; a run without friction has 0 of it."""
    if not isinstance(text, str):
        return {}
    try:
        scene = parsed_toml(text)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: its scene is no TOML ({reason_of(error)})") from None
    found = {}
    for key, name in _OF_SCENE.items():
        value = scene
        for part in key.split("."):
            value = value.get(part) if isinstance(value, dict) else None
        if isinstance(value, int | float):
            found[name] = float(value)
    if "kind" in scene and not isinstance(scene.get("friction"), dict):
        found["mu"] = 0.0
    return found


def _of_text(path):
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read as text ({getattr(error, 'strerror', None) or 'not UTF-8'})") from None
    conditions, remark, table = {}, "", []
    for number, line in enumerate(lines, start=1):
        text = line.strip(" ")  # a tab at the end may be an empty field
        found = _CONDITION.match(text)
        if found:
            key, value = found.groups()
            conditions[key] = _number_or_word(value)
        elif text.startswith("#"):
            remark = text.lstrip("# ") if not table else remark
        elif text.strip():
            table.append((number, text))
    if not table:
        raise InputError(f"{path}: holds no table")
    separator = next((mark for mark in ",;\t" if mark in table[0][1]), None)
    names = _fields(table[0][1], separator)
    if all(_is_number(name) for name in names):
        behind = _fields(_UNITS.sub("", remark), next((mark for mark in ",;\t" if mark in remark), None))
        if len(behind) != len(names) or any(_is_number(name) for name in behind):
            raise InputError(f"{path}: line {table[0][0]}: the columns have no names; the first line must name them")
        names = behind
    else:
        names = _fields(_UNITS.sub("", table[0][1]), separator)
        table = table[1:]
    again = [name for name in names if names.count(name) > 1]
    if again:
        raise InputError(f"{path}: {names.count(again[0])} columns have the name {again[0]!r}")
    if not table:
        raise InputError(f"{path}: no numbers below the names {', '.join(names)}")
    return Columns(str(path), dict(zip(names, _numbers(path, table, names), strict=True)), conditions)


def _numbers(path, table, names):
    """The columns of a table of (line number, text); the fast way if all is well, else line by line to name what is not."""
    separator = next((mark for mark in ",;\t" if mark in table[0][1]), None)
    try:
        values = np.loadtxt([text for _, text in table], delimiter=separator, ndmin=2, comments="#").T
        if len(values) == len(names):
            return values
    except ValueError:
        pass  # the line is named below
    rows = []
    for number, text in table:
        fields = _fields(text.split("#")[0], separator)
        if len(fields) != len(names):
            raise InputError(f"{path}: line {number}: {len(fields)} fields for {len(names)} columns ({', '.join(names)})")
        for name, field in zip(names, fields, strict=True):
            if field and not _is_number(field):
                raise InputError(f"{path}: line {number}: {name} = {field!r} is not a number")
        rows.append([float(field) if field else np.nan for field in fields])
    return np.array(rows).T


def _fields(text, separator):
    return [field.strip().strip("\"'") for field in (text.split() if separator is None else text.split(separator))]


def _is_number(text):
    try:
        float(text)
    except ValueError:
        return False
    return True


def _number_or_word(text):
    return float(text) if _is_number(text) else text.strip("\"'")
