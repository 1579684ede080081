"""The smoothing kernels: integral, width, slope and the mean along a line, each against a formula or a quadrature of its own."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from plain_kernels import SHAPES, SPHERE, plain_line, plain_moment, plain_phi

from anisogran.averaging.coarse_graining import gradient_weights, grain_weights, line_weights
from anisogran.averaging.smoothing_kernels import KERNELS, smoothing, standard_deviation
from anisogran.outcome import InputError

EVERY = [(kernel, dimension) for kernel in KERNELS for dimension in (2, 3)]
SMOOTH = [(kernel, dimension) for kernel, dimension in EVERY if kernel != "heaviside"]
every = pytest.mark.parametrize(("kernel", "dimension"), EVERY)
smooth = pytest.mark.parametrize(("kernel", "dimension"), SMOOTH)


def profile(s, r):
    """phi at the distances r from one body."""
    points = np.zeros((len(r), s.dimension))
    points[:, -1] = r
    return grain_weights(points, np.zeros((1, s.dimension)), s).toarray()[:, 0]


def line(s, point, start, branch):
    return line_weights([point], [start], [branch], s).toarray()[0, 0]


@every
@pytest.mark.parametrize("width", [1e-3, 0.7])
def test_a_kernel_integrates_to_one_and_has_the_spread_it_says(kernel, dimension, width):
    s = smoothing(kernel, width, dimension)
    node, weight = np.polynomial.legendre.leggauss(60)
    r = 0.5 * (node + 1) * s.reach
    shell = SPHERE[dimension] * r ** (dimension - 1) * profile(s, r) * 0.5 * s.reach * weight
    assert shell.sum() == pytest.approx(1.0, abs=1e-12)  # 60 points are exact for the polynomials, and to rounding for the Gaussian
    variance = (shell * r**2).sum() / dimension
    assert standard_deviation(s) == pytest.approx(np.sqrt(variance), rel=1e-12)
    exact = plain_moment(kernel, dimension, power=2) / plain_moment(kernel, dimension) / dimension
    assert standard_deviation(s) == pytest.approx(width * np.sqrt(exact), rel=1e-12)


def test_widths_mean_what_they_are_said_to_mean():
    """The Gaussian's width is its standard deviation but for the little that is cut off; the reach is 6.5, 2 and 1 widths."""
    for dimension, lost in ((2, 21.125 * np.exp(-21.125)), (3, 6.5**3 * np.exp(-21.125) * np.sqrt(2 / np.pi) / 3)):
        deviation = standard_deviation(smoothing("gaussian", 2.0, dimension))
        assert deviation == pytest.approx(2.0 * np.sqrt(1 - lost), rel=1e-13)  # next order: the square of 5e-8
    assert standard_deviation(smoothing("lucy", 2.0, 3)) == pytest.approx(2.0 / np.sqrt(3))
    assert standard_deviation(smoothing("heaviside", 2.0, 2)) == pytest.approx(1.0)
    assert [smoothing(kernel, 2.0, 2).reach for kernel in KERNELS] == [13.0, 4.0, 2.0]


@every
def test_the_profile_is_the_formula_and_ends_at_the_reach(kernel, dimension):
    s = smoothing(kernel, 0.25, dimension)
    shape, _ = SHAPES[kernel]
    r = np.linspace(0, 1, 40) * s.reach
    np.testing.assert_allclose(profile(s, r), s.norm * shape(r / 0.25), rtol=1e-13, atol=1e-15 * s.norm)
    assert profile(s, [0.0])[0] == s.norm
    edge = {"gaussian": np.exp(-21.125), "lucy": 0.0, "heaviside": 1.0}[kernel] * s.norm
    assert profile(s, [s.reach])[0] == pytest.approx(edge, rel=1e-12)  # a body exactly at the reach counts
    assert profile(s, [s.reach * (1 + 1e-12)])[0] == 0.0


@smooth
def test_the_gradient_is_that_of_the_kernel(kernel, dimension, rng):
    """Central differences come nearer with the square of their step."""
    s = smoothing(kernel, 0.3, dimension)
    point = rng.uniform(-1, 1, (20, dimension))
    point *= (rng.uniform(0.1, 0.9, 20) * s.reach / np.linalg.norm(point, axis=1))[:, None]
    body = np.zeros((1, dimension))
    for axis, gradient in enumerate(gradient_weights(point, body, s)):
        errors = []
        for step in (2e-3, 1e-3):
            shift = step * np.eye(dimension)[axis]
            difference = (grain_weights(point + shift, body, s) - grain_weights(point - shift, body, s)).toarray() / (2 * step)
            errors.append(np.abs(difference - gradient.toarray()).max())
        assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.02)  # the step is a hundredth of the width
        assert errors[1] < 1e-4 * s.norm / s.width  # the gradient itself is about norm/width
    assert all(gradient.toarray()[0, 0] == 0 for gradient in gradient_weights(body, body, s))


@every
def test_the_mean_along_a_line_against_quadrature(kernel, dimension, rng):
    """From segments much shorter than the width to much longer ones, inside, across and outside of the reach."""
    s = smoothing(kernel, 0.4, dimension)
    seen = 0
    for length in (1e-9, 1e-5, 1e-4, 2e-3, 0.1, 0.4, 3.0, 20.0):
        for _ in range(12):
            direction = rng.normal(size=dimension)
            branch = length * direction / np.linalg.norm(direction)
            point = rng.uniform(-3, 3, dimension)
            start = point + rng.uniform(-0.7, 0.7, dimension) * s.reach - rng.uniform() * branch
            exact = plain_line(kernel, 0.4, point, start, branch)
            assert line(s, point, start, branch) == pytest.approx(exact, rel=1e-10, abs=1e-11 * s.norm)
            seen += 0 < exact < s.norm
    assert seen > 40 or kernel == "heaviside"


@every
@pytest.mark.parametrize("height", [0.0, 1e-200, 1e-30, 1e-9, 1e-3])
def test_a_line_through_the_point_is_no_special_case(kernel, dimension, height):
    s = smoothing(kernel, 0.4, dimension)
    point, across, start, branch = np.zeros((4, dimension))
    across[0], start[1], branch[1] = height, -0.3, 1.1
    exact = plain_line(kernel, 0.4, point, start, branch)
    assert line(s, point, start + across, branch) == pytest.approx(exact, rel=1e-5 if height == 1e-3 else 1e-12)  # height^2/width^2
    assert line(s, point, point + across, branch) == pytest.approx(plain_line(kernel, 0.4, point, point, branch), rel=1e-2 * height + 1e-12)


@every
def test_the_mean_along_a_line_at_the_edge(kernel, dimension):
    """A branch without length is a point; a line that only touches the reach has no part in it; one that ends there counts."""
    s = smoothing(kernel, 0.5, dimension)
    point, start, branch = np.zeros((3, dimension))
    start[0], branch[1] = 0.3, 0.2
    for part in (0.0, 1e-300, 1e-14, 1e-9):
        assert line(s, point, start, part * branch) == pytest.approx(float(plain_phi(kernel, 0.5, dimension)[0](start)), rel=1e-8)
    start[0], branch[1] = s.reach, 1.0
    assert line(s, point, start - 0.5 * branch, branch) == 0.0
    start[0], start[1], branch[1] = 0.0, s.reach, 1.0
    assert line(s, point, start, branch) == 0.0
    half = line(s, point, start - 2 * s.reach * branch, s.reach * branch)
    assert half == pytest.approx(line(s, point, point, s.reach * branch), rel=1e-13)
    assert half > 0.1 * s.norm


@every
def test_a_grazing_line_never_has_a_negative_mean(kernel, dimension, rng):
    """Lines that pass, or begin, at the very reach, where the integral is smaller than the rounding of its terms."""
    s = smoothing(kernel, 0.37, dimension)
    turn = np.linalg.qr(rng.normal(size=(2000, dimension, dimension)))[0]
    height = s.reach * (1 - np.concatenate([10 ** rng.uniform(-17, -3, 400), 1e-16 * rng.integers(-4, 5, 1600)]))
    length = 10 ** rng.uniform(-8, 2, 2000)
    start = height[:, None] * turn[:, 0] - (rng.uniform(0, 1, 2000) * length)[:, None] * turn[:, 1]
    mean = line_weights(np.zeros((1, dimension)), start, length[:, None] * turn[:, 1], s).toarray()[0]
    assert (mean >= 0).all()
    top = {"gaussian": 1.03 * np.exp(-12.5), "lucy": 5e-9, "heaviside": 1.0}[kernel]  # at 0.999 of the reach
    chord = 2 * np.sqrt(np.maximum(s.reach**2 - height**2, 0) + 1e-12 * s.reach**2)  # rounding moves a line by 1e-14 of a long branch
    assert (mean <= top * s.norm * np.minimum(chord / length, 1)).all()
    outward = line_weights(np.zeros((1, dimension)), height[:, None] * turn[:, 0], length[:, None] * turn[:, 0], s).toarray()[0]
    assert (outward >= 0).all()


@smooth
def test_the_divergence_of_the_line_is_the_difference_of_its_ends(kernel, dimension, rng):
    """branch . grad of the integral = phi(x - start) - phi(x - end): why the stress of coarse graining balances momentum exactly."""
    s = smoothing(kernel, 0.4, dimension)
    points = rng.uniform(-0.2, 0.2, (30, dimension))  # so that both ends are within reach, whose edge has a jump for the Gaussian
    start, branch = rng.uniform(-0.2, 0.2, (2, 1, dimension))
    ends = (grain_weights(points, start, s) - grain_weights(points, start + branch, s)).toarray()
    errors = []
    for step in (2e-2, 1e-2):
        shift = step * branch
        difference = (line_weights(points + shift, start, branch, s) - line_weights(points - shift, start, branch, s)).toarray() / (
            2 * step
        )
        errors.append(np.abs(difference - ends).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.02)
    assert errors[1] < 1e-3 * s.norm


lengths = st.floats(-3, 3, allow_subnormal=False)


@settings(max_examples=300, deadline=None)
@given(
    kind=st.sampled_from(EVERY), start=st.tuples(*[lengths] * 3), branch=st.tuples(*[lengths] * 3),
    scale=st.sampled_from([1.0, 1e-3, 1e-6, 1e-13, 0.0]), part=st.floats(0, 1),
)  # fmt: skip
def test_any_segment_has_a_mean_between_nothing_and_the_top(kind, start, branch, scale, part):
    """It does not depend on the direction, and the means of two pieces make that of the whole."""
    kernel, dimension = kind
    s = smoothing(kernel, 0.5, dimension)
    point, start, branch = np.zeros(dimension), np.array(start[:dimension]), scale * np.array(branch[:dimension])
    whole = line(s, point, start, branch)
    assert 0 <= whole <= s.norm * (1 + 1e-14)
    cut = start + part * branch
    pieces = part * line(s, point, start, part * branch) + (1 - part) * line(s, point, cut, (1 - part) * branch)
    # the edge of the reach is known to rounding, 1e-16 of the distances, and may fall on the other side of a segment that is as short
    length = np.linalg.norm(branch)
    blur = 1.0 if length < 1e-11 and abs(np.linalg.norm(start) - s.reach) < 1e-11 else 1e-11 + (1e-15 / length if length > 0 else 0)
    blur = min(blur, 1.0) if kernel == "heaviside" else 1e-11 + min(blur, 1.0) * np.exp(-12.5)
    assert line(s, point, start + branch, -branch) == pytest.approx(whole, abs=2 * blur * s.norm)
    assert pieces == pytest.approx(whole, abs=2 * blur * s.norm)


def test_bad_kernels_are_refused():
    with pytest.raises(InputError, match="kernel = 'gauss' is unknown; known are gaussian, lucy, heaviside"):
        smoothing("gauss", 1.0, 2)
    with pytest.raises(InputError, match="width = 0 must be above 0 m"):
        smoothing("lucy", 0.0, 2)
    with pytest.raises(InputError, match="width = nan must be a finite number"):
        smoothing("lucy", np.nan, 2)
    with pytest.raises(InputError, match="dimension = 1 must be 2 or 3"):
        smoothing("lucy", 1.0, 1)
    with pytest.raises(InputError, match="'heaviside' has no gradient"):
        gradient_weights([[0.0, 0]], [[0.0, 0]], smoothing("heaviside", 1.0, 2))
