"""The discrete equations of a ring flow: the weak balances in the space, and what the walls do to them."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from anisogran.continuum.assembly import Assembly
from anisogran.continuum.balance import complex_step, stacked
from anisogran.continuum.factors import Factors

NO_REACTION = 1e-6  # share of the largest reaction below which a component of force counts as absent


@dataclass
class System:
    """The equations test @ B^T q(B x) + linear @ x = load, for x in a given one + trial @ (any vector).

    `balance(point)` gives the dict of q, `positive(point)` arrays, linear in the point, that must be above 0. The sparse `trial`
    [unknown, column] has a column for each value that may change: prescribed unknowns have none, tied ones share one. `test`
    [equation, unknown] combines forces: a row with a single 1 asks for balance there. `linear` [equation, unknown] and `load` are
    what the walls add. `fluidity_unit` is the least that counts as a change of the fluidity.
    """

    space: Any
    balance: Any
    positive: Any
    trial: Any
    test: Any
    linear: Any
    load: np.ndarray
    fluidity_unit: float = 0.0
    assembly: Any = None

    def __post_init__(self):
        if self.assembly is None:
            self.assembly = Assembly(self.space.dofs, self.trial, self.test, self.linear)

    def reaction(self, x):
        """B^T q, all rows: where the velocity is prescribed, the force of the wall on the grains."""
        return self.space.residual(stacked(self.balance(self.space.point(x)), self.space.rows, self.space.r))

    def residual(self, x):
        return self.test @ self.reaction(x) + self.linear @ x - self.load

    def factorised(self, x):
        """A sparse factorisation of the tangent; RuntimeError if it is singular."""
        slope = complex_step(self.balance, self.space.points(x), self.space.rows)
        return Factors(self.assembly.matrix(self.space.tangents(slope)))

    def of_fields(self, names):
        """These equations for some fields alone, with the others held."""
        field_of = np.concatenate([np.full(part.stop - part.start, name in names) for name, part in self.space.part.items()])
        columns = np.flatnonzero(self.trial.T @ field_of > 0)
        part = {"trial": self.trial[:, columns], "test": self.test[columns], "linear": self.linear[columns], "load": self.load[columns]}
        return replace(self, **part, assembly=None)

    def positive_values(self, x):
        return self.positive(self.space.point(x))

    def size(self, step, x):
        """The largest change of an unknown, in units of its field."""
        changes = []
        for name, part in self.space.part.items():
            unit = np.abs(x[part]).max() + self.fluidity_unit if name == "g" else 1.0
            changes.append(np.abs(step[part]).max() / unit)
        return float(np.max(changes))  # NaN if there is one, unlike the built-in max

    def imbalance(self, x):
        """The largest force or torque left over on a free velocity, in units of the largest reaction."""
        reactions, ratios = np.abs(self.reaction(x)), []
        left = np.abs(self.trial @ self.residual(x))
        for name in ("u_r", "u_phi"):
            part = self.space.part[name]
            arm = self.space.place[part] if name == "u_phi" else 1.0
            unit = max((arm * reactions[part]).max(), NO_REACTION * (arm * reactions.max()).max())
            ratios.append((arm * left[part]).max() / unit)
        return float(np.max(ratios))
