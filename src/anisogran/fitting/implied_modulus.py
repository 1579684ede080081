"""The modulus B twice: directly from strains and stresses, and as the evolution of the stress ratio implies it."""

from typing import NamedTuple

import numpy as np

from anisogran.outcome import InputError

_CONSTANT = 0.05  # sigma_V that varies by less counts as constant


class ComparedB(NamedTuple):
    """B of both kinds with one standard error each (nan if there is none), in the unit of stress; prints as one line.

    `implied` stands for sigma_V at the start; `lowest` and `highest` are those for the smallest and largest sigma_V on the way.
    `apart` is |direct - implied| in standard errors of the difference, nan without errors. `remarks` say what to know.
    """

    direct: float
    direct_error: float
    implied: float
    implied_error: float
    lowest: float
    highest: float
    apart: float
    remarks: tuple[str, ...]

    def __str__(self):
        told = f"B = {_number(self.direct, self.direct_error)} directly, beta s_max sigma_V = {_number(self.implied, self.implied_error)}"
        apart = "" if np.isnan(self.apart) else f" ({self.apart:.1f} standard errors apart)"
        return "; ".join([told + apart, *self.remarks])


def compared_B(moduli, relaxation, sigma_V):
    """`ComparedB` of a fit that has B (`initial_moduli`, `probed_moduli`, `path_moduli`) and of a `relaxation` fit of s_D(eps_D).

    At constant sigma_V and without volume strain d s_D/d eps_D = (B/sigma_V) (1 - s_D/s_max), hence B = beta s_max sigma_V.
    `sigma_V`, a number or a row over the points of the relaxation fit in the order of loading. In a box at constant side pressure p it
    is p/(1 - s_D) and not constant: then s_D(eps_D) is no exact exponential and beta an average along the curve, so that B lies
    between `lowest` and `highest` at best; a remark says so. All eps_D and sigma half/half.
    Raises InputError for fits without B, or without beta and s_max, and for sigma_V that is not above 0.
    """
    if "B" not in moduli.values:
        raise InputError(f"compared_B: the first fit must have B, has {', '.join(moduli.values)}")
    if not {"beta", "s_max"} <= set(relaxation.values):
        raise InputError(f"compared_B: the second fit must have beta and s_max, has {', '.join(relaxation.values)}")
    sigma_V = np.atleast_1d(np.asarray(sigma_V, dtype=float))
    if sigma_V.ndim != 1 or not sigma_V.size or not np.all(np.isfinite(sigma_V)) or np.any(sigma_V <= 0.0):
        raise InputError("compared_B: sigma_V must be one row of finite stresses above 0")
    beta, s_max = relaxation.values["beta"], relaxation.values["s_max"]
    relative = [relaxation.errors[name] / abs(relaxation.values[name]) for name in ("beta", "s_max")]
    correlation = next((value for pair, value in relaxation.correlations.items() if set(pair) == {"beta", "s_max"}), np.nan)
    error = float(np.sqrt(relative[0] ** 2 + relative[1] ** 2 + 2.0 * correlation * np.sign(s_max) * relative[0] * relative[1]))
    implied, direct, direct_error = beta * s_max * sigma_V, moduli.values["B"], moduli.errors["B"]
    implied_error = error * abs(float(implied[0]))
    both = float(np.hypot(direct_error, implied_error))
    remarks, ratio = [], float(sigma_V.max() / sigma_V.min())
    if ratio > 1.0 + _CONSTANT:
        remarks.append(
            f"sigma_V is not constant (largest over smallest {ratio:.3g}; p/(1 - s_D) in an isobaric box), beta is an average along the "
            f"curve and beta s_max sigma_V runs from {implied.min():.4g} to {implied.max():.4g}"
        )
    remarks += [f"the {name} is not trustworthy" for name, fit in (("direct fit", moduli), ("relaxation", relaxation)) if not fit.verdict]
    apart = abs(direct - float(implied[0])) / both if both > 0.0 else float("nan")
    return ComparedB(
        direct, direct_error, float(implied[0]), implied_error, float(implied.min()), float(implied.max()), apart, tuple(remarks)
    )


def _number(value, error):
    return f"{value:.4g}" + (f" +- {error:.2g}" if error == error else " (no error bar)")
