"""The peak of the moving average: exact for straight and quadratic curves, the same however often a curve is sampled."""

import numpy as np
import pytest

import anisogran as ag


def test_a_tent_loses_a_quarter_of_the_width_times_its_slope():
    """Average of 100 - 1000 |x - 0.05| over 0.004 about the top: 100 - 1000 * 0.001."""
    for points in (3, 21, 1001):
        strain = np.linspace(0.0, 0.1, points)
        found = ag.fit.peak(strain, 100.0 - 1000.0 * abs(strain - 0.05))
        assert found.value == pytest.approx(99.0, rel=1e-6)  # the grid of a twentieth of the width meets the top to rounding
        assert found.strain == pytest.approx(0.05, abs=1e-4)


def test_a_constant_and_a_rise_are_exact():
    strain = np.geomspace(1.0, 2.0, 50) - 1.0  # not uniform
    assert ag.fit.peak(strain, np.full(50, 3.0)).value == pytest.approx(3.0, rel=1e-12)
    rising = ag.fit.peak(strain, 5.0 * strain, width=0.1)
    assert rising == pytest.approx((5.0 * 0.95, 0.95), rel=1e-12)


def test_noise_and_ringing_do_not_lift_it(rng):
    strain = np.linspace(0.0, 0.1, 2001)
    true = 200.0 * (1 - np.exp(-200 * strain))
    noisy = true + rng.normal(0, 20.0, strain.size)
    found = ag.fit.peak(strain, noisy).value
    assert noisy.max() > 240.0
    # 81 points in the width: a standard deviation of 2.2, of which the largest of some 20 independent averages lies two above
    assert found == pytest.approx(200.0, abs=9.0)


def test_nan_at_the_end_is_left_out():
    """As collected sweeps have them where a run is shorter than others."""
    strain = np.linspace(0.0, 0.1, 101)
    padded = np.append(strain, [np.nan] * 5)
    assert ag.fit.peak(padded, 3.0 * padded) == ag.fit.peak(strain, 3.0 * strain)


def test_many_curves_at_once():
    strain = np.broadcast_to(np.linspace(0.0, 0.1, 101), (2, 3, 101))
    height = np.arange(1.0, 7.0).reshape(2, 3, 1)
    found = ag.fit.peak(strain, height * np.sin(20 * strain))
    assert found.value.shape == found.strain.shape == (2, 3)
    one = ag.fit.peak(strain[1, 2], 6.0 * np.sin(20 * strain[1, 2]))
    assert (found.value[1, 2], found.strain[1, 2]) == one
    with pytest.raises(ag.InputError, match=r"one shape, have \(2, 3, 101\) and \(2, 3, 100\)"):
        ag.fit.peak(strain, strain[..., 1:])


@pytest.mark.parametrize(
    ("strain", "words"),
    [
        (np.linspace(0.0, 0.003, 10), "spans 0.003, the width of the average is 0.004"),
        ([0.0, 0.05, 0.04, 0.1], "the strain must grow"),
        ([0.0, 0.05, np.nan], r"^peak: 2 finite points \(of 3\) are too few, 3 are needed$"),
    ],
)
def test_what_has_no_peak_is_refused(strain, words):
    with pytest.raises(ag.InputError, match=words):
        ag.fit.peak(strain, np.ones(len(strain)))
