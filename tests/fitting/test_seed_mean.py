"""The mean over seeds and its standard error."""

import numpy as np

import anisogran as ag


def test_two_values_by_hand():
    """1 and 3: mean 2, standard deviation sqrt(2), over sqrt(2) values."""
    mean, error = ag.fit.mean_and_error([1.0, 3.0])
    assert mean == 2.0
    np.testing.assert_allclose(error, 1.0, rtol=1e-15)


def test_the_axis_is_the_one_named():
    mean, error = ag.fit.mean_and_error([[1.0, 3.0], [5.0, 11.0]], axis=0)
    np.testing.assert_allclose(mean, [3.0, 7.0], rtol=1e-15)
    np.testing.assert_allclose(error, [2.0, 4.0], rtol=1e-15)


def test_one_value_has_no_error():
    mean, error = ag.fit.mean_and_error([[1.0], [2.0]])
    np.testing.assert_array_equal(mean, [1.0, 2.0])
    assert np.isnan(error).all()


def test_the_error_is_that_of_many_repetitions(rng):
    """The scatter of the means of 4000 sets of six: known to 1/sqrt(2 4000) = 1.1 %, as the mean square error of the six is."""
    mean, error = ag.fit.mean_and_error(rng.normal(size=(4000, 6)))
    np.testing.assert_allclose(np.sqrt(np.mean(error**2)), np.std(mean), rtol=0.05)
