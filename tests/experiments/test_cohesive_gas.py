"""A free gas: momentum stays, energy goes, and only attraction makes clusters that last."""

import numpy as np
import pytest

from anisogran import CohesiveGas, Friction, Luding
from anisogran.dem import Grains, Open, Simulation

SMALL = {"n": 60, "duration": 0.08, "samples": 80, "seed": 4}


@pytest.fixture(scope="module")
def gases():
    """Runs by kc."""
    return {kc: CohesiveGas(contact=Luding(5e4, 1e5, kc, 0.1), **SMALL).run() for kc in (0.0, 4e5)}


@pytest.mark.parametrize("ratio", [0.0, 0.5, 1.0, 4.0])
def test_without_dashpots_every_pair_parts(ratio):
    """Head on, of the energy is left 1/2/(1 + kc/k2) at k1/k2 = 1/2, whatever the speed: loading 1/2, unloading 1/4, parting the rest."""
    for speed in (0.1, 1.0):
        grains = Grains([[-1e-3, 0.0], [1e-3, 0.0]], 1e-3, velocity=[[speed, 0.0], [-speed, 0.0]])
        sim = Simulation(grains, Luding(5e4, 1e5, ratio * 1e5), boundary=Open())
        before = sim.kinetic_energy()
        sim.run(2000)
        assert len(sim.snapshot().pairs) == 0
        assert sim.kinetic_energy() / before == pytest.approx(0.5 / (1 + ratio), rel=1e-2)  # the step at kinks: measured 4e-3


def test_the_gas_begins_as_told(gases):
    start = gases[0.0].snapshots["start"]
    assert np.sqrt(np.mean(np.sum(start.velocity**2, axis=1))) == pytest.approx(0.5, rel=1e-12)
    assert np.pi * np.sum(start.radius**2) / start.volume == pytest.approx(0.2, rel=1e-12)
    np.testing.assert_array_equal(start.velocity, gases[4e5].snapshots["start"].velocity)
    assert int(gases[0.0].series.fragments[0]) == 60


def test_momentum_is_conserved(gases):
    """It is zero all the time, but for rounding."""
    for run in gases.values():
        for snapshot in run.snapshots.values():
            momentum = snapshot.mass @ snapshot.velocity
            start = run.snapshots["start"]
            assert np.abs(momentum).max() < 1e-12 * np.sum(start.mass * np.hypot(*start.velocity.T))


def test_energy_never_grows(gases):
    for run in gases.values():
        energy = (run.series.kinetic_energy + run.series.elastic_energy).values
        assert np.diff(energy).max() < 1e-5 * energy[0]  # what the time step adds at the kinks of the law
        assert energy[-1] < 0.2 * energy[0]
        np.testing.assert_allclose(run.series.granular_temperature, run.series.kinetic_energy / 60, rtol=1e-12)


def test_the_temperature_is_that_of_translation():
    """With friction grains turn, and the kinetic energy contains that; in two dimensions T is the mean of m v_x^2 and m v_y^2."""
    run = CohesiveGas(friction=Friction(2e4, 0.5), **SMALL | {"duration": 0.02}).run()
    end, last = run.snapshots["end"], run.series.isel(time=-1)
    assert float(last.granular_temperature) == pytest.approx(np.mean(0.5 * end.mass * np.sum(end.velocity**2, axis=1)), rel=1e-12)
    assert float(last.kinetic_energy) / 60 > 1.01 * float(last.granular_temperature)


def test_only_attraction_makes_clusters(gases):
    without, sticky = gases[0.0].series, gases[4e5].series
    assert int(without.fragments.min()) > 50  # only collisions of the moment
    assert float(without.largest_fragment.max()) < 0.12
    assert int(sticky.fragments[-1]) < 20
    assert float(sticky.largest_fragment[-1]) > 0.2
    assert float(sticky.mean_fragment_mass[-1]) == pytest.approx(gases[4e5].snapshots["end"].mass.sum() / int(sticky.fragments[-1]))


def test_snapshots_are_spread_over_the_run(gases):
    names = sorted(gases[0.0].snapshots)
    assert names == ["end", *(f"frame-{k:08d}" for k in range(10, 81, 10)), "start"]
    assert set(CohesiveGas(**SMALL | {"n": 20, "duration": 1e-3}, frames=0).run().snapshots) == {"start", "end"}
