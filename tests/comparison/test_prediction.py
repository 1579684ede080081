"""Parameters fitted on one made-up cell predict another that obeys the same law, and miss one that does not."""

from dataclasses import replace

import numpy as np
import pytest
from made_up import LAW, made_up_run

import anisogran as ag
from anisogran.comparison import RIVALS, best_exponential, frozen, predictions
from anisogran.continuum import Nonlocal
from anisogran.scenes.changes import changed


@pytest.fixture(scope="module")
def parameters():
    return frozen([made_up_run()], LAW.mu_s, LAW.b)


def test_parameters_are_those_of_the_cell(parameters):
    assert parameters.amplitude == pytest.approx(LAW.amplitude, rel=2e-3)
    assert parameters.amplitude_with_wall == pytest.approx(LAW.amplitude, rel=1e-3)
    assert parameters.wall == pytest.approx(0.0, abs=1e-3)
    assert parameters.errors["amplitude"] < 1e-9  # blocks without noise
    assert not parameters.reasons


@pytest.mark.parametrize("change", [{"inner_radius": 14.0}, {"wall_speed": 0.2}])
def test_another_cell_with_the_same_law_is_predicted(parameters, change):
    table = predictions(parameters, made_up_run(**change))
    l2 = dict(zip(table.rival.values, table.l2.values, strict=True))
    assert list(table.rival.values) == list(RIVALS)
    assert l2["nonlocal"] < 1e-3  # as well as the amplitude is found
    assert l2["nonlocal with wall"] < 1e-3
    assert l2["copy"] > 0.02  # the other cell has another profile: what no mechanics says
    assert l2["local"] > 0.5
    np.testing.assert_allclose(table.l2_noise, 0.01, rtol=1e-6)
    assert float(table.l2_continuum.sel(rival="nonlocal")) < 1e-5
    np.testing.assert_allclose(table.v_phi.sel(rival="nonlocal"), table.v_phi_dem, rtol=0.01)


def test_another_law_is_missed(parameters):
    table = predictions(parameters, made_up_run(Nonlocal(LAW.mu_s, LAW.b, 1.0)))
    assert float(table.l2.sel(rival="nonlocal")) > 0.1


def test_the_copy_is_the_profile_in_wall_speeds_and_diameters(parameters):
    run = made_up_run(inner_radius=14.0, wall_speed=0.2)
    copied = predictions(parameters, run).v_phi.sel(rival="copy")
    np.testing.assert_allclose(copied, 5.0 * made_up_run().profiles.v_phi, rtol=1e-12)


def test_the_exponential_is_that_of_the_cell_in_wall_speeds_and_diameters(parameters):
    run = made_up_run(inner_radius=14.0, wall_speed=0.2)
    told = predictions(parameters, run).v_phi.sel(rival="exponential")
    np.testing.assert_allclose(told, 5.0 * best_exponential(made_up_run().profiles), rtol=1e-9)


def test_several_runs_are_told_by_their_mean_and_scatter():
    runs = [made_up_run(Nonlocal(LAW.mu_s, LAW.b, amplitude)) for amplitude in (0.6, 0.8)]
    parameters = frozen(runs, LAW.mu_s, LAW.b)
    assert parameters.amplitude == pytest.approx(0.7, rel=2e-3)
    assert parameters.errors["amplitude"] == pytest.approx(0.1, rel=1e-2)  # the difference over sqrt(2) sqrt(2)


def test_runs_of_different_cells_are_not_fitted_as_one():
    one = made_up_run()
    longer = replace(one, scene=changed(one.scene, {"seed": 7, "travel": 120.0}))
    frozen([one, longer], LAW.mu_s, LAW.b)
    with pytest.raises(ag.InputError, match=r"must differ in the seed only, but wall_speed is 0\.04 and 0\.2"):
        frozen([one, made_up_run(wall_speed=0.2)], LAW.mu_s, LAW.b)
    other = replace(one, scene=ag.RingShearVolume())
    with pytest.raises(ag.InputError, match="but kind is ring_shear and ring_shear_volume"):
        frozen([one, other], LAW.mu_s, LAW.b)


def test_a_warning_of_a_run_reaches_who_reads_the_numbers(parameters):
    run = replace(made_up_run(), status="warned: not steady")
    words = "the run of the grains ended as warned: not steady"
    assert words in frozen([run], LAW.mu_s, LAW.b).reasons
    assert words in predictions(parameters, run).attrs["reasons"]


def test_no_run_is_refused():
    with pytest.raises(ag.InputError, match="frozen: needs at least one run"):
        frozen([], 0.3, 1.0)
