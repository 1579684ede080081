"""The TOML file of an element test: read, checked, and written as a template."""

from anisogran.files.toml_file import read_toml
from anisogran.models import LAWS
from anisogran.models.controls import KINDS
from anisogran.outcome import InputError, closest

_KEYS = ("law", "integrator", "steps", "parameters", "start", "control")

_PATHS = {
    "scalar": "biaxial",
    "tensorial": "simple_shear",
    "mohr_coulomb": "biaxial",
    "mu_of_I": "simple_shear",
}
_CONTROLS = {
    "biaxial": ["eps_zz = [0.0, 0.1]  # turning points; [0.0, 0.02, 0.01, 0.1] unloads once", "pressure = 100.0  # sigma_xx, N/m"],
    "simple_shear": [
        "gamma = [0.0, 0.5]  # amount of shear, turning points",
        "sigma_zz = 100.0  # normal stress, N/m; leave it out: constant volume",
    ],
}
_STARTS = {"mu_of_I": ["area_fraction = 0.8199"]}


def read_element(path):
    """The arguments of `element_test` (a dict) from a TOML file.

    Raises InputError, one line with file, table, key and what is allowed, for a file that cannot be read or that says something unknown;
    what the law and the path say about their own keys and bounds is told by `element_test`.
    """
    content = read_toml(path)
    for key in content:
        if key not in _KEYS:
            raise InputError(f"{path}: unknown key {key!r}, did you mean {closest(key, _KEYS)!r}? It has {', '.join(_KEYS)}")
    for key in ("law", "parameters", "control"):
        if key not in content:
            raise InputError(f"{path}: {key} is missing")
    for key in ("parameters", "start", "control"):
        if not isinstance(content.get(key, {}), dict):
            raise InputError(f"{path}: {key} must be a table, [{key}]")
    if not isinstance(content["law"], str) or content["law"] not in LAWS:
        raise InputError(f"{path}: law = {content['law']!r} must be one of {', '.join(LAWS)}")
    content["control"] = _control(path, content["control"])
    return content


def _control(path, table):
    """The control with the path of its `kind` written out."""
    table = dict(table)
    kind = table.pop("kind", None)
    if kind is None:
        return table
    if kind not in KINDS:
        raise InputError(f"{path}: [control] kind = {kind!r} must be one of {', '.join(KINDS)}")
    build = KINDS[kind]
    known = build.__code__.co_varnames[: build.__code__.co_argcount]
    for key in table:
        if key not in (*known, "time"):
            raise InputError(
                f"{path}: [control] unknown key {key!r}, did you mean {closest(key, known)!r}? {kind} has {', '.join(known)}, time"
            )
    time = {"time": table.pop("time")} if "time" in table else {}
    needed = known[: len(known) - len(build.__defaults__ or ())]
    missing = [key for key in needed if key not in table]
    if missing:
        raise InputError(f"{path}: [control] {', '.join(missing)} missing; {kind} has {', '.join(known)}")
    return build(**table) | time


def element_template(law):
    """A file for `read_element` that runs as it is, each key with its unit and meaning. Raises InputError for an unknown law."""
    if law not in LAWS:
        raise InputError(f"law = {law!r} must be one of {', '.join(LAWS)}")
    kind = _PATHS[law]
    lines = [
        f"# An element test: anisogran element FILE. Laws: {', '.join(LAWS)}.",
        f'law = "{law}"',
        'integrator = "midpoint"  # or rk45 (error control), explicit',
        "steps = 1000  # from one turning point to the next",
        "",
        "[parameters]  # compression positive; strains half/half: eps_V = (e1 + e2)/2, eps_D = (e1 - e2)/2",
        *(f"{key} = {example!r}  # {meaning}" + f" [{unit}]" * (unit != "1") for key, (unit, meaning, example) in LAWS[law].KEYS.items()),
        "",
        "# [start]  # default: isotropic, at the prescribed stress; sigma_xx, sigma_zz, sigma_xz, "
        + ", ".join(name for name in LAWS[law].INTERNAL if name),
        *(["[start]", *_STARTS[law]] if law in _STARTS else []),
        "",
        "[control]",
        f'kind = "{kind}"  # or {", ".join(other for other in KINDS if other != kind)}; or no kind, and three of',
        "# eps_ or sigma_ xx, zz, xz, V, D as numbers or turning points, with spin [rad] and time [s] if they matter",
        *_CONTROLS[kind],
        *(["time = [0.0, 1.0]  # s"] if law in _STARTS else []),
    ]
    return "\n".join(lines) + "\n"
