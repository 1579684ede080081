"""How fast the laws at a point are: updates of many points with and without tangent, and one curve; each beside its error."""

import numpy as np

from anisogran.benchmark.averages import seconds_of
from anisogran.models import (
    INTEGRATORS,
    LAWS,
    PointState,
    RungeKutta45,
    biaxial,
    element_test,
    law_parameters,
    peak_stress,
    simple_shear,
    updated,
)

PRESSURE = 100.0  # in the unit of the moduli
STEP = 1e-5  # root mean square of each component of a strain increment: a thousandth of the strain to the critical state
EXACT = RungeKutta45(1e-12)  # the errors are those against it
CURVE = 1000  # steps
_ANISOTROPIC = {"E": 1e5, "B": 5e4, "s_max": 0.3, "A_max": 2e4, "beta_F": 80.0}
PARAMETERS = {
    "scalar": _ANISOTROPIC,
    "tensorial": _ANISOTROPIC | {"G": 2.5e4},
    "mohr_coulomb": {"E": 1e5, "G": 2.5e4, "phi": 0.4, "c": 2.0, "phi_residual": 0.3, "psi": 0.1, "beta": 30.0},
    "mu_of_I": {"mu_s": 0.28, "b": 1.1, "phi_max": 0.84, "slope": 0.3, "grain_mass": 1e-5},
}
INTERNAL = {"A": (0.0, 1e4), "A_1": (0.0, 1e4), "A_2": (0.0, 1e4), "kappa": (0.0, 0.1), "area_fraction": (0.7, 0.83)}  # range


def models_benchmark(points=100_000, repeats=5):
    """Millions of updates a second on one core for each law and integrator, a dict, without and with the tangent, and the error of the
    stress of one update; seconds of one curve of 1,000 steps at one point with a prescribed stress, and its error."""
    numbers = {"points": points, "repeats": repeats}
    for law in LAWS:
        batch, exact = some_points(law, points), updated(**some_points(law, points), integrator=EXACT).stress
        for name in INTEGRATORS:
            plain = seconds_of(lambda name=name, batch=batch: updated(**batch, integrator=name), repeats)
            tangent = seconds_of(lambda name=name, batch=batch: updated(**batch, integrator=name, tangent=True), repeats)
            error = np.max(np.abs(updated(**batch, integrator=name).stress - exact)) / np.abs(exact).max()
            curve = seconds_of(lambda law=law, name=name: curve_of(law, CURVE, name), repeats)
            numbers |= {
                f"{law}_{name}_million_per_s": 1e-6 * points / plain,
                f"{law}_{name}_with_tangent_million_per_s": 1e-6 * points / tangent,
                f"{law}_{name}_error": float(error),
                f"{law}_{name}_curve_s": curve,
                f"{law}_{name}_curve_error": curve_error(law, CURVE, name),
            }
    return numbers


def some_points(law, points):
    """Arguments of `updated`: points at many stresses and anisotropies, each with its own small increment of strain and rotation."""
    rng = np.random.default_rng(1)
    sigma_V, angle = rng.uniform(0.9 * PRESSURE, 1.1 * PRESSURE, points), rng.uniform(0.0, 2.0 * np.pi, points)
    sigma_D = rng.uniform(0.0, 0.35, points) * sigma_V  # some above the strength
    sigma_1, sigma_2 = sigma_D * np.cos(angle), sigma_D * np.sin(angle)
    eps_V, eps_1, eps_2, spin = rng.normal(scale=STEP, size=(4, points))
    if law == "scalar":  # in the axes of the box
        sigma_2, eps_2, spin = 0.0 * sigma_2, 0.0 * eps_2, 0.0 * spin
    internal = {name: rng.uniform(*INTERNAL[name], points) for name in LAWS[law].INTERNAL if name}
    return {
        "state": PointState(np.array([[sigma_V + sigma_1, sigma_2], [sigma_2, sigma_V - sigma_1]]), internal),
        "d_eps": np.array([[eps_V + eps_1, eps_2], [eps_2, eps_V - eps_1]]),
        "parameters": law_parameters(law, **PARAMETERS[law]),
        "d_spin": spin,
    }


def curve_of(law, steps, integrator):
    """The ElementTest of the biaxial box, from the peak on for the law that is elastic before; for one that has no stress at rest, of
    simple shear at a growing rate and constant normal stress."""
    if LAWS[law].STRESS_IS_STATE:
        p = PARAMETERS[law]
        start = {"sigma_zz": peak_stress(PRESSURE, p["phi"], p["c"])} if law == "mohr_coulomb" else None
        return element_test(law, p, biaxial([0.0, 0.01], PRESSURE), start, steps, integrator)
    time = np.linspace(0.0, 1.0, steps + 1)
    path = simple_shear(time + time**2, PRESSURE) | {"time": time}
    return element_test(law, PARAMETERS[law], path, {"area_fraction": 0.8399}, integrator=integrator)


def curve_error(law, steps, integrator):
    """Largest difference of the stress along the curve from one of ten times as many exact steps, relative to the largest stress."""
    curve, exact = curve_of(law, steps, integrator), curve_of(law, 10 * steps, EXACT)
    curve.status.require()
    exact.status.require()
    return float(np.max(np.abs(curve.stress[..., 1:] - exact.stress[..., 10::10])) / np.abs(exact.stress).max())
