"""anisogran: from particle simulations to continuum theory for granular matter.

This is the front door: the names that a user types. Each is resolved when it is first used, so that `import anisogran` loads nothing.
"""

from importlib import import_module

__version__ = "0.1.0"

_ROOMS = {"dem": "dem", "models": "models", "fit": "fitting", "continuum": "continuum", "glossary": "glossary", "tensors": "tensors"}

_NAMES = {
    "InputError": "outcome",
    "NotConverged": "outcome",
    "RunFailed": "outcome",
    "Status": "outcome",
    "Linear": "dem",
    "Luding": "dem",
    "Friction": "dem",
    "contact_path": "dem",
    "Snapshot": "snapshot",
    "element_test": "models",
    "average": "averaging",
    "contact_directions": "averaging",
    "force_network": "averaging",
    "fragments": "averaging",
    "grain_chains": "averaging",
    "RingFlow": "continuum",
    "Biaxial": "experiments",
    "CohesiveGas": "experiments",
    "RingShear": "experiments",
    "RingShearVolume": "experiments",
    "SimpleShear": "experiments",
    "Stiffness": "experiments",
    "Tablet": "experiments",
    "read_scene": "experiments",
    "sweep": "sweeps",
    "sweep_status": "sweeps",
    "collect_sweep": "sweeps",
    "study": "sweeps",
    "open": "files",
    "read_lammps": "files",
    "read_mercury": "files",
    "compare": "comparison",
}

__all__ = sorted([*_ROOMS, *_NAMES])  # noqa: PLE0605


def __getattr__(name):
    if name in _ROOMS:
        value = import_module(f"{__name__}.{_ROOMS[name]}")
    elif name in _NAMES:
        value = getattr(import_module(f"{__name__}.{_NAMES[name]}"), name)
    else:
        raise AttributeError(f"module 'anisogran' has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__():
    return sorted({*globals(), *__all__})
