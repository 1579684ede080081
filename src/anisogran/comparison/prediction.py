"""Predictions: everything is fitted on one cell, frozen, and held against runs of other cells that no parameter has seen.

The rivals on the same rings: the local law, the nonlocal one with its amplitude, the same with the exchange of fluidity at the wall, and
two base lines without mechanics, in wall speeds and grain diameters: the exponential of the calibrated cell and the very profile of it.
"""

from dataclasses import dataclass

import numpy as np
import xarray as xr

from anisogran.comparison.calibration import fitted_amplitude, fitted_wall
from anisogran.comparison.measured import measured, remarks
from anisogran.comparison.measures import exponential_fit, log_rms, near_l2
from anisogran.comparison.pairing import compare, ring_flow, wall_stress_ratio
from anisogran.continuum import LocalMuI, Nonlocal
from anisogran.fitting import mean_and_error
from anisogran.glossary import attributes
from anisogran.outcome import InputError
from anisogran.scenes.keys import keys_of

OBSERVING = {"seed", "travel", "discard", "block", "samples_per_diameter", "frames"}  # keys that leave the cell as it is
RIVALS = "local", "nonlocal", "nonlocal with wall", "exponential", "copy"


@dataclass(frozen=True, eq=False)
class Frozen:
    """All that was fitted, before any predicted run is looked at; standard errors over the calibrating runs (seeds), or over the blocks
    of a single one.

    mu_s, b: given, from homogeneous tests. amplitude: alone; amplitude_with_wall and wall: together. exponential: amplitude in wall speeds,
    length in d. profile: v_phi in wall speeds over the depth in d.
    """

    mu_s: float
    b: float
    amplitude: float
    amplitude_with_wall: float
    wall: float
    exponential: tuple[float, float]
    profile: xr.DataArray
    errors: dict
    reasons: tuple[str, ...]

    def laws(self):
        """{rival: law} of those with mechanics."""
        return {
            "local": LocalMuI(self.mu_s, self.b),
            "nonlocal": Nonlocal(self.mu_s, self.b, self.amplitude),
            "nonlocal with wall": Nonlocal(self.mu_s, self.b, self.amplitude_with_wall, self.wall),
        }


def frozen(runs, mu_s, b):
    """The Frozen parameters from one or more runs of one cell that differ in the seed only (or in how long and often it is looked at).

    Raises InputError for no run or runs of different cells, and what the fits raise.
    """
    runs = [measured(run, "frozen") for run in runs]
    if not runs:
        raise InputError("frozen: needs at least one run")
    for run in runs[1:]:
        same_cell(runs[0].scene, run.scene)
    alone, both = [fitted_amplitude(run, mu_s, b) for run in runs], [fitted_wall(run, mu_s, b) for run in runs]
    found = {"amplitude": (alone, "amplitude"), "amplitude_with_wall": (both, "amplitude"), "wall": (both, "wall")}
    values, errors = {}, {}
    for name, (calibrations, key) in found.items():
        mean, error = mean_and_error([one.values[key] for one in calibrations])
        values[name], errors[name] = float(mean), float(error) if len(runs) > 1 else calibrations[0].errors[key]
    fits = [exponential_fit(run.profiles).values for run in runs]
    speed = np.mean([fit["amplitude"] / run.scene.wall_speed for fit, run in zip(fits, runs, strict=True)])
    exponential = float(speed), float(np.mean([fit["length"] for fit in fits]))
    shortest = min(runs, key=lambda run: run.profiles.sizes["r"]).profiles
    count = shortest.sizes["r"]
    profile = np.mean([run.profiles.v_phi.values[:count] / run.scene.wall_speed for run in runs], axis=0)
    copied = xr.DataArray(profile, {"depth": shortest.depth.values}, dims="depth")
    reasons = tuple(reason for one in (*alone, *both) for reason in one.status.reasons)
    reasons += tuple(reason for run in runs for reason in remarks(run))
    return Frozen(mu_s, b, **values, exponential=exponential, profile=copied, errors=errors, reasons=reasons)


def same_cell(first, other):
    """Raises InputError if two scenes are not of the same cell."""
    for key in ("kind", *(name for name in keys_of(first) if name not in OBSERVING)):
        one, two = getattr(first, key), getattr(other, key, None)
        if one != two:
            raise InputError(f"frozen: the runs that are fitted must differ in the seed only, but {key} is {one} and {two}")


def predictions(parameters, run):
    """What Frozen parameters say of a run, a Dataset over `rival` (and `r`).

    v_phi and v_phi_dem with its error; l2 over the rings nearer than 8 d to the inner one, l2_noise, l2_continuum (error of the solver),
    log_rms over the resolved rings, stress_ratio_wall and that of the grains with its error. NaN where a rival says nothing. The attribute
    `reasons` says what a reader must know of the error bars. Raises InputError and NotConverged as `compare` does.
    """
    run = measured(run, "predictions")
    profiles, speed = run.profiles, run.scene.wall_speed
    depth, rows = profiles.depth.values, {}
    for name, law in parameters.laws().items():
        one = compare(run, ring_flow(run, law).solve(), name)
        rows[name] = one.table.v_phi.values, one.l2, one.l2_continuum, one.log_rms, one.stress_ratio_wall_continuum
    top, length = parameters.exponential
    copied = np.interp(depth, parameters.profile.depth.values, parameters.profile.values, right=np.nan)
    for name, shape in {"exponential": top * np.exp(-depth / length), "copy": copied}.items():
        known = speed * shape
        rows[name] = known, near_l2(profiles, known), np.nan, log_rms(profiles, known), np.nan
    v_phi, l2, l2_continuum, logs, ratios = (np.array([rows[name][k] for name in RIVALS]) for k in range(5))
    noise = profiles.v_phi.values + profiles.v_phi_error.values
    ratio, ratio_error = wall_stress_ratio(run)
    return xr.Dataset(
        {
            "v_phi": (("rival", "r"), v_phi, attributes("v_phi", source="predicted")),
            "v_phi_dem": ("r", profiles.v_phi.values, attributes("v_phi", source="DEM")),
            "v_phi_dem_error": ("r", profiles.v_phi_error.values, profiles.v_phi_error.attrs),
            "l2": ("rival", l2, {"units": "1", "long_name": "relative L2 difference of v_phi over the rings nearer than 8 d"}),
            "l2_noise": ((), near_l2(profiles, noise), {"units": "1", "long_name": "the same of the error bars of the grains"}),
            "l2_continuum": ("rival", l2_continuum, {"units": "1", "long_name": "the same of a finer solution"}),
            "log_rms": ("rival", logs, {"units": "1", "long_name": "root mean square difference of ln v_phi on the resolved rings"}),
            "stress_ratio_wall": ("rival", ratios, attributes("stress_ratio", source="inner ring")),
            "stress_ratio_wall_dem": ((), ratio, attributes("stress_ratio", source="inner ring, DEM")),
            "stress_ratio_wall_dem_error": ((), ratio_error, {"units": "1", "long_name": "standard error of it"}),
        },
        {"rival": list(RIVALS), "r": profiles.r, "depth": profiles.depth},
        {"reasons": "; ".join(one.reasons)},
    )
