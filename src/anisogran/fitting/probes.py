"""E, A, B and G of one state from infinitesimal probes of it: small strain increments in several directions and their stresses."""

import numpy as np
from scipy.optimize import minimize_scalar

from anisogran.fitting.linear_moduli import coupling, estimate, undetermined
from anisogran.fitting.moduli_verdict import moduli_result
from anisogran.outcome import InputError, checked
from anisogran.tensors import plane_parts, plane_tensor

_ANGLES = 45  # of the scan for phi_C; chi^2 has at most four waves in its period of 90 degrees
_CELL = 0.5 * np.pi / _ANGLES
_SIGNIFICANT = 5.0  # standard deviations; noise alone, with an axis chosen to fit it, reaches three
_COMPLEX_STEP = 1e-30
_SAME = 1e-9  # strains below this part of the largest are rounding
_LAW = "d sigma_V = E eps_V + A eps_D c, d SIGMA_D = [A eps_V + (B - 2G) eps_D c] D(phi_C) + 2G eps_D D(phi_eps)"


def probed_moduli(d_eps, d_sigma, phi_C=None, errors=None):
    """Fit of the anisotropic law to probes: `FitResult` with E, A, B, G (unit of stress) and, if it is not given, phi_C [rad].

    d_eps, d_sigma: strain and stress increments [i, j, n], shape (2, 2, n), compression positive; only symmetric parts count. Half/half
    measures as in `models.stiffness`. `phi_C` is the axis of the structure, with A of either sign. Without it the axis is fitted, from
    at least 3 independent strains; it is then the stiff one (A >= 0), in (-pi/2, pi/2]. If all strains are coaxial with a given phi_C,
    G is not determined and is left out (then `predict` is nan for other strains). `errors`, shape (n,) or one number: standard errors
    of the stress components of a probe; without, the scatter about the law is the noise, equal for all.
    `residuals` holds the misfit, and A from d sigma_V and d sigma_D apart ("A_in_sigma_V", "A_in_sigma_D", "A_difference_error"):
    the law has one A, and a fit is not trustworthy if the two differ by half their mean and by three errors.
    `predict(d_eps)` is the fitted d_sigma[i, j, ...]. Probes too large for a linear answer are seen in the misfit only.
    Raises InputError for other shapes, and for probes that leave a modulus open, naming it.
    """
    strain, stress, weight, dropped = _components(d_eps, d_sigma, errors)
    how = {"weight": weight, "known_noise": errors is not None}
    given = phi_C is not None
    if given:
        phi_C = checked("probed_moduli", "phi_C", phi_C)
    else:
        rank = np.linalg.matrix_rank(strain, tol=_SAME * np.linalg.norm(strain))
        if rank < 3:
            raise InputError(f"probed_moduli: probes of {rank} independent strains leave phi_C open, give it or 3 independent ones")
        phi_C = _axis(strain, stress, how)
    columns = _columns(strain, phi_C)
    coaxial = given and not np.any(np.abs(columns["G"]) > _SAME * np.max(np.abs(strain)))
    if coaxial:
        del columns["G"]
    missing = undetermined(columns)
    if missing:
        raise InputError(
            f"probed_moduli: these {strain.shape[1]} probes leave {', '.join(missing)} open, more independent strains are needed"
        )
    found = estimate(columns, stress, **how)
    if not given and found.values["A"] < 0.0:  # the soft axis: the stiff one stands across
        phi_C = phi_C - 0.5 * np.pi
        columns = _columns(strain, phi_C)
        found = estimate(columns, stress, **how)
    reasons = {}
    if not given:
        phi_C = 0.5 * np.pi - (0.5 * np.pi - phi_C) % np.pi  # the same axis, in (-pi/2, pi/2]
        least = float(np.sum(found.residual**2))
        found = estimate(columns, stress, more={"phi_C": (float(phi_C), _turn(strain, phi_C, found.values))}, **how)
        if not _stands_out(strain, stress, how, least, found.free):
            reasons["phi_C"] = "no axis stands out: the misfit is much the same for any phi_C"
    sizes = np.linalg.norm(strain, axis=0)
    return moduli_result(
        _LAW, found, stress, _response if not given else lambda x, **moduli: _response(x, phi_C=phi_C, **moduli),
        reasons=reasons, x_range=(float(sizes.min()), float(sizes.max())), weight=weight,
        dropped=dropped, symmetry=coupling(columns, stress, **how),
        remarks=("all probes are coaxial with phi_C, G is not determined",) if coaxial else (),
    )  # fmt: skip


def _components(d_eps, d_sigma, errors):
    """(strain, stress, weight, dropped): the components V, (xx - yy)/2 and xy of both, shape (3, n), of the finite probes."""
    d_eps, d_sigma = np.asarray(d_eps, dtype=float), np.asarray(d_sigma, dtype=float)
    if d_eps.ndim != 3 or d_eps.shape[:2] != (2, 2) or d_eps.shape != d_sigma.shape:
        raise InputError(f"probed_moduli: d_eps and d_sigma must be (2, 2, n), have shapes {d_eps.shape} and {d_sigma.shape}")
    error = np.broadcast_to(np.asarray(1.0 if errors is None else errors, dtype=float), d_eps.shape[2:])
    finite = np.all(np.isfinite(d_eps) & np.isfinite(d_sigma), axis=(0, 1)) & np.isfinite(error)
    if not np.any(finite) or not np.any(d_eps[:, :, finite]):
        raise InputError("probed_moduli: no finite probe with a strain")
    if np.any(error[finite] <= 0.0):
        raise InputError(f"probed_moduli: errors must be above 0, the smallest is {error[finite].min():g}")
    return plane_parts(d_eps[:, :, finite]), plane_parts(d_sigma[:, :, finite]), 1.0 / error[finite], int(finite.size - finite.sum())


def _columns(strain, phi_C):
    """{name: d stress/d modulus}, each (3, n) in the components V, (xx - yy)/2, xy; analytic in phi_C."""
    C, S, (V, x, y) = np.cos(2.0 * phi_C), np.sin(2.0 * phi_C), strain
    along, across, none = x * C + y * S, y * C - x * S, np.zeros_like(V)  # eps_D cos and sin of twice the angle to the structure
    return {
        "E": np.array([V, none, none]),
        "A": np.array([along, V * C, V * S]),
        "B": np.array([none, along * C, along * S]),
        "G": np.array([none, -2.0 * across * S, 2.0 * across * C]),
    }


def _turn(strain, phi_C, values):
    """d stress/d phi_C at these moduli, exact (complex step), (3, n)."""
    turned = _columns(strain, phi_C + 1j * _COMPLEX_STEP)
    return sum(value * np.imag(turned[name]) for name, value in values.items()) / _COMPLEX_STEP


def _axis(strain, stress, how):
    """The phi_C of the least chi^2: a scan over its period of 90 degrees (A of either sign), then a search in the best cell."""
    best = _CELL * int(np.argmin(_scan(strain, stress, how)))

    def chi_square(phi_C):
        return float(np.sum(estimate(_columns(strain, phi_C), stress, **how).residual ** 2))

    return float(minimize_scalar(chi_square, bounds=(best - _CELL, best + _CELL), method="bounded", options={"xatol": 1e-12}).x)


def _scan(strain, stress, how):
    return [np.sum(estimate(_columns(strain, _CELL * i), stress, **how).residual ** 2) for i in range(_ANGLES)]


def _stands_out(strain, stress, how, least, free):
    """Whether the worst axis is significantly worse than the best."""
    noise = least / free if free > 0.0 else 0.0
    if how["known_noise"]:
        noise = max(noise, 1.0)
    rounding = 1e-20 * np.sum((stress * how["weight"]) ** 2)
    return max(_scan(strain, stress, how)) - least > max(_SIGNIFICANT**2 * noise, rounding)


def _response(d_eps, E, A, B, G=np.nan, phi_C=0.0):
    """d sigma[i, j, ...]; nan where a G that is not known is needed."""
    columns = _columns(plane_parts(d_eps), phi_C)
    shear = np.where(columns["G"] == 0.0, 0.0, G * columns["G"])
    return plane_tensor(E * columns["E"] + A * columns["A"] + B * columns["B"] + shear)
