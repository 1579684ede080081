"""Element test: one point of the scalar law driven along a path with mixed control (one strain, one stress)."""

from dataclasses import dataclass
from math import isfinite

import numpy as np

from anisogran.models.scalar import ScalarState, scalar_step
from anisogran.outcome import InputError, Status, checked

_MAX_ITERATIONS = 10
_TOLERANCE = 1e-11  # of the pressure; rounding of sigma_V - sigma_D is some 1e-16 of it


@dataclass(frozen=True)
class ElementTest:
    """Curves along the path, each of shape (n,), and how it ended.

    Strains half/half and stresses, compression positive, as in the glossary; A has the unit of the moduli. If `status` is failed
    the curves end at the last state that was reached, and `status.require()` raises.
    """

    eps_zz: np.ndarray
    eps_xx: np.ndarray
    eps_V: np.ndarray
    eps_D: np.ndarray
    sigma_xx: np.ndarray
    sigma_zz: np.ndarray
    s_D: np.ndarray
    A: np.ndarray
    status: Status


def isobaric_biaxial(eps_zz, pressure, parameters, A_start=0.0):
    """The biaxial box at constant sigma_xx = pressure, driven by the vertical strains eps_zz: an `ElementTest`.

    `eps_zz`, shape (n,): true strains of the path, compression positive, from the isotropic start at eps_zz[0]; it may turn back.
    `parameters` is a `ScalarParameters`; `A_start` the anisotropy at the start. One step of `scalar_step` per interval, hence
    second order in the strain step. Strictly eps_V/eps_D = S (B - A)/(E - A), so the sample contracts while A < B.
    The path stops with status failed if the stiffness is no longer positive definite (E B <= A^2), if the box gives way sideways,
    or if sigma_xx = pressure cannot be reached. Raises InputError for a bad path, pressure or parameter, or E B <= A_start^2.
    """
    path = _checked_path(eps_zz)
    pressure = checked("isobaric_biaxial", "pressure", pressure, above=0.0)
    p = _checked_parameters(parameters, A_start)
    state = ScalarState(pressure, 0.0, float(A_start))
    eps_xx, states, status = [0.0], [state], Status()
    for d_eps_zz in np.diff(path):
        new, d_eps_xx, trouble = _isobaric_step(state, d_eps_zz, pressure, p)
        if not trouble and p.E * p.B <= new.A**2:
            trouble = f"the stiffness is not positive definite: E B = {p.E * p.B:g} <= A^2 = {new.A**2:g}"
        if trouble:
            status = status.fail(f"stopped at eps_zz = {path[len(states) - 1]:.6g}: {trouble}")
            break
        state = new
        states.append(state)
        eps_xx.append(eps_xx[-1] + d_eps_xx)
    sigma_V, sigma_D, A = (np.array(column, dtype=float) for column in zip(*states, strict=True))
    eps_zz, eps_xx = path[: len(states)] - path[0], np.array(eps_xx)
    return ElementTest(
        eps_zz=path[: len(states)],
        eps_xx=eps_xx,
        eps_V=0.5 * (eps_zz + eps_xx),
        eps_D=0.5 * (eps_zz - eps_xx),
        sigma_xx=sigma_V - sigma_D,
        sigma_zz=sigma_V + sigma_D,
        s_D=sigma_D / sigma_V,
        A=A,
        status=status,
    )


def _isobaric_step(state, d_eps_zz, pressure, parameters):
    """(new state, d eps_xx, trouble): Newton for the lateral strain that keeps sigma_xx; trouble is a sentence, or ""."""
    d_eps_xx = -d_eps_zz  # the isochoric guess: exact at the critical state, and on the right side of the kink at d_eps_D = 0
    for _ in range(_MAX_ITERATIONS):
        increment = 0.5 * (d_eps_zz + d_eps_xx), 0.5 * (d_eps_zz - d_eps_xx)
        new, (sigma_V, sigma_D), tangent = scalar_step(state, increment, parameters)
        if not (isfinite(sigma_V) and isfinite(sigma_D)) or sigma_V <= 0.0:
            return state, 0.0, f"the sample goes into tension (sigma_V = {sigma_V:g})"
        lateral = 0.5 * ((tangent[0, 0] - tangent[1, 0]) - (tangent[0, 1] - tangent[1, 1]))  # d sigma_xx / d eps_xx
        if lateral <= 0.0:
            return state, 0.0, f"the box gives way sideways: d sigma_xx/d eps_xx = {lateral:g} is not positive"
        if abs(sigma_V - sigma_D - pressure) <= _TOLERANCE * pressure:
            return ScalarState(*(float(value) for value in new)), d_eps_xx, ""
        d_eps_xx = d_eps_xx - (sigma_V - sigma_D - pressure) / lateral
    return (
        state,
        0.0,
        f"sigma_xx = {pressure:g} is not reachable in {_MAX_ITERATIONS} Newton iterations; try a smaller strain step",
    )


def _checked_path(eps_zz):
    path = np.asarray(eps_zz, dtype=float)
    if path.ndim != 1 or path.size < 2 or not np.all(np.isfinite(path)):
        raise InputError(f"isobaric_biaxial: eps_zz must be one row of at least two finite strains, has shape {path.shape}")
    return path


def _checked_parameters(p, A_start):
    where = "isobaric_biaxial"
    checked(where, "E", p.E, above=0.0)
    checked(where, "B", p.B, above=0.0)
    checked(where, "s_max", p.s_max, at_least=0.0, below=1.0)
    checked(where, "A_max", p.A_max)
    checked(where, "beta_F", p.beta_F, at_least=0.0)
    A_start = checked(where, "A_start", A_start)
    limit = (p.E * p.B) ** 0.5
    if abs(A_start) >= limit:
        raise InputError(f"{where}: |A_start| = {abs(A_start):g} must be below sqrt(E B) = {limit:g}: not positive definite")
    return p
