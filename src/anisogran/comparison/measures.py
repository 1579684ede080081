"""Numbers that say how far two velocity profiles are apart, and how well the stress of grains is in equilibrium."""

import numpy as np

from anisogran import fitting, tensors

NEAR = 8.0  # grain diameters from the inner ring in which profiles are compared: beyond, grains creep too slowly to be averaged well


def near(profiles):
    """(rings,) bool: the rings whose middle is less than NEAR grain diameters from the inner ring."""
    return profiles.depth.values < NEAR


def relative_l2(profile, reference, r):
    """sqrt(sum r (profile - reference)^2 / sum r reference^2): the relative difference over the area of the rings."""
    return float(np.sqrt(np.sum(r * (profile - reference) ** 2) / np.sum(r * reference**2)))


def near_l2(profiles, v_phi):
    """The relative L2 difference of a velocity and that of the grains over the rings near the inner one."""
    used = near(profiles)
    return relative_l2(v_phi[used], profiles.v_phi.values[used], profiles.r.values[used])


def log_rms(profiles, v_phi):
    """Root mean square difference of ln v between a velocity and the DEM's, on its resolved rings; infinite if it is not positive there,
    NaN if it is not known there, or no ring is resolved."""
    used = resolved(profiles)
    if not used.any() or np.isnan(v_phi[used]).any():
        return float("nan")
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


def decay_length_error(run):
    """Standard error of the DEM's decay length in grain diameters: the same fit to every block of the run, and their scatter."""
    lengths = [decay_length(run.profiles, v_phi) for v_phi in run.blocks.v_phi.transpose("block", "r").values]
    return float(np.std(lengths, ddof=1) / np.sqrt(len(lengths))) if len(lengths) > 1 else float("nan")


def exponential_fit(profiles):
    """FitResult of the exponential in the depth (amplitude in m/s, length in grain diameters) closest to the DEM's v_phi in relative L2,
    over the rings near the inner one: the base line of every comparison."""
    used = near(profiles)
    weight = np.sqrt(profiles.r.values[used])  # of a ring in the L2 difference
    return fitting.exponential_decay(profiles.depth.values[used], profiles.v_phi.values[used], 1.0 / weight)


def best_exponential(profiles):
    """That exponential on the rings of the profiles, (rings,) in m/s."""
    return exponential_fit(profiles).predict(profiles.depth.values)


def near_angle(profiles, name):
    """An angle of the profiles, such as rate_to_stress_angle, in degrees over the rings nearer than 8 d, and its standard error: the
    mean of the rings, each by its own error, as if they were independent. In the ring they are not: seeds differ by several of these."""
    used = near(profiles)
    value, error = (np.degrees(profiles[key].values[used]) for key in (name, f"{name}_error"))
    weight = 1.0 / error**2
    return float(np.sum(weight * value) / weight.sum()), float(1.0 / np.sqrt(weight.sum()))


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
