"""The lecture's macroscopic cohesion from peak stresses at several contact adhesions: one fit of all of them."""

import numpy as np

from anisogran.fitting.least_squares import Parameter, Part, fit_together
from anisogran.fitting.observations import observations
from anisogran.models import macro_cohesion, peak_stress
from anisogran.outcome import InputError


def cohesion(p, kc, sigma_zz, k1, k2, errors=None, offset=False):
    """Fit of sigma_zz = p K + 2 c sqrt(K), c = c0 (1 - k1/k2)/(1 + k2/kc): `FitResult` with phi [rad] and c0 (unit of stress).

    p, kc and sigma_zz have shape (n,): side pressure, contact adhesion (unit of k1 and k2) and peak stress, compression positive; the
    points are taken to be independent runs. phi and c0 hold for all kc. With `offset` a third parameter c_rest is added to c, the
    cohesion at kc = 0, where the formula has none. The data sets of the result are the values of kc.
    Raises InputError for data that cannot be fitted at all, for kc < 0 and unless 0 <= k1 < k2.
    """
    where = "cohesion"
    p, kc, sigma_zz = (np.ma.filled(np.ma.asarray(row, dtype=float), np.nan) for row in (p, kc, sigma_zz))
    if p.ndim != 1 or not p.shape == kc.shape == sigma_zz.shape:
        raise InputError(f"{where}: p, kc and sigma_zz must be rows of one length, have shapes {p.shape}, {kc.shape}, {sigma_zz.shape}")
    if not np.all(np.isfinite(kc)):
        raise InputError(f"{where}: every kc must be a finite number")
    factors = {float(one): macro_cohesion(1.0, k1, k2, one) for one in np.unique(kc)}
    if not any(factors.values()):
        raise InputError(f"{where}: the formula gives no cohesion, needs k1 < k2 and a kc above 0 (k1 = {k1:g}, k2 = {k2:g})")
    errors = None if errors is None else np.asarray(errors, dtype=float)
    chosen = {one: kc == one for one in factors}
    data = {
        one: observations(f"{where} at kc = {one:g}", p[mask], sigma_zz[mask], None if errors is None else errors[mask], parameters=1)
        for one, mask in chosen.items()
    }
    scale = max(float(np.max(np.abs([one.x, one.y]))) for one in data.values())
    quarter = 0.5 * np.pi - 1e-3
    parameters = [Parameter("phi", 1.0, -quarter, quarter), Parameter("c0", scale, -100.0, 100.0, level=True)]
    starts = [(phi, c0) for phi in (0.05, 0.2, 0.5, 1.0) for c0 in (-0.1, 0.01, 0.5)]
    if offset:
        parameters.append(Parameter("c_rest", scale, -10.0, 10.0, level=True))
        starts = [(*start, 0.01) for start in starts]
    parts = [Part(data[one], starts, f"kc={one:.12g}", {"kc": one}, known={"factor": factor}) for one, factor in factors.items()]
    law = "sigma_zz = p K + 2 c sqrt(K), c = c0 (1 - k1/k2)/(1 + k2/kc)" + (" + c_rest" if offset else "")
    shared = {parameter.name: "all" for parameter in parameters}
    return fit_together(law, _peak, parameters, parts, scales=(scale, scale), series=False, shared=shared, where=where)


def _peak(p, phi, c0, factor, c_rest=0.0):
    return peak_stress(p, phi, c0 * factor + c_rest)
