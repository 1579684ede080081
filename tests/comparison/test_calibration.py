"""Parameters that a made-up ring was computed with are found again, with errors that its fluctuations deserve."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from made_up import LAW, made_up_run

from anisogran.comparison import fitted_amplitude, fitted_wall
from anisogran.continuum import Nonlocal
from anisogran.outcome import InputError

WALLED = Nonlocal(LAW.mu_s, LAW.b, 0.7, wall=0.2)


def test_amplitude_is_found_again():
    found = fitted_amplitude(made_up_run(), LAW.mu_s, LAW.b)
    assert found.values["amplitude"] == pytest.approx(LAW.amplitude, rel=2e-3)  # the search stops at 1e-3 in its logarithm
    assert found.l2 < 2e-3
    assert found.status.level == "ok"
    found = fitted_amplitude(made_up_run(), LAW.mu_s, LAW.b, bounds=(0.1, 0.4))
    assert found.status.level == "warned"
    assert "the best nonlocal amplitude 0.4 lies at the bound" in str(found.status)


def test_bounds_that_do_not_ascend_are_refused():
    with pytest.raises(InputError, match=r"fitted_amplitude: bounds = \(2, 0.1\) must ascend from above 0"):
        fitted_amplitude(made_up_run(), LAW.mu_s, LAW.b, bounds=(2, 0.1))


def test_amplitude_and_wall_are_found_again_together():
    found = fitted_wall(made_up_run(WALLED), LAW.mu_s, LAW.b)
    assert found.values["amplitude"] == pytest.approx(0.7, rel=1e-4)  # the search stops at 1e-6 in its coordinates
    assert found.values["wall"] == pytest.approx(0.2, rel=1e-3)
    assert found.law == Nonlocal(LAW.mu_s, LAW.b, found.values["amplitude"], found.values["wall"])
    assert found.l2 < 1e-5
    assert found.status.level == "ok"


def test_a_wall_that_is_not_there_is_found_to_be_none():
    found = fitted_wall(made_up_run(), LAW.mu_s, LAW.b)
    assert found.values["wall"] == pytest.approx(0.0, abs=1e-4)


@pytest.mark.parametrize(("fit", "law"), [(fitted_amplitude, LAW), (fitted_wall, WALLED)])
def test_errors_are_the_scatter_of_repeated_fits(fit, law):
    """Six runs with other noise: the standard deviation of six values is known to 32 %, so a factor of 2.5 either way holds."""
    fits = [fit(made_up_run(law, noise=0.05, seed=seed), law.mu_s, law.b) for seed in range(6)]
    for name in fits[0].values:
        scatter = np.std([one.values[name] for one in fits], ddof=1)
        assert 0.4 < np.mean([one.errors[name] for one in fits]) / scatter < 2.5


@pytest.mark.parametrize(("name", "half", "other"), [("amplitude", 0.007, "wall"), ("wall", 0.01, "amplitude")])
def test_blocks_that_differ_in_one_parameter_make_an_error_of_that_alone(name, half, other):
    """Each of two blocks obeys a law of its own: the standard error of their mean is half the difference of the two values."""
    run = made_up_run(WALLED)
    laws = [replace(WALLED, **{name: getattr(WALLED, name) + step}) for step in (-half, half)]
    v_phi = [made_up_run(law).profiles.v_phi.values for law in laws]
    blocks = xr.Dataset({"v_phi": (("block", "r"), v_phi)}, coords={"r": run.profiles.r})
    errors = fitted_wall(replace(run, blocks=blocks), LAW.mu_s, LAW.b).errors
    assert errors[name] == pytest.approx(half, rel=0.01)  # to first order
    assert errors[other] < 0.02 * half


def test_without_blocks_there_are_no_errors():
    found = fitted_amplitude(replace(made_up_run(), blocks=None), LAW.mu_s, LAW.b)
    assert np.isnan(found.errors["amplitude"])
