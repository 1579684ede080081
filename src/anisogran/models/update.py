"""Any law on whole arrays of points: (state, strain increment, parameters) -> (state, stress, tangent)."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from anisogran.models.integrators import INTEGRATORS, advance_all, advance_all_with_tangent
from anisogran.models.laws import LAWS, name_of
from anisogran.models.point import MEANING
from anisogran.outcome import InputError, checked
from anisogran.tensors import plane_parts, plane_tensor

NO_SHEAR = "the scalar law holds in the axes of the box and knows no shear strain xz and no rotation; take the tensorial law"


class PointState(NamedTuple):
    """stress[i, j, ...], compression positive, and the internal variables of the law by name, each of shape (...).

    scalar: A (positive is stiffer along z, the second axis); tensorial: A_1, A_2 = A (cos, sin)(2 phi_C); mohr_coulomb: kappa;
    mu_of_I: area_fraction.
    """

    stress: np.ndarray
    internal: dict


class Updated(NamedTuple):
    """What `updated` returns; outcome (...) is 0 where all is well, else a key of `MEANING`."""

    state: PointState
    stress: np.ndarray
    tangent: np.ndarray | None
    outcome: np.ndarray


def updated(state, d_eps, parameters, *, d_spin=0.0, d_time=1.0, integrator="midpoint", tangent=False, on_failure="raise"):
    """The state after a strain increment, for a point, a series or all quadrature points at once: an `Updated`.

    state          a `PointState` with a batch of any shape (...)
    d_eps          (2, 2, ...), compression positive; its antisymmetric part does not matter
    parameters     of one law, from `law_parameters`
    d_spin         (...), rotation of the material in rad, counter-clockwise;  d_time (...), duration in s, for laws that know a rate
    integrator     "midpoint", "rk45" or "explicit", or what `integrator_record` takes, with its own tolerance
    tangent        whether to find d stress_ij / d eps_kl, (2, 2, 2, 2, ...), consistent with the integrator (by a complex step;
                   not with rk45 where a mohr_coulomb point begins to yield within the increment)
    on_failure     "raise": InputError naming the first point that failed; "report": its state is the old one, and outcome says why

    Nothing of `state` is changed. Raises InputError for bad shapes, internal variables that are not those of the law, numbers that are
    not finite, a duration that is not above 0, a shear or rotation given to the scalar law, or an unknown integrator.
    """
    law = name_of(parameters)
    method = integrator_record(integrator)
    if on_failure not in ("raise", "report"):
        raise InputError(f"updated: on_failure = {on_failure!r} must be raise or report")
    d_eps, d_spin, d_time = np.asarray(d_eps, dtype=float), np.asarray(d_spin, dtype=float), np.asarray(d_time, dtype=float)
    stress = np.asarray(state.stress, dtype=float)
    for key, t in (("stress", stress), ("d_eps", d_eps)):
        if t.shape[:2] != (2, 2):
            raise InputError(f"updated: {key} has shape {t.shape}, must be (2, 2, ...)")
    batch = np.broadcast_shapes(stress.shape[2:], d_eps.shape[2:], d_spin.shape, d_time.shape)
    states, increments = flat_states(law, state, batch), _flat_increments(d_eps, d_spin, d_time, batch)
    for key, array in (("state", states), ("increment", increments)):
        if not np.all(np.isfinite(array)):
            raise InputError(f"updated: the {key} of point {int(np.argwhere(~np.isfinite(array).all(axis=0))[0, 0])} is not finite")
    if not np.all(increments[4] > 0.0):
        raise InputError(f"updated: d_time = {increments[4].min():g} must be above 0 s")
    if law == "scalar" and np.any(increments[2:4]):
        raise InputError(f"updated: {NO_SHEAR}")
    old, outcomes = states.copy(), np.zeros(states.shape[1], dtype=np.int64)
    moduli = None
    if tangent:
        moduli = np.empty((3, 3, states.shape[1]))
        advance_all_with_tangent(method, parameters, states, increments, outcomes, moduli)
    else:
        advance_all(method, parameters, states, increments, outcomes)
    failed = np.flatnonzero(outcomes)
    if failed.size and on_failure == "raise":
        raise InputError(f"{law} law: point {failed[0]} of {outcomes.size}: {MEANING[int(outcomes[failed[0]])]}")
    states[:, failed] = old[:, failed]
    new = state_of(law, states, batch)
    return Updated(new, new.stress, None if moduli is None else full_tangent(moduli, batch), outcomes.reshape(batch))


def integrator_record(integrator):
    """The record of an integrator given by name, as dict of its name and settings, or the record itself. Raises InputError for another."""
    if isinstance(integrator, Mapping):
        settings = dict(integrator)
        record = integrator_record(str(settings.pop("name", None)))
        for key in settings:
            if key not in record._fields:
                raise InputError(f"integrator: unknown setting {key!r}; {integrator['name']} has {', '.join(record._fields)}")
        return record._replace(**{key: checked("integrator", key, value, above=0.0) for key, value in settings.items()})
    if isinstance(integrator, str):
        if integrator not in INTEGRATORS:
            raise InputError(f"integrator = {integrator!r} must be one of {', '.join(INTEGRATORS)}")
        return INTEGRATORS[integrator]
    if type(integrator) not in {type(known) for known in INTEGRATORS.values()}:
        raise InputError(f"integrator = {integrator!r} must be one of {', '.join(INTEGRATORS)}, or a record of them")
    return integrator


def flat_states(law, state, batch):
    """(5, n) for the kernels. Raises InputError for internal variables that are not those of the law."""
    names = [name for name in LAWS[law].INTERNAL if name]
    if set(state.internal) != set(names):
        raise InputError(f"{law} law: internal variables must be {', '.join(names)}, are {', '.join(state.internal) or 'none'}")
    inner = [state.internal[name] if name else 0.0 for name in LAWS[law].INTERNAL]
    return _stacked([*plane_parts(np.asarray(state.stress, dtype=float)), *inner], batch)


def _flat_increments(d_eps, d_spin, d_time, batch):
    return _stacked([*plane_parts(d_eps), d_spin, d_time], batch)


def _stacked(rows, batch):
    """Rows of any shape that broadcasts to the batch, as one contiguous array (rows, n)."""
    out = np.empty((len(rows), *batch))
    for i, values in enumerate(rows):
        out[i] = values
    return out.reshape(len(rows), -1)


def state_of(law, states, batch):
    """The `PointState` of (5, n)."""
    states = states.reshape(5, *batch)
    internal = {name: values for name, values in zip(LAWS[law].INTERNAL, states[3:], strict=True) if name}
    return PointState(plane_tensor(states[:3]), internal)


# stress_ij = sum_a _SPREAD[i, j, a] (sigma_V, sigma_1, sigma_2)_a, and (eps_V, eps_1, eps_2)_a = sum_kl _SPREAD[k, l, a] eps_kl / 2
_SPREAD = np.array([[[1.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [[0.0, 0.0, 1.0], [1.0, -1.0, 0.0]]])


def full_tangent(moduli, batch):
    """C[i, j, k, l, ...] of the half/half moduli (3, 3, n)."""
    tangent = 0.5 * np.einsum("ija,abn,klb->ijkln", _SPREAD, moduli, _SPREAD)
    return tangent.reshape(2, 2, 2, 2, *batch)
