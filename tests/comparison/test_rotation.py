"""Rotations of grains: made-up cells whose grains spin by the couple-stress equation, and a small cell of real grains."""

import numpy as np
import pytest
import xarray as xr
from made_up import made_up_run

from anisogran import RingShear
from anisogran.comparison import asymmetry, ring_edges, ring_flow, spin_length
from anisogran.continuum import Nonlocal, spin
from anisogran.outcome import InputError

LENGTH = 1.2


def turning_run(length=LENGTH, noise=1e-5, inner=None):
    """The made-up cell with spins by the equation, and blocks of stress that is symmetric but for noise."""
    run = made_up_run(inner_radius=10.0)
    profiles, rng = run.profiles, np.random.default_rng(3)
    spins = spin(ring_flow(run, Nonlocal(0.28, 1.1, 0.7)).solve(), length, inner=inner).ring_average(ring_edges(profiles))
    r = profiles.r.values
    profiles["continuum_spin"] = ("r", spins.continuum_spin)
    profiles["eigen_rotation"] = ("r", spins.eigen_rotation + noise * rng.normal(size=r.size))
    profiles["eigen_rotation_error"] = ("r", np.full(r.size, noise))
    stress = profiles.stress.values[:, :, None] * np.ones((12, 1)) + 1e-4 * rng.normal(size=(2, 2, 12, r.size))
    run.blocks["stress"] = xr.DataArray(stress, dims=("i", "j", "block_12", "r")).isel(block_12=slice(8)).rename(block_12="block")
    return run


def test_the_length_is_found_and_trusted():
    for inner in (None, "ring"):
        run = turning_run(inner=inner)
        fit = spin_length(run, inner)
        # rings of one diameter do not show how W bends inside them: 2 % too much, and the noise of 1 to 3 %
        assert fit.values["length"] == pytest.approx(LENGTH, rel=0.06)
        assert fit.verdict, str(fit)
        np.testing.assert_allclose(fit.predict(run.profiles.r.values), run.profiles.eigen_rotation, atol=2e-4)


def test_grains_that_turn_with_the_flow_give_no_length():
    fit = spin_length(turning_run(length=0.02, noise=1e-4))
    assert not fit.verdict
    assert "the signal" in str(fit.verdict)
    assert np.isnan(fit.errors["length"])


def test_asymmetry_is_told_in_standard_errors():
    run = turning_run()
    even = asymmetry(run)
    assert even.largest < 5.0  # eight rings, errors from eight blocks
    assert even.share == pytest.approx(1.4e-4 / np.sqrt(8.0) / 0.28, rel=0.5)
    run.blocks["stress"][{"i": 0, "j": 1}] += 5e-3
    odd = asymmetry(run)
    np.testing.assert_allclose(odd.difference - even.difference, 5e-3, rtol=1e-9)
    np.testing.assert_allclose(odd.error, even.error, rtol=1e-9)
    assert odd.largest > 30.0


def test_bad_runs_are_named():
    with pytest.raises(InputError, match="spin_length: the profiles have no continuum_spin"):
        spin_length(made_up_run())
    with pytest.raises(InputError, match=r"inner = 'wall' must be None or \"ring\""):
        spin_length(turning_run(), "wall")
    run = turning_run()
    with pytest.raises(InputError, match="asymmetry: the run has no blocks"):
        asymmetry(type(run)(run.scene, run.series, run.profiles, None))


def test_the_stress_of_real_grains_is_symmetric():
    """So couple stresses do not act on the flow, and the spin may be solved after it."""
    run = RingShear(n=250, inner_radius=4.0, travel=18.0, discard=2.0, block=2.0, seed=2).run()
    found = asymmetry(run)
    assert found.share < 3e-3
    assert found.largest < 7.0  # errors from eight blocks: Student's t beyond 5 has a chance of 1e-3 a ring
    assert run.blocks.sizes["block"] == 8
    fit = spin_length(run)  # too short a run to tell; what it says is no error
    assert np.isfinite(fit.values["length"])
