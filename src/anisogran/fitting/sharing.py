"""Which parameter of which data set is which variable of a fit."""

from dataclasses import dataclass
from difflib import get_close_matches
from numbers import Real

import numpy as np

from anisogran.outcome import InputError


@dataclass(frozen=True)
class Sharing:
    """The table parameter x data set; prints as text.

    `variables[label, parameter]` is the name of the variable that this parameter is in this data set: "beta" if one value holds
    for all, "s_max[mu=0.5]" for one that the data sets with this condition share, "s_0[LABEL]" for one of this data set alone.
    `points` and `weights` have the labels as keys.
    """

    parameters: tuple
    labels: tuple
    variables: dict
    points: dict
    weights: dict

    def __str__(self):
        head = ["data set", "points", "weight", *self.parameters]
        rows = [[label, str(self.points[label]), f"{self.weights[label]:.3g}", *self._words(label)] for label in self.labels]
        widths = [max(len(row[i]) for row in [head, *rows]) for i in range(len(head))]
        lines = ["   ".join(word.ljust(width) for word, width in zip(row, widths, strict=True)).rstrip() for row in [head, *rows]]
        count = len(set(self.variables.values()))
        return "\n".join([*lines, f"{count} variables for {sum(self.points.values())} points"])

    def _words(self, label):
        for parameter in self.parameters:
            inside = self.variables[label, parameter].removeprefix(parameter)[1:-1]
            yield "own" if inside == label else inside or "all"


def nearest(word, known):
    """' (did you mean ...?)' or the list of what there is, for a message."""
    close = get_close_matches(str(word), [str(name) for name in known], n=1, cutoff=0.5)
    return f"did you mean {close[0]!r}?" if close else f"there are {', '.join(str(name) for name in known) or 'none'}"


def variables(where, names, labels, conditions, shared):
    """(index, variable names): index[k, j], shape (K, p), is the number of the variable that parameter j is in data set k.

    `shared` maps parameter names to a tuple of names of conditions (data sets with equal values share the parameter), to "all" or
    () for one value for all; parameters without an entry are own. Raises InputError for names that there are not.
    """
    shared = dict(shared or {})
    for name in shared:
        if name not in names:
            raise InputError(f"{where}: shared parameter {name!r} is unknown; {nearest(name, names)}")
    index, found = np.zeros((len(labels), len(names)), dtype=int), {}
    for j, name in enumerate(names):
        for k, label in enumerate(labels):
            variable = name if len(labels) == 1 else _variable(where, name, label, conditions[k], shared.get(name))
            index[k, j] = found.setdefault(variable, len(found))
    return index, tuple(found)


def _variable(where, name, label, conditions, by):
    if by is None:
        return f"{name}[{label}]"
    by = () if by == "all" else (by,) if isinstance(by, str) else tuple(by)
    for condition in by:
        if condition not in conditions:
            raise InputError(
                f"{where}: {name} is shared by {condition!r}, which data set {label!r} does not state; {nearest(condition, conditions)}"
            )
    return f"{name}[{words(conditions, by)}]" if by else name


def words(conditions, by=None):
    """'p=100, mu=0.5'; numbers to 12 digits, which is also when two of them count as equal."""
    values = {key: conditions[key] for key in (conditions if by is None else by)}
    return ", ".join(f"{key}={value:.12g}" if isinstance(value, Real) else f"{key}={value}" for key, value in values.items())
