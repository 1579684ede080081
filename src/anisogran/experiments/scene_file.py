"""Scene files: a kind of experiment and its keys in TOML, the same that its record takes in Python.

kind = "biaxial"
pressure = 100.0        # or "100 N/m"
friction = "none"       # switches off what has a default
[contact]
law = "luding"          # k1, k2, ...
[quick]                 # what replaces the above in a quick run
n = 150
"""

from anisogran.experiments.kinds import experiment_of
from anisogran.files.toml_file import parsed_toml, read_toml, reason_of
from anisogran.outcome import InputError, shown
from anisogran.scenes.changes import nested, parsed_override
from anisogran.scenes.tables import Place, merged, scene_of, tables_of


def read_scene(path, overrides=(), quick=False):
    """The Experiment of a scene file; what it leaves out is the default of the experiment.

    `overrides` are texts KEY=VALUE such as "contact.kc=1e5" or "friction=none", applied last. `quick`: with the keys of its table
    [quick]. Raises InputError, one line naming file (or --set), table, key, value and bound.
    """
    content = read_toml(path)
    experiment = experiment_of(content.pop("kind", None), f"{path}: kind")
    smaller = content.pop("quick", None)
    tables, defaults, where = merged(experiment, {}, content, Place(path)), tables_of(experiment()), str(path)
    scene = scene_of(experiment, tables, where)
    if smaller is None and quick:
        raise InputError(f"{path}: has no table [quick]")
    if smaller is not None:
        if not isinstance(smaller, dict):
            raise InputError(f"{path}: quick = {shown(smaller)} must be a table, [quick]")
        reduced = merged(experiment, tables, smaller, Place(path, "quick"), defaults)
        small = scene_of(experiment, reduced, f"{path} with [quick]")  # also if it is not wanted: a file is right or wrong as a whole
        if quick:
            tables, scene, where = reduced, small, f"{path} with [quick]"
    if not overrides:
        return scene
    options = [" ".join(f"--set {text}".split()) for text in overrides]  # on one line, whatever they are
    for text, option in zip(overrides, options, strict=True):
        tables = merged(experiment, tables, nested(*parsed_override(text, option)), Place(option), defaults)
    return scene_of(experiment, tables, f"{where} with {' '.join(options)}")


def scene_from(text, where):
    """The Experiment of a text that `scene_text` has made. Raises InputError."""
    try:
        content = parsed_toml(text)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{where}: the scene is no TOML ({reason_of(error)})") from None
    experiment = experiment_of(content.pop("kind", None), f"{where}: kind")
    return scene_of(experiment, merged(experiment, {}, content, Place(where)), where)
