"""Fields in closed form on hand-made samples: elastic strain and moduli, couples and curvature, directions, ratios."""

import numpy as np
import pytest
from clusters import make

from anisogran import average
from anisogran.averaging import KNOWN
from anisogran.averaging.densities import OF_POINTS, SUMS
from anisogran.averaging.fields import DERIVED, extensive_needs
from anisogran.glossary import GLOSSARY
from anisogran.snapshot import Snapshot

EXACT = {"rtol": 0, "atol": 1e-12}


def lattice(side, overlap, stiffness, axes=((1.0, 0.0), (0.0, 1.0)), friction=0.0):
    """A periodic square lattice of discs of radius 1 that overlap by `overlap` (x, y) along the axes, with linear springs."""
    count = side * side
    spacing = 2.0 - np.asarray(overlap)
    i, j = np.divmod(np.arange(count), side)
    position = np.stack([i * spacing[0], j * spacing[1]], axis=1) + 0.3
    right, up = ((i + 1) % side) * side + j, i * side + (j + 1) % side
    pairs = np.concatenate([np.stack([np.arange(count), right], 1), np.stack([np.arange(count), up], 1)])
    normal = np.concatenate([np.tile([1.0, 0.0], (count, 1)), np.tile([0.0, 1.0], (count, 1))])
    depth = np.repeat(overlap, count)
    point = position[pairs[:, 0]] + normal * (1 - 0.5 * depth)[:, None]
    force = -stiffness * depth[:, None] * normal + friction * normal[:, ::-1]
    return Snapshot(
        position, np.ones(count), np.ones(count), np.zeros((count, 2)), np.zeros(count), pairs, force, point, depth, cell=side * spacing
    )


def test_elastic_strain_of_a_lattice():
    """Delta = delta n and l = (1 - delta/2) n along both axes: the best fit is delta/l; the fabric takes l = a n and gives delta l/a^2."""
    overlap = np.array([0.02, 0.05])
    data = average(
        lattice(4, overlap, 1e3), fields=["elastic_strain", "elastic_strain_raw", "stress_static", "bulk_modulus", "shear_modulus"]
    )
    arm = 1 - 0.5 * overlap
    np.testing.assert_allclose(data.elastic_strain_raw, np.diag(overlap / arm), **EXACT)
    np.testing.assert_allclose(data.elastic_strain, np.diag(overlap * arm), **EXACT)
    sigma = 1e3 * overlap / (2.0 - overlap)[::-1]
    np.testing.assert_allclose(data.stress_static, np.diag(sigma), rtol=1e-13, atol=1e-12)
    assert float(data.bulk_modulus) == pytest.approx(sigma.sum() / (overlap * arm).sum(), rel=1e-12)
    assert float(data.shear_modulus) == pytest.approx((sigma[1] - sigma[0]) / np.diff(overlap * arm)[0], rel=1e-12)


def test_bulk_modulus_is_stiffness_times_fabric():
    """For normal springs and an isotropic fabric tr sigma/tr eps = k tr F/(2 pi), exactly, whatever the (small or large) overlap."""
    data = average(lattice(4, (0.03, 0.03), 1e3), fields=["bulk_modulus", "fabric_trace"])
    assert float(data.bulk_modulus) == pytest.approx(1e3 * float(data.fabric_trace) / (2 * np.pi), rel=1e-12)


def test_elastic_strain_is_the_least_squares_fit(rng):
    """The raw variant minimises S = sum (Delta - eps . l)^2: its gradient vanishes there, for any contacts at all."""
    position = rng.uniform(0, 5, (12, 2))
    pairs = np.stack([np.arange(11), np.arange(1, 12)], axis=1)
    point = position[:-1] + rng.normal(size=(11, 2))
    snapshot = Snapshot(
        position,
        rng.uniform(0.5, 1, 12),
        np.ones(12),
        np.zeros((12, 2)),
        np.zeros(12),
        pairs,
        np.zeros((11, 2)),
        point,
        rng.uniform(0.1, 0.2, 11),
    )
    strain = average(snapshot, fields=["elastic_strain_raw"]).elastic_strain_raw.values
    arms = np.concatenate([point - position[:-1], point - position[1:]])
    delta = np.tile(snapshot.overlap, 2)[:, None] * arms / np.hypot(*arms.T)[:, None]
    best = np.linalg.lstsq(arms, delta, rcond=None)[0].T
    np.testing.assert_allclose(strain, 0.5 * (best + best.T), **EXACT)


def test_contacts_along_one_line_tell_no_strain():
    chain = make([[0, 0], [1, 0], [2, 0]], [0.5] * 3, [(0, 1), (1, 2)], [(-1, 0), (-1, 0)])
    data = average(chain, fields=["elastic_strain", "elastic_strain_raw", "bulk_modulus"])
    for name in data.data_vars:
        assert np.isnan(data[name]).all()
        assert data[name].attrs["reason"] == "no contacts"


def test_couple_stress_of_one_contact():
    """M_j = (l x f) l_j/V from both ends; a tangential force t at the arm a turns both grains the same way, so the two ends cancel."""
    tangential = make([[0, 0], [2, 0]], [1.0, 1.0], [(0, 1)], [(0.0, 3.0)], volume=10.0)
    np.testing.assert_allclose(average(tangential, fields="couple_stress").couple_stress, [0.0, 0.0], **EXACT)
    wall = make([[0, 0]], [1.0], [(0, -1)], [(-1.0, 3.0)], point=[[2.0, 0.0]], volume=10.0)
    np.testing.assert_allclose(average(wall, fields="couple_stress").couple_stress, [2.0 * 3.0 * 2.0 / 10, 0.0], **EXACT)


def test_torque_stiffness_is_couple_over_curvature():
    """Spin 0.5 x, and one wall contact with the couple of the test before: M_x/kappa_x = 1.2/0.5."""
    position = [[0, 0], [3, 0], [0, 3]]
    snapshot = make(position, [1.0] * 3, [(0, -1)], [(-1.0, 3.0)], point=[[2.0, 0.0]], volume=10.0, spin=[0.0, 1.5, 0.0])
    data = average(snapshot, fields=["torque_stiffness", "curvature"])
    np.testing.assert_allclose(data.curvature, [0.5, 0.0], **EXACT)
    assert float(data.torque_stiffness) == pytest.approx(1.2 / 0.5, rel=1e-12)


@pytest.mark.parametrize("angle", [-1.2, 0.0, 0.3, np.pi / 2])
def test_axes_of_a_turned_lattice(angle):
    """Stress, fabric and elastic strain of a lattice squeezed along x point there; turned, they follow; simple shear compresses at 135."""
    still = lattice(3, (0.05, 0.02), 1e3)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    inner = np.linalg.norm(still.point - still.position[still.pairs[:, 0]], axis=1) < 1.0
    assert inner.all()
    # an open sample, since a turned cell is no cell: the contacts across the border go
    kept = np.linalg.norm(still.position[still.pairs[:, 1]] - still.position[still.pairs[:, 0]], axis=1) < 2.1
    position = still.position @ turn.T
    snapshot = Snapshot(
        position, still.radius, still.mass, np.stack([0.5 * position[:, 1], 0 * position[:, 1]], 1), still.spin, still.pairs[kept],
        (still.force @ turn.T)[kept], (still.point @ turn.T)[kept], still.overlap[kept],
    )  # fmt: skip
    names = ["stress_angle", "elastic_strain_angle", "strain_to_stress_angle", "strain_rate_angle", "rate_to_stress_angle", "fabric_angle"]
    data = average(snapshot, fields=["stress_static", *names])
    for name in ("stress_angle", "elastic_strain_angle"):
        assert np.cos(2 * (float(data[name]) - angle)) == pytest.approx(1.0, abs=1e-12)
    assert float(data.strain_to_stress_angle) == pytest.approx(0.0, abs=1e-7)  # an angle is known to the root of rounding
    assert float(data.strain_rate_angle) == pytest.approx(-np.pi / 4, abs=1e-12)
    difference = float(data.rate_to_stress_angle)
    assert -np.pi / 2 < difference <= np.pi / 2
    assert np.cos(2 * (difference - angle - np.pi / 4)) == pytest.approx(1.0, abs=1e-12)
    assert data.stress_angle.attrs["units"] == "rad"
    assert np.isnan(data.fabric_angle)  # as many contacts one way as the other: isotropic, no axis


def test_inertial_number_in_plane_and_in_space(rng):
    """I = rate sqrt(m/p) in the plane and rate d sqrt(rho/p) in space, for simple shear with the engineering rate."""
    for d, units in ((2, "N/m"), (3, "N/m2")):
        position = rng.uniform(0, 4, (50, d))
        velocity = np.zeros((50, d))
        velocity[:, 0] = 0.7 * position[:, 1]
        spin = np.zeros(50) if d == 2 else np.zeros((50, 3))
        force, point = np.eye(d)[:1] * 5.0, position[:1] - np.eye(d)[:1] * 0.3
        snapshot = Snapshot(position, np.full(50, 0.3), np.full(50, 2.0), velocity, spin, [[0, -1]], force, point, [0.01], volume=30.0)
        data = average(snapshot, fields=["inertial_number", "shear_rate", "pressure", "s_D"])
        pressure = 5.0 * 0.3 / 30.0 / d
        assert float(data.shear_rate) == pytest.approx(0.7, rel=1e-12)
        assert float(data.pressure) == pytest.approx(pressure, rel=1e-10)
        assert data.pressure.attrs["units"] == units
        inertia = 2.0 if d == 2 else 0.6**2 * 2.0 / (4 / 3 * np.pi * 0.3**3)
        assert float(data.inertial_number) == pytest.approx(0.7 * np.sqrt(inertia / pressure), rel=1e-10)
        # one eigenvalue: |dev| = p d sqrt((d - 1)/(2 d)), the same as half the difference in the plane
        assert float(data.s_D) == pytest.approx(d * np.sqrt((d - 1) / (2 * d)), rel=1e-10)


def test_agitation_is_the_spread_about_the_linear_field(rng):
    """Random velocities on top of a shear: stress_dynamic = sum m v'v'/V with v' the residuals of a weighted least-squares fit."""
    n = 80
    position, mass = rng.uniform(0, 5, (n, 2)), rng.uniform(1, 2, n)
    velocity = rng.normal(size=(n, 2)) + position @ np.array([[0.3, 2.0], [-1.0, 0.1]])
    snapshot = make(position, np.full(n, 0.1), [], [], mass=mass, velocity=velocity, volume=25.0)
    root = np.sqrt(mass)[:, None]
    design = np.column_stack([np.ones(n), position])
    residual = velocity - design @ np.linalg.lstsq(root * design, root * velocity, rcond=None)[0]
    expected = np.einsum("p,pi,pj->ij", mass, residual, residual) / 25.0
    data = average(snapshot, fields=["stress_dynamic", "stress", "stress_static", "velocity"])
    np.testing.assert_allclose(data.stress_dynamic, expected, rtol=1e-11)
    np.testing.assert_allclose(data.stress, expected, rtol=1e-11)
    np.testing.assert_allclose(data.velocity, mass @ velocity / mass.sum(), rtol=1e-12)  # of the box: the plain mean


def test_gaussian_slope_is_the_kernels_own_gradient(rng):
    """grad(rho v)/rho - v grad(rho)/rho over the same for the positions: for the Gaussian it is the velocity gradient."""
    n = 400
    position, mass = rng.uniform(0, 10, (n, 2)), rng.uniform(1, 2, n)
    velocity = rng.normal(size=(n, 2))
    points = np.array([[5.0, 5.0], [4.1, 6.3]])

    def kernel_slope(values):
        snapshot = make(position, np.full(n, 0.1), [], [], mass=mass, velocity=values)
        data = average(
            snapshot, on="points", points=points, width=1.0, fields=["density", "density_gradient", "momentum_density", "momentum_gradient"]
        )
        rho, mean = data.density.values, data.momentum_density.values / data.density.values
        return data.momentum_gradient.values / rho - mean[:, None] * data.density_gradient.values[None] / rho

    snapshot = make(position, np.full(n, 0.1), [], [], mass=mass, velocity=velocity)
    gradient = average(snapshot, on="points", points=points, width=1.0, fields="velocity_gradient").velocity_gradient.values
    chain = np.einsum("ikp,kjp->ijp", gradient, kernel_slope(position))
    np.testing.assert_allclose(kernel_slope(velocity), chain, rtol=1e-9)


def test_only_what_is_asked_for_is_summed(monkeypatch):
    """The velocity needs no contact, the fabric no velocity: nothing else is touched."""
    snapshot = make([[0, 0], [1, 0], [0, 1]], [0.5] * 3, [(0, 1)], [(-1, 0)])
    assert not {"stress_static", "fabric"} & set(extensive_needs(["velocity", "density"]))
    summed = []
    for name, function in SUMS.items():
        monkeypatch.setitem(SUMS, name, lambda sample, name=name, function=function: summed.append(name) or function(sample))
    average(snapshot, fields=["fabric_trace"])
    assert summed == ["fabric"]


def test_every_field_is_known_to_the_glossary_and_can_be_asked_for(rng):
    """Fields and ingredients are told apart by the glossary; each field gives its own units on every place it is known on."""
    assert set(OF_POINTS) <= set(KNOWN) <= set(GLOSSARY)
    ingredients = (set(SUMS) | set(DERIVED)) - set(KNOWN)
    assert ingredients == {
        "solid_fraction", "diameter_density", "momentum_offset", "momentum_flux", "mass_offset", "mass_spread", "mass_spin",
        "mass_spin_offset", "overlap_moment", "branch_moment", "carrying_grains", "carrying_contacts", "spread", "linear_velocity",
        "linear_spin",
    }  # fmt: skip
    for name in DERIVED:
        assert set(DERIVED[name].needs) <= {"place", *SUMS, *DERIVED}


def test_angles_between_axes_have_their_sign():
    """Two contacts a and b of a grain: the fabric leans to the middle, the stress to the stronger one, the strain to the deeper one."""
    a, b = np.deg2rad([10.0, 50.0])
    normal = np.array([[np.cos(a), np.sin(a)], [np.cos(b), np.sin(b)]])
    one = Snapshot(
        [[0, 0], [8.0, 0], [0, 8.0]], [1.0] * 3, [1.0] * 3, [[0, 0], [-0.8, 0], [0, 0]], [0.0] * 3, [(0, -1), (0, -2)],
        -np.array([[1.0], [3.0]]) * normal, normal, [0.01, 0.05],
    )  # fmt: skip
    data = average(one, fields=[name for name in DERIVED if name.endswith("_angle")] + ["elastic_strain"])
    stress = 0.5 * np.arctan2(np.sin(2 * a) + 3 * np.sin(2 * b), np.cos(2 * a) + 3 * np.cos(2 * b))
    assert float(data.stress_angle) == pytest.approx(stress)
    assert float(data.fabric_angle) == pytest.approx(0.5 * (a + b))
    assert float(data.fabric_to_stress_angle) == pytest.approx(stress - 0.5 * (a + b))
    assert float(data.strain_rate_angle) == pytest.approx(0.0, abs=1e-12)  # compression along x
    assert float(data.rate_to_stress_angle) == pytest.approx(stress)
    assert float(data.rate_to_fabric_angle) == pytest.approx(0.5 * (a + b))
    # both strains are the best fit of the overlaps, and this one is not symmetric before it is made so
    moment = 0.01 * np.outer(normal[0], normal[0]) + 0.05 * np.outer(normal[1], normal[1])
    fit = moment @ np.linalg.inv(normal.T @ normal)
    assert abs(fit[0, 1] - fit[1, 0]) > 0.01
    np.testing.assert_allclose(data.elastic_strain, 0.5 * (fit + fit.T), **EXACT)
    strain = 0.5 * np.arctan2(fit[0, 1] + fit[1, 0], fit[0, 0] - fit[1, 1])
    assert float(data.strain_to_stress_angle) == pytest.approx(stress - strain)


def test_compression_along_y_has_the_angle_90_degrees():
    """Not -90: the angle of an axis is above -pi/2."""
    position = np.array([[0, 0], [1.0, 0], [0, 1.0], [1.0, 1.0]])
    snapshot = make(position, [0.5] * 4, [], [], velocity=position * [0.3, -0.7])
    assert float(average(snapshot, fields="strain_rate_angle").strain_rate_angle) == pytest.approx(np.pi / 2)


def test_grains_on_a_line_tell_no_gradient_and_tension_no_inertial_number():
    line = make([[0, 0], [1.0, 0], [2.0, 0]], [0.5] * 3, [(0, 1)], [(1.0, 0)], velocity=[[0, 0], [0, 1.0], [0, 2.0]])
    data = average(line, fields=["velocity_gradient", "stress_dynamic"])
    assert np.isnan(data.velocity_gradient).all()
    np.testing.assert_array_equal(data.stress_dynamic, 0.0)  # along the line the motion is linear
    position = [[0, 0], [1.0, 0], [0, 1.0]]
    pulled = make(position, [0.5] * 3, [(0, 1)], [(1.0, 0)], velocity=[[0, 0], [0, 1.0], [0, 0]])
    data = average(pulled, fields=["inertial_number", "pressure", "shear_rate"])
    assert float(data.pressure) < 0
    assert float(data.shear_rate) == pytest.approx(1.0)
    assert np.isnan(data.inertial_number)
