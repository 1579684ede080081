"""What accuracy costs: the orders that the table shows are those that they should be, and nothing in it has rotted."""

import json
from itertools import pairwise

import numpy as np
import pytest

from anisogran import cli, fitting
from anisogran.benchmark import made_packing
from anisogran.cli import cost_command
from anisogran.cost import curve_fits, effects, rooms
from anisogran.outcome import RunFailed


def priced(room, tmp_path_factory):
    """The rows of a room, quick, by the command, from its file; the figure has been drawn, every row has its keys and a price."""
    path = tmp_path_factory.mktemp("cost") / "cost.json"
    with pytest.raises(SystemExit) as end:
        cli.main(["cost", room, "--quick", "--json", str(path), "--out", str(path.parent / "pictures")])
    assert end.value.code == 0
    assert (path.parent / "pictures" / f"cost-{room}.png").stat().st_size > 10_000
    rows = json.loads(path.read_text())[room]
    for row in rows:
        assert set(row) == {"knob", "value", "error", "seconds", "default"}
        assert row["seconds"] > 0
    return rows


def check_knobs(rows, count):
    """There are so many knobs with an error, and each has one default."""
    knobs = {row["knob"] for row in rows if row["error"] is not None}
    assert len(knobs) == count
    for knob in knobs:
        assert sum(row["default"] for row in block(rows, knob)) == 1, knob


def block(rows, beginning):
    found = [row for row in rows if row["knob"].startswith(beginning)]
    assert found, beginning
    return found


def slope(rows):
    """Exponent of the error in the value, by least squares in the logarithms."""
    return np.polyfit(np.log([row["value"] for row in rows]), np.log([row["error"] for row in rows]), 1)[0]


@pytest.fixture(scope="module")
def rows(tmp_path_factory):
    return priced("averaging", tmp_path_factory)


def test_a_wider_kernel_scatters_less_and_flattens_more(rows):
    """The scatter falls as one over the width (one over the root of the grains in it), the wave is lost with its square."""
    assert slope(block(rows, "width in d: scatter")) == pytest.approx(-1.0, abs=0.25)  # one packing; the widest kernel sees it all
    wave = block(rows, "width in d: error of a velocity wave")[1:4]  # from where grains fill the kernel to where it is as wide as the wave
    assert slope(wave) == pytest.approx(2.0, abs=0.3)
    assert [row["value"] for row in rows if row["default"] and row["knob"].startswith("width")] == [1.0, 1.0]


def test_more_grains_in_a_cell_scatter_less(rows):
    """As one over the root of their number."""
    assert slope(block(rows, "grains in a cell")) == pytest.approx(-0.5, abs=0.2)  # four cells in the last row: 35 % sampling error


def test_kernels_of_one_standard_deviation_are_alike(rows):
    errors = [row["error"] for row in block(rows, "kernel of standard deviation")]
    assert len(errors) == 4
    assert max(errors) / min(errors) < 1.5


def test_each_field_has_a_price_and_together_they_are_cheaper(rows):
    for beginning in ("price of a field on rings", "price of a field at"):
        prices = block(rows, beginning)
        assert prices[-1]["value"] == "all together"
        assert len(prices) > 40
        assert prices[-1]["seconds"] < 0.7 * sum(row["seconds"] for row in prices[:-1])
        assert all(row["error"] is None for row in prices)


def test_default_is_marked_once_a_knob(rows):
    for before, after in pairwise(row for row in rows if row["default"]):
        assert before["knob"] != after["knob"]


def test_an_unknown_room_is_one_line(capsys):
    with pytest.raises(SystemExit) as end:
        cli.main(["cost", "kitchen"])
    assert end.value.code == 2
    assert "cost kitchen: must be one of dem, averaging, models, fitting, continuum, whole, all" in capsys.readouterr().err


@pytest.fixture(scope="module")
def law_rows(tmp_path_factory):
    return priced("models", tmp_path_factory)


def test_integrators_of_the_laws_have_their_orders_and_the_default_is_marked(law_rows):
    """A prescribed stress is met at the ends of steps, so that Runge-Kutta is of second order here too."""
    for integrator, order in (("midpoint", 2.0), ("rk45", 2.0), ("explicit", 1.0)):
        blocks = [row for row in law_rows if row["knob"].startswith(f"steps to a turn, {integrator}")]
        for name in {row["knob"] for row in blocks}:
            measured = -slope([row for row in blocks if row["knob"] == name])
            assert measured == pytest.approx(order, abs=0.2)  # sub-steps of the coarsest steps help the midpoint
            assert f"order {measured:.2f}" in name
    marked = [row["value"] for row in law_rows if row["default"]]
    assert marked == ["midpoint", "midpoint", 1e-9]
    tolerances = block(law_rows, "tolerance of rk45")
    assert [row["error"] for row in tolerances] == sorted((row["error"] for row in tolerances), reverse=True)
    assert len(block(law_rows, "price of an update")) == 8


@pytest.fixture(scope="module")
def ring_rows(tmp_path_factory):
    return priced("continuum", tmp_path_factory)


def test_the_ring_converges_with_mesh_and_rate_floor_at_their_orders(ring_rows):
    check_knobs(ring_rows, 18)
    mesh = block(ring_rows, "elements along the radius: error of v_phi, nonlocal law")
    assert slope(mesh[2:]) == pytest.approx(-3.0, abs=0.1)  # quadratic elements
    mesh = block(ring_rows, "elements along the radius: error of the stress ratio, nonlocal law")
    assert slope(mesh[1:5]) == pytest.approx(-4.0, abs=0.2)  # a force: twice the order of the rate; 256 is at the limit of the reference
    floor = block(ring_rows, "rate_floor: error of v_phi, local law")
    assert slope(floor[:4]) == pytest.approx(1.0, abs=0.03)  # creep in proportion; below, the mesh is seen


def test_the_references_of_the_ring_are_better_than_the_defaults(ring_rows):
    """The own error is told in the knob; a default is never within ten times of it."""
    told = [row for row in ring_rows if "reference good to" in row["knob"] and row["default"]]
    assert len(told) == 8
    for row in told:
        assert 0.0 < 10.0 * float(row["knob"].rpartition(" ")[2]) < row["error"]


def test_iterations_cut_off_leave_an_error_and_the_default_does_not(ring_rows):
    for law in ("local", "nonlocal"):
        cut = block(ring_rows, f"max_iterations, the last iterate: error of v_phi, {law} law")
        mesh = block(ring_rows, f"elements along the radius: error of v_phi, {law} law")
        [default] = [row["error"] for row in mesh if row["default"]]
        assert cut[-1]["default"]
        assert cut[-1]["error"] == pytest.approx(default, rel=1e-6)
        assert cut[0]["error"] > 100 * default


def test_the_second_dimension_buys_nothing_but_for_a_ring_off_centre(ring_rows):
    for law in ("local", "nonlocal"):
        line, plane = block(ring_rows, f"dimension, 16 elements along: error of v_phi, {law} law")
        assert plane["error"] == pytest.approx(line["error"], rel=1e-3)  # the same functions; Newton's tolerance squared lies below
        assert plane["seconds"] > 2 * line["seconds"]
    around = block(ring_rows, "elements_around: error of v_phi")
    assert slope(around[1:]) < -3.0  # quadratic elements, of third order or more


@pytest.fixture(scope="module")
def fit_rows(tmp_path_factory):
    return priced("fitting", tmp_path_factory)


def linearised(points, memory=None):
    """Standard errors of (s_0, s_max, beta) of a fit to the made-up curve, by differences and the covariance of its noise."""
    eps_D = np.linspace(0.0, curve_fits.STRAIN, points)
    truth = np.array([0.02, 0.45, 80.0])
    curve = lambda s_0, s_max, beta: s_max - (s_max - s_0) * np.exp(-beta * eps_D)  # noqa: E731
    slopes = np.array(
        [(curve(*(truth + step)) - curve(*(truth - step))) / (2e-5 * at) for at, step in zip(truth, 1e-5 * np.diag(truth), strict=True)]
    )
    apart = np.abs(eps_D[:, None] - eps_D)
    noise = 0.02**2 * (np.eye(points) if memory is None else np.exp(-apart / memory))
    inverse = np.linalg.inv(slopes @ slopes.T)
    return np.sqrt(np.diag(inverse @ slopes @ noise @ slopes.T @ inverse))


@pytest.mark.parametrize("memory", [None, curve_fits.MEMORY])
def test_errors_of_the_fits_are_those_of_linear_theory(memory):
    """20 data sets tell an error to 16 %; 45 % are three of that."""
    results = [fitting.relaxation(*one, until=None).values for one in curve_fits.data_sets(400, 20, memory=memory)]
    for name, exact in zip(("s_0", "s_max", "beta"), linearised(400, memory), strict=True):
        measured = np.sqrt(np.mean([(values[name] - curve_fits.TRUTH[name]) ** 2 for values in results]))
        assert measured == pytest.approx(exact, rel=0.45), name


def test_true_errors_are_those_of_linear_theory():
    assert list(curve_fits.true_errors(400).values()) == pytest.approx(linearised(400), rel=1e-8)  # differences of second order


def test_more_points_help_only_where_their_noise_is_their_own(fit_rows):
    check_knobs(fit_rows, 12)
    for name in ("s_max", "beta"):
        white = block(fit_rows, f"points, white noise: error of {name}")
        assert [row["value"] for row in white] == [25, 100, 400, 1600]
        assert slope(white) == pytest.approx(-0.5, abs=0.2)  # 10 data sets: 22 % of each error, 0.08 of the slope
        correlated = block(fit_rows, f"points, noise with a memory of 0.017 of the path: error of {name}")
        assert slope(correlated) > -0.25  # theory: a factor 0.9 from 100 points to 1600


def test_a_curve_must_reach_its_plateau_and_outliers_want_a_robust_loss(fit_rows):
    reached = block(fit_rows, "largest eps_D, 400 points: error of s_max")
    assert reached[0]["error"] > 3 * reached[-1]["error"]
    linear, robust = block(fit_rows, "loss, 100 points, 5% outliers: error of s_max")
    assert linear["default"]
    assert robust["error"] < linear["error"]
    assert robust["seconds"] > 2 * linear["seconds"]


def test_a_larger_bootstrap_knows_errors_better_up_to_what_the_data_know(fit_rows):
    """The square of its error falls by 1/(2 samples), to that of the covariance."""
    few, usual = (row["error"] for row in block(fit_rows, "samples of a bootstrap"))
    assert few**2 - usual**2 == pytest.approx(0.5 / 20 - 0.5 / 200, rel=0.9)  # 10 data sets, 2 errors that hang together: 30 % each
    covariance, profile, bootstrap = block(fit_rows, "kind of error bar")
    assert bootstrap["error"] == usual
    assert profile["error"] == pytest.approx(covariance["error"], rel=0.5)  # 400 points: the profile is all but a parabola
    assert covariance["seconds"] < profile["seconds"] < bootstrap["seconds"]


@pytest.fixture(scope="module")
def grain_rows(tmp_path_factory):
    return priced("dem", tmp_path_factory)


def test_grains_converge_to_closed_forms_with_the_time_step(grain_rows):
    """To the restitutions exp(-g t_c/2 m12) and sqrt(k1/k2), and to a damped oscillator."""
    check_knobs(grain_rows, 11)
    for name in ("restitution, dashpot", "relaxation of a damped chain"):
        errors = block(grain_rows, f"steps in a contact time: {name}")
        assert slope(errors[2:]) == pytest.approx(-1.0, abs=0.15)  # the dashpot sees the velocity of half a step ago
        assert errors[-1]["error"] < 3e-3
    errors = block(grain_rows, "steps in a contact time: restitution, hysteresis")
    assert slope(errors[1:]) < -1.8  # kinks of a force that is continuous
    assert errors[-1]["error"] < 1e-4


def test_steady_flow_is_denser_slower_and_softer(grain_rows):
    """One seed of 100 grains over 0.6 of strain knows the area fraction to 0.5 %, and mu too badly to be compared."""
    one, two = block(grain_rows, "seeds of 50 grains")
    assert two["error"] < one["error"]  # the mean square of means is below that of the values
    assert two["seconds"] == pytest.approx(2 * one["seconds"])
    fast, _, slow = block(grain_rows, "inertial number: phi")
    assert fast["error"] == pytest.approx(0.04, abs=0.015)  # of the full room
    assert slow["error"] < 0.015
    assert fast["seconds"] < slow["seconds"]
    soft, _, stiff = block(grain_rows, "p/k: phi")
    assert soft["error"] == pytest.approx(0.025, abs=0.02)  # likewise
    assert soft["error"] > stiff["error"]


def test_each_effect_has_its_price_beside_the_same_scene_without_it(grain_rows):
    """Bounds leave room for a machine that is at work elsewhere."""
    ratio = {}
    for without, with_it in zip(*[iter(block(grain_rows, "price of"))] * 2, strict=True):
        assert without["knob"] == with_it["knob"]
        assert (without["value"], with_it["value"]) == ("without", "with")
        ratio[without["knob"].removeprefix("price of ").partition(",")[0]] = with_it["seconds"] / without["seconds"]
    assert len(ratio) == 7
    assert 1.1 < ratio["friction and rotation"] < 2.0
    assert 1.4 < ratio["the energy ledger"] < 3.5
    assert 0.8 < ratio["background drag"] < 1.3


def test_the_skin_of_the_neighbour_list_changes_rounding_only():
    """It decides the order of grains in memory, and so that of sums; later a dense packing makes more of it, as of any rounding.

    A contact that is not in the list for a single step would move its grains by 1e-10 of a radius or more.
    """
    packing = made_packing(200)
    thin, thick = (effects.sheared(packing, skin) for skin in (effects.SKINS[0], effects.SKINS[-1]))
    for simulation in (thin, thick):
        simulation.run(300)
        assert simulation.counters["late_builds"] == 0
    assert thin.counters["builds"] > 3 * thick.counters["builds"]
    np.testing.assert_allclose(thin.position, thick.position, rtol=0, atol=1e-12 * packing[1].min())


def test_all_rooms_are_gone_through_in_order(monkeypatch, tmp_path, capsys):
    """Made-up rooms, since the real ones take minutes; the file is whole after each."""
    rows = [{"knob": "step: error", "value": 1.0, "error": 0.1, "seconds": 0.01, "default": True}]
    monkeypatch.setattr(
        rooms, "ROOMS", {name: lambda quick, name=name: [row | {"knob": name} for row in rows] for name in ("dem", "fitting")}
    )
    with pytest.raises(SystemExit) as end:
        cli.main(["cost", "all", "--json", str(tmp_path / "cost.json")])
    assert end.value.code == 0
    assert json.loads((tmp_path / "cost.json").read_text()) == {name: [rows[0] | {"knob": name}] for name in ("dem", "fitting")}
    told = capsys.readouterr().out
    assert told.index("== dem ==") < told.index("== fitting ==")


def test_the_command_knows_the_rooms_there_are():
    assert tuple(rooms.ROOMS) == cost_command.ROOMS


def test_a_room_that_fails_leaves_no_empty_folder(monkeypatch, tmp_path):
    def breaks(quick):
        raise RunFailed("a made-up end")

    monkeypatch.setattr(rooms, "ROOMS", {"dem": breaks})
    kept = tmp_path / "kept"
    kept.mkdir()
    for folder, stays in ((tmp_path / "new", False), (kept, True)):
        with pytest.raises(SystemExit) as end:
            cli.main(["cost", "dem", "--out", str(folder)])
        assert end.value.code == 3
        assert folder.exists() == stays
