"""The shipped studies of the ring shear cell are what they should be: in balance, steady, complete."""

from pathlib import Path

import numpy as np
import pytest

import anisogran as ag
from anisogran.comparison import study_runs
from anisogran.continuum import LAWS
from anisogran.experiments.scene_file import scene_from

DATA = Path(__file__).parents[1] / "fits" / "data"
CELLS = [
    *(("ring_reference", cell) for cell in ("reference", "fast", "inner_4", "inner_6", "loose", "soft", "stiff", "slow")),
    ("ring_paper", "paper"), ("ring_lecture", "smooth"), ("ring_lecture", "lecture"),
]  # fmt: skip


@pytest.fixture(scope="module")
def studies():
    return {name: ag.open(DATA / f"{name}.h5") for name in ("ring_reference", "ring_paper", "ring_lecture")}


@pytest.fixture(scope="module")
def study(studies):
    return studies["ring_reference"]


@pytest.mark.parametrize(("file", "cell"), CELLS)
def test_the_stress_of_every_cell_is_in_balance(studies, file, cell):
    """r^2 sigma_rphi the same on all circles within 0.3 %, and d(r sigma_rr)/dr = sigma_phiphi within 3 % of the pressure.

    The second without the innermost and the outermost ring of the lecture's cell: discs of the wall, which are no sample, fill a part of
    the one, and nearly equal grains stand in rows along the other, where a circle cuts all of them or none.
    """
    circles, profiles = (studies[file][f"{cell}/{group}"].to_dataset() for group in ("circles", "profiles"))
    torque = circles.cut_shear_stress * circles.r**2
    assert (torque.std("r") < 0.003 * torque.mean("r")).all()
    slope = np.diff(circles.cut_pressure * circles.r, axis=1) / np.diff(circles.r)
    residual = (slope - profiles.stress.isel(i=1, j=1).values)[:, slice(1, -1) if cell == "lecture" else slice(None)]
    assert (np.sqrt(np.mean(residual**2, axis=1)) < 0.03 * profiles.pressure.mean("r").values).all()


@pytest.mark.hard_case("N7", of=[law.kind for law in LAWS])
def test_the_torques_on_both_rings_agree_within_their_errors(studies, answer):
    """Of 20 runs nearly all within two standard errors of 3 to 8 blocks, and all within 2 %: the sample takes up no torque on average."""
    deviations = []
    for file, cell in CELLS:
        for run in study_runs(studies[file], cell).values():
            steady, blocks = run.scene.steady(run.series), run.blocks.sizes["block"]
            inner = steady.wall_shear_stress.values * run.scene.inner_radius**2
            difference = (inner - (steady.outer_shear_stress * steady.outer_radius**2).values) / inner.mean()
            means = [part.mean() for part in np.array_split(difference, blocks)]
            assert abs(difference.mean()) < 0.02
            deviations.append(abs(difference.mean()) / (np.std(means, ddof=1) / np.sqrt(blocks)))
    within = np.array(deviations) < 2
    assert np.mean(within) > 0.8
    answer.named(f"of grains within two standard errors in {within.sum()} of {within.size} runs")


@pytest.mark.parametrize(("file", "cell"), CELLS)
def test_every_cell_is_finished_and_says_what_it_is(studies, file, cell):
    """And is steady, but for that at constant volume, which warns of its pressure."""
    cases = studies[file][f"{cell}/cases"].to_dataset()
    assert (cases.state == "finished").all()
    doubts = [str(message) for message in cases.message.values if "steady" in str(message) or "constant volume" in str(message)]
    assert len(doubts) == (cell == "lecture")
    assert scene_from(cases.attrs["scene"], cell).kind == ("ring_shear_volume" if cell == "lecture" else "ring_shear")


def test_at_constant_volume_the_pressure_is_lost(studies):
    """Over three turns by more than a factor of ten, while the shear zone dilates and the outside becomes denser."""
    series, blocks = (studies["ring_lecture"][f"lecture/{group}"].to_dataset().isel(seed=0) for group in ("series", "blocks"))
    assert float(series.turns.max()) == pytest.approx(3.0, abs=0.01)
    pressure = series.wall_pressure.values
    assert pressure[:500].mean() > 10 * pressure[-500:].mean() > 0
    assert float(blocks.area_fraction[-1, 0]) < float(blocks.area_fraction[0, 0])
    assert float(blocks.area_fraction[-1, 6:].mean()) > float(blocks.area_fraction[0, 6:].mean())


def test_grains_roll_in_layers_at_smooth_rings(studies):
    """The eigen-rotation of the first layer and that of the second have opposite signs, in both runs."""
    layers = studies["ring_lecture"]["smooth/layers"].to_dataset()
    for low, high, sign in ((0.3, 0.7, -1), (0.7, 1.3, 1)):
        near = layers.isel(r=(layers.depth.values > low) & (layers.depth.values < high))
        weighted = sign * (near.eigen_rotation * near.number_density).sum("r") / near.number_density.sum("r")
        assert (weighted > 5 * near.eigen_rotation_error.median("r")).all()


def test_dense_and_loose_starts_end_alike(study):
    """Dense samples dilate, loose ones contract, by 1 % of the radius: the steady outer radius is the same within the scatter of seeds."""
    begin, end = {}, {}
    for cell in ("reference", "loose"):
        radius = study[f"{cell}/series"].outer_radius
        begin[cell], end[cell] = radius[:, 0].values, radius[:, 800:].mean("sample").values
    assert begin["reference"].max() < end["reference"].min() < begin["loose"].min()
    assert end["loose"].mean() == pytest.approx(end["reference"].mean(), abs=0.08)  # seeds scatter by 0.06


def test_the_shear_zone_is_dilated_and_thins_with_the_inner_radius(study):
    profiles = {cell: study[f"{cell}/profiles"].to_dataset().mean("seed") for cell in ("inner_4", "inner_6", "reference")}
    for one in profiles.values():
        assert one.area_fraction[0] < 0.76 < 0.81 < one.area_fraction[-1]
        assert one.fabric_trace[0] < one.fabric_trace[-1]
    decay = [float(one.v_phi[3] / one.v_phi[0]) for one in profiles.values()]
    assert decay == sorted(decay)


def test_the_friction_law_of_the_same_grains():
    steady = ag.open(DATA / "ring_friction_law.h5", holds="shear/steady")["shear/steady"].to_dataset()
    assert steady.stress_ratio.shape == (9, 3)
    fit = ag.fit.mu_of_I(*(steady[name].values.ravel() for name in ("inertial_number", "stress_ratio", "stress_ratio_error")))
    assert fit.values["mu_s"] == pytest.approx(0.281, abs=0.004)
    assert fit.values["b"] == pytest.approx(1.13, abs=0.1)
    slow = steady.rate_to_stress_angle[:5].mean()
    assert abs(np.degrees(slow)) < 1.0  # homogeneous slow flow is coaxial; errors of 0.5 degrees each
