"""The comparison on a made-up cell whose velocity is the continuum's own: then nothing may differ."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from made_up import LAW, made_up_run

from anisogran import InputError, RingShear, compare
from anisogran import open as open_results
from anisogran.comparison import (
    best_exponential,
    decay_length,
    decay_length_error,
    equilibrium,
    log_rms,
    relative_l2,
    ring_edges,
    ring_flow,
    wall_stress_ratio,
)
from anisogran.continuum import LocalMuI, local_mu_i
from anisogran.files import save_results
from continuum_cases import CASES, name


def test_equal_flows_do_not_differ():
    run = made_up_run()
    comparison = compare(run, ring_flow(run, LAW).solve(), "nonlocal")
    assert comparison.l2 < 1e-10
    assert comparison.decay_length_continuum == pytest.approx(comparison.decay_length_dem, rel=1e-6)
    assert comparison.l2_noise == pytest.approx(0.01, rel=1e-6)
    assert comparison.log_rms < 1e-10
    assert set(comparison.table.data_vars) == {"v_phi", "v_phi_dem", "v_phi_dem_error", "shear_rate", "inertial_number"}
    assert comparison.stress_ratio_wall_dem == pytest.approx(0.45 / 0.9)


@pytest.fixture(scope="module", params=CASES, ids=name)
def cell(request):
    """(run, flow, comparison) of grains that obey the law."""
    run = made_up_run(request.param)
    flow = ring_flow(run, request.param).solve()
    return run, flow, compare(run, flow)


@pytest.mark.hard_case("N8")
def test_a_cell_is_compared_on_its_rings_and_over_their_width(cell, answer):
    run, flow, comparison = cell
    r = run.profiles.r.values
    np.testing.assert_array_equal(comparison.table.r, r)
    assert relative_l2(flow.at(r).v_phi, comparison.table.v_phi.values, r) > 1e-3  # values are none of the middles
    assert comparison.l2 < 1e-10
    assert comparison.l2_noise == pytest.approx(0.01, rel=1e-6)
    assert comparison.reasons == ("the error bars of the grains come from 8 blocks only",)
    answer.computed(comparison.l2, "grains that obey the law")
    answer.named(f"warned: {comparison.reasons[0]}")


@pytest.mark.hard_case("N9")
def test_every_comparison_tells_the_error_of_its_flow(cell, answer):
    """On a mesh twice as fine with a tenth of the rate floor, which is as good as one that is four times as fine; below 1 % by default."""
    run, flow, comparison = cell
    better = replace(flow.problem, elements=4 * (flow.r.size // 2) + 3, rate_floor=0.1 * flow.problem.floor).solve()
    found, exact = (one.ring_average(ring_edges(run.profiles)).v_phi for one in (flow, better))
    truth = relative_l2(found, exact, run.profiles.r.values)
    assert 0.7 * truth < comparison.l2_continuum < 0.01
    answer.computed(comparison.l2_continuum, "v_phi against twice the mesh and a tenth of the rate floor")


def test_the_stress_ratio_has_the_error_of_its_blocks():
    """Ratios of 0.4 and 0.6 in two blocks of the steady part: 0.5 +- 0.1, whatever came before; of one block nothing is known."""
    run = made_up_run()
    steady = run.series.time.values > 20.0 / 0.04
    series = run.series.copy()
    series["wall_pressure"] = ("time", np.ones(11))
    series["wall_shear_stress"] = ("time", np.where(steady, np.where(np.arange(11) < 7, 0.4, 0.6), 9.0))
    for blocks, error in ((2, 0.1), (1, np.nan)):
        profiles = run.profiles.assign_attrs(blocks=blocks)
        np.testing.assert_allclose(wall_stress_ratio(replace(run, series=series, profiles=profiles)), (0.5, error))


def test_the_error_of_a_nonlocal_flow_is_told_by_a_finer_mesh():
    """32 or 64 elements, by more than 2^3."""
    run = made_up_run()
    large, small = (compare(run, replace(ring_flow(run, LAW), elements=elements).solve()).l2_continuum for elements in (32, 64))
    assert 8 * small < large < 32 * small
    assert 1e-8 < small < 1e-4  # of the floor alone 1e-9


def test_the_error_of_a_flow_is_told_by_a_lower_floor():
    """The floor of a nonlocal law in proportion, where it counts more than the mesh."""
    run = made_up_run()
    flows = (replace(ring_flow(run, LAW), elements=256, rate_floor=floor).solve() for floor in (1e-3, 1e-4))
    large, small = (compare(run, flow).l2_continuum for flow in flows)
    assert 8 * small < large < 12 * small


@pytest.mark.hard_case("N9", of="local_mu_i")
@pytest.mark.parametrize("speed", [0.01, 0.04, 0.06, 0.16])
def test_the_error_told_of_a_local_flow_is_no_smaller_than_the_true_one(speed, answer):
    """Against the closed form, averaged over the rings by many points; its kink lies anywhere in the mesh. Measured: 0.8 to 3.4 of it."""
    law, run = LocalMuI(0.28, 1.1), made_up_run(wall_speed=speed)
    flow = ring_flow(run, law).solve()
    edges = ring_edges(run.profiles)
    r = np.linspace(edges[:-1], edges[1:], 4001)
    exact = local_mu_i(r, speed, law, 6.0, 15.0, 1.0, np.pi / 6)
    truth = np.sum(exact * r, axis=0) / np.sum(r, axis=0)
    v_phi = flow.ring_average(edges).v_phi
    told, true = compare(run, flow).l2_continuum, relative_l2(v_phi, truth, run.profiles.r.values)
    assert told > 0.7 * true
    answer.computed(true, "v_phi against the closed form")


def test_problem_of_the_comparison_is_that_of_the_run():
    """Radii, speed, pressure of the steady part and the mass of a free grain."""
    flow = ring_flow(made_up_run(), LAW)
    assert (flow.r_inner, flow.r_outer, flow.wall_speed) == (6.0, pytest.approx(15.0), 0.04)
    assert flow.outer_pressure == pytest.approx(1.0)
    assert flow.grain_mass == pytest.approx(np.pi / 6)


def test_local_law_is_told_apart():
    run = made_up_run()
    flow = ring_flow(run, LocalMuI(0.28, 1.1)).solve()
    comparison = compare(run, flow, "local")
    assert comparison.l2 > 0.5
    table = comparison.table
    assert relative_l2(table.v_phi.values, table.v_phi_dem.values, table.r.values) == pytest.approx(comparison.l2)
    assert comparison.stress_ratio_wall_continuum == flow.stress_ratio_wall
    assert np.isnan(comparison.decay_length_continuum)  # it stands still beyond its layer


def test_relative_l2_in_closed_form():
    r = np.array([1.0, 3.0])
    assert relative_l2(np.array([1.0, 1.0]), np.array([1.0, 2.0]), r) == pytest.approx(np.sqrt(3 / 13))


def test_log_rms_in_closed_form():
    profiles = made_up_run().profiles
    v = profiles.v_phi.values
    assert log_rms(profiles, v * np.exp(0.3)) == pytest.approx(0.3)
    assert log_rms(profiles, np.zeros_like(v)) == np.inf
    assert np.isnan(log_rms(profiles, np.full_like(v, np.nan)))
    assert np.isnan(log_rms(profiles.assign(v_phi_error=profiles.v_phi), v))  # no ring is resolved
    profiles["v_phi_error"] = ("r", np.where(profiles.depth > 3, 1.0, 1e-6))  # what is not resolved does not count
    assert log_rms(profiles, np.where(profiles.depth > 3, -1.0, v)) == pytest.approx(0.0, abs=1e-12)


def test_base_line_is_the_closest_exponential():
    profiles = made_up_run().profiles
    r, depth, v = profiles.r.values, profiles.depth.values, profiles.v_phi.values
    best = relative_l2(best_exponential(profiles), v, r)
    lengths, amplitudes = np.meshgrid(np.linspace(0.5, 3, 120), v[0] * np.linspace(1.0, 2.5, 120))
    others = [relative_l2(a * np.exp(-depth / s), v, r) for s, a in zip(lengths.ravel(), amplitudes.ravel(), strict=True)]
    assert best <= min(others) * (1 + 1e-9)


def test_decay_length_uses_only_resolved_rings():
    run = made_up_run()
    exact = run.profiles.assign(v_phi=("r", 0.03 * np.exp(-run.profiles.depth.values / 1.3)))
    exact["v_phi_error"] = ("r", np.where(exact.depth > 5, 1.0, 1e-4))
    exact["v_phi"] = exact.v_phi.where(exact.depth < 5, 0.5)  # rubbish where the error says so
    assert decay_length(exact, exact.v_phi.values) == pytest.approx(1.3, rel=1e-4)  # the tolerance of the fit
    exact["v_phi_error"][-1] = 1e-4  # a ring beyond the first that fails is no better for its small error
    assert decay_length(exact, exact.v_phi.values) == pytest.approx(1.3, rel=1e-4)


def test_decay_length_trusts_a_ring_by_its_error():
    """One ring off by a fifth, with an error to match: it hardly counts beside rings that are known to a thousandth."""
    profiles = made_up_run().profiles
    exact = 0.03 * np.exp(-profiles.depth.values / 1.3)
    profiles["v_phi"] = ("r", np.where(np.arange(8) == 4, 1.2, 1.0) * exact)
    profiles["v_phi_error"] = ("r", np.where(np.arange(8) == 4, 0.25, 1e-3) * exact)
    assert decay_length(profiles, profiles.v_phi.values) == pytest.approx(1.3, rel=1e-4)  # (1e-3/0.25)^2 of a fifth


def test_noise_is_measured_over_the_area_of_the_rings():
    run = made_up_run()
    run.profiles["v_phi_error"] = ("r", 1e-4 * np.arange(1.0, 9.0))
    r, v = run.profiles.r.values, run.profiles.v_phi.values
    noise = compare(run, ring_flow(run, LAW).solve()).l2_noise
    assert noise == pytest.approx(np.sqrt(np.sum(r * (1e-4 * np.arange(1, 9)) ** 2) / np.sum(r * v**2)))


def test_a_run_of_one_block_is_compared_without_errors():
    run = made_up_run()
    run.profiles["v_phi_error"] = run.profiles.v_phi_error * np.nan
    comparison = compare(run, ring_flow(run, LAW).solve())
    assert comparison.l2 < 1e-10
    assert np.isnan(comparison.l2_noise)
    assert comparison.decay_length_dem == pytest.approx(1.4, abs=0.3)


def test_error_of_the_decay_length_is_the_scatter_of_the_blocks():
    assert decay_length_error(made_up_run()) < 1e-9
    two = made_up_run()
    depth = two.profiles.depth.values
    two.profiles["v_phi"], two.profiles["v_phi_error"] = ("r", np.exp(-depth)), ("r", 1e-6 * np.exp(-depth))
    blocks = xr.Dataset({"v_phi": (("block", "r"), [np.exp(-depth), np.exp(-depth / 1.2)])}, coords={"r": two.blocks.r})
    assert decay_length_error(replace(two, blocks=blocks)) == pytest.approx(0.1, rel=1e-3)  # lengths 1.0 and 1.2: 0.2/sqrt(2)/sqrt(2)
    errors = [decay_length_error(made_up_run(noise=0.05, seed=seed)) for seed in range(10)]
    assert 0.002 < np.mean(errors) < 0.1


def test_equilibrium_of_an_exact_stress():
    run = made_up_run()
    residual = equilibrium(run.profiles)
    assert residual["torque_residual"] < 1e-12
    assert residual["radial_residual"] < 1e-12
    bent = run.profiles.stress.values.copy()
    bent[0, 0] *= 1 + 0.1 * run.profiles.r.values
    assert equilibrium(run.profiles.assign(stress=(("i", "j", "r"), bent)))["radial_residual"] > 0.1


def test_a_run_without_rings_is_refused():
    with pytest.raises(InputError, match="no ring profiles"):
        compare(SimpleNamespace(profiles=None), ring_flow(made_up_run(), LAW).solve())


def test_a_flow_that_is_not_solved_is_refused():
    run = made_up_run()
    with pytest.raises(InputError, match=r"it must be what RingFlow\(...\).solve\(\) returns"):
        compare(run, ring_flow(run, LAW))


def test_a_results_file_is_compared_like_the_run_that_left_it(tmp_path):
    run = RingShear(n=250, inner_radius=4.0, travel=4.0, discard=1.0, block=1.0, seed=1).run()
    flow = ring_flow(run, LAW).solve()
    run.save(tmp_path / "ring.h5")
    kept = open_results(tmp_path / "ring.h5")
    assert ring_flow(kept, LAW) == ring_flow(run, LAW)
    assert compare(kept, flow).l2 == compare(run, flow).l2
    few = "the error bars of the grains come from 3 blocks only"
    assert compare(kept, flow).reasons == compare(run, flow).reasons == (few, f"the run of the grains ended as {run.status}")


def test_a_path_or_a_flow_of_another_cell_is_refused():
    run = made_up_run()
    with pytest.raises(InputError, match=r"compare: 'ring\.h5' is a path; give a run, or what `open` makes of its results file"):
        compare("ring.h5", ring_flow(run, LAW).solve())
    with pytest.raises(InputError, match="the rings of the run, 6 to 14 m, leave the flow, 14 to 23 m"):
        compare(run, ring_flow(made_up_run(inner_radius=14.0), LAW).solve())


def test_a_results_file_of_something_else_is_refused(tmp_path):
    save_results(tmp_path / "other.h5", {"steady": xr.Dataset({"mu": ("test", [0.3])})}, {})
    with pytest.raises(InputError, match="compare: the results file is not that of a run; it has steady"):
        compare(open_results(tmp_path / "other.h5"), ring_flow(made_up_run(), LAW).solve())
