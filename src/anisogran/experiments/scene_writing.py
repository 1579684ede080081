"""Scenes as TOML: the text of a scene, and the commented file that a new one starts from."""

from anisogran.experiments.scene_keys import keys_of, name_of
from anisogran.experiments.scene_tables import NONE

COLUMN = 32  # where comments begin


def scene_text(scene):
    """TOML from which `read_scene` makes an equal scene; what is None by default and is None is left out."""
    tables = []
    for name, one in keys_of(scene).items():
        record = getattr(scene, name)
        if one.records and record is not None:
            law = [f'law = "{name_of(type(record))}"'] * (len(one.records) > 1)
            tables += ["", f"[{name}]", *law, *_values(record)]
    return "\n".join([f'kind = "{scene.kind}"', *_values(scene), *tables]) + "\n"


def _values(record):
    """The lines of the keys of a record that are numbers, or off against their default."""
    lines = []
    for name, one in keys_of(record).items():
        value = getattr(record, name)
        if value is None:
            lines += [f'{name} = "{NONE}"'] * (one.default is not None)
        elif not one.records:
            lines.append(_line(name, one, value))
    return lines


def _line(name, one, value, comment=""):
    """`name = value  # unit; comment`."""
    said = f"{name} = {_number(one, value)}"
    comment = "; ".join(part for part in (one.suffix, comment) if part)
    return f"{said:{COLUMN}}# {comment}" if comment else said


def _number(one, value):
    """A number as TOML has it."""
    return repr(int(value) if one.whole else float(value))
