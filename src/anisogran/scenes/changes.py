"""A scene with other values, as an option --set or a sweep asks for: "contact.kc=1e5"."""

from anisogran.files.toml_file import parsed_toml
from anisogran.outcome import InputError
from anisogran.scenes.tables import Place, merged, scene_of, tables_of


def changed(scene, changes):
    """The scene with other values, {"contact.kc": 5e4, "seed": 2}. Raises InputError as `read_scene` does."""
    experiment, tables = type(scene), tables_of(scene)
    defaults = tables_of(experiment())
    for key, value in changes.items():
        tables = merged(experiment, tables, nested(key, value), Place(experiment.__name__), defaults)
    return scene_of(experiment, tables, experiment.__name__)


def parsed_override(text, option):
    """(key, value) of a text KEY=VALUE; the value as TOML, or else the text itself. Raises InputError, which begins with `option`."""
    key, equals, value = text.partition("=")
    if not equals or not key.strip() or not value.strip():
        raise InputError(f"{option}: must be KEY=VALUE, such as contact.kc=1e5")
    try:
        content = parsed_toml(f"value = {value}")
    except (ValueError, RecursionError):
        return key.strip(), value.strip()
    return key.strip(), content["value"] if list(content) == ["value"] else value.strip()


def nested(key, value):
    """{"a": {"b": value}} of the key "a.b"."""
    for name in reversed(key.split(".")):
        value = {name: value}
    return value
