"""The rotations of the grains in the ring: whether the stress is symmetric, so that no couples act on the flow, and the spin's length."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator

from anisogran.comparison.measured import measured
from anisogran.comparison.measures import ring_edges
from anisogran.continuum import SpinEquation
from anisogran.fitting.least_squares import Parameter, fit_curve
from anisogran.fitting.observations import observations
from anisogran.outcome import InputError

FINENESS = 40  # elements in a ring of the profile
LENGTHS = np.geomspace(0.05, 5.0, 12)  # starts, in diameters


class Asymmetry(NamedTuple):
    """sigma_rphi - sigma_phir (N/m) on the rings of a profile, its standard error from blocks, and sigma_rphi itself; each (rings,)."""

    r: np.ndarray
    difference: np.ndarray
    error: np.ndarray
    shear_stress: np.ndarray

    @property
    def largest(self):
        """The largest difference in standard errors."""
        return float(np.max(np.abs(self.difference) / self.error))

    @property
    def share(self):
        """Root mean square of the difference over that of the shear stress."""
        return float(np.sqrt(np.mean(self.difference**2) / np.mean(self.shear_stress**2)))


def asymmetry(run):
    """The Asymmetry of the stress in a RingShear run, or a results file of one.

    Where it is nothing within its error, couple stresses do not act on the flow (r d(sigma_rphi)/dr + sigma_rphi + sigma_phir = 0 is then
    the whole balance) and the spin can be solved after it. Raises InputError for a run with fewer than two blocks.
    """
    run = measured(run, "asymmetry")
    if run.blocks is None or run.blocks.sizes["block"] < 2:
        raise InputError("asymmetry: the run has no blocks for an error; let it travel for two blocks or more after what it discards")
    stress = run.blocks.stress.transpose("i", "j", "block", "r").values
    each = stress[0, 1] - stress[1, 0]
    error = np.std(each, axis=0, ddof=1) / np.sqrt(len(each))
    return Asymmetry(run.profiles.r.values, np.mean(each, axis=0), error, np.mean(stress[0, 1], axis=0))


def spin_length(run, inner=None):
    """Fit of the length l of the couple-stress equation to the eigen-rotation of the grains: `FitResult` with `length` (m).

    The spin of the mean flow is the grains' own, on the rings of the profile, so that no error of a flow law comes in; each ring counts
    by its block error. `inner`: None for no couple at the inner ring, "ring" if the grains turn with it; no couple at the outer one.
    The verdict must be read: where the grains turn with the flow there is no signal, and layers of grains that roll on each other, as
    at a ring, are no continuum. Raises InputError for a run without rotations or block errors, or another condition.
    """
    if inner not in (None, "ring"):
        raise InputError(f'spin_length: inner = {inner!r} must be None or "ring"')
    run = measured(run, "spin_length")
    profiles, d = run.profiles, run.scene.mean_diameter
    for name in ("continuum_spin", "eigen_rotation", "eigen_rotation_error"):
        if name not in profiles:
            raise InputError(f"spin_length: the profiles have no {name}")
    speed = run.scene.wall_speed / run.scene.inner_radius
    data = observations("spin_length", profiles.r, profiles.eigen_rotation, profiles.eigen_rotation_error, parameters=1)

    def curve_in(length, rate):
        """omega*(r; l) with lengths and rates in these units."""
        edges, r = ring_edges(profiles) / length, profiles.r.values / length
        flow = PchipInterpolator(r, profiles.continuum_spin.values / rate)
        equation = SpinEquation(mesh(edges), lambda x: flow(np.clip(x, r[0], r[-1])))
        means = equation.ring_means(edges)
        follows = means @ equation.solve(0.0)  # W itself, seen through the same elements
        turning = speed / rate if inner == "ring" else None

        def curve(x, length):
            return np.interp(x, r, means @ equation.solve(length, inner=turning) - follows)  # on the rings themselves, exact

        return curve

    rate = float(np.max(np.abs(profiles.continuum_spin.values)))
    return fit_curve(
        "l^2 lap omega = 2 (omega - W)",
        curve_in(d, rate),
        (Parameter("length", d, 0.0, 20.0),),
        data,
        LENGTHS[:, None],
        scales=(d, rate),
        series=True,
        curve_of_data=curve_in(1.0, 1.0),
    )


def mesh(edges):
    """FINENESS equal elements in every ring."""
    return np.concatenate([np.linspace(a, b, FINENESS + 1)[:-1] for a, b in pairwise(edges)] + [edges[-1:]])
