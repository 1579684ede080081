"""The sparse weights against every point with every body, wherever the points lie, and what they must conserve."""

import numpy as np
import pytest
from plain_kernels import plain_line, plain_phi

from anisogran.averaging import coarse_graining
from anisogran.averaging.coarse_graining import gradient_weights, grain_and_gradient_weights, grain_weights, line_weights
from anisogran.averaging.smoothing_kernels import KERNELS, smoothing
from anisogran.outcome import InputError

dimensions = pytest.mark.parametrize("dimension", [2, 3])
kernels = pytest.mark.parametrize("kernel", KERNELS)


def clouds(dimension, rng):
    """Points that try the search: a cloud, a grid, a line, a diagonal, one place, one point, and clusters with points very far away."""
    cloud = rng.uniform(-2, 3, (150, dimension))
    grid = np.stack(np.meshgrid(*[np.arange(-2.0, 3.0)] * dimension), -1).reshape(-1, dimension)
    axis = np.linspace(-2, 2, 90)[:, None]
    far = np.concatenate([cloud[:60], 1e9 * rng.normal(size=(4, dimension)), [[1e25] + [0.0] * (dimension - 1)]])
    return {
        "cloud": cloud, "grid": grid, "line": axis * np.eye(dimension)[-1], "diagonal": axis * np.ones(dimension),
        "one place": np.repeat(cloud[:1], 30, axis=0), "one point": cloud[:1], "far": far,
    }  # fmt: skip


@kernels
@dimensions
@pytest.mark.parametrize("width", [0.02, 0.2, 0.9, 30.0])
def test_grain_weights_are_those_of_every_pair(kernel, dimension, width, rng):
    phi, reach = plain_phi(kernel, width, dimension)
    s = smoothing(kernel, width, dimension)
    for name, points in clouds(dimension, rng).items():
        near = points[rng.integers(0, len(points), 60)] + 0.5 * reach * rng.uniform(-1, 1, (60, dimension))
        bodies = np.concatenate([near, points[:5], rng.uniform(-4, 5, (40, dimension)), [[1e12] * dimension, [-1e30] * dimension]])
        vectors = points[:, None] - bodies[None]
        weights = grain_weights(points, bodies, s)
        assert weights.shape == (len(points), len(bodies))
        np.testing.assert_allclose(weights.toarray(), phi(vectors), rtol=1e-11, atol=1e-14 * s.norm, err_msg=name)
        inside = np.linalg.norm(vectors, axis=-1) <= reach
        np.testing.assert_array_equal(np.diff(weights.indptr), inside.sum(axis=0))
        assert weights.nnz > 0


@dimensions
def test_no_body_at_the_very_reach_is_lost_to_rounding(dimension, rng):
    """Points on the borders of the search's cells, which are half a reach wide, and bodies one reach from them."""
    for reach in rng.uniform(0.1, 1.0, 300):
        s = smoothing("heaviside", reach, dimension)
        points, bodies = np.zeros((60, dimension)), np.zeros((240, dimension))
        points[:, 0] = rng.uniform(-1, 1) + 0.5 * reach * np.arange(60)
        one_reach_away = np.concatenate([points[:, 0] - reach, points[:, 0] + reach])
        bodies[:, 0] = np.concatenate([np.nextafter(one_reach_away, -9.0), np.nextafter(one_reach_away, 99.0)])
        inside = (points[:, None, 0] - bodies[None, :, 0]) ** 2 <= reach * reach
        np.testing.assert_array_equal(grain_weights(points, bodies, s).toarray() > 0, inside)


@dimensions
def test_gradient_weights_come_with_the_grain_weights(dimension, rng):
    points, bodies = rng.uniform(-2, 2, (80, dimension)), rng.uniform(-2, 2, (50, dimension))
    s = smoothing("gaussian", 0.3, dimension)
    phi, _ = plain_phi("gaussian", 0.3, dimension)
    vectors = points[:, None] - bodies[None]
    weights, gradient = grain_and_gradient_weights(points, bodies, s)
    np.testing.assert_array_equal(weights.toarray(), grain_weights(points, bodies, s).toarray())
    assert len(gradient) == dimension
    for axis, (alone, together) in enumerate(zip(gradient_weights(points, bodies, s), gradient, strict=True)):
        exact = -vectors[..., axis] / 0.3**2 * phi(vectors)
        np.testing.assert_allclose(together.toarray(), exact, rtol=1e-11, atol=1e-14 * s.norm)
        np.testing.assert_array_equal(alone.toarray(), together.toarray())
    before = gradient[0].toarray()
    weights.sort_indices()  # in place: a matrix that shared its indices with others would spoil them
    np.testing.assert_array_equal(gradient[0].toarray(), before)


@kernels
@dimensions
@pytest.mark.parametrize(("width", "length"), [(0.05, 0.3), (0.3, 0.3), (0.3, 4.0), (3.0, 0.5)])
def test_line_weights_are_those_of_every_pair(kernel, dimension, width, length, rng):
    s = smoothing(kernel, width, dimension)
    for name, points in clouds(dimension, rng).items():
        picked = points[rng.permutation(len(points))[:12]]
        branch = length * rng.normal(size=(8, dimension))
        start = picked[rng.integers(0, len(picked), 8)] - rng.uniform(0, 1, (8, 1)) * branch
        weights = line_weights(points, start, branch, s).toarray()
        rows = [int(np.flatnonzero((points == point).all(axis=1))[0]) for point in picked]
        exact = [[plain_line(kernel, width, point, start[c], branch[c]) for c in range(8)] for point in picked]
        # far away the place itself is known to 1e-16 of its distance only
        np.testing.assert_allclose(weights[rows], exact, rtol=0, atol=(1e-11 if name != "far" else 1e-5) * s.norm, err_msg=name)
    assert weights.max() > 0


@kernels
@dimensions
def test_a_body_gives_all_it_has_to_a_fine_grid(kernel, dimension):
    """Sum over the points times the cell of each = 1, for grains and for contacts: the integral of the density is the mass."""
    s = smoothing(kernel, 1.0 / (5, 2, 1)[KERNELS.index(kernel)], dimension)  # reach 1
    axis = np.linspace(-1.6, 1.6, 65 if dimension == 2 else 49)
    cell = (axis[1] - axis[0]) ** dimension
    points = np.stack(np.meshgrid(*[axis] * dimension), -1).reshape(-1, dimension)
    bodies = np.array([[0.01, -0.02, 0.013], [0.2, 0.3, 0.0]])[:, :dimension]
    branch = np.array([[0.3, 0.1, -0.2], [-0.5, 0.0, 0.0]])[:, :dimension]
    # measured: lucy 1e-6 and below; gaussian, for its small jump at the edge, 6e-7; heaviside is a count of points in a ball
    loose = {"gaussian": 3e-6, "lucy": 5e-6, "heaviside": 1e-2}[kernel]
    np.testing.assert_allclose(cell * grain_weights(points, bodies, s).sum(axis=0), 1.0, atol=loose)
    np.testing.assert_allclose(cell * line_weights(points, bodies, branch, s).sum(axis=0), 1.0, atol=loose)


@kernels
@dimensions
def test_weights_do_not_depend_on_the_frame(kernel, dimension, rng):
    s = smoothing(kernel, 0.4, dimension)
    points, bodies, branch = (rng.uniform(-1, 1, (40, dimension)) for _ in range(3))
    turn, _ = np.linalg.qr(rng.normal(size=(dimension, dimension)))
    shift = rng.uniform(-3, 3, dimension)
    for weights, vectors in ((grain_weights, ()), (line_weights, (branch,))):
        plain = weights(points, bodies, *vectors, s).toarray()
        turned = weights(points @ turn + shift, bodies @ turn + shift, *(v @ turn for v in vectors), s).toarray()
        np.testing.assert_allclose(turned, plain, rtol=0, atol=1e-12 * s.norm)
        assert (plain > 0).any()


@dimensions
def test_nothing_is_a_valid_number_of_bodies_points_and_neighbours(dimension):
    s = smoothing("gaussian", 0.1, dimension)
    none, one = np.zeros((0, dimension)), np.ones((1, dimension))
    for weights, vectors in ((grain_weights, 1), (line_weights, 2)):
        assert weights(one, *[none] * vectors, s).shape == (1, 0)
        assert weights(none, *[one] * vectors, s).shape == (0, 1)
        assert weights([], *[[]] * vectors, s).shape == (0, 0)
        assert weights(one, *[100 * one] * vectors, s).nnz == 0
    assert grain_weights(one, one, s).toarray()[0, 0] == s.norm
    assert [gradient.shape for gradient in gradient_weights(one, none, s)] == [(1, 0)] * dimension


def test_what_is_no_list_of_places_is_refused():
    s = smoothing("lucy", 1.0, 2)
    with pytest.raises(InputError, match=r"position has shape \(1, 3\), expected \(N, 2\)"):
        grain_weights([[0.0, 0.0]], [[0.0, 0.0, 0.0]], s)
    with pytest.raises(InputError, match=r"points\[1\] is not finite"):
        grain_weights([[0.0, 0.0], [np.nan, 0.0]], [[0.0, 0.0]], s)
    with pytest.raises(InputError, match=r"branch has 2 rows, expected 1"):
        line_weights([[0.0, 0.0]], [[0.0, 0.0]], [[0.0, 0.0], [1.0, 0.0]], s)
    with pytest.raises(InputError, match="points is no array of numbers"):
        grain_weights([["a", "b"]], [[0.0, 0.0]], s)


def test_more_weights_than_an_index_can_count_are_refused_before_they_are_made(monkeypatch):
    """Here with a bound of 11: four points and three grains within reach of each other are counted, not stored."""
    s = smoothing("lucy", 1.0, 2)
    monkeypatch.setattr(coarse_graining, "LARGEST", 11)
    with pytest.raises(InputError, match="12 weights must be at most 11"):
        grain_weights(np.zeros((4, 2)), np.zeros((3, 2)), s)
    begin, near = coarse_graining.near_points(np.zeros((4, 3)), np.zeros((3, 3)), np.zeros((3, 3)), 1.0, 11)
    assert (begin[-1], near.size) == (12, 0)
    monkeypatch.setattr(coarse_graining, "LARGEST", 12)
    assert grain_weights(np.zeros((4, 2)), np.zeros((3, 2)), s).nnz == 12
