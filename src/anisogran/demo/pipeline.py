"""What the demo does with its runs: fits the laws, solves the continuum with them, and compares. Every number comes from this run."""

import time
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from anisogran.comparison import (
    best_exponential,
    compare,
    decay_length_error,
    equilibrium,
    fitted_amplitude,
    homogeneous_friction,
    log_rms,
    relative_l2,
    ring_flow,
)
from anisogran.continuum import LocalMuI
from anisogran.cost.main_job import MainJob
from anisogran.demo.biaxial_law import biaxial_law, box_numbers
from anisogran.demo.grains import of_kind, run_grains, shared_out, told
from anisogran.experiments.steady_shear import steady_state


@dataclass(frozen=True)
class Findings:
    """All that the demo found; `numbers` is the dict that goes to --json, flat but for `accuracy`, which a promise adds."""

    scene: MainJob
    boxes: list  # Runs
    ring: object  # Run
    shear: xr.Dataset  # steady values over the inertial numbers
    laws: list  # BiaxialLaw of each box
    friction: object  # FitResult of mu(I)
    flows: dict  # name: Flow
    comparisons: list  # Comparison
    exponential: np.ndarray  # the two-parameter base line on the rings
    numbers: dict
    reasons: list  # sentences that a reader must see
    kept: object = None  # Kept, for a demo that promised an accuracy

    @property
    def biaxial(self):
        """The first box, which is shown."""
        return self.boxes[0]

    @property
    def law(self):
        """Its law."""
        return self.laws[0]


def run_demo(scene, progress):
    """The Findings of a MainJob; `progress(fractions of the particle runs)` is called several times a second.

    Raises RunFailed if a simulation stops and NotConverged if the continuum has no solution.
    """
    clock = time.perf_counter()
    runs = [run for job in run_grains(shared_out(scene.experiments()), progress) for run in job]
    [ring], boxes, tests = (of_kind(runs, kind) for kind in ("ring_shear", "biaxial", "simple_shear"))
    grains_done = time.perf_counter()

    box_laws = [biaxial_law(box) for box in boxes]
    shear = xr.concat([steady_state(run) for run in tests], "test")
    friction = homogeneous_friction(shear)
    mu_s, b = friction.values["mu_s"], friction.values["b"]

    calibration = fitted_amplitude(ring, mu_s, b)
    laws = {"local": LocalMuI(mu_s=mu_s, b=b), "nonlocal": calibration.law}
    flows = {name: replace(ring_flow(ring, constitutive), elements=scene.elements).solve() for name, constitutive in laws.items()}
    comparisons = [compare(ring, flow, name) for name, flow in flows.items()]
    local, nonlocal_ = comparisons
    exponential = best_exponential(ring.profiles)

    balance = equilibrium(ring.profiles)
    numbers = {
        "wall_s": None,  # known only when the report is written
        "grains_s": grains_done - clock,
        **box_numbers(box_laws),
        "mu_s": mu_s,
        "mu_s_err": friction.errors["mu_s"],
        "b": b,
        "b_err": friction.errors["b"],
        "mu_source": "periodic simple shear",
        "nonlocal_amplitude": calibration.values["amplitude"],
        "nonlocal_amplitude_err": calibration.errors["amplitude"],
        "decay_length_dem": local.decay_length_dem,
        "decay_length_dem_err": decay_length_error(ring),
        "decay_length_continuum": nonlocal_.decay_length_continuum,
        "l2_local": local.l2,
        "l2_nonlocal": nonlocal_.l2,
        "l2_exponential": relative_l2(exponential, ring.profiles.v_phi.values, ring.profiles.r.values),
        "l2_noise": local.l2_noise,
        "log_rms_local": local.log_rms,
        "log_rms_nonlocal": nonlocal_.log_rms,
        "log_rms_exponential": log_rms(ring.profiles, exponential),
        "stress_ratio_wall_dem": local.stress_ratio_wall_dem,
        "stress_ratio_wall_local": local.stress_ratio_wall_continuum,
        "stress_ratio_wall_nonlocal": nonlocal_.stress_ratio_wall_continuum,
        **balance,
        "particle_steps_per_s": ring.provenance["particle_steps_per_s"],
        "grain_steps": sum(int(run.provenance["grain_steps"]) for run in runs),
        "seed": scene.seed,
    }
    reasons = [f"{name}: {text}" for name, text in _warnings(runs, box_laws, friction, flows, calibration)]
    return Findings(scene, boxes, ring, shear, box_laws, friction, flows, comparisons, exponential, numbers, reasons)


def _warnings(runs, box_laws, friction, flows, calibration):
    """(where, sentence) for everything that ended less than well."""
    statuses = {told(run): run.status for run in runs} | {"nonlocal amplitude": calibration.status}
    statuses |= {f"continuum, {name}": flow.status for name, flow in flows.items()}
    for name, status in statuses.items():
        yield from ((name, reason) for reason in status.reasons)
    fits = {"fit of mu(I)": friction}
    for k, law in enumerate(box_laws):
        box = f", box {k + 1}" if len(box_laws) > 1 else ""
        fits |= {f"fit of s_D{box}": law.fits["s_D"], f"fit of the anisotropy{box}": law.fits["anisotropy"]}
    for name, fit in fits.items():
        yield from ((name, f"not trustworthy: {reason}") for reason in fit.verdict.reasons)
