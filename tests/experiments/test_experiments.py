"""Small versions of the experiments: each protocol runs for real, and the physics that must hold on any size holds."""

import json
from itertools import pairwise

import numpy as np
import pytest

from anisogran import Biaxial, RingShear, SimpleShear
from anisogran.dem import Friction, Linear, Luding
from anisogran.experiments.simple_shear import steady_state
from anisogran.glossary import GLOSSARY
from anisogran.outcome import InputError


@pytest.fixture(scope="module")
def biaxial():
    return Biaxial(grains=150, friction=Friction(2e4, 0.5), strain=0.05, duration=0.03, samples=40, seed=3).run()


@pytest.fixture(scope="module")
def ring():
    return RingShear(grains=250, inner_radius=4.0, travel=10.0, discard=2.0, block=1.0, seed=3).run()


@pytest.fixture(scope="module")
def shear():
    return SimpleShear(inertial_number=0.05, grains=100, strain=3.0, discard=1.0, seed=3).run()


def test_biaxial_box_starts_isotropic_and_keeps_its_pressure(biaxial):
    s = biaxial.series
    assert abs(float(s.s_D[0])) < 0.02  # the gate: both walls within 1 % of the pressure
    assert float(s.eps_zz[0]) == 0.0
    assert float(s.eps_zz[-1]) == pytest.approx(0.05, abs=1e-9)
    np.testing.assert_allclose(s.sigma_xx_wall, 100.0, rtol=0.03)
    # grains and walls measure the same stress, but for inertia
    np.testing.assert_allclose(s.sigma_zz, s.sigma_zz_wall, rtol=0.15)
    assert float(abs(s.sigma_zz / s.sigma_zz_wall - 1).median()) < 0.02


def test_biaxial_box_shows_what_granular_matter_does(biaxial):
    """Contraction first, dilation later; a stress ratio of a frictional packing; contacts are lost along the minor axis."""
    s = biaxial.series
    assert float(s.eps_V.max()) > 0
    assert float(s.eps_V[-1]) < 0
    assert 0.3 < float(s.s_D.max()) < 0.65  # asin: 17 to 40 degrees
    assert float(s.anisotropy.max()) > 0.1
    assert float(s.coordination_number[-1]) < float(s.coordination_number[0])


def test_strain_measures_are_half_half(biaxial):
    s = biaxial.series
    np.testing.assert_allclose(s.eps_V + s.eps_D, s.eps_zz, atol=1e-15)
    np.testing.assert_allclose(s.eps_V - s.eps_D, s.eps_xx, atol=1e-15)


def test_same_seed_same_bits(biaxial):
    again = biaxial.scene.run()
    for name in biaxial.series.data_vars:
        np.testing.assert_array_equal(again.series[name], biaxial.series[name])
    np.testing.assert_array_equal(again.snapshots["end"].force, biaxial.snapshots["end"].force)


def test_everything_is_labelled(biaxial, ring, shear):
    for dataset in (biaxial.series, ring.series, ring.profiles, shear.series):
        for name in dataset.data_vars:
            assert dataset[name].attrs["long_name"], name
            assert dataset[name].attrs["units"] == GLOSSARY[name.removesuffix("_error")].unit
        assert "compression positive" in dataset.attrs["conventions"]


def test_provenance_tells_scene_and_effects(biaxial):
    p = biaxial.provenance
    assert json.loads(p["scene"])["friction"]["mu"] == 0.5
    assert "Friction" in p["active_effects"]
    assert p["absent_effects"] == "wall_friction, drag"
    assert p["late_builds"] == 0
    assert p["particle_steps_per_s"] > 1e5


def test_frictionless_scene_leaves_friction_out():
    run = Biaxial(grains=60, contact=Linear(1e5, 0.1), strain=0.01, duration=0.005, samples=10).run()
    assert run.provenance["absent_effects"] == "friction, wall_friction, drag"
    np.testing.assert_array_equal(run.snapshots["end"].spin, 0.0)


def test_torque_is_the_same_on_every_circle(ring):
    """r^2 sigma_rphi is constant: nothing but the rings gives the sample a torque."""
    r, stress = ring.profiles.r.values, ring.profiles.stress.values
    torque = r**2 * 0.5 * (stress[0, 1] + stress[1, 0])
    assert np.std(torque) / np.mean(torque) < 0.12  # 250 grains over 8 d of travel: a tenth is the noise of so short a run
    late = ring.series.isel(time=slice(len(ring.series.time) // 5, None))
    inner = float(late.wall_shear_stress.mean()) * ring.scene.inner_radius**2
    outer = float((late.outer_shear_stress * late.outer_radius**2).mean())
    assert np.mean(torque) == pytest.approx(inner, rel=0.05)
    assert outer == pytest.approx(inner, rel=0.05)


def test_ring_shears_next_to_its_inner_wall(ring):
    v = ring.profiles.v_phi.values / ring.scene.wall_speed
    assert 0.3 < v[0] < 1.0
    assert v[-1] < 0.05
    assert np.all(np.diff(v) < 0.02)
    assert float(ring.profiles.area_fraction[0]) < float(ring.profiles.area_fraction[3])  # dilated at the inner ring
    assert float(ring.series.outer_pressure.mean()) == pytest.approx(1.0, rel=0.02)
    assert ring.profiles.attrs["blocks"] == 8
    assert float(ring.profiles.v_phi_error[0]) > 0


def test_homogeneous_shear_is_steady_under_its_pressure(shear):
    steady = shear.scene.steady(shear.series)
    assert float(steady.sigma_yy.mean()) == pytest.approx(1.0, rel=0.03)
    assert 0.2 < float(steady.stress_ratio.mean()) < 0.45
    assert float(steady.inertial_number.mean()) == pytest.approx(0.05, rel=0.05)
    state = steady_state(shear)
    assert 0 < float(state.stress_ratio_error) < 0.05
    assert shear.series.strain[-1] == pytest.approx(3.0, rel=1e-3)


def test_absurd_runs_are_warned_of():
    soft = Biaxial(grains=40, pressure=3e3, contact=Linear(1e5, 0.1), strain=0.01, duration=0.005, samples=10).run()
    assert "of the mean radius: too soft for this load" in str(soft.status)
    fast = RingShear(grains=150, inner_radius=3.0, wall_speed=2.0, travel=6.0, discard=2.0, block=2.0, seed=1).run()
    assert "far from quasi-static" in str(fast.status)
    one = RingShear(grains=150, inner_radius=3.0, travel=4.0, discard=2.0, block=2.0).run()
    assert "one block only: no error bars" in str(one.status)
    assert np.isnan(one.profiles.v_phi_error).all()


def test_fast_shear_holds_its_pressure():
    run = SimpleShear(inertial_number=0.3, grains=100, strain=4.0, discard=1.0, seed=2).run()
    # 5 % is where the status warns; the control sees contacts only, and agitation adds its share
    assert float(run.scene.steady(run.series).sigma_yy.mean()) == pytest.approx(1.0, abs=0.1)


def test_progress_is_reported():
    seen = []
    SimpleShear(inertial_number=0.1, grains=60, strain=0.6, discard=0.1, samples_per_strain=50).run(progress=seen.append)
    assert seen[-1] == 1.0
    assert all(b >= a for a, b in pairwise(seen))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Biaxial(pressure=-1.0), "Biaxial: pressure = -1.0: Input should be greater than 0"),
        (lambda: Biaxial(presure=1.0), "Biaxial: presure = 1.0: Extra inputs are not permitted"),
        (lambda: Biaxial(grains=3), "Biaxial: grains = 3: Input should be greater than or equal to 20"),
        (lambda: RingShear(wall_speed="fast"), "RingShear: wall_speed = 'fast': Input should be a valid number"),
        (lambda: SimpleShear(inertial_number=float("nan")), "SimpleShear: inertial_number = nan"),
        (lambda: RingShear(travel=45.0), "travel = 45 must be at least discard \\+ block = 40 \\+ 20, or there is nothing to average"),
        (lambda: RingShear(grains=60), "grains = 60 fill a gap of 1.4 mean diameters; 4.5 are needed"),
        (lambda: RingShear(inner_radius=0.8), "inner_radius = 0.8 m must be at least two mean diameters"),
        (lambda: RingShear(block=0.02), "block = 0.02 holds no sample"),
        (lambda: SimpleShear(strain=1.0), "strain = 1 must be at least discard \\+ 0.5 = 2"),
        (lambda: Biaxial(contact=Luding(2.0, 1.0)), "Luding: k2 = 1 must be at least 2"),
    ],
)
def test_bad_scenes_get_one_line(make, message):
    with pytest.raises(InputError, match=message) as caught:
        make()
    assert "\n" not in str(caught.value)
