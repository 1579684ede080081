"""The list of laws at a point. A new one is a file with the members of its neighbours, and one line in LAWS."""

from inspect import signature

from anisogran.compiled import specialised
from anisogran.models import inertial_law, plasticity, scalar, tensorial
from anisogran.outcome import InputError, closest

LAWS = {"scalar": scalar, "tensorial": tensorial, "mohr_coulomb": plasticity, "mu_of_I": inertial_law}

_OF_PARAMETERS = {law.Parameters: law for law in LAWS.values()}


def _table(function):
    return specialised({kind: getattr(law, function) for kind, law in _OF_PARAMETERS.items()})


rate, midpoint, trouble, stressed = _table("rate"), _table("midpoint"), _table("trouble"), _table("stressed")


def name_of(parameters):
    """The name of the law whose parameters these are."""
    law = _OF_PARAMETERS[type(parameters)]
    return next(name for name, candidate in LAWS.items() if candidate is law)


def law_parameters(law, **values):
    """The checked parameters of a law by name, as `update` and `element_test` take them.

    Raises InputError for an unknown law, a missing or unknown parameter (naming the nearest), or a value out of bounds.
    """
    if law not in LAWS:
        raise InputError(f"law = {law!r} must be one of {', '.join(LAWS)}")
    build = LAWS[law].checked_parameters
    known = signature(build).parameters
    for key in values:
        if key not in known:
            raise InputError(f"{law} law: unknown parameter {key!r}, did you mean {closest(key, known)!r}? It has {', '.join(known)}")
    missing = [key for key, parameter in known.items() if parameter.default is parameter.empty and key not in values]
    if missing:
        raise InputError(f"{law} law: {', '.join(missing)} missing")
    return build(**values)
