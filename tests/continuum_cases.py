"""One law of every kind in the list, with the examples that its keys give: a new law gets the general tests for free."""

from anisogran.continuum import LAWS
from anisogran.keys import REQUIRED, record_keys


def example(law, **changes):
    """The law with the examples of its keys where there is no default."""
    return law(**{name: one.example for name, one in record_keys(law).items() if one.default is REQUIRED} | changes)


CASES = [example(law) for law in LAWS]
LOCAL = [law for law in CASES if "g" not in law.fields]


def name(law):
    return law.kind
