"""The file of a continuum problem: kind = "ring_flow" and the keys of RingFlow in TOML, with its law in the table [law].

kind = "ring_flow"
r_inner = 13.0          # or "13 m"
...
[law]
law = "nonlocal"        # mu_s, b, amplitude, ...
"""

from anisogran.continuum import Nonlocal, RingFlow
from anisogran.files.toml_file import read_toml
from anisogran.outcome import InputError, shown
from anisogran.scenes.changes import nested, parsed_override
from anisogran.scenes.keys import keys_of
from anisogran.scenes.tables import Place, merged, scene_of
from anisogran.scenes.writing import scene_template

EXAMPLE = RingFlow(13.0, 33.0, Nonlocal(0.26, 1.0, 0.9), 1e-3, 1.0)


def read_flow(path, overrides=()):
    """The RingFlow of a file; what it leaves out is the default. `overrides` are texts KEY=VALUE such as "law.b=0.9", applied last.

    Raises InputError, one line naming file (or --set), table, key, value and bound.
    """
    content = read_toml(path)
    kind = content.pop("kind", None)
    if kind != RingFlow.kind:
        raise InputError(f'{path}: kind = {shown(kind)} must be "{RingFlow.kind}"')
    absent, where = dict.fromkeys(keys_of(RingFlow)), str(path)
    tables = merged(RingFlow, {}, content, Place(path), absent)
    flow = scene_of(RingFlow, tables, where)
    for text in overrides:
        option = " ".join(f"--set {text}".split())
        tables = merged(RingFlow, tables, nested(*parsed_override(text, option)), Place(option), absent)
        where += f" with {option}"
    return scene_of(RingFlow, tables, where) if overrides else flow


def flow_template():
    """A commented file for `read_flow` that runs as it is: every key with unit, range and meaning, and all laws."""
    return scene_template(RingFlow, quick=False, scene=EXAMPLE)
