import numpy as np
import pytest

from anisogran.fitting.residuals import correlation_time, runs_test


def test_correlation_time_of_known_noise(rng):
    n = 4000
    constant = np.ones((n, 1))
    noise = rng.normal(size=n)
    assert correlation_time(noise, constant) == pytest.approx(1.0, abs=0.1)  # standard deviation of rho: 1/sqrt(4000)
    for i in range(1, n):
        noise[i] = 0.9 * noise[i - 1] + np.sqrt(0.19) * noise[i]
    assert correlation_time(noise, constant) == pytest.approx(19.0, rel=0.3)  # 200 independent points: about 12 %
    assert correlation_time(np.zeros(n), constant) == 1.0
    assert correlation_time(noise[:4], np.ones((4, 1))) == 1.0


def test_runs_test():
    assert runs_test(np.array([1.0, -1.0] * 50)) < 1e-10  # too regular
    assert runs_test(np.repeat([1.0, -1.0], 50)) < 1e-10  # too few runs
    assert runs_test(np.array([1, 1, -1, -1, 1, -1, -1, 1, 1, -1, 1, -1, -1, 1.0])) > 0.05
    assert np.isnan(runs_test(np.ones(10)))


def test_what_the_fit_has_taken_away_is_allowed_for(rng):
    """Residuals of a straight line plus a curve through noise of known memory: the raw autocorrelation gives half of it."""
    n, trials = 200, 60
    x = np.linspace(-1, 1, n)
    columns = np.linalg.qr(np.column_stack([np.ones(n), x, x**2]))[0]
    noise = rng.normal(size=(n, trials))
    for i in range(1, n):
        noise[i] = 0.85 * noise[i - 1] + np.sqrt(1 - 0.85**2) * noise[i]
    left = noise - columns @ (columns.T @ noise)
    taus = [correlation_time(left[:, i], columns) for i in range(trials)]
    assert np.median(taus) == pytest.approx(12.3, rel=0.15)  # (1 + rho)/(1 - rho); median of 60 trials with a spread of 40 %: 6 %


def test_a_smooth_misfit_is_no_endless_noise():
    """Residuals of a law that is a little wrong: tau stays of the order of their wave length, so that errors of the order of the misfit
    come out, not none at all."""
    x = np.linspace(0.0, 1.0, 60)
    misfit = np.sin(3 * np.pi * x) * (1 - x)
    jacobian = np.stack([np.ones_like(x), x, x**2], axis=1)
    misfit -= jacobian @ np.linalg.lstsq(jacobian, misfit, rcond=None)[0]
    tau = correlation_time(misfit, jacobian)
    assert 3 < tau < 20  # half a wave is 20 points
