"""Averages over time: means of quantities, honest errors, any source of snapshots."""

import numpy as np
import pytest
import xarray as xr
from clusters import make

import anisogran as ag
from anisogran import average
from anisogran.averaging import TimeBlocks
from anisogran.averaging.blocks import MOST_BLOCKS, standard_error
from anisogran.outcome import InputError
from anisogran.snapshot import frames


def gas(rng, frames, count=20):
    """Snapshots of discs with independent random velocities and masses."""
    for _ in range(frames):
        position, velocity = rng.uniform(0, 4, (count, 2)), rng.normal(size=(count, 2))
        yield make(position, np.full(count, 0.2), [], [], mass=rng.uniform(1, 2, count), velocity=velocity, volume=16.0)


def test_fields_are_made_of_mean_quantities(rng):
    """The mean velocity is mean momentum over mean mass, not a mean of quotients."""
    snapshots = list(gas(rng, 7))
    data = average(snapshots, on="grid", edges=([0, 2, 4], [0, 4]), fields=["density", "momentum_density", "velocity"])
    one_by_one = [average(s, on="grid", edges=([0, 2, 4], [0, 4]), fields=["density", "momentum_density"]) for s in snapshots]
    np.testing.assert_allclose(data.density, np.mean([one.density for one in one_by_one], axis=0), rtol=1e-13)
    np.testing.assert_allclose(data.momentum_density, np.mean([one.momentum_density for one in one_by_one], axis=0), rtol=1e-12, atol=1e-15)
    assert data.attrs["snapshots"] == 7
    assert data.attrs["blocks"] == 7


def test_a_stream_is_read_once_and_need_not_fit_into_memory(rng):
    """Blocks are joined in pairs, so their number stays bounded, and the mean is that of all snapshots."""
    blocks = TimeBlocks()
    values = rng.normal(size=1000)
    for value in values:
        blocks.add({"x": np.array([value])})
        assert len(blocks.sums) <= MOST_BLOCKS
    assert blocks.size == 32  # 1000 snapshots in 31 whole blocks and a bit
    assert blocks.mean()["x"][0] == pytest.approx(values.mean(), rel=1e-12)
    np.testing.assert_allclose([part["x"][0] for part in blocks.means()], values[:992].reshape(31, 32).mean(axis=1), rtol=1e-10)


def test_the_error_is_right_for_independent_snapshots(rng):
    """Of 400 means over independent samples about 68 % lie within one error bar; the error is that of the mean."""
    within, errors = 0, []
    for _ in range(400):
        error, independent = standard_error(record := rng.normal(size=(24, 1)))
        errors.append(error[0])
        within += abs(record.mean()) < error[0]
        assert 0.5 < independent <= 24
    assert np.mean(errors) == pytest.approx(1 / np.sqrt(24), rel=0.2)  # a little large: by chance neighbours look alike
    assert 0.64 < within / 400 < 0.82  # 68 %, 2.3 % sampling, and the same excess


def test_the_error_grows_with_the_memory_of_the_record(rng):
    """Neighbouring blocks of correlation c are worth (1 - c)/(1 + c): an AR(1) record has its known error of the mean."""
    c, count, cells = 0.5, 24, 400
    noise = rng.normal(size=(count, cells)) * np.sqrt(1 - c * c)
    record = np.empty((count, cells))
    record[0] = rng.normal(size=cells)
    for k in range(1, count):
        record[k] = c * record[k - 1] + noise[k]
    error, independent = standard_error(record)
    assert independent == pytest.approx(count * (1 - c) / (1 + c), rel=0.1)  # the bias of c in a short record is taken out to first order
    assert np.sqrt(np.mean(error**2)) == pytest.approx(record.mean(axis=0).std(), rel=0.1)


def test_few_blocks_count_as_they_are_and_one_tells_nothing():
    error, independent = standard_error(np.array([[1.0], [3.0]]))
    assert error[0] == pytest.approx(1.0)
    assert independent == 2.0
    error, independent = standard_error(np.array([[1.0]]))
    assert np.isnan(error).all()
    assert independent == 1.0


def test_axes_are_averaged_as_axes():
    """Axes at 89 and -89 degrees are two degrees apart."""
    record = np.deg2rad([[89.0], [-89.0], [89.0], [-89.0]])
    error, _ = standard_error(record, axis=True)
    assert np.rad2deg(error[0]) == pytest.approx(np.std([1, -1, 1, -1], ddof=1) / 2, rel=1e-9)


def test_the_error_of_an_angle_is_that_of_an_axis():
    """Grains pressed along 89 and -89 degrees by turns: the field of the average has the small error."""

    def pressed(angle):
        normal = np.array([np.cos(np.deg2rad(angle)), np.sin(np.deg2rad(angle))])
        return make([[0, 0]], [1.0], [(0, -1)], [-normal], point=[normal])

    data = average([pressed(angle) for angle in (89, -89, 89, -89)], fields="stress_angle")
    assert abs(float(data.stress_angle)) == pytest.approx(np.pi / 2)
    assert np.rad2deg(float(data.stress_angle_error)) == pytest.approx(np.std([1, -1, 1, -1], ddof=1) / 2, rel=1e-9)


def test_blocks_of_a_given_size_are_not_joined():
    blocks = TimeBlocks(size=1)
    for value in range(MOST_BLOCKS + 5):
        blocks.add({"x": np.array([float(value)])})
    assert [part["x"][0] for part in blocks.means()] == list(range(MOST_BLOCKS + 5))


def test_a_run_and_its_file_give_the_same_averages(tmp_path):
    """A run is averaged over the frames of its steady state; so is the file that it was saved to."""
    run = ag.SimpleShear(n=200, strain=1.0, discard=0.4, inertial_number=0.05, frames=12, seed=3).run()
    assert len(run.frames) == 12
    assert all(a.time < b.time for a, b in zip(run.frames[:-1], run.frames[1:], strict=True))
    data = average(run, fields=["stress", "fabric", "shear_rate", "stress_angle", "rate_to_stress_angle"], least_contacts=2)
    rate = run.series.strain[-1] / run.series.time[-1]
    # the grains follow the walls of the cell on average; at twelve moments six seeds gave 0.93 to 1.09 of the rate
    assert float(data.shear_rate) == pytest.approx(float(rate), rel=0.2)
    assert 0 < float(data.rate_to_stress_angle_error) < 0.2
    for name in ("stress", "fabric"):
        assert 0 < data[name].attrs["independent_blocks"] <= 12  # a run so short may hold less than one
        assert (data[f"{name}_error"] > 0).all()
    run.save(tmp_path / "shear.h5")
    xr.testing.assert_identical(average(run), average(ag.open(tmp_path / "shear.h5")))


def test_contacts_that_bear_nothing_are_left_out():
    pairs, forces = [[0, 1], [1, 2], [0, 2]], [[3.0, 4.0], [0.0, 4.9e-3], [0.0, 5.0]]  # of 3.335 in the mean: the second 1.5e-3 of it
    snapshot = make([[0, 0], [1, 0], [2, 0]], [0.5] * 3, pairs, forces)
    assert snapshot.bearing(1e-3).pairs.tolist() == pairs
    bearing = snapshot.bearing(2e-3)
    assert bearing.pairs.tolist() == [pairs[0], pairs[2]]
    assert bearing.force.tolist() == [forces[0], forces[2]]
    assert (len(bearing.point), len(bearing.overlap), len(bearing.position)) == (2, 2, 3)
    assert len(make([[0, 0]], [0.5], [], []).bearing(1e-3).pairs) == 0


def test_without_frames_the_last_snapshot_stands_for_the_run():
    early, late = make([[0, 0]], [1.0], [], [], time=1.0), make([[0, 0]], [1.0], [], [], time=2.0)
    assert frames({"end": late, "start": early}) == [late]
    assert frames({"end": late, "frame-00000002": late, "frame-00000001": early}) == [early, late]


def test_results_without_snapshots_say_so(tmp_path):
    from anisogran.files import save_results

    save_results(tmp_path / "bare.h5", {}, {})
    with pytest.raises(InputError, match="holds no snapshots"):
        average(ag.open(tmp_path / "bare.h5"))
