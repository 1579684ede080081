"""Directions of contacts: exact cases on lattices, known distributions, and what a sheared packing must obey."""

import numpy as np
import pytest
from clusters import make

from anisogran import SimpleShear, average, tensors
from anisogran.averaging import contact_directions, fourier_coefficients
from anisogran.outcome import InputError
from anisogran.snapshot import Snapshot

EXACT = {"rtol": 0, "atol": 1e-12}
ANISOTROPIES = (("a2", "axis"), ("a_n", "normal_axis"), ("a_t", "tangential_axis"))


def star(theta, force=None, **more):
    """One disc for each direction, apart from each other, each with one contact with a wall; `force` (n, 2) on the discs."""
    normal = np.stack([np.cos(theta), np.sin(theta)], axis=1)
    position = np.stack([3.0 * np.arange(len(theta)), np.zeros(len(theta))], axis=1)
    pairs = np.stack([np.arange(len(theta)), np.full(len(theta), -1)], axis=1)
    return make(position, [0.5] * len(theta), pairs, -normal if force is None else force, point=position + 0.5 * normal, **more)


def lattice(angles, turn=0.0):
    """A disc and the neighbours on one side of it, in the directions `angles`: each contact has two ends, as in the whole lattice."""
    angles = np.asarray(angles) + turn
    around = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    pairs = [(0, k + 1) for k in range(len(angles))]
    return make(np.concatenate([[[0, 0]], around]), [0.5] * (1 + len(angles)), pairs, -around)


def test_fourier_coefficients_of_a_known_distribution(rng):
    """Drawn from f by rejection; the standard error of 2 <cos> is at most 2/sqrt(n)."""
    a2, a4, axis = 0.6, -0.25, 0.4
    theta = rng.uniform(-np.pi, np.pi, 400_000)
    f = 1 + a2 * np.cos(2 * (theta - axis)) + a4 * np.cos(4 * (theta - axis))
    theta = theta[rng.uniform(0, 2, len(theta)) < f]
    tolerance = 4 * 2 / np.sqrt(len(theta))
    assert fourier_coefficients(theta)[:2] == (pytest.approx(a2, abs=tolerance), pytest.approx(a4, abs=tolerance))
    assert fourier_coefficients(theta)[2] == pytest.approx(axis, abs=tolerance / a2)
    dataset = contact_directions(star(theta[:100_000]), bins=24)
    centre = dataset.angle.values
    half = np.pi / 24  # mean over a bin: each harmonic is damped by sin(n half)/(n half)
    damped = [np.sin(n * half) / (n * half) * a * np.cos(n * (centre - axis)) for n, a in ((2, a2), (4, a4))]
    deviation = (dataset.contact_density - (1 + sum(damped)) / (2 * np.pi)) / dataset.contact_density_error
    assert float((deviation**2).mean()) == pytest.approx(1.0, abs=1.2)  # chi^2 of 24 bins: 4 standard deviations of sqrt(2/24)
    assert dataset.contacts == 100_000


def test_fourier_coefficients_of_few_directions():
    assert fourier_coefficients([0.3, 0.3 - np.pi]) == pytest.approx((2.0, 2.0, 0.3))
    assert fourier_coefficients([0.0, 0.5 * np.pi], weight=[3.0, 1.0]) == pytest.approx((1.0, 2.0, 0.0))
    assert fourier_coefficients([0.5 * np.pi], angle=0.0) == pytest.approx((-2.0, 2.0, 0.0))
    assert fourier_coefficients([0.0, 0.5 * np.pi]) == pytest.approx((0.0, 2.0, 0.0))  # no axis: 0
    assert np.isnan(fourier_coefficients([])).all()
    assert np.isnan(fourier_coefficients([0.1], weight=[0.0])).all()
    assert fourier_coefficients([], angle=0.2)[2] == 0.2
    for theta, weight in (([0.0, np.nan], None), ([0.0], [-1.0]), ([0.0], [np.inf])):
        with pytest.raises(InputError, match="theta must be finite, and weight finite and at least 0"):
            fourier_coefficients(theta, weight)
    with pytest.raises(InputError, match=r"have the shapes \(1,\), \(2,\)"):
        fourier_coefficients([0.0], [1.0, 2.0])


@pytest.mark.parametrize("turn", [0.0, 0.2])
def test_lattices_have_no_second_harmonic(turn):
    square = contact_directions(lattice([0, np.pi / 2], turn), bins=36)
    assert square.a2 == pytest.approx(0, abs=1e-12)
    assert square.a4 == pytest.approx(2 * np.cos(4 * turn))  # without an axis of the second harmonic, from the first axis
    hexagonal = contact_directions(lattice([0, np.pi / 3, 2 * np.pi / 3], turn))
    assert (hexagonal.a2, hexagonal.a4) == (pytest.approx(0, abs=1e-12), pytest.approx(0, abs=1e-12))
    assert hexagonal.contacts == 3
    assert hexagonal.contact_ends == 6
    if turn:  # away from the edges of the bins
        np.testing.assert_allclose(hexagonal.contact_density[[1, 7, 13, 19, 25, 31]], 36 / (6 * 2 * np.pi), **EXACT)
    assert float(hexagonal.contact_density.sum()) * 2 * np.pi / 36 == pytest.approx(1.0)


def test_aligned_contacts_have_the_largest_coefficients():
    chain = contact_directions(lattice([0.7, 0.7 + np.pi]))
    assert (chain.a2, chain.a4, chain.axis) == (pytest.approx(2.0), pytest.approx(2.0), pytest.approx(0.7))
    assert chain.a2_error == 0.0
    assert np.isnan(chain.a_n)  # one direction tells no harmonic of the forces
    assert chain.contact_density[4] == pytest.approx(0.5 * 36 / (2 * np.pi))
    assert chain.contact_density_error[4] == pytest.approx(0.5 * 36 / (2 * np.pi) / np.sqrt(2))
    assert np.isnan(chain.contact_density_error[5])
    assert np.isnan(chain.normal_force[5])


def test_rotation_shifts_the_distribution(rng):
    theta = rng.uniform(0, 2 * np.pi, 200)
    size = rng.uniform(1, 2, (200, 1))
    plain, turned = (
        contact_directions(star(angle, -size * np.stack([np.cos(angle + 0.2), np.sin(angle + 0.2)], axis=1)))
        for angle in (theta, theta + 3 * 2 * np.pi / 36)
    )
    for name in ("contact_density", "contact_density_error", "normal_force", "tangential_force"):
        np.testing.assert_allclose(turned[name], np.roll(plain[name], 3), rtol=1e-10)
    for name, axis in ANISOTROPIES:
        assert turned[name] == pytest.approx(float(plain[name]))
        assert np.tan(turned[axis] - plain[axis]) == pytest.approx(np.tan(np.pi / 6))


def test_forces_of_a_known_law_are_recovered(rng):
    """f_n = f0 (1 + a_n cos 2(theta - p)), f_t = -f0 a_t sin 2(theta - q): exactly, wherever the contacts are, and the axes compress."""
    theta = np.concatenate([rng.uniform(0, 2 * np.pi, 300), rng.uniform(0, 1.0, 300)])
    f0, a_n, p, a_t, q = 3.0, 0.5, 0.9, 0.2, -0.3
    normal, tangential = f0 * (1 + a_n * np.cos(2 * (theta - p))), -f0 * a_t * np.sin(2 * (theta - q))
    along, across = np.stack([np.cos(theta), np.sin(theta)], axis=1), np.stack([-np.sin(theta), np.cos(theta)], axis=1)
    exerted = normal[:, None] * along + tangential[:, None] * across
    dataset = contact_directions(star(theta, -exerted), bins=4)
    for name, value in (("a_n", a_n), ("normal_axis", p), ("a_t", a_t), ("tangential_axis", q), ("mean_normal_force", normal.mean())):
        assert dataset[name] == pytest.approx(value, abs=1e-12)
    first = theta < np.pi / 2
    assert dataset.normal_force[0] == pytest.approx(normal[first].mean() / normal.mean())
    assert dataset.tangential_force[0] == pytest.approx(tangential[first].mean() / normal.mean())
    # contacts all around with tangential forces alone beside an even pressure: compression along q
    even = np.arange(100) * np.pi / 50
    force = star(even).force + 0.1 * np.sin(2 * (even - q))[:, None] * np.stack([-np.sin(even), np.cos(even)], axis=1)
    assert tensors.principal_angle(average(star(even, force)).stress_static.values) == pytest.approx(q)
    assert contact_directions(star(even, force)).tangential_axis == pytest.approx(q)


def test_both_ends_of_a_contact_count_and_a_wall_once():
    """Three contacts of disc 0: with disc 1 (to the right), with the wall grain 2 (above) and with a wall (below)."""
    snapshot = make(
        [[0, 0], [1, 0], [0, 1]], [0.5] * 3, [(0, 1), (0, 2), (0, -2)], [(-1.0, 0), (0, -4.0), (0, 4.0)],
        point=[[0.5, 0], [0, 0.5], [0, -0.5]], fixed=[0, 0, 1],
    )  # fmt: skip

    def counted(turn=0.5, **options):  # turned into the middle of the bins
        turning = tensors.rotation(turn)
        turned = {name: getattr(snapshot, name) @ turning.T for name in ("position", "force", "point")}
        return contact_directions(make(**turned, radius=[0.5] * 3, pairs=snapshot.pairs, fixed=[0, 0, 1]), bins=4, **options)

    everything = counted()
    np.testing.assert_allclose(everything.contact_density * 2 * np.pi / 4, 0.25, **EXACT)
    assert (everything.contacts, everything.contact_ends) == (3, 4)
    assert everything.mean_normal_force == pytest.approx((1 + 1 + 4 + 4) / 4)
    inner = counted(walls=False)
    np.testing.assert_allclose(inner.contact_density * 2 * np.pi / 4, [0.5, 0, 0.5, 0], **EXACT)
    assert (inner.contacts, inner.contact_ends) == (1, 2)
    right = counted(where=np.array([False, True, False]))
    np.testing.assert_allclose(right.contact_density * 2 * np.pi / 4, [0, 0, 1, 0], **EXACT)
    assert (right.contacts, right.contact_ends) == (1, 1)
    left = counted(where=lambda snapshot: snapshot.position[:, 0] < 0.5)
    np.testing.assert_allclose(left.contact_density * 2 * np.pi / 4, [1 / 3, 1 / 3, 0, 1 / 3], **EXACT)
    assert (left.contacts, left.contact_ends) == (3, 3)


def test_error_of_the_second_coefficient_is_that_of_independent_contacts():
    """2 cos 2(theta - axis) is 2 thrice and -2 once: mean 1, variance 3, for a mean of four."""
    dataset = contact_directions(star(np.array([0.1, 0.1, 0.1, 0.1 + np.pi / 2])))
    assert dataset.a2 == pytest.approx(1.0)
    assert dataset.a2_error == pytest.approx(np.sqrt(3 / 4))


def test_bins_cover_the_circle_from_zero():
    dataset = contact_directions(star(np.array([1e-9, np.pi / 2 + 1e-9, -1e-9])), bins=8)
    np.testing.assert_allclose(dataset.angle, (np.arange(8) + 0.5) * np.pi / 4, **EXACT)
    np.testing.assert_allclose(dataset.contact_density * np.pi / 4, np.array([1, 0, 1, 0, 0, 0, 0, 1]) / 3, **EXACT)
    below = make([[0, 0]], [0.5], [(0, -1)], [(-1, 0)], point=[[0.5, -1e-18]])  # its angle modulo 2 pi is rounded to 2 pi
    assert contact_directions(below, bins=8).contact_density[0] > 0


def test_polar_frame_of_radial_contacts():
    """Pairs of discs that touch along e_r, all around, seen from e_r: all normals at 0 and pi, in the laboratory everywhere."""
    azimuth = np.arange(12) * np.pi / 6 + 0.1
    out = np.stack([np.cos(azimuth), np.sin(azimuth)], axis=1)
    ring = make(np.concatenate([5 * out, 6 * out]), [0.5] * 24, [(k, 12 + k) for k in range(12)], -out)
    polar = contact_directions(ring, frame="polar")
    assert (polar.a2, polar.a4, polar.axis) == (pytest.approx(2.0), pytest.approx(2.0), pytest.approx(0, abs=1e-12))
    assert contact_directions(ring).a2 == pytest.approx(0, abs=1e-12)
    outer = contact_directions(ring, frame="polar", where=np.arange(24) >= 12)  # they touch inwards, with a normal of -e_r
    assert float(outer.contact_density[17:19].sum()) * 2 * np.pi / 36 == pytest.approx(1.0)
    with pytest.raises(InputError, match="grain 0 lies in the origin"):
        contact_directions(lattice([0.0]), frame="polar")


def test_several_snapshots_add_up():
    """One with 1 contact and one with 2: the density is that of the 3 together."""
    one, two = lattice([0.3]), lattice([0.3, 2.0])
    both = contact_directions(snapshot for snapshot in (one, two))
    assert both.contacts == 3
    assert both.contact_density[1] == pytest.approx(2 / 6 * 36 / (2 * np.pi))
    with pytest.raises(InputError, match="there is no snapshot"):
        contact_directions([])


def test_no_contacts_are_no_directions():
    empty = contact_directions(make([[0, 0], [3, 0]], [0.5] * 2, [], []))
    assert empty.contacts == 0
    assert empty.contact_ends == 0
    for name in set(empty.data_vars) - {"contacts", "contact_ends"}:
        assert np.isnan(empty[name]).all(), name
    walls = make([[0, 0], [1, 0]], [0.5] * 2, [(0, 1)], [(-1, 0)], fixed=[1, 1])
    assert contact_directions(walls).contacts == 0
    pulled = contact_directions(make([[0, 0], [1, 0]], [0.5] * 2, [(0, 1)], [(1, 0)]))  # tension only
    assert pulled.mean_normal_force == -1.0
    assert np.isnan(pulled.normal_force).all()
    three = lattice([0.1, 1.0, 2.0])
    assert contact_directions(three).a_n == pytest.approx(0, abs=1e-12)
    assert np.isnan(contact_directions(make(three.position, three.radius, three.pairs, -three.force)).a_n)


def test_bad_options_are_refused():
    snapshot = lattice([0.0])
    for bins in (3, 10.0, True, "many"):
        with pytest.raises(InputError, match="must be a whole number, at least 4"):
            contact_directions(snapshot, bins=bins)
    with pytest.raises(InputError, match="frame = 'ring' must be 'lab' or 'polar'"):
        contact_directions(snapshot, frame="ring")
    for where in ([True], [0, 1]):
        with pytest.raises(InputError, match=r"it must be \(2,\) of bool"):
            contact_directions(snapshot, where=where)
    sphere = Snapshot([[0, 0, 0]], [1.0], [1.0], [[0, 0, 0]], [[0, 0, 0]], [], [], [], [])
    with pytest.raises(InputError, match="three-dimensional"):
        contact_directions(sphere)


def test_stress_of_a_sheared_packing_follows_from_its_anisotropies():
    """s_D = |a2 + a_n + a_t|/(2 + a2 a_n), each at twice the angle of its axis, if forces do not depend on the branch length."""
    end = SimpleShear(n=150, strain=0.6, discard=0.1, inertial_number=0.05).run().snapshots["end"]
    stress = average(end).stress_static.values
    dataset = contact_directions(end)
    vectors = {name: float(dataset[name]) * np.exp(2j * float(dataset[axis])) for name, axis in ANISOTROPIES}
    product = (vectors["a2"] * np.conj(vectors["a_n"])).real
    expected = sum(vectors.values()) / (2 + product)
    measured = tensors.deviator_size(stress) / tensors.mean(stress) * np.exp(2j * tensors.principal_angle(stress))
    # larger discs bear larger forces, which the relation leaves out: 1 to 11 % over eight seeds, 1 % for this one
    assert abs(expected - measured) < 0.05 * abs(measured)
    # the short form drops the product, a2 a_n/2, and takes the axes as one: 6 to 17 % over eight seeds, 7 % for this one
    assert 0.5 * sum(abs(vector) for vector in vectors.values()) == pytest.approx(abs(measured), rel=0.12)
