"""The minimum of a fit with all that errors are computed from."""

from typing import NamedTuple

import numpy as np

from anisogran.fitting.problem import Problem
from anisogran.fitting.spread import Spread


class Estimate(NamedTuple):
    """`names` of the variables (P,), the `units` that turn scaled variables into those of the data, `scales` of x and y."""

    problem: Problem
    theta: np.ndarray
    spread: Spread
    names: tuple
    units: np.ndarray
    scales: tuple

    def named(self, scaled):
        """{name: value in the units of the data} of scaled variables, shape (P,)."""
        return dict(zip(self.names, (scaled * self.units).tolist(), strict=True))

    @property
    def sigmas(self):
        """One standard error of each scaled variable, nan if there is none."""
        return np.sqrt(np.diag(self.spread.covariance))

    def correlations(self, variables=slice(None)):
        """{(name, name): correlation of the two estimates} of these variables, nan without an error."""
        names, units = np.array(self.names)[variables].tolist(), np.sign(self.units[variables])
        covariance = self.spread.covariance[variables][:, variables] * np.outer(units, units)
        sigma = np.sqrt(np.diag(covariance))
        product = np.outer(sigma, sigma)
        matrix = np.divide(covariance, product, out=np.full(covariance.shape, np.nan), where=product > 0.0).tolist()
        return {(a, b): matrix[i][j] for i, a in enumerate(names) for j, b in enumerate(names[i + 1 :], start=i + 1)}
