"""DEM averages beside the continuum: the same rings, the same averaging width, error bars from the DEM, and numbers for the misfit."""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from scipy.optimize import minimize_scalar

from anisogran import fitting, tensors
from anisogran.continuum import Flow, Nonlocal, RingFlow
from anisogran.glossary import attributes
from anisogran.outcome import InputError, Status
from anisogran.scenes.writing import scene_text


@dataclass(frozen=True, eq=False)
class Comparison:
    """Profiles of DEM and continuum on the same rings (`table`, over r) and what they differ by.

    l2 is the relative L2 difference of v_phi, l2_noise what the DEM's own error bars amount to in the same measure; log_rms the root
    mean square difference of ln v_phi on the resolved rings, infinite for a continuum at rest there; decay lengths are in grain
    diameters, from the same exponential fit on the same rings, NaN where nothing decays.
    """

    name: str
    table: xr.Dataset
    l2: float
    l2_noise: float
    log_rms: float
    decay_length_dem: float
    decay_length_continuum: float
    stress_ratio_wall_dem: float
    stress_ratio_wall_continuum: float


def relative_l2(profile, reference, r):
    """sqrt(sum r (profile - reference)^2 / sum r reference^2): the relative difference over the area of the rings."""
    return float(np.sqrt(np.sum(r * (profile - reference) ** 2) / np.sum(r * reference**2)))


def log_rms(profiles, v_phi):
    """Root mean square difference of ln v between a velocity and the DEM's, on its resolved rings; infinite if it is not positive there."""
    used = resolved(profiles)
    if not np.all(v_phi[used] > 0):
        return float("inf")
    return float(np.sqrt(np.mean(np.log(v_phi[used] / profiles.v_phi.values[used]) ** 2)))


def ring_edges(profiles):
    """The edges of the rings of a profile, (rings + 1,) in m."""
    return np.asarray(profiles.attrs["edges"])


def resolved(profiles, factor=3.0):
    """(rings,) bool: the rings where the velocity exceeds its error `factor` times, counted from the inner ring to the first that fails.

    Without errors (a run of one block) it is the rings where the velocity has its sign.
    """
    error = profiles.v_phi_error.values
    clear = profiles.v_phi.values > factor * np.where(np.isfinite(error), error, 0.0)
    return np.cumprod(clear).astype(bool)


def decay_length(profiles, v_phi):
    """Length of v = amplitude exp(-depth/length), in grain diameters, fitted to a velocity on the DEM's resolved rings.

    Each ring counts by the DEM's relative error there, so that continuum and grains are judged alike; all count the same if it is
    not known. Rings at rest (below a thousandth of the first ring; what is left of a local law there is its regularisation) are left
    out, and with fewer than three rings there is no length: NaN.
    """
    used = resolved(profiles) & (v_phi > 1e-3 * v_phi[0])
    if np.count_nonzero(used) < 3:
        return float("nan")
    errors = v_phi[used] * (profiles.v_phi_error / profiles.v_phi).values[used]
    fit = fitting.exponential_decay(profiles.depth.values[used], v_phi[used], errors if np.isfinite(errors).all() else None)
    return fit.values["length"]


def best_exponential(profiles):
    """The base line of every comparison: the exponential in the depth that is closest to the DEM's v_phi in relative L2, on its rings."""
    weight = np.sqrt(profiles.r.values)  # of a ring in the L2 difference
    return fitting.exponential_decay(profiles.depth.values, profiles.v_phi.values, 1.0 / weight).predict(profiles.depth.values)


def decay_length_error(run):
    """Standard error of the DEM's decay length in grain diameters: the same fit to every block of the run, and their scatter."""
    lengths = [decay_length(run.profiles, v_phi) for v_phi in run.blocks.v_phi.transpose("block", "r").values]
    return float(np.std(lengths, ddof=1) / np.sqrt(len(lengths))) if len(lengths) > 1 else float("nan")


def ring_flow(run, law):
    """The RingFlow of the cell that `run` (a RingShear) simulated: its radii, speed and the DEM's own mean radial stress as pressure."""
    scene = run.scene
    grain_mass = float(run.snapshots["end"].mass[run.snapshots["end"].free].mean())
    steady = scene.steady(run.series)
    return RingFlow(
        r_inner=scene.inner_radius,
        r_outer=float(steady.outer_radius.mean()),
        law=law,
        wall_speed=scene.wall_speed,
        outer_pressure=float(steady.outer_pressure.mean()),
        grain_diameter=scene.mean_diameter,
        grain_mass=grain_mass,
    )


def compare(run, flow, name="continuum"):
    """The Comparison of a RingShear run with a solved RingFlow, on the rings of the run.

    Raises InputError for a run without ring profiles, and for a flow that is not solved.
    """
    if not isinstance(flow, Flow):
        raise InputError(f"compare: the flow is a {type(flow).__name__}; it must be what RingFlow(...).solve() returns")
    if getattr(run, "profiles", None) is None or "v_phi" not in run.profiles:
        raise InputError("compare: the run has no ring profiles; it must come from RingShear")
    profiles, scene = run.profiles, run.scene
    rings = flow.ring_average(ring_edges(profiles))
    v_phi = np.asarray(rings.v_phi)
    table = xr.Dataset(
        {
            "v_phi": ("r", v_phi, attributes("v_phi", source=name)),
            "v_phi_dem": ("r", profiles.v_phi.values, attributes("v_phi", source="DEM")),
            "v_phi_dem_error": ("r", profiles.v_phi_error.values, profiles.v_phi_error.attrs),
            "shear_rate": ("r", np.abs(np.asarray(rings.shear_rate)), attributes("shear_rate", source=name)),
        },
        coords={"r": profiles.r, "depth": profiles.depth},
        attrs={"law": str(flow.problem.law), "scene": scene_text(scene)},
    )
    r = profiles.r.values
    steady = scene.steady(run.series)
    return Comparison(
        name=name,
        table=table,
        l2=relative_l2(v_phi, profiles.v_phi.values, r),
        l2_noise=relative_l2(profiles.v_phi.values + profiles.v_phi_error.values, profiles.v_phi.values, r),
        log_rms=log_rms(profiles, v_phi),
        decay_length_dem=decay_length(profiles, profiles.v_phi.values),
        decay_length_continuum=decay_length(profiles, v_phi),
        stress_ratio_wall_dem=float(steady.wall_shear_stress.mean() / steady.wall_pressure.mean()),
        stress_ratio_wall_continuum=float(flow.stress_ratio_wall),
    )


def equilibrium(profiles):
    """How well the DEM's stress is in equilibrium, as two relative figures.

    torque_residual: standard deviation of r^2 sigma_rphi over the rings, over its mean. radial_residual: root mean square of
    d(r sigma_rr)/dr - sigma_phiphi between neighbouring rings, over the mean pressure (inertia is left out: it is rho v^2/r).
    """
    r = profiles.r.values
    stress = profiles.stress.values
    torque = r**2 * 0.5 * (stress[0, 1] + stress[1, 0])
    slope = np.diff(r * stress[0, 0]) / np.diff(r)
    hoop = 0.5 * (stress[1, 1, 1:] + stress[1, 1, :-1])
    pressure = tensors.mean(stress)
    return {
        "torque_residual": float(np.std(torque) / abs(np.mean(torque))),
        "radial_residual": float(np.sqrt(np.mean((slope - hoop) ** 2)) / np.mean(pressure)),
    }


def fitted_amplitude(run, mu_s, b, bounds=(0.1, 2.0)):
    """The nonlocal amplitude whose flow comes closest to the DEM's v_phi of this ring in relative L2, and a Status.

    One parameter, fitted on the very run it is then compared with. The status is "warned" if the best value lies at a bound.
    """

    def misfit(log_amplitude):
        law = Nonlocal(mu_s=mu_s, b=b, amplitude=float(np.exp(log_amplitude)))
        rings = ring_flow(run, law).solve().ring_average(ring_edges(run.profiles))
        return relative_l2(np.asarray(rings.v_phi), run.profiles.v_phi.values, run.profiles.r.values)

    found = minimize_scalar(misfit, bounds=np.log(bounds), method="bounded", options={"xatol": 1e-3})
    amplitude = float(np.exp(found.x))
    if min(abs(found.x - np.log(bounds))) < 5e-3:
        return amplitude, Status().warn(f"the best nonlocal amplitude {amplitude:.3g} lies at the bound of {bounds}")
    return amplitude, Status()
