"""The shipped studies of the ring shear cell are what they should be: in balance, steady, complete."""

from pathlib import Path

import numpy as np
import pytest

import anisogran as ag
from anisogran.sweeps.cases import scene_from

DATA = Path(__file__).parents[1] / "fits" / "data"
CELLS = ("reference", "fast", "inner_4", "inner_6", "loose", "soft", "stiff", "slow")


@pytest.fixture(scope="module")
def study():
    return ag.open(DATA / "ring_reference.h5", holds="reference/circles")


@pytest.mark.parametrize("cell", CELLS)
def test_the_stress_of_every_cell_is_in_balance(study, cell):
    """r^2 sigma_rphi the same on all circles within 0.3 %, and d(r sigma_rr)/dr = sigma_phiphi within 3 % of the pressure."""
    circles, profiles = (study[f"{cell}/{group}"].to_dataset() for group in ("circles", "profiles"))
    torque = circles.cut_shear_stress * circles.r**2
    assert (torque.std("r") < 0.003 * torque.mean("r")).all()
    slope = np.diff(circles.cut_pressure * circles.r, axis=1) / np.diff(circles.r)
    residual = slope - profiles.stress.isel(i=1, j=1).values
    assert (np.sqrt(np.mean(residual**2, axis=1)) < 0.03 * profiles.pressure.mean("r").values).all()


@pytest.mark.parametrize("cell", CELLS)
def test_every_cell_is_finished_and_steady_and_says_what_it_is(study, cell):
    cases = study[f"{cell}/cases"].to_dataset()
    assert (cases.state == "finished").all()
    assert not [message for message in cases.message.values if "steady" in str(message)]
    assert scene_from(cases.attrs["scene"], cell).kind == "ring_shear"


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
