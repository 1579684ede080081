"""What the residuals of a fit say: how long they remember, and whether their signs are random."""

from math import erfc, sqrt

import numpy as np
from scipy.optimize import minimize_scalar

_MEMORY = 0.5  # the series is thinned to the lag at which its autocorrelation falls below this
_OFFSETS = 4  # so many of the thinned series are looked at together
_LONGEST = 0.98  # largest correlation of neighbours in a thinned series


def correlation_time(residual, jacobian):
    """tau = (1 + rho)/(1 - rho) in points, at least 1 (white noise), of residuals in order of x: n/tau points are independent.

    The autocorrelation of residuals is far below that of the noise, since the fit follows the slow part of the noise. So rho is
    taken where the restricted likelihood of noise with exponential memory is largest, which allows for the p columns of the
    `jacobian`, shape (n, p). The series is first thinned until neighbours are moderately correlated: then smooth or finely
    sampled noise, which no exponential describes from one point to the next, gives the right order too.

    Where the likelihood finds no stationary noise at all, the residuals are a smooth misfit of the law. A misfit has no length of
    memory to be estimated; tau is then the sum of the autocorrelation over its first positive stretch, which makes the errors of
    the order of the misfit.
    """
    n, p = jacobian.shape
    if n < 5 * p or not np.any(residual):
        return 1.0
    columns = np.linalg.qr(jacobian)[0]  # same span; unit columns keep the determinant in range
    step = _thinning(residual, n // (5 * p))
    offsets = np.unique(np.linspace(0, step - 1, _OFFSETS).astype(int))
    parts = [(residual[offset::step], columns[offset::step]) for offset in offsets]
    best = minimize_scalar(lambda rho: sum(_misfit(rho, *part) for part in parts), bounds=(0.0, _LONGEST), method="bounded")
    rho = best.x ** (1.0 / step)
    tau = (1.0 + rho) / (1.0 - rho)
    if tau * (p + 1) > n:  # fewer independent points than one more than parameters: no noise, but a trend
        correlation = _autocorrelation(residual)
        negative = np.flatnonzero(correlation <= 0.0)
        tau = 1.0 + 2.0 * np.sum(correlation[1 : negative[0] if negative.size else None])
    return float(tau)


def _autocorrelation(residual):
    """Correlation of the residuals at the lags 0, 1, ..., n - 1, about zero; shape (n,)."""
    power = np.abs(np.fft.rfft(residual, 2 * residual.size)) ** 2  # zero padding: no wrap-around
    covariance = np.fft.irfft(power)[: residual.size]
    return covariance / covariance[0]


def _thinning(residual, longest):
    """The first lag at which the autocorrelation is below _MEMORY, at most `longest`."""
    below = np.flatnonzero(_autocorrelation(residual)[: longest + 1] < _MEMORY)
    return int(below[0]) if below.size else max(1, longest)


def _misfit(rho, residual, columns):
    """-2 ln of the restricted likelihood of residuals with the correlation rho^lag, up to a constant."""

    def whitened(values):
        return np.concatenate([values[:1] * np.sqrt(1.0 - rho**2), values[1:] - rho * values[:-1]])

    q, r = np.linalg.qr(whitened(columns))
    noise = whitened(residual)
    left = noise - q @ (q.T @ noise)
    free = residual.size - columns.shape[1]
    return 2.0 * np.sum(np.log(np.abs(np.diag(r)))) + free * np.log(left @ left) - np.log(1.0 - rho**2)


def runs_test(residual):
    """The probability that signs as ordered as these come from independent points (Wald-Wolfowitz, two-sided), or nan."""
    signs = residual[residual != 0.0] > 0.0
    above, below = int(signs.sum()), int(signs.size - signs.sum())
    n = above + below
    if above == 0 or below == 0 or n < 3:
        return float("nan")
    runs = 1 + int(np.count_nonzero(signs[1:] != signs[:-1]))
    expected = 1.0 + 2.0 * above * below / n
    variance = (expected - 1.0) * (expected - 2.0) / (n - 1.0)
    return float("nan") if variance <= 0.0 else erfc(abs(runs - expected) / sqrt(2.0 * variance))
