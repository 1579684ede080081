"""Rings: exact weights first, then fields that are known in closed form."""

import numpy as np
import pytest
import xarray as xr
from clusters import make

from anisogran import average
from anisogran.averaging import Rings, chance_drift, drift, field_values, mean_and_error
from anisogran.averaging.densities import densities
from anisogran.averaging.overlap_areas import disc_in_circle, ring_shares
from anisogran.snapshot import Snapshot

area_inside_circle = np.vectorize(disc_in_circle)

EDGES = np.arange(5.0, 13.0)


def test_lens_in_closed_form():
    # two unit circles, centres 1 apart: 2 pi/3 - sqrt(3)/2
    assert area_inside_circle(1.0, 1.0, 1.0) == pytest.approx(2 * np.pi / 3 - np.sqrt(3) / 2, abs=1e-14)
    assert area_inside_circle(5.0, 1.0, 4.0) == 0.0  # touches from outside
    assert area_inside_circle(3.0, 1.0, 4.0) == pytest.approx(np.pi)  # touches from inside
    assert area_inside_circle(0.0, 2.0, 0.5) == pytest.approx(np.pi * 0.25)  # the circle lies in the disc
    assert area_inside_circle(1.0, 1.0, 0.0) == 0.0


def test_area_against_counting(rng):
    """A disc cut by a circle, against a fine grid of points."""
    grid = (np.arange(1500) + 0.5) / 1500 * 2 - 1
    x, y = np.meshgrid(grid, grid)
    disc = x**2 + y**2 < 1
    for distance, circle in [(3.0, 3.4), (0.7, 1.2), (1.1, 0.4), (0.2, 1.1)]:
        counted = np.mean(disc & ((x + distance) ** 2 + y**2 < circle**2)) * 4
        assert area_inside_circle(distance, 1.0, circle) == pytest.approx(counted, abs=3e-4)  # points on the rim


def test_shares_of_a_disc_add_up_to_one(rng):
    position = rng.uniform(-20, 20, (300, 2))
    radius = rng.uniform(0.01, 3.0, 300)
    indptr, _, shares = ring_shares(position, radius, np.ones(300, bool), np.linspace(0, 40, 50), None)
    np.testing.assert_allclose(np.add.reduceat(shares, indptr[:-1]), 1.0, atol=1e-12)
    assert shares.min() > -1e-12


def test_tangency_leaves_no_rounding(rng):
    """One rounding before the touch from outside or from inside: no area, or all of it, and no root of a negative number."""
    disc, circle = rng.uniform(0.1, 1.0, 500), rng.uniform(1.5, 9.0, 500)
    outside, inside = np.nextafter(disc + circle, 0), np.nextafter(circle - disc, 9)
    # a chord at the distance eps from the rim cuts off eps^(3/2) r^2
    np.testing.assert_allclose(area_inside_circle(outside, disc, circle), 0.0, atol=1e-14)
    np.testing.assert_allclose(area_inside_circle(inside, disc, circle) / (np.pi * disc**2), 1.0, rtol=1e-12)
    np.testing.assert_allclose(area_inside_circle(np.nextafter(circle - disc, 9), circle, disc) / (np.pi * disc**2), 1.0, rtol=1e-12)


def ring_sums(snapshot, edges, *names):
    """Sums over each ring (density times its area) of extensive quantities."""
    place = Rings(np.asarray(edges, float), np.empty(0))
    values = densities(snapshot, place, names)
    return [values[name] * values["volume"] for name in names]


def crowd(rng, count=4000):
    """Many discs at random in the annulus, overlapping or not: only for averages that do not ask for contacts."""
    r = np.sqrt(rng.uniform(3.0**2, 15.0**2, count))
    phi = rng.uniform(-np.pi, np.pi, count)
    position = np.stack([r * np.cos(phi), r * np.sin(phi)], axis=1)
    return position


def test_rigid_rotation(rng):
    """v = Omega x r: v_phi proportional to r, no shear, and spin equal to the continuum's."""
    position = crowd(rng)
    omega = 0.3
    velocity = omega * np.stack([-position[:, 1], position[:, 0]], axis=1)
    snapshot = make(position, np.full(4000, 0.2), [], [], velocity=velocity, spin=np.full(4000, omega))
    profile = average(snapshot, on="rings", edges=EDGES)
    # the profile is linear in r, so its local linear fit is exact
    np.testing.assert_allclose(profile.v_phi, omega * profile.r, rtol=1e-12)
    np.testing.assert_allclose(profile.spin, omega, rtol=1e-12)
    np.testing.assert_allclose(profile.eigen_rotation, 0, atol=1e-13)
    np.testing.assert_allclose(profile.velocity[0], 0, atol=1e-12)
    np.testing.assert_allclose(profile.stress, 0, atol=1e-12)
    np.testing.assert_allclose(profile.shear_rate, 0, atol=1e-13)


def test_motion_that_is_linear_in_the_radius_has_its_gradient_in_polar_components(rng):
    """v_r = a r, v_phi = b r: grad = [[a, -b], [b, a]]; and a spin c r has the curvature (c, 0)."""
    position = crowd(rng)
    r = np.hypot(*position.T)
    velocity = position @ np.array([[0.2, 0.3], [-0.3, 0.2]])
    snapshot = make(position, np.full(4000, 0.2), [], [], velocity=velocity, spin=0.4 * r)
    profile = average(snapshot, on="rings", edges=EDGES, fields=["velocity_gradient", "curvature", "strain_rate", "strain_rate_angle"])
    one = np.ones(len(profile.r))
    np.testing.assert_allclose(profile.velocity_gradient, np.multiply.outer([[0.2, -0.3], [0.3, 0.2]], one), atol=1e-12)
    np.testing.assert_allclose(profile.curvature, np.multiply.outer([0.4, 0.0], one), atol=1e-12)
    np.testing.assert_allclose(profile.strain_rate, np.multiply.outer([[-0.2, 0.0], [0.0, -0.2]], one), atol=1e-12)  # compression positive


def test_cylindrical_components_in_space(rng):
    """Velocity and spin linear in r and z: v_r, v_phi, v_z = A (r, z), with gradients along (r, phi, z) that differ from cell to cell."""
    n = 5000
    position = rng.uniform(-6, 6, (n, 3))
    r, z = np.hypot(position[:, 0], position[:, 1]), position[:, 2]
    out = np.column_stack([position[:, :2] / r[:, None], np.zeros(n)])
    along, up = np.column_stack([-out[:, 1], out[:, 0], np.zeros(n)]), np.array([0.0, 0.0, 1.0])
    A = np.array([[0.2, 0.5], [0.3, -0.4], [0.7, 0.1]])

    def field(a):
        return sum((a[k, 0] * r + a[k, 1] * z)[:, None] * axis for k, axis in enumerate((out, along, up)))

    snapshot = Snapshot(position, np.full(n, 0.2), np.ones(n), field(A), field(2 * A), [], [], [], [])
    data = average(
        snapshot, on="rings", edges=([1.0, 2.0, 4.0], [-3.0, 0.0, 1.0, 3.0]),
        fields=["velocity", "spin", "velocity_gradient", "curvature", "continuum_spin", "stress_dynamic"],
    )  # fmt: skip
    r, z = (part.values for part in xr.broadcast(data.r, data.z))
    v = np.multiply.outer(A[:, 0], r) + np.multiply.outer(A[:, 1], z)
    gradient = np.zeros((3, 3, *r.shape))
    gradient[:, 0], gradient[:, 2] = A[:, 0, None, None], A[:, 1, None, None]
    gradient[0, 1], gradient[1, 1] = -v[1] / r, v[0] / r
    np.testing.assert_allclose(data.velocity, v, atol=1e-12)
    np.testing.assert_allclose(data.spin, 2 * v, atol=1e-12)
    np.testing.assert_allclose(data.velocity_gradient, gradient, atol=1e-12)
    np.testing.assert_allclose(data.curvature, 2 * gradient, atol=1e-12)
    curl = [-gradient[1, 2], gradient[0, 2] - gradient[2, 0], gradient[1, 0] - gradient[0, 1]]  # v_z does not change along phi
    np.testing.assert_allclose(data.continuum_spin, 0.5 * np.array(curl), atol=1e-12)
    np.testing.assert_allclose(data.stress_dynamic, 0, atol=1e-11)
    area = np.pi * np.array([3.0, 12.0])
    np.testing.assert_allclose(data.volume, np.outer(area, [3.0, 1.0, 2.0]), rtol=1e-14)


def test_a_sphere_is_found_in_its_own_ring_and_level():
    sphere = Snapshot([[0.0, 3.0, 0.5]], [0.1], [2.0], [[0.3, 0.0, 0.4]], [[1.0, 0, 0]], [], [], [], [])
    data = average(sphere, on="rings", edges=([0.0, 2.0, 4.0], [-3.0, 0.0, 1.0, 3.0]), fields=["density", "velocity", "spin_density"])
    mass = (data.density * data.volume).values
    np.testing.assert_allclose(mass, [[0, 0, 0], [0, 2.0, 0]], atol=1e-12)
    np.testing.assert_allclose(data.velocity[:, 1, 1], [0.0, -0.3, 0.4], atol=1e-12)
    np.testing.assert_allclose((data.spin_density * data.volume)[:, 1, 1], [0.0, -4 / 3 * np.pi * 0.1**3, 0.0], rtol=1e-9, atol=1e-12)


def test_mass_is_counted_once(rng):
    position = crowd(rng)
    snapshot = make(position, np.full(4000, 0.2), [], [], mass=rng.uniform(1, 2, 4000))
    edges = np.linspace(0.0, 20.0, 41)
    mass, area = ring_sums(snapshot, edges, "density", "solid_fraction")
    assert mass.sum() == pytest.approx(snapshot.mass.sum(), rel=1e-12)
    assert area.sum() == pytest.approx(4000 * np.pi * 0.04, rel=1e-12)


def test_polar_components_of_one_contact():
    """Two discs that touch along the radius at azimuth 90 degrees press radially only; along the circle, in hoop direction only."""
    radial = make([[0, 8.0], [0, 9.0]], [0.5, 0.5], [(0, 1)], [(0, -2.0)])
    total = ring_sums(radial, EDGES, "stress_static")[0].sum(axis=-1)
    np.testing.assert_allclose(total, np.diag([2.0 * 1.0, 0]), atol=1e-12)
    angle = 1.0 / 8.0
    hoop = make([[8.0, 0], [8 * np.cos(angle), 8 * np.sin(angle)]], [0.5, 0.5], [(0, 1)], [(np.sin(angle / 2), -np.cos(angle / 2))])
    total = ring_sums(hoop, EDGES, "stress_static")[0].sum(axis=-1)
    length = 2 * 8 * np.sin(angle / 2)
    # each end sees the contact under half the angle between the grains
    assert total[1, 1] == pytest.approx(length * np.cos(angle / 2) ** 2, rel=1e-12)


def test_agitation_and_fabric_of_grains_on_a_circle():
    """Discs within one ring that move in and out with u: sigma_rr = mass per area times u^2. A wall grain adds nothing."""
    angle = np.arange(12) * np.pi / 6
    out = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    sign = np.where(np.arange(12) % 2 == 0, 1.0, -1.0)
    fixed = np.arange(12) >= 10
    snapshot = make(
        8.5 * out, np.full(12, 0.2), [(0, -1), (1, -1)], np.zeros((2, 2)), point=8.7 * out[:2], mass=np.full(12, 3.0), fixed=fixed,
        velocity=0.4 * sign[:, None] * out,
    )  # fmt: skip
    profile = average(snapshot, on="rings", edges=EDGES, fields=["stress", "fabric"])
    np.testing.assert_allclose((profile.stress * profile.volume).sum("r"), np.diag([10 * 3.0 * 0.4**2, 0]), atol=1e-12)
    np.testing.assert_allclose((profile.fabric * profile.volume).sum("r"), np.diag([2 * np.pi * 0.04, 0]), atol=1e-12)
    mass, grains = ring_sums(snapshot, EDGES, "density", "number_density")
    assert mass.sum() == pytest.approx(30.0)
    assert grains.sum() == pytest.approx(10.0)


def moments_of(profile, edges, **more):
    """Extensive quantities of rings evenly filled with grains of a velocity profile v_phi(r), as a function of radius."""
    width = np.diff(edges)
    r, ones = 0.5 * (edges[1:] + edges[:-1]), np.ones(len(width))
    points, weights = np.polynomial.legendre.leggauss(6)
    x = 0.5 * width * points[:, None]  # offsets of the grains, of mass density 2
    v = profile(r + x)
    mean = 0.5 * weights[:, None]
    nothing = np.zeros(len(r))
    two = {
        "density": 2.0 * ones, "mass_offset": nothing[None], "mass_spread": 2.0 * (mean * x * x).sum(axis=0)[None, None],
        "momentum_density": 2.0 * np.stack([nothing, (mean * v).sum(axis=0)]),
        "momentum_offset": 2.0 * np.stack([nothing, (mean * v * x).sum(axis=0)])[:, None],
        "momentum_flux": 2.0 * np.einsum("i,j,k->ijk", [0, 1], [0, 1], (mean * v * v).sum(axis=0)),
    }  # fmt: skip
    return r, two | more


def test_quotients_of_a_profile():
    """v = b/r with b = 2, spin 0.3, grain mass 4, stress [[3, 0.5], [0.7, 1]]: shear rate 4/r^2, continuum spin 0, pressure 2."""
    edges = np.linspace(5.0, 13.0, 65)
    ones = np.ones(64)
    stress = np.array([[3.0, 0.5], [0.7, 1.0]])[:, :, None] * ones
    spin = {"mass_spin": 0.6 * ones[None], "mass_spin_offset": 0.0 * ones[None, None]}
    r, quantities = moments_of(
        lambda r: 2.0 / r, edges, stress_static=stress, fabric=2.0 * stress, number_density=0.5 * ones, **spin,
        diameter_density=ones, solid_fraction=ones,
    )  # fmt: skip
    names = ["pressure", "stress_ratio", "s_D", "fabric_trace", "fabric_deviator", "inertial_number", "shear_rate", "eigen_rotation"]
    profile = field_values(quantities, Rings(edges, np.empty(0)), [*names, "spin", "continuum_spin"])
    # what is left of v = b/r about its tangent counts as agitation: (b/r^3 w^2/12)^2 with w = 1/8, below 1e-9
    np.testing.assert_allclose(profile["pressure"], 2.0, rtol=1e-8)
    np.testing.assert_allclose(profile["stress_ratio"], 0.6 / 2.0, rtol=1e-8)
    np.testing.assert_allclose(profile["s_D"], np.hypot(1.0, 0.6) / 2.0, rtol=1e-8)
    np.testing.assert_allclose(profile["fabric_trace"], 8.0)
    np.testing.assert_allclose(profile["fabric_deviator"], 2.0 * np.hypot(1.0, 0.6))
    np.testing.assert_allclose(profile["inertial_number"], profile["shear_rate"] * np.sqrt(4.0 / 2.0), rtol=1e-8)
    np.testing.assert_allclose(profile["shear_rate"], 4.0 / r**2, rtol=1e-3)
    np.testing.assert_allclose(profile["eigen_rotation"], 0.3 - profile["continuum_spin"])
    np.testing.assert_allclose(profile["eigen_rotation"], 0.3, atol=1e-4)  # second order in the ring width: (1/8)^2/20 b/r^4


def test_gradient_of_a_couette_profile():
    """v = a r + b/r: velocity, shear rate 2 b/r^2 and continuum spin a, at second order in the ring width."""
    a, b = 0.1, 2.0
    errors = []
    for count in (16, 32, 64):
        edges = np.linspace(5.0, 13.0, count + 1)
        r, quantities = moments_of(lambda r: a * r + b / r, edges)
        profile = field_values(quantities, Rings(edges, np.empty(0)), ["v_phi", "shear_rate", "continuum_spin"])
        exact = {"v_phi": a * r + b / r, "shear_rate": 2 * b / r**2, "continuum_spin": a}
        errors.append([np.abs(profile[name] - value).max() for name, value in exact.items()])
    order = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    np.testing.assert_allclose(order, 2.0, atol=0.3)  # the outermost rings move towards the steep end


def test_block_errors_know_the_spread(rng):
    blocks = xr.Dataset({"v": (("block", "r"), rng.normal(3.0, 2.0, (400, 5)))})
    mean = mean_and_error(blocks)
    np.testing.assert_allclose(mean.v_error, 2.0 / np.sqrt(400), rtol=0.2)  # 1/sqrt(2*400) = 4 % each, five of them
    assert mean.attrs["blocks"] == 400
    two = mean_and_error(xr.Dataset({"v": ("block", [1.0, 3.0])}))
    assert float(two.v) == 2.0
    assert float(two.v_error) == pytest.approx(1.0)  # sqrt(2) of n - 1, over sqrt(2)
    assert np.isnan(mean_and_error(blocks.isel(block=[0])).v_error).all()


def test_drift_is_measured_in_standard_errors(rng):
    steady = rng.normal(0, 1, 100)
    assert abs(drift(steady)) < 3.5
    assert drift(steady + np.linspace(0, 5, 100)) > 5
    assert drift(np.ones(10)) == 0.0


def test_a_drift_that_chance_makes():
    """The two-sided quantile of Student's t with as many degrees of freedom as both halves have; fewer than four values tell nothing."""
    assert chance_drift(6) == pytest.approx(4.604, abs=1e-3)  # tables: 4 degrees of freedom, 1 %
    assert chance_drift(12, chance=0.05) == pytest.approx(2.228, abs=1e-3)  # 10 degrees of freedom
    assert chance_drift(3) == np.inf
    records = np.random.default_rng(1).normal(size=(4000, 8))
    exceeding = np.mean([abs(drift(record)) > chance_drift(8) for record in records])
    assert exceeding == pytest.approx(0.01, abs=0.005)  # of 4000
