"""Exponential approach to a limit: the evolution of stress ratio and anisotropy with deviatoric strain (Luding's lecture).

    dx = beta (x_max sgn(d eps_D) - x) |d eps_D|                             scalar
    da = beta (a_max d eps - a |d eps|) + dw x a                             tensor, d eps the deviator of the strain, dw the rotation

The lecture writes the scalar for growing eps_D. The sign makes it hold after a load reversal, where x turns towards -x_max. The tensor
form is the same law in any direction, carried along by the rotation of the material; both are solved exactly for a constant direction.
"""

import numpy as np

from anisogran.compiled import kernel, subkernel
from anisogran.models.first_order import cosine_and_sine, exponential, inverse, size
from anisogran.outcome import InputError, checked
from anisogran.tensors import plane_parts, plane_tensor


def loading_sense(d_eps_D):
    """+1.0 where the increment is >= 0, else -1.0; the real part decides, so that a complex step stays on its branch."""
    return np.where(np.real(d_eps_D) < 0.0, -1.0, 1.0)


def relax(x0, x_max, beta, d_eps_D):
    """The value after an increment d_eps_D, exact for any size of the increment, same shape as the arguments broadcast.

    x0 and x_max share any unit, beta and d_eps_D have none (half/half strain). A negative increment relaxes towards -x_max.
    Analytic in all arguments but for the kink at d_eps_D = 0, where a derivative is that of loading, d_eps_D -> 0+.
    Raises InputError if a beta is negative, since x would then run away.
    """
    if np.any(np.real(beta) < 0.0):
        raise InputError(f"relax: beta = {np.min(np.real(beta)):g} must be at least 0")
    sense = loading_sense(d_eps_D)
    # expm1 keeps x0 exactly when nothing happens (beta = 0 or no increment) and tiny increments accurate
    return x0 - (x_max * sense - x0) * np.expm1(-beta * (sense * d_eps_D))


@subkernel
def relaxation(limit, beta, eps_1, eps_2, spin):
    """What `relax_tensor`'s law does to any vector a of a deviator: (k_r, k_i, gain_1, gain_2), for `relaxed`; numbers real or complex."""
    b = beta * size(eps_1, eps_2)
    w = 2.0 * spin
    decay = exponential(-b)
    c, s = cosine_and_sine(w)
    # the mean of exp(z t) over 0 < t < 1 with z = -b + i w, as (real, imaginary)
    square = b * b + w * w
    if square.real > 1e-5:
        up, side, over = decay * c - 1.0, decay * s, inverse(square)
        mean_r, mean_i = (side * w - up * b) * over, -(side * b + up * w) * over
    else:  # the closed form would cancel; the first term left out, |z|^5/720, is rounding
        mean_r, mean_i = 1.0 - 0.2 * b, 0.2 * w
        for share in (1 / 4, 1 / 3, 1 / 2):
            mean_r, mean_i = 1.0 - share * (b * mean_r + w * mean_i), share * (w * mean_r - b * mean_i)
    gain_1, gain_2 = beta * limit * eps_1, beta * limit * eps_2
    return decay * c, decay * s, mean_r * gain_1 - mean_i * gain_2, mean_r * gain_2 + mean_i * gain_1


@subkernel
def relaxed(first, second, change):
    """The vector after a `relaxation`."""
    k_r, k_i, gain_1, gain_2 = change
    return k_r * first - k_i * second + gain_1, k_i * first + k_r * second + gain_2


@kernel
def _relax_all(a, limit, beta, strain, spin, out):
    for n in range(a.shape[1]):
        out[0, n], out[1, n] = relaxed(a[0, n], a[1, n], relaxation(limit, beta, strain[0, n], strain[1, n], spin[n]))


def relax_tensor(a, a_max, beta, d_eps, d_spin=0.0):
    """The deviator a[i, j, ...] after a strain increment d_eps[i, j, ...] and a rotation d_spin[...] (rad, counter-clockwise).

    a = A D(phi_C): size A, axis phi_C; it tends to a_max along the axis of the largest compression of d_eps (compression positive), whose
    trace does not matter. Exact for any size of an increment whose direction and ratio of rotation to strain are constant, as in
    simple shear; without a rotation and along one axis it is `relax`. |a| never exceeds the larger of |a_0| and a_max (if >= 0).
    Returns (2, 2, ...), symmetric and traceless; a and a_max share any unit.
    Raises InputError for shapes that are not (2, 2, ...), a beta < 0, or numbers that are not finite.
    """
    beta, a_max = checked("relax_tensor", "beta", beta, at_least=0.0), checked("relax_tensor", "a_max", a_max)
    a, d_eps, d_spin = np.asarray(a, dtype=float), np.asarray(d_eps, dtype=float), np.asarray(d_spin, dtype=float)
    if a.shape[:2] != (2, 2) or d_eps.shape[:2] != (2, 2):
        raise InputError(f"relax_tensor: a and d_eps must be (2, 2, ...), have shapes {a.shape} and {d_eps.shape}")
    batch = np.broadcast_shapes(a.shape[2:], d_eps.shape[2:], d_spin.shape)
    flat_a, flat_eps = (_vector(t, batch) for t in (a, d_eps))
    out = np.empty_like(flat_a)
    _relax_all(flat_a, a_max, beta, flat_eps, np.broadcast_to(d_spin, batch).reshape(-1).copy(), out)
    first, second = out.reshape(2, *batch)
    return plane_tensor([np.zeros(batch), first, second])


def _vector(t, batch):
    """(2, n): the vector of the deviator of t, batch flattened."""
    parts = plane_parts(t)[1:].reshape(2, *(1,) * (len(batch) - (t.ndim - 2)), *t.shape[2:])
    return np.ascontiguousarray(np.broadcast_to(parts, (2, *batch)).reshape(2, -1))
