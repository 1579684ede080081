import numpy as np
import pytest

from anisogran.dem.packing import random_positions, uniform_radii
from anisogran.outcome import InputError


def test_radii_have_their_mean_and_ratio(rng):
    radius = uniform_radii(200_000, 2.0, 3.0, rng)
    assert radius.mean() == pytest.approx(2.0, rel=5e-3)  # three standard errors
    assert 1.0 <= radius.min() < 1.001
    assert 2.999 < radius.max() <= 3.0


def test_no_disc_overlaps_another_nor_its_images_nor_what_is_there(rng):
    radius = uniform_radii(120, 0.5, 3.0, rng)
    period = np.array([16.0, 16.0])
    position = random_positions(
        radius, lambda rng, n: rng.uniform(0, period, (n, 2)), lambda points, r: np.ones(len(points), bool), rng,
        taken=[[8.0, 8.0]], taken_radius=[2.0], period=period,
    )  # fmt: skip
    everything, sizes = np.vstack([position, [[8.0, 8.0]]]), np.append(radius, 2.0)
    i, j = np.triu_indices(121, 1)
    apart = everything[i] - everything[j]
    apart -= np.rint(apart / period) * period
    assert np.all(np.hypot(*apart.T) > sizes[i] + sizes[j])


def test_a_full_box_is_refused(rng):
    with pytest.raises(InputError, match="no room for grain"):
        random_positions(np.full(9, 0.5), lambda rng, n: rng.uniform(0, 2, (n, 2)), lambda points, r: np.ones(len(points), bool), rng)
