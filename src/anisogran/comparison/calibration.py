"""What the homogeneous tests do not tell, found on one ring: the nonlocal amplitude, and the fluidity that the wall adds.

The friction law mu_s + b I comes from homogeneous shear and is not touched here. Each parameter is fitted to the velocity over the rings
near the inner one, in relative L2; its error is what the fluctuations of the run, block by block, make of it to first order.
"""

from dataclasses import dataclass
from math import exp, log, sqrt

import numpy as np
from scipy.optimize import least_squares, minimize_scalar

from anisogran.comparison.measured import measured
from anisogran.comparison.measures import near, ring_edges
from anisogran.comparison.pairing import ring_flow
from anisogran.continuum import Nonlocal
from anisogran.outcome import InputError, NotConverged, Status

AMPLITUDES = 0.1, 2.0  # grain diameters
EXCHANGES = -3.0, 0.9  # kappa A / sqrt(mu_s): at 1 a wall at rest would fluidise the grains
NAMES = {"amplitude": "nonlocal amplitude", "wall": "exchange of fluidity at the wall"}  # in the order of the coordinates
STEP = 1e-3  # of the derivatives for the errors, in the logarithm of A and in kappa A / sqrt(mu_s)


@dataclass(frozen=True, eq=False)
class Calibration:
    """A Nonlocal law fitted on one ring; `values` and standard `errors` by name (amplitude in d, wall = kappa), the L2 misfit, a Status."""

    law: Nonlocal
    values: dict
    errors: dict
    l2: float
    status: Status


class _Misfit:
    """The weighted difference of velocities over the near rings, for coordinates (ln A) or (ln A, kappa A / sqrt(mu_s))."""

    def __init__(self, run, mu_s, b):
        self.run, self.mu_s, self.b = run, mu_s, b
        self.used = near(run.profiles)
        self.dem = run.profiles.v_phi.values[self.used]
        root = np.sqrt(run.profiles.r.values[self.used])
        self.weight = root / np.linalg.norm(root * self.dem)

    def law(self, x):
        amplitude = exp(x[0])
        wall = x[1] * sqrt(self.mu_s) / amplitude if len(x) > 1 else None
        return Nonlocal(self.mu_s, self.b, amplitude, wall)

    def velocity(self, x):
        return ring_flow(self.run, self.law(x)).solve().ring_average(ring_edges(self.run.profiles)).v_phi[self.used]

    def __call__(self, x):
        return self.weight * (self.velocity(x) - self.dem)

    def slopes(self, x):
        """d(residual)/dx by central differences, (rings, coordinates)."""
        steps = STEP * np.eye(len(x))
        return np.stack([(self(x + step) - self(x - step)) / (2 * STEP) for step in steps], axis=1)

    def found(self, x, near_bound):
        """The Calibration at x."""
        law = self.law(x)
        values = {"amplitude": law.amplitude} | ({"wall": law.wall} if len(x) > 1 else {})
        status = Status()
        for name in near_bound:
            status = status.warn(f"the best {NAMES[name]} {values[name]:.3g} lies at the bound of its range")
        return Calibration(law, values, self.errors(x, law), float(np.linalg.norm(self(x))), status)

    def errors(self, x, law):
        """Standard errors from the scatter of the blocks; NaN without two blocks."""
        blocks = self.run.blocks
        if blocks is None or blocks.sizes["block"] < 2:
            return dict.fromkeys(list(NAMES)[: len(x)], float("nan"))
        parts = self.weight * (blocks.v_phi.transpose("block", "r").values[:, self.used] - self.dem)
        moved = parts @ np.linalg.pinv(self.slopes(x)).T  # (block, coordinate)
        if len(x) == 1:
            physical = law.amplitude * moved
        else:
            wall = sqrt(self.mu_s) / law.amplitude * moved[:, 1] - law.wall * moved[:, 0]
            physical = np.stack([law.amplitude * moved[:, 0], wall], axis=1)
        errors = physical.std(axis=0, ddof=1) / np.sqrt(len(physical))
        return dict(zip(NAMES, map(float, errors), strict=False))


def fitted_amplitude(run, mu_s, b, bounds=AMPLITUDES):
    """The Calibration of the nonlocal amplitude alone, with dg/dr = 0 at both rings.

    One parameter, fitted on the very run it is then compared with. Its status is "warned" if the best value lies at a bound. Raises
    InputError for a run without ring profiles, and for bounds that do not ascend from above 0.
    """
    if not 0 < bounds[0] < bounds[1]:
        raise InputError(f"fitted_amplitude: bounds = {bounds} must ascend from above 0")
    misfit = _Misfit(measured(run, "fitted_amplitude"), mu_s, b)
    found = minimize_scalar(lambda x: np.linalg.norm(misfit([x])), bounds=np.log(bounds), method="bounded", options={"xatol": 1e-3})
    at_bound = min(abs(found.x - np.log(bounds))) < 5e-3
    return misfit.found(np.array([found.x]), ["amplitude"] if at_bound else [])


def fitted_wall(run, mu_s, b, bounds=AMPLITUDES):
    """The Calibration of the amplitude and of kappa, dg/dr = -(kappa/d) g at the inner ring, together.

    Raises NotConverged if the search ends without a minimum, else as `fitted_amplitude`.
    """
    misfit = _Misfit(measured(run, "fitted_wall"), mu_s, b)
    first = log(fitted_amplitude(run, mu_s, b, bounds).law.amplitude)
    limits = np.array([(log(bounds[0]), EXCHANGES[0]), (log(bounds[1]), EXCHANGES[1])])
    found = least_squares(misfit, [first, 0.0], bounds=limits, x_scale=[0.1, 0.1], diff_step=1e-4, xtol=1e-6, ftol=1e-9)
    if not found.success:
        raise NotConverged(f"fitted_wall: {found.message}", [found.cost], found.x)
    at_bound = np.min(np.abs(found.x - limits), axis=0) < 5e-3
    return misfit.found(found.x, [name for name, at in zip(NAMES, at_bound, strict=True) if at])
