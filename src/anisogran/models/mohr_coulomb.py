"""Mohr-Coulomb: yield line tau = c + sigma tan(phi) of stress circles, and the lecture's macroscopic cohesion.

Compression positive; radians. Two angles must not be mixed: the *internal* one is the slope of the common tangent of several circles,
the *total* one the slope of a line through the origin that touches a circle (the mobilised, or secant, angle). They agree if c = 0.
"""

from typing import NamedTuple

import numpy as np

from anisogran.outcome import InputError, checked


class StressCircles(NamedTuple):
    """Centre (sigma_1 + sigma_2)/2 and radius (sigma_1 - sigma_2)/2 of Mohr's circles, one shape (...), unit of stress."""

    centre: np.ndarray
    radius: np.ndarray

    def points(self, n=181):
        """(sigma, tau), shape (2, n, ...): the upper half of the circles, from the larger to the smaller principal stress."""
        angle = np.linspace(0.0, np.pi, n).reshape(n, *(1,) * np.ndim(self.centre))
        return np.array([self.centre + self.radius * np.cos(angle), self.radius * np.sin(angle)])


class YieldLine(NamedTuple):
    """Friction angle phi [rad] of the line, and cohesion c, its shear stress at sigma = 0, unit of stress."""

    phi: float
    c: float

    def shear_stress(self, sigma):
        """tau = c + sigma tan(phi), shape of sigma."""
        return self.c + np.asarray(sigma) * np.tan(self.phi)

    def touching_points(self, circles):
        """(sigma, tau), shape (2, ...): the points of the circles that are nearest to the line; on it where the circle touches it.

        There the plane is turned by pi/4 + phi/2 from the one that bears the larger principal stress.
        """
        return np.array([circles.centre - circles.radius * np.sin(self.phi), circles.radius * np.cos(self.phi)])

    def excess(self, circles):
        """How far the circles reach over the line, radius - c cos(phi) - centre sin(phi), shape (...): 0 where they touch it."""
        return circles.radius - self.c * np.cos(self.phi) - circles.centre * np.sin(self.phi)


class FailureLines(NamedTuple):
    """The `YieldLine` of the peak stresses and that of the residual stresses after it."""

    peak: YieldLine
    residual: YieldLine


def stress_circles(sigma_min, sigma_max):
    """The `StressCircles` of principal stresses, shape of the arguments broadcast. InputError where sigma_max < sigma_min."""
    low, high = np.asarray(sigma_min, dtype=float), np.asarray(sigma_max, dtype=float)
    if np.any(high < low):
        raise InputError("stress_circles: sigma_max must be at least sigma_min (compression is positive)")
    return StressCircles(0.5 * (high + low), 0.5 * (high - low))


def mohr_coulomb_line(sigma_min, sigma_max):
    """The common tangent of stress circles with the principal stresses sigma_min <= sigma_max, each of shape (n,), n >= 2.

    A circle of centre m and radius r touches the line if r = c cos(phi) + m sin(phi): exact for two circles, a straight
    least-squares line through the (m, r) for more. Returns a `YieldLine`; c is negative if the data ask for it.
    Raises InputError for fewer than two circles, equal centres, sigma_max < sigma_min, or radii that grow as fast as the centres.
    """
    centre, radius = _circles_of_tests("mohr_coulomb_line", sigma_min, sigma_max, 2)
    offset = centre - centre.mean()
    if np.all(np.abs(offset) <= 1e-12 * np.max(np.abs(centre))):
        raise InputError("mohr_coulomb_line: all circles have the same centre, so that no line is determined")
    sin_phi = (offset @ radius) / (offset @ offset)
    if abs(sin_phi) >= 1.0:
        raise InputError(f"mohr_coulomb_line: sin(phi) = {sin_phi:g} must be below 1: one circle lies inside the other")
    intercept = radius.mean() - sin_phi * centre.mean()
    return YieldLine(float(np.arcsin(sin_phi)), float(intercept / np.sqrt(1.0 - sin_phi**2)))


def total_friction_line(sigma_min, sigma_max):
    """The line through the origin that fits stress circles best, a `YieldLine` with c = 0 and the total (secant) angle.

    sigma_min <= sigma_max of shape (n,), n >= 1; the least-squares slope of radius over centre, the mobilised angle itself for one
    circle. Raises InputError for no circle, sigma_max < sigma_min, or stresses that no line from the origin can touch.
    """
    centre, radius = _circles_of_tests("total_friction_line", sigma_min, sigma_max, 1)
    square, product = centre @ centre, centre @ radius
    if abs(product) >= square:
        raise InputError(f"total_friction_line: sin(phi) = {product:g}/{square:g} must be below 1: the circles hold the origin")
    return YieldLine(float(np.arcsin(product / square)), 0.0)


def failure_lines(sigma_min, peak, residual):
    """The `FailureLines` of tests at the side pressures sigma_min, each with its peak and its residual sigma_max; shapes (n,).

    Past the peak a sample loses cohesion and friction: what is left is the residual line. Raises InputError as
    `mohr_coulomb_line`, or where a residual stress is above the peak of its test.
    """
    peak, residual = np.asarray(peak, dtype=float), np.asarray(residual, dtype=float)
    if peak.shape == residual.shape and np.any(residual > peak):
        k = np.argmax(residual > peak)
        raise InputError(f"failure_lines: residual = {residual.flat[k]:g} must be at most the peak of its test, {peak.flat[k]:g}")
    return FailureLines(mohr_coulomb_line(sigma_min, peak), mohr_coulomb_line(sigma_min, residual))


def _circles_of_tests(where, sigma_min, sigma_max, fewest):
    low, high = (np.atleast_1d(np.asarray(sigma, dtype=float)) for sigma in (sigma_min, sigma_max))
    if low.ndim != 1 or low.shape != high.shape or low.size < fewest:
        raise InputError(f"{where}: needs {'two' if fewest == 2 else 'one'} or more circles, has shapes {low.shape} and {high.shape}")
    if not np.all(np.isfinite(low) & np.isfinite(high)):
        raise InputError(f"{where}: all stresses must be finite numbers")
    if np.any(high < low):
        raise InputError(f"{where}: sigma_max must be at least sigma_min (compression is positive)")
    return stress_circles(low, high)


def mobilised_angle(s_D):
    """arcsin(s_D) [rad], the angle of the line through the origin that touches the circle; same shape, s_D = sigma_D/sigma_V.

    A secant angle: with cohesion it is above the internal angle of a `YieldLine`, and falls with pressure. Two dimensions only.
    Raises InputError where |s_D| > 1.
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
