"""The laws at a point, with normal deformation and a pressure other than 1, which no steady ring flow shows."""

import dataclasses

import numpy as np
import pytest

from anisogran import tensors
from anisogran.continuum import LocalMuI, Nonlocal, RingFlow
from anisogran.continuum.balance import Point, Setting
from anisogran.continuum.laws import shear_rate

SETTING = Setting(inertial=0.3, diameter=0.1, density=0.0, rate_floor=1e-9, inner=1.0)


def state(rng):
    d_rr, d_ff, gamma = rng.standard_normal((3, 20))
    rate = np.sqrt((d_rr - d_ff) ** 2 + gamma**2)
    pressure = rng.uniform(0.2, 5.0, 20)
    inertial_number = SETTING.inertial * rate / np.sqrt(pressure)
    mu = 0.3 + 0.9 * inertial_number
    point = Point(0 * rate, 0 * rate, d_rr, d_ff, gamma, pressure, rate / mu, 0 * rate)
    return point, np.array([[d_rr, 0.5 * gamma], [0.5 * gamma, d_ff]]), mu


@pytest.mark.parametrize("law", [LocalMuI(0.3, 0.9), Nonlocal(0.3, 0.9, 0.8)])
def test_stress_is_coaxial_dissipates_and_has_the_ratio_mu(law, rng):
    point, deformation, mu = state(rng)
    s_rr, s_ff, s_rf = law.stress(point, SETTING)
    stress = np.array([[s_rr, s_rf], [s_rf, s_ff]])
    np.testing.assert_allclose(tensors.mean(stress), point.p, rtol=1e-12)
    # the rate floor, 1e-9, over rates and fluidities of order 0.1
    np.testing.assert_allclose(tensors.deviator_size(stress), mu * point.p, rtol=1e-6)
    # compression positive: the deviator of the stress opposes that of the rate of deformation
    work = np.einsum("ijn,ijn->n", tensors.deviator(stress), tensors.deviator(deformation))
    np.testing.assert_allclose(work, -mu * point.p * shear_rate(point), rtol=1e-6)


@pytest.mark.parametrize("law", [LocalMuI(0.3, 0.9), Nonlocal(0.3, 0.9, 0.8)])
def test_rate_from_the_stress_is_the_shear_rate(law, rng):
    point, _, mu = state(rng)
    np.testing.assert_allclose(law.rate(point, SETTING, mu * point.p), shear_rate(point), rtol=1e-6)


def test_uniform_fluidity_fulfils_its_equation_with_mu_of_i(rng):
    point, _, _ = state(rng)
    source, flux, _ = Nonlocal(0.3, 0.9, 0.8).fluidity(point, SETTING)
    np.testing.assert_allclose(source, 0.0, atol=1e-12)
    np.testing.assert_array_equal(flux, 0.0)


def test_records_are_frozen():
    problem = RingFlow(13.0, 33.0, LocalMuI(0.3, 0.9), 1e-3, 1.0)
    for record, name in ((problem, "wall_speed"), (problem.law, "b"), (Nonlocal(0.3, 0.9, 0.8), "amplitude")):
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(record, name, 1.0)
