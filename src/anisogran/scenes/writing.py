"""Scenes as TOML: the text of a scene, and the commented file that a new one starts from."""

from anisogran.keys import REQUIRED
from anisogran.scenes.keys import keys_of, name_of
from anisogran.scenes.tables import NONE

COLUMN = 28  # where comments begin


def scene_text(scene):
    """TOML from which `read_scene` makes an equal scene; what is None by default and is None is left out."""
    tables = []
    for name, one in keys_of(scene).items():
        record = getattr(scene, name)
        if one.records and record is not None:
            law = [f'law = "{name_of(type(record))}"'] * (len(one.records) > 1)
            tables += ["", f"[{name}]", *law, *_values(record)]
    return "\n".join([f'kind = "{scene.kind}"', *_values(scene), *tables]) + "\n"


def scene_template(experiment, quick=True, scene=None):
    """The commented file of the default scene of an experiment, a class, or of this `scene`: every key with unit, range and meaning.

    `quick`: with a table of small sizes.
    """
    scene, keys = experiment() if scene is None else scene, keys_of(experiment)
    needed = [name for name, one in keys.items() if one.default is REQUIRED]
    lines = [
        f"# {experiment.__doc__.splitlines()[0]}",
        '# A number may bring its unit, as "1 N/m", the one in brackets. A key or table that is left out is as it stands here.',
        *[f"# These must be given: {', '.join(needed)}."] * bool(needed),
        f'kind = "{experiment.kind}"',
        *_explained(keys, vars(scene)),
    ]
    for name, one in keys.items():
        if one.records:
            lines += ["", *_explained_table(name, one, getattr(scene, name))]
    if quick:
        lines += ["", _commented("[quick]", "what replaces the above in a quick run; [quick.contact] may, too")]
        lines += [_line(name, keys[name], value) for name, value in experiment.quick.items()]
    return "\n".join(lines) + "\n"


def _explained(keys, values):
    """The lines of the keys that are numbers, with unit, range and meaning; without a value a key is a comment with an example."""
    lines = []
    for name, one in keys.items():
        if not one.records:
            value = values.get(name)
            off = value is None
            about = "; ".join(part for part in (one.suffix, one.range) if part)
            said = f"{'# ' * off}{name} = {_number(one, one.example if off else value)}"
            lines.append(_commented(said, one.meaning + f" [{about}]" * bool(about)))
    return lines


def _explained_table(name, one, record):
    """The lines of a table, then what it holds with each other law, as comments; all are comments if the scene lacks the table."""
    present = one.records[0] if record is None else type(record)
    off = f'; to switch it off, {name} = "{NONE}" above all tables' if one.optional and record is not None else ""
    lines = [_commented(f"[{name}]", one.meaning + off)]
    for law in (present, *(other for other in one.records if other is not present)):
        keys = keys_of(law)
        values = {key: part.example if part.default is REQUIRED else part.default for key, part in keys.items()}
        if record is not None and law is present:
            values = vars(record)
        named = [f'law = "{name_of(law)}"'] if len(one.records) > 1 else []
        block = named + _explained(keys, values)
        lines += block if law is present else ["# or", *(f"# {line}" for line in block)]
    return [f"# {line}" for line in lines] if record is None else lines


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


def _line(name, one, value):
    """`name = value  # unit`."""
    return _commented(f"{name} = {_number(one, value)}", one.suffix)


def _number(one, value):
    """A number, a switch, or a word, as TOML has it."""
    if one.switch:
        return str(bool(value)).lower()
    return f'"{value}"' if one.words else repr(int(value) if one.whole else float(value))


def _commented(line, comment):
    """The line with a comment, if there is one, in its column."""
    return f"{line:{COLUMN}}# {comment}" if comment else line
