"""Mohr-Coulomb from peak stresses: friction angle and cohesion."""

import numpy as np

from anisogran.fitting.least_squares import Parameter, Part, fit_together
from anisogran.fitting.observations import DataSet, labels, observations
from anisogran.models import peak_stress


def mohr_coulomb(p, sigma_zz, errors=None):
    """Fit of sigma_zz = p K + 2 c sqrt(K), K = (1 + sin phi)/(1 - sin phi): `FitResult` with phi [rad] and c (unit of stress).

    p is the side pressure, sigma_zz the peak stress, shape (n,), compression positive; all error is taken to be in sigma_zz,
    and the points to be independent runs. phi belongs to the tangent line, not to a line through the origin. c may be zero, hence
    its error is judged against the range of the fitted stresses. Two points give the exact tangent, without errors and not
    trustworthy. Raises InputError for data that cannot be fitted at all.
    """
    return _fit("mohr_coulomb", [DataSet(p, sigma_zz, errors)], [""])


def mohr_coulomb_lines(sets, shared=(("phi", "all"),), balance=False):
    """Fit of yield lines of several `DataSet`s (x = p, y = sigma_zz) at once: `FitResult` with phi and c, each own or shared.

    By default one phi holds for all, and c is own: `values` has "phi" and "c[LABEL]". `shared` is a dict, for instance
    {"phi": ("mu",), "c": ("kc",)}; see `relaxations`. The rest is as in `mohr_coulomb`.
    Raises InputError for what it refuses, and for names of parameters or conditions that are unknown.
    """
    return _fit("mohr_coulomb_lines", sets, labels("mohr_coulomb_lines", sets), dict(shared or {}), balance)


def _fit(where, sets, names, shared=None, balance=False):
    data = [observations(f"{where} {name}".strip(), one.x, one.y, one.errors, parameters=2) for name, one in zip(names, sets, strict=True)]
    scale = max(float(np.max(np.abs([one.x, one.y]))) for one in data)
    starts = [(phi, c) for phi in (0.05, 0.2, 0.5, 1.0) for c in (-0.1, 0.01, 0.1)]
    parts = [Part(own, starts, name, one.conditions, one.weight) for own, name, one in zip(data, names, sets, strict=True)]
    law = "sigma_zz = p K + 2 c sqrt(K)"
    settings = {"shared": shared, "balance": balance, "where": where}
    return fit_together(law, peak_stress, line_parameters(scale), parts, scales=(scale, scale), series=False, **settings)


def line_parameters(scale):
    """phi and c of a yield line in scaled stresses."""
    quarter = 0.5 * np.pi - 1e-3
    return Parameter("phi", 1.0, -quarter, quarter), Parameter("c", scale, -10.0, 10.0, level=True)
