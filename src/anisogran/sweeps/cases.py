"""What a sweep varies, in words and as values, and the scene of each of its cases."""

import itertools
import math
import re

from anisogran.experiments.experiment import Experiment
from anisogran.outcome import InputError, shown
from anisogran.scenes.changes import nested, parsed_override
from anisogran.scenes.tables import Place, merged, scene_of, tables_of

MANY = 10_000  # cases
RANGE = re.compile(r"\s*([+-]?\d{1,18})\.\.([+-]?\d{1,18})\s*")
NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9._-]{0,63}")  # of the folder of a case


def parsed_vary(texts):
    """{key: [values]} of texts such as "contact.kc=0,5e4,1e5" or "seed=1..6". Raises InputError naming the one that is not of this form."""
    vary = {}
    for text in texts:
        key, equals, values = (part.strip() for part in text.partition("="))
        if not (key and equals and values):
            raise InputError(f"--vary {text}: must be KEY=VALUES, such as contact.kc=0,5e4,1e5 or seed=1..6")
        if key in vary:
            raise InputError(f"--vary {text}: {key} is varied already; give all its values at once")
        vary[key] = [value for part in values.split(",") for value in _parsed_values(key, part, text)]
    return vary


def _parsed_values(key, part, text):
    """What stands between two commas: one value, or a range of whole numbers with both its ends."""
    between = RANGE.fullmatch(part)
    if between:
        first, last = map(int, between.groups())
        if not 0 <= last - first < MANY:
            raise InputError(f"--vary {text}: {part.strip()} must rise, by less than {MANY}")
        return range(first, last + 1)
    if not part.strip():
        raise InputError(f"--vary {text}: a value is missing between two commas")
    return [parsed_override(f"{key}={part}", f"--vary {text}")[1]]


def case_scenes(scene, vary):
    """({key: [values as the scene has them]}, {(values of a case): its Experiment}) of a scene and all combinations of {key: values}.

    The last key varies fastest. Raises InputError, one line with key, value and bound, for the first value or combination that cannot be.
    """
    if not isinstance(vary, dict) or not vary:
        raise InputError(f"vary = {shown(vary)} must be a dict of keys and their values, such as {{'contact.kc': [0, 5e4]}}")
    if not isinstance(scene, Experiment):
        raise InputError(f"scene = {shown(scene)} must be an experiment, such as Biaxial(pressure=100.0) or read_scene(file)")
    experiment, tables = type(scene), tables_of(scene)
    defaults = tables_of(experiment())

    def with_values(tables, values):
        for key, value in values:
            tables = merged(experiment, tables, nested(key, value), Place(f"--vary {key}"), defaults)
        return tables

    plain = {}
    for key, values in vary.items():
        if not isinstance(key, str):
            raise InputError(f"vary: {shown(key)} is no key, such as 'contact.kc'")
        inside = next((other for other in map(str, vary) if other.startswith(f"{key}.")), None)
        if inside is not None:
            raise InputError(f"--vary {key}: {inside} lies in it; vary one of them")
        found = [value_of(with_values(tables, [(key, value)]), key) for value in _listed(key, values)]
        twice = next((value for k, value in enumerate(found) if value in found[:k]), ...)
        if twice is not ...:
            raise InputError(f"--vary {key}: {text_of(twice)} is there twice")
        plain[key] = found
    count = math.prod(map(len, plain.values()))
    if count > MANY:
        raise InputError(f"--vary {' '.join(plain)}: {count} cases, at most {MANY} are taken")
    scenes = {}
    for values in itertools.product(*plain.values()):
        case = list(zip(plain, values, strict=True))
        where = " ".join(f"--vary {key}={text_of(value)}" for key, value in case)
        scenes[values] = scene_of(experiment, with_values(tables, case), where)
    return plain, scenes


def _listed(key, values):
    """The values of a key as a list that is not too long. Raises InputError."""
    if isinstance(values, str | bytes | dict):
        raise InputError(f"--vary {key}: {shown(values)} must be a list of values")
    try:
        values = list(itertools.islice(values, MANY + 1))
    except TypeError:
        raise InputError(f"--vary {key}: {shown(values)} must be a list of values") from None
    if not 0 < len(values) <= MANY:
        raise InputError(f"--vary {key}: takes 1 to {MANY} values")
    return values


def value_of(tables, key):
    """What nested tables hold for a key with dots: a number, None or the name of a law. Raises InputError if it is a table."""
    for name in key.split("."):
        tables = tables[name]
    if isinstance(tables, dict):
        raise InputError(f"--vary {key}: is a table; vary one of its keys, {', '.join(f'{key}.{name}' for name in tables)}")
    return tables


def text_of(value):
    """A value in few letters, from which it can be read back."""
    if not isinstance(value, float):
        return "none" if value is None else str(value)
    short = f"{value:g}" if float(f"{value:g}") == value else repr(value)
    return re.sub(r"e\+?(-?)0*", r"e\1", short)


def case_name(case, taken):
    """A name for the folder of the case {key: value}, of letters that every system takes; none of those `taken`."""
    name = "-".join(f"{key}_{text_of(value)}" for key, value in case.items())
    if NAME.fullmatch(name) and name not in taken:
        return name
    return next(name for name in (f"case-{k:04d}" for k in itertools.count(1)) if name not in taken)
