"""What the demo does with its runs: fits the laws, solves the continuum with them, and compares. Every number comes from this run."""

import time
from dataclasses import dataclass, field

import numpy as np
import xarray as xr

from anisogran import fitting
from anisogran.comparison import (
    best_exponential,
    compare,
    decay_length_error,
    equilibrium,
    fitted_amplitude,
    log_rms,
    relative_l2,
    ring_flow,
)
from anisogran.continuum import LocalMuI
from anisogran.dem import Friction, Luding
from anisogran.demo.biaxial_law import biaxial_law
from anisogran.demo.grains import demo_jobs, run_grains
from anisogran.experiments import Biaxial, RingShear
from anisogran.experiments.steady_shear import steady_state


@dataclass(frozen=True)
class DemoScene:
    """Sizes of the demo. The default takes about a minute on two cores; `small()` a few seconds, for tests."""

    seed: int = 1
    biaxial: Biaxial = field(
        default_factory=lambda: Biaxial(
            n=1000, friction=Friction(stiffness=2e4, mu=0.5), contact=Luding(k1=5e4, k2=1e5, damping=0.1), wall_mass=1e-3
        )
    )
    ring: RingShear = field(default_factory=lambda: RingShear(travel=160.0))
    inertial_numbers: tuple = tuple(np.geomspace(0.008, 0.12, 10).round(5))
    shear_grains: int = 400
    shear_strain: float = 4.0

    @classmethod
    def small(cls, seed=1):
        """Every stage for real, on few grains and for a short time: the numbers are rough."""
        return cls(
            seed=seed,
            biaxial=Biaxial(
                n=150, friction=Friction(stiffness=2e4, mu=0.5), contact=Luding(k1=5e4, k2=1e5, damping=0.1), strain=0.06,
                duration=0.02, wall_mass=2e-5, wall_damping=0.02, samples=100,
            ),
            ring=RingShear(n=250, inner_radius=4.0, travel=26.0, discard=2.0, block=3.0),
            inertial_numbers=tuple(np.geomspace(0.03, 0.1, 10)),
            shear_grains=100,
            shear_strain=2.5,
        )  # fmt: skip


@dataclass(frozen=True)
class Findings:
    """All that the demo found; `numbers` is the flat dict that goes to --json."""

    scene: DemoScene
    biaxial: object  # Run
    ring: object  # Run
    shear: xr.Dataset  # steady values over the inertial numbers
    law: object  # BiaxialLaw
    friction: object  # FitResult of mu(I)
    flows: dict  # name: Flow
    comparisons: list  # Comparison
    exponential: np.ndarray  # the two-parameter base line on the rings
    numbers: dict
    reasons: list  # sentences that a reader must see


def run_demo(scene, progress):
    """The Findings of a DemoScene; `progress(fractions of the particle runs)` is called several times a second.

    Raises RunFailed if a simulation stops and NotConverged if the continuum has no solution.
    """
    clock = time.perf_counter()
    (ring,), (biaxial, *tests) = run_grains(demo_jobs(scene), progress)
    grains_done = time.perf_counter()

    law = biaxial_law(biaxial)
    shear = xr.concat([steady_state(run) for run in tests], "test")
    friction = fitting.mu_of_I(shear.inertial_number.values, shear.stress_ratio.values, shear.stress_ratio_error.values)
    mu_s, b = friction.values["mu_s"], friction.values["b"]

    calibration = fitted_amplitude(ring, mu_s, b)
    laws = {"local": LocalMuI(mu_s=mu_s, b=b), "nonlocal": calibration.law}
    flows = {name: ring_flow(ring, constitutive).solve() for name, constitutive in laws.items()}
    comparisons = [compare(ring, flow, name) for name, flow in flows.items()]
    local, nonlocal_ = comparisons
    exponential = best_exponential(ring.profiles)

    s_D = law.fits["s_D"]
    balance = equilibrium(ring.profiles)
    numbers = {
        "wall_s": None,  # known only when the report is written
        "grains_s": grains_done - clock,
        "s_D_peak": law.s_D_peak,
        "s_D_final": law.s_D_final,
        "s_max": s_D.values["s_max"],
        "s_max_err": s_D.errors["s_max"],
        "beta_s": s_D.values["beta"],
        "beta_s_err": s_D.errors["beta"],
        "verdict": str(s_D.verdict),
        "trustworthy": bool(s_D.verdict),
        "A_max": law.fits["anisotropy"].values["s_max"],
        "A_max_err": law.fits["anisotropy"].errors["s_max"],
        "beta_F": law.fits["anisotropy"].values["beta"],
        "beta_F_err": law.fits["anisotropy"].errors["beta"],
        "friction_angle_peak_deg": float(np.degrees(law.angle_peak)),
        "friction_angle_final_deg": float(np.degrees(law.angle_final)),
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
        "grain_steps": sum(int(run.provenance["grain_steps"]) for run in (ring, biaxial, *tests)),
        "seed": scene.seed,
    }
    reasons = [f"{name}: {text}" for name, text in _warnings(ring, biaxial, tests, law, friction, flows, calibration)]
    return Findings(scene, biaxial, ring, shear, law, friction, flows, comparisons, exponential, numbers, reasons)


def _warnings(ring, biaxial, tests, law, friction, flows, calibration):
    """(where, sentence) for everything that ended less than well."""
    statuses = {"ring shear cell": ring.status, "biaxial box": biaxial.status, "nonlocal amplitude": calibration.status}
    statuses |= {f"simple shear, I = {run.scene.inertial_number:g}": run.status for run in tests}
    statuses |= {f"continuum, {name}": flow.status for name, flow in flows.items()}
    for name, status in statuses.items():
        yield from ((name, reason) for reason in status.reasons)
    for name, fit in {"fit of s_D": law.fits["s_D"], "fit of the anisotropy": law.fits["anisotropy"], "fit of mu(I)": friction}.items():
        yield from ((name, f"not trustworthy: {reason}") for reason in fit.verdict.reasons)
