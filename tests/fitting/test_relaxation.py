import numpy as np
import pytest

from anisogran.fitting import relaxation
from anisogran.outcome import InputError

TRUTH = {"s_0": 0.05, "s_max": 0.4, "beta": 60.0}
STRAIN = np.linspace(0.0, 0.1, 300)
CURVE = 0.4 - 0.35 * np.exp(-60.0 * STRAIN)


def remembering_noise(rng, rho, shape):
    """Noise of variance 1 with the correlation rho^lag along its first axis: correlation time (1 + rho)/(1 - rho)."""
    noise = rng.normal(size=shape)
    for i in range(1, shape[0]):
        noise[i] = rho * noise[i - 1] + np.sqrt(1 - rho**2) * noise[i]
    return noise


def coverage(rng, rho, points, trials):
    """{name: share of 95 % intervals that cover the truth}, and the mean correlation time found."""
    x, y = STRAIN[:: 300 // points], CURVE[:: 300 // points]
    noise = 0.02 * remembering_noise(rng, rho, (x.size, trials))
    fits = [relaxation(x, y + noise[:, i]) for i in range(trials)]
    assert all(fit.verdict for fit in fits)
    inside = {name: np.mean([low <= value <= high for low, high in (fit.interval(name) for fit in fits)]) for name, value in TRUTH.items()}
    return inside, np.mean([fit.residuals["correlation_time"] for fit in fits])


def test_intervals_cover_the_truth_with_white_noise(rng):
    inside, tau = coverage(rng, 0.0, points=100, trials=200)
    assert all(0.90 <= share <= 0.99 for share in inside.values()), inside  # 200 trials of 95 %: standard deviation 1.5 %
    assert tau < 1.3


def test_intervals_cover_the_truth_with_noise_that_remembers(rng):
    inside, tau = coverage(rng, 0.8, points=300, trials=100)
    # 33 independent points; 100 trials of 95 %: standard deviation 2 %. The naive error covers half of the cases
    assert all(0.88 <= share <= 1.0 for share in inside.values()), inside
    assert tau == pytest.approx(9.0, rel=0.25)  # (1 + rho)/(1 - rho); sampling, and one in ten from finite length


def test_smooth_noise_is_not_taken_for_endless_memory(rng):
    kernel = np.exp(-0.5 * (np.arange(-30, 31) / 4.0) ** 2)
    taus = []
    for _ in range(10):
        noise = np.convolve(rng.normal(size=360), kernel / np.sqrt(np.sum(kernel**2)), mode="valid")
        taus.append(relaxation(STRAIN, CURVE + 0.02 * noise).residuals["correlation_time"])
    # exact: sum of the correlations, 2 sqrt(pi) 4 = 14; an exponential fitted to a Gaussian correlation errs to the safe side
    assert 10 < np.median(taus) < 35


def test_the_tail_after_the_peak_is_left_out_and_said_so(rng):
    noise = 0.004 * rng.normal(size=300)
    falling = np.where(STRAIN > 0.07, CURVE - 4.0 * (STRAIN - 0.07), CURVE) + noise
    result, all_points = relaxation(STRAIN, falling), relaxation(STRAIN, falling, until=None)
    assert result.verdict
    assert 0.05 < result.x_range[1] < 0.075
    assert result.cut == 300 - result.points > 0
    assert result.values == pytest.approx(TRUTH, rel=0.05, abs=0.01)
    assert all_points.cut == 0
    assert all_points.values["s_max"] < 0.39  # the bias that the cut avoids
    assert all_points.values["beta"] > 63
    assert relaxation(STRAIN, CURVE + noise).cut == 0  # a noisy plateau is no peak


def test_a_law_that_falls_is_fitted_as_well(rng):
    result = relaxation(STRAIN, -CURVE + 0.004 * rng.normal(size=300))
    assert result.verdict
    assert result.values["s_max"] == pytest.approx(-0.4, abs=0.01)  # ten standard errors


def test_units_order_and_kind_of_the_data_do_not_matter(rng):
    x, y = 100 * STRAIN, 1e9 * (CURVE + 0.01 * rng.normal(size=300))
    plain, order = relaxation(STRAIN, y / 1e9), rng.permutation(300)
    other = relaxation(np.ma.masked_array(x[order]), y[order].tolist())
    for name, factor in {"s_0": 1e9, "s_max": 1e9, "beta": 0.01}.items():
        assert other.values[name] == pytest.approx(factor * plain.values[name], rel=1e-6)  # minimiser: root of 1e-12
        assert other.errors[name] == pytest.approx(factor * plain.errors[name], rel=1e-4)  # with it the search for tau
    counts = relaxation(np.arange(300), np.ma.masked_greater((1000 * CURVE).astype(int), 390))
    assert counts.dropped == np.count_nonzero((1000 * CURVE).astype(int) > 390)


def test_the_error_is_that_of_linear_theory(rng):
    """White noise of known size given as errors: the covariance is (J^T J)^-1 sigma^2, J by hand."""
    result = relaxation(STRAIN, CURVE + 0.01 * rng.normal(size=300), errors=np.full(300, 0.01))
    decay, gap = np.exp(-result.values["beta"] * STRAIN), result.values["s_max"] - result.values["s_0"]
    J = np.column_stack([decay, 1 - decay, gap * STRAIN * decay])
    sigma = 0.01 * np.sqrt(np.diag(np.linalg.inv(J.T @ J)))
    tau, chi_square = result.residuals["correlation_time"], result.residuals["chi_square"]
    enlarged = sigma * np.sqrt(max(tau, chi_square / result.free))
    assert list(result.errors.values()) == pytest.approx(enlarged, rel=1e-8)  # rounding of the inverse, condition 1e2


def test_the_result_tells_its_story(rng):
    result = relaxation(STRAIN, CURVE + 0.01 * rng.normal(size=300))
    np.testing.assert_allclose(result.predict(STRAIN), CURVE, atol=0.01)  # one noise; the fit is far better
    assert result.x_range == (0.0, 0.1)
    assert result.points == 300
    assert result.residuals["rms"] == pytest.approx(0.01, rel=0.2)  # 300 points: 4 %
    assert result.residuals["runs_p"] > 0.01
    assert len(result.starts) >= 8
    assert result.start in result.starts
    assert result.lmfit_version.count(".") >= 1
    assert "s_max = 0.4" in str(result)
    low, high = result.interval("beta", level=0.5)
    assert high - low < 1.4 * result.errors["beta"]  # 2 x 0.674
    with pytest.raises(InputError, match="interval: needs one of s_0, s_max, beta"):
        result.interval("gamma")
    with pytest.raises(AttributeError):
        result.points = 3


def test_structure_in_the_residuals_is_reported():
    result = relaxation(STRAIN, CURVE + 0.01 * np.sin(400 * STRAIN))
    assert "structure left in residuals" in str(result.verdict)


def test_bad_settings_are_named():
    with pytest.raises(InputError, match="until = 'end' must be"):
        relaxation(STRAIN, CURVE, until="end")
    with pytest.raises(InputError, match="start must give beta, s_0, s_max, has beta"):
        relaxation(STRAIN, CURVE, start={"beta": 1.0})
    with pytest.raises(InputError, match="outside the range"):
        relaxation(STRAIN, CURVE, start={"s_0": 0.0, "s_max": 0.4, "beta": -1.0})
    with pytest.raises(InputError, match="errors must be above 0"):
        relaxation(STRAIN, CURVE, errors=0 * STRAIN)


def test_strain_of_the_wrong_sign_is_refused():
    x = np.linspace(0.0, 0.1, 50)
    with pytest.raises(InputError, match=r"eps_D = -0\.1 is negative; the law holds for loading"):
        relaxation(-x, 0.4 * (1 - np.exp(-50 * x)))
    with pytest.raises(InputError, match="must be a dict of s_0, s_max and beta"):
        relaxation(x, 0.4 * (1 - np.exp(-50 * x)), start=(0, 1, 2))
