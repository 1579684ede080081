"""Mohr-Coulomb: yield line tau = c + sigma tan(phi), and the lecture's macroscopic cohesion. Compression positive; radians."""

from typing import NamedTuple

import numpy as np

from anisogran.outcome import InputError, checked


class YieldLine(NamedTuple):
    """Friction angle phi [rad], of the tangent line (not of a line through the origin), and cohesion c, unit of stress."""

    phi: float
    c: float


def mohr_coulomb_line(sigma_min, sigma_max):
    """The common tangent of stress circles with the principal stresses sigma_min <= sigma_max, each of shape (n,), n >= 2.

    A circle of centre m and radius r touches the line if r = c cos(phi) + m sin(phi): exact for two circles, a straight
    least-squares line through the (m, r) for more. Returns a `YieldLine`; c is negative if the data ask for it.
    Raises InputError for fewer than two circles, equal centres, sigma_max < sigma_min, or radii that grow as fast as the centres.
    """
    low, high = (np.atleast_1d(np.asarray(sigma, dtype=float)) for sigma in (sigma_min, sigma_max))
    if low.ndim != 1 or low.shape != high.shape or low.size < 2:
        raise InputError(f"mohr_coulomb_line: needs two or more circles, has shapes {low.shape} and {high.shape}")
    if not np.all(np.isfinite(low) & np.isfinite(high)):
        raise InputError("mohr_coulomb_line: all stresses must be finite numbers")
    if np.any(high < low):
        raise InputError("mohr_coulomb_line: sigma_max must be at least sigma_min (compression is positive)")
    centre, radius = 0.5 * (high + low), 0.5 * (high - low)
    offset = centre - centre.mean()
    if np.all(np.abs(offset) <= 1e-12 * np.max(np.abs(centre))):
        raise InputError("mohr_coulomb_line: all circles have the same centre, so that no line is determined")
    sin_phi = (offset @ radius) / (offset @ offset)
    if abs(sin_phi) >= 1.0:
        raise InputError(f"mohr_coulomb_line: sin(phi) = {sin_phi:g} must be below 1: one circle lies inside the other")
    intercept = radius.mean() - sin_phi * centre.mean()
    return YieldLine(float(np.arcsin(sin_phi)), float(intercept / np.sqrt(1.0 - sin_phi**2)))


def mobilised_angle(s_D):
    """arcsin(s_D) [rad], the angle of the line through the origin that touches the circle; same shape, s_D = sigma_D/sigma_V.

    Two dimensions only. Raises InputError where |s_D| > 1.
    """
    s_D = np.asarray(s_D)
    if np.any(np.abs(np.real(s_D)) > 1.0):
        raise InputError(f"mobilised_angle: |s_D| = {np.nanmax(np.abs(np.real(s_D))):g} must be at most 1")
    return np.arcsin(s_D)[()]


def peak_stress(p, phi, c):
    """sigma_zz on the yield line at the side pressure p: p K + 2 c sqrt(K), K = (1 + sin phi)/(1 - sin phi); unit of stress."""
    p = np.asarray(p)
    root = np.cos(phi) / (1.0 - np.sin(phi))  # sqrt(K), analytic
    return p * root**2 + 2.0 * c * root


def macro_cohesion(c0, k1, k2, kc):
    """c = c0 (1 - k1/k2)/(1 + k2/kc), the lecture's macroscopic cohesion, unit of c0; exactly 0 at kc = 0.

    The factor is the strongest attraction of the contact law over k2 delta_max. c0 belongs to one preparation (it follows the
    largest overlap), it is no material constant. k1, k2, kc share a unit. InputError unless k2 > 0, 0 <= k1 <= k2, kc >= 0.
    """
    where = "macro_cohesion"
    k2 = checked(where, "k2", k2, above=0.0)
    k1 = checked(where, "k1", k1, at_least=0.0, at_most=k2)
    kc = checked(where, "kc", kc, at_least=0.0)
    return c0 * (1.0 - k1 / k2) * kc / (kc + k2)
