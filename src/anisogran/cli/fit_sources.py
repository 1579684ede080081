"""From files to fits: which rows of which file, one data set or several, one fit or several."""

from dataclasses import dataclass, field
from difflib import get_close_matches

import numpy as np

from anisogran.cli.fit_kinds import DERIVED, KINDS, with_peaks
from anisogran.cli.fit_law import calibrated, path_rows
from anisogran.files import read_columns
from anisogran.outcome import InputError


@dataclass(frozen=True)
class RowsOfFile:
    """The rows of one data set by the names a fit knows them by, what they are called in the file, and its conditions."""

    label: str
    path: str
    rows: dict
    names: dict
    conditions: dict


@dataclass(frozen=True)
class Fitted:
    """A FitResult, the data sets it stands on, and what stands beside it."""

    label: str
    result: object
    sets: list
    more: dict = field(default_factory=dict)


def kind_of(name):
    """The `Kind` of this name. Raises InputError with the nearest one."""
    if name not in KINDS:
        close = get_close_matches(name, KINDS, n=1, cutoff=0.5)
        raise InputError(f"fit {name}: must be one of {', '.join(KINDS)}" + (f"; did you mean {close[0]}?" if close else ""))
    return KINDS[name]


def sharing(text):
    """{parameter: "all" or a tuple of conditions} of "s_max=mu,beta=all", or None. Raises InputError for what is not of this form."""
    if text is None:
        return None
    shared = {}
    for part in text.split(","):
        name, equals, by = (word.strip() for word in part.partition("="))
        if not (name and equals and by):
            raise InputError(f"--shared {text}: {part.strip()!r} must be PARAMETER=all or PARAMETER=CONDITION, as s_max=mu,beta=all")
        shared[name] = "all" if by == "all" else tuple(word.strip() for word in by.split("+"))
    return shared


def data_sets(name, kind, files, x=None, y=None, y_error=None, apart=False):
    """The `RowsOfFile` of all files; one of all of them if the points are runs of their own, unless they are to be kept `apart`."""
    if kind.whole and (x or y_error):
        raise InputError(f"fit {name}: takes paths; no --x or --y-error, and --y names the measured columns that count, as sigma_zz,eps_V")
    if kind.panels and (x or y or y_error):
        raise InputError(f"fit {name}: takes {', '.join(names[0] for names in kind.columns)}; no --x, --y or --y-error")
    again = [path for path in files if files.count(path) > 1]
    if again:
        raise InputError(f"{again[0]}: is given {files.count(again[0])} times; a fit must not count data twice")
    labels = [path.stem if [other.stem for other in files].count(path.stem) == 1 else str(path) for path in files]
    tables = [read_columns(path) for path in files]
    if kind.pooled:
        tables = [with_peaks(one) for one in tables]
    if kind.whole:
        return [RowsOfFile(label, one.path, *path_rows(one), one.conditions) for label, one in zip(labels, tables, strict=True)]
    sets = [rows_of(label, one, kind, x, y, y_error) for label, one in zip(labels, tables, strict=True)]
    if not kind.pooled or apart or len(sets) == 1:
        return sets
    known = set.intersection(*(set(one.rows) for one in sets))
    lost = [one.path for one in sets if set(one.rows) != known]
    if lost:
        raise InputError(f"{lost[0]}: has a column of errors, others have none; name it with --y-error or leave it out")
    rows = {key: np.concatenate([one.rows[key] for one in sets]) for key in sets[0].rows}
    return [RowsOfFile(f"{len(sets)} files", ", ".join(one.path for one in sets), rows, sets[0].names, {})]


def rows_of(label, columns, kind, x, y, y_error):
    """The rows of one file. Raises InputError naming file and column."""
    asked = [*kind.columns]
    if x is not None:
        asked[0] = (x,)
    if y is not None:
        asked[-1] = (y,)
    keys = [names[0] for names in kind.columns]
    found, names = {}, {}
    for key, alternatives in zip(keys, asked, strict=True):
        names[key], found[key] = row_of(columns, alternatives, kind.groups)
    for key in kind.optional:
        if columns.has(key, kind.groups):
            found[key] = columns.row(key, kind.groups)
    error = y_error or f"{names[keys[-1]]}_error"
    if y_error is not None or (not kind.panels and there(columns, error, kind.groups)):
        _, found["errors"] = row_of(columns, (error,), kind.groups)
    size = max(row.size for row in found.values())
    for key, row in found.items():
        if row.size not in (1, size):
            raise InputError(f"{columns.path}: {names.get(key, key)} has {row.size} values, others have {size}")
    rows = {key: np.broadcast_to(row, size) for key, row in found.items()}
    return RowsOfFile(label, columns.path, rows, {key: name.rsplit("/", 1)[-1] for key, name in names.items()}, columns.conditions)


def row_of(columns, alternatives, groups):
    """(name, row) of the first alternative that is there, or that can be made of others; else the InputError of the first."""
    for name in alternatives:
        if columns.has(name, groups):
            return name, columns.row(name, groups)
    for name in alternatives:
        if there(columns, name, groups):
            sources, made = DERIVED[name]
            return name, made(*(columns.row(source, groups) for source in sources))
    return alternatives[0], columns.row(alternatives[0], groups)


def there(columns, name, groups):
    """Whether a file has this row, or those that it is made of."""
    return columns.has(name, groups) or (name in DERIVED and all(columns.has(source, groups) for source in DERIVED[name][0]))


def fits(name, kind, sets, shared, law=None, fixed=None, chosen=None):
    """The `Fitted` of the data sets: one each, or one of all of them with shared parameters.

    `law`, `fixed` and the `chosen` columns are for a whole law.
    """
    if kind.whole:
        result, figures = calibrated(sets, law, shared, fixed, chosen)
        return [Fitted(f"{len(sets)} files" if len(sets) > 1 else sets[0].label, result, sets, {"law_figures": figures})]
    if law is not None or fixed is not None:
        raise InputError(f"fit {name}: takes no --law and no --fixed; they are for fit law")
    if shared is not None:
        if kind.together is None:
            able = ", ".join(key for key, one in KINDS.items() if one.together is not None)
            raise InputError(f"fit {name}: has no parameters to share; --shared is for {able or 'no KIND yet'}")
        return [Fitted(f"{len(sets)} files", kind.together(sets, shared), sets)]
    done = []
    for one in sets:
        try:
            result = kind.fit(one.rows)
        except InputError as error:
            raise InputError(f"{one.path}: {error}") from None
        done.append(Fitted(one.label, result, [one], kind.more(one.rows, result) if kind.more else {}))
    return done
