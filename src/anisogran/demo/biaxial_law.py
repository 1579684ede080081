"""The lecture's laws from one biaxial run: evolution of s_D and of the anisotropy, friction angles, and the moduli E, A, B.

The moduli are given three times. From the fabric, for a network that moves affinely (an upper bound). From the response: in an isobaric
biaxial test eps_V/eps_D = S (B - A)/(E - A) (scalar law with the softening factor S on both eps_D terms), so the start, where A is still
about 0, gives B and B/E. Later A only ever enters beside E, and one isobaric path cannot tell them apart: no A is read from it. And B
once more as the fit implies it, B = beta_s s_max sigma_V.
"""

from dataclasses import dataclass

import numpy as np

from anisogran import fitting
from anisogran.averaging import contact_network
from anisogran.models import biaxial, element_test, mobilised_angle, network_moduli
from anisogran.outcome import InputError


@dataclass(frozen=True)
class BiaxialLaw:
    """What one biaxial run tells about the law; moduli in N/m, angles in rad. `element` is the scalar law on the same path, or None."""

    fits: dict  # "s_D", "anisotropy": FitResult
    s_D_peak: float
    s_D_final: float
    angle_peak: float
    angle_final: float
    moduli_fabric_start: object  # NetworkModuli
    moduli_fabric_peak: object
    response: dict  # E, A, B, and what they were read from
    element: object
    element_remark: str


def biaxial_law(run):
    """The BiaxialLaw of a Biaxial run."""
    series, scene = run.series, run.scene
    eps_D = series.eps_D.values
    fits = {name: fitting.relaxation(eps_D, series[name].values) for name in ("s_D", "anisotropy")}
    s_D_peak = fitting.peak(series.eps_zz.values, series.s_D.values).value
    s_D_final = float(series.s_D.values[-len(eps_D) // 5 :].mean())
    k_t = 0.0 if scene.friction is None else scene.friction.stiffness
    moduli = {}
    for moment in ("start", "peak"):
        network = contact_network(run.snapshots[moment], angle=0.5 * np.pi)  # the stiff axis is the vertical one
        moduli[moment] = network_moduli(network.a2, network.a4, scene.contact.stiffest, k_t, network.scale)
    response = moduli_from_response(series, fits["s_D"])
    element, remark = scalar_law(series, scene.pressure, fits, response)
    return BiaxialLaw(
        fits,
        s_D_peak,
        s_D_final,
        float(mobilised_angle(s_D_peak)),
        float(mobilised_angle(s_D_final)),
        moduli["start"],
        moduli["peak"],
        response,
        element,
        remark,
    )


def told_numbers(law):
    """{name: value} of a BiaxialLaw, and {name: standard error} of those that were fitted."""
    values = {
        "s_D_peak": law.s_D_peak,
        "s_D_final": law.s_D_final,
        "friction_angle_peak_deg": float(np.degrees(law.angle_peak)),
        "friction_angle_final_deg": float(np.degrees(law.angle_final)),
    }
    errors = {}
    for name, limit, beta in (("s_D", "s_max", "beta_s"), ("anisotropy", "A_max", "beta_F")):
        fit = law.fits[name]
        values |= {limit: fit.values["s_max"], beta: fit.values["beta"]}
        errors |= {limit: fit.errors["s_max"], beta: fit.errors["beta"]}
    return values, errors


def box_numbers(laws):
    """The flat dict of what the boxes told, means over them; NAME_err are errors: of the fit to a single box, or of the mean of more."""
    told = [told_numbers(law) for law in laws]
    columns = {name: [values[name] for values, _ in told] for name in told[0][0]}
    errors = told[0][1] if len(laws) == 1 else {name: float(fitting.mean_and_error(column)[1]) for name, column in columns.items()}
    verdicts = [law.fits["s_D"].verdict for law in laws]
    return {
        **{name: float(np.mean(column)) for name, column in columns.items()},
        **{f"{name}_err": error for name, error in errors.items()},
        "verdict": "; ".join(dict.fromkeys(map(str, verdicts))),
        "trustworthy": all(map(bool, verdicts)),
    }


def _slope(x, y):
    """Least-squares slope of y(x)."""
    return float(np.polyfit(x, y, 1)[0])


def moduli_from_response(series, fit):
    """E and B in N/m as far as an isobaric path tells them; NaN, never a guess, where it does not. Also the points they stand on.

    B is d sigma_D/d eps_D and E = B / (d eps_V/d eps_D), both over the first eps_D <= 1/(4 beta_s), at A of about 0.
    """
    eps_D, eps_V = series.eps_D.values, series.eps_V.values
    sigma_D = 0.5 * (series.sigma_zz - series.sigma_xx).values
    beta = fit.values["beta"]
    start = eps_D <= 0.25 / beta
    mean_stress = 0.5 * float((series.sigma_xx + series.sigma_zz).values[start].mean())
    found = {"E": np.nan, "B": np.nan, "points": int(start.sum()), "B_implied": beta * fit.values["s_max"] * mean_stress}
    if start.sum() >= 4:
        found["B"] = _slope(eps_D[start], sigma_D[start])
        ratio = _slope(eps_D[start], eps_V[start])
        if ratio > 0:  # the sample contracts at first, else E is not determined
            found["E"] = found["B"] / ratio
    return found


def scalar_law(series, pressure, fits, response):
    """The scalar law on the DEM's strain path, up to the end of the fit: (ElementTest or None, remark).

    E and B come from the response; the anisotropy follows the fabric, A = E a_2/2, as in a network of contacts.
    """
    s_D, anisotropy = fits["s_D"].values, fits["anisotropy"].values
    E, B = response["E"], response["B"]
    if not np.all(np.isfinite([E, B])):
        return None, ", not drawn, since the response does not determine E and B"
    parameters = {"E": E, "B": B, "s_max": s_D["s_max"], "A_max": 0.5 * E * anisotropy["s_max"], "beta_F": anisotropy["beta"]}
    last = series.eps_zz.values[series.eps_D.values <= fits["s_D"].x_range[1]].max()
    try:
        element = element_test("scalar", parameters, biaxial([0.0, last], pressure), steps=300)
    except InputError as error:
        return None, f", not drawn: {error}"
    return element, "" if element.status.level == "ok" else f", {element.status}"
