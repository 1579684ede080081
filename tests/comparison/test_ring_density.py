"""Densities of a made-up ring that obeys the law, and the outer ring that holds its grains."""

from types import SimpleNamespace

import numpy as np
import pytest
from made_up import LAW, made_up_run

from anisogran.comparison import packing, ring_edges, ring_flow

NU, SLOPE = 0.83, 0.3


def test_a_ring_that_obeys_the_law_is_found_to():
    run = made_up_run()
    flow = ring_flow(run, LAW).solve()
    nu = NU - SLOPE * np.asarray(flow.ring_average(ring_edges(run.profiles)).inertial_number)
    run.profiles["area_fraction"], run.profiles["area_fraction_error"] = ("r", nu), ("r", 1e-3 + 0 * nu)
    found = packing(run, flow, NU, SLOPE)
    np.testing.assert_allclose(found.area_fraction, nu, rtol=1e-15)
    assert found.rms < 1e-15
    run.profiles["area_fraction"] = ("r", nu + np.where(np.arange(8) == 0, 0.5, 0.01))
    assert packing(run, flow, NU, SLOPE).rms == pytest.approx(0.01)  # the first ring does not count


def test_a_looser_ring_reaches_farther():
    """Two rings of the same grains, with and without the slope: what the flow takes is a I over the area, at the density of its end."""
    run = made_up_run(wall_speed=0.4)
    flow = ring_flow(run, LAW).solve()
    run.profiles["area_fraction"] = run.profiles["area_fraction_error"] = ("r", np.zeros(8))
    dense, loose = (packing(run, flow, NU, slope).outer_radius for slope in (0.0, SLOPE))
    r = np.linspace(6.0, 15.0, 4001)
    taken = SLOPE * np.trapezoid(2 * np.pi * r * np.asarray(flow.at(r).inertial_number), r) / NU
    assert taken > 5.0
    assert np.pi * (loose**2 - dense**2) == pytest.approx(taken, rel=1e-2)  # but for I = 0.001 beyond the flow


@pytest.mark.parametrize("share", [0.7, 1.0, 1.2])
def test_the_outer_ring_holds_all_grains(share):
    """At one density everywhere: the area between the rings is that of the grains over it, also beyond the flow."""
    run = made_up_run()
    scene = run.scene
    area = share * np.pi * (15.0**2 - 6.0**2) * NU  # of the cell that was solved
    radius = np.full(600, np.sqrt(area / np.pi / 600))
    run.profiles["area_fraction"] = run.profiles["area_fraction_error"] = ("r", np.zeros(8))
    other = SimpleNamespace(
        inner_radius=scene.inner_radius, radii=lambda: (radius, None), steady=scene.steady, mean_diameter=1.0, mass=scene.mass
    )
    flow = ring_flow(run, LAW).solve()
    found = packing(SimpleNamespace(scene=other, series=run.series, profiles=run.profiles), flow, NU, 0.0)
    assert found.outer_radius == pytest.approx(np.sqrt(36.0 + share * (15.0**2 - 6.0**2)), rel=1e-6)  # trapezoids: (h/r)^2/12
    assert found.outer_radius_dem == pytest.approx(15.0)
