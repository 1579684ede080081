"""Thin layers about the axis: who is in which, and fields that are known in closed form."""

import numpy as np
import pytest
from clusters import make

from anisogran.averaging import layer_fields, layer_sums

EDGES = np.linspace(4.0, 8.0, 41)


def test_a_grain_counts_whole_where_its_centre_is():
    snapshot = make(
        [[0.0, 4.55], [-5.05, 0.0], [3.0, 0.0], [9.0, 0.0], [0.0, -4.55]], np.full(5, 0.5), [], [],
        velocity=[[-2.0, 7.0], [1.0, -3.0], [1.0, 1.0], [1.0, 1.0], [4.0, 0.0]], spin=[0.5, 0.25, 1.0, 1.0, 0.7], fixed=[0, 0, 0, 0, 1],
    )  # fmt: skip
    sums = layer_sums(snapshot, EDGES)
    expected = {"layer_grains": (1, 1), "layer_v_phi": (2.0, 3.0), "layer_spin": (0.5, 0.25)}
    for name, (first, second) in expected.items():
        assert len(sums[name]) == 40
        assert sums[name][5] == pytest.approx(first)
        assert sums[name][10] == pytest.approx(second)
        assert sums[name].sum() == pytest.approx(first + second)


def test_couette_flow(rng):
    """v = a r + b/r: the continuum spins with a everywhere; grains that spin with c have the eigen-rotation c - a."""
    a, b, c, count = 0.3, 2.0, 0.1, 60_000
    r, phi = np.sqrt(rng.uniform(4.0**2, 8.0**2, count)), rng.uniform(0, 2 * np.pi, count)
    r[(r > 6.0) & (r < 6.1)] = 7.05  # one layer that no grain visits
    along = np.stack([-np.sin(phi), np.cos(phi)], axis=1)
    snapshot = make(
        r[:, None] * np.stack([np.cos(phi), np.sin(phi)], axis=1), np.full(count, 0.5), [], [], velocity=(a * r + b / r)[:, None] * along,
        spin=np.full(count, c),
    )  # fmt: skip
    fields = layer_fields(layer_sums(snapshot, EDGES), EDGES, 1.0)
    seen = np.arange(40) != 20
    middle = 0.5 * (EDGES[1:] + EDGES[:-1])
    np.testing.assert_allclose(fields["v_phi"][seen], (a * middle + b / middle)[seen], atol=3e-3)  # where in a layer the grains are
    np.testing.assert_allclose(fields["continuum_spin"][seen], a, atol=0.01)  # their scatter again, over a window of one
    np.testing.assert_allclose(fields["eigen_rotation"][seen], c - a, atol=0.01)
    assert fields["number_density"][20] == 0
    assert all(np.isnan(fields[name][20]) for name in ("v_phi", "spin", "continuum_spin", "eigen_rotation"))
    assert np.sum(fields["number_density"] * np.pi * np.diff(EDGES**2)) == pytest.approx(count)


def test_too_few_layers_tell_no_slope():
    sums = {"layer_grains": np.r_[np.ones(3), np.zeros(37)], "layer_v_phi": np.zeros(40), "layer_spin": np.zeros(40)}
    fields = layer_fields(sums, EDGES, 1.0)
    np.testing.assert_array_equal(fields["v_phi"][:3], 0.0)
    assert np.isnan(fields["eigen_rotation"]).all()
