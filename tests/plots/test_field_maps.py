"""A map shows each value at its place: scalars by colour, tensors by their principal axes."""

import numpy as np
import pytest
import xarray as xr
from matplotlib.collections import LineCollection

from anisogran import plots, tensors
from anisogran.averaging import average
from anisogran.glossary import attributes
from anisogran.outcome import InputError
from anisogran.snapshot import Snapshot


def plane(**fields):
    """A Dataset on 2 x 3 cells of the width 1 and 2, from arrays by name."""
    variables = {name: ((*"ij"[: array.ndim - 2], "x", "y"), array, attributes(name)) for name, array in fields.items()}
    return xr.Dataset(variables, {"x": [0.5, 1.5], "y": [1.0, 3.0, 5.0]}, {"x_edges": np.arange(3.0), "y_edges": 2 * np.arange(4.0)})


def crosses(fig):
    """The segments (n, 2, 2) of each colour, and the text of its legend."""
    (axes,) = fig.axes
    lines = [np.array(c.get_segments()) for c in axes.collections if isinstance(c, LineCollection)]
    return lines, [text.get_text() for text in axes.get_legend().texts], axes.get_legend().get_title().get_text()


def uniform(t):
    return np.tile(np.asarray(t, dtype=float)[:, :, None, None], (1, 1, 2, 3))


def test_a_scalar_is_a_colour_in_each_cell(tmp_path):
    value = np.array([[1.0, 2.0, np.nan], [4.0, 5.0, 6.0]])
    fig = plots.field_map(plane(pressure=value), "pressure", "pressures")
    axes, bar = fig.axes
    (mesh,) = axes.collections
    shown = mesh.get_array()
    np.testing.assert_array_equal(shown.filled(-1.0), [[1.0, 4.0], [2.0, 5.0], [-1.0, 6.0]])  # a row for each y
    np.testing.assert_array_equal(mesh.get_coordinates()[:, 0, 1], [0, 2, 4, 6])
    np.testing.assert_array_equal(mesh.get_coordinates()[0, :, 0], [0, 1, 2])
    assert bar.get_ylabel() == "$p$ [N/m]"
    assert (axes.get_xlabel(), axes.get_ylabel(), axes.get_aspect()) == ("$x$ [m]", "$y$ [m]", 1.0)
    assert mesh.to_rgba(shown)[2, 0, 3] == 0  # blank
    fig.savefig(tmp_path / "scalar.png")


def test_the_order_of_the_dimensions_does_not_matter():
    dataset = plane(pressure=np.arange(6.0).reshape(2, 3), stress=np.random.default_rng(1).random((2, 2, 2, 3)))
    for turned in (dataset, dataset.transpose("y", "x", "j", "i")):
        np.testing.assert_array_equal(plots.field_map(turned, "pressure").axes[0].collections[0].get_array(), [[0, 3], [1, 4], [2, 5]])
    for one, other in zip(*(crosses(plots.field_map(d, "stress"))[0] for d in (dataset, dataset.transpose(..., "j", "i"))), strict=True):
        np.testing.assert_array_equal(one, other)


def test_colours_are_symmetric_about_zero_or_go_around_the_circle_where_that_is_meant():
    def limits(rename=None, **fields):
        ((name, _),) = fields.items()
        dataset = plane(**fields)
        mesh = plots.field_map(dataset.rename({name: rename or name}), rename or name).axes[0].collections[0]
        return mesh.get_clim(), mesh.get_cmap().name

    both = np.array([[1.0, -3.0, 2.0], [0.0, 0.5, np.nan]])
    assert limits(spin=both) == ((-3.0, 3.0), "RdBu")
    assert limits(spin=np.abs(both)) == ((0.0, 3.0), "viridis")
    assert limits(stress_angle=0.1 * both) == ((-np.pi / 2, np.pi / 2), "twilight")
    assert limits(stress_angle=np.abs(both), rename="stress_angle_error") == ((0.0, 3.0), "viridis")  # no angle itself


def test_an_axis_of_a_tensor_is_as_long_as_its_eigenvalue_and_points_along_it():
    """Eigenvalues 2 along 30 degrees and -1 across, everywhere: the longest is nearly as long as the narrower side of a cell."""
    t = tensors.rotate(np.diag([2.0, -1.0]), np.pi / 6)
    (pressed, pulled), texts, title = crosses(plots.field_map(plane(stress=uniform(t)), "stress"))
    assert texts == ["compression, up to 2", "tension, up to 1"]
    assert title == r"$\sigma$ [N/m]"
    for lines, length, angle in ((pressed, 0.95, np.pi / 6), (pulled, 0.475, np.pi / 6 + np.pi / 2)):
        arm = lines[:, 1] - lines[:, 0]
        np.testing.assert_allclose(arm, np.tile(length * np.array([np.cos(angle), np.sin(angle)]), (6, 1)), atol=1e-12)  # rounding
        middles = [(x, y) for x in (0.5, 1.5) for y in (1.0, 3.0, 5.0)]
        np.testing.assert_allclose(lines.mean(axis=1), middles, rtol=1e-12)  # rounding


def test_a_cell_without_a_tensor_is_left_blank():
    t = uniform(np.diag([2.0, 1.0]))
    t[0, 1, 1, 2] = np.nan
    t[:, :, 0, 0] = [[0.0, 0.0], [0.0, -1e-16]]  # rounding is no tension
    (lines,), texts, _ = crosses(plots.field_map(plane(fabric=t), "fabric"))
    assert len(lines) == 2 * 4
    assert not (lines.mean(axis=1) == [1.5, 5.0]).all(axis=1).any()
    assert texts == ["positive, up to 2"]


def test_the_antisymmetric_part_has_no_axes():
    spin = np.array([[0.0, 5.0], [-5.0, 0.0]])
    (bare,), *_ = crosses(plots.field_map(plane(stress=uniform(np.diag([2.0, 1.0]))), "stress"))
    (with_spin,), *_ = crosses(plots.field_map(plane(stress=uniform(np.diag([2.0, 1.0]) + spin)), "stress"))
    np.testing.assert_array_equal(bare, with_spin)


def test_a_field_of_nothing_is_an_empty_map(tmp_path):
    nothing = np.full((2, 2, 2, 3), np.nan)
    for k, (dataset, name, text) in enumerate(
        ((plane(stress=nothing), "stress", "unknown"), (plane(stress=0 * uniform(np.eye(2))), "stress", "= 0"))
    ):
        fig = plots.field_map(dataset, name)
        lines, _, title = crosses(fig)
        assert lines == []
        assert title.endswith(text)
        fig.savefig(tmp_path / f"{k}.png")
    fig = plots.field_map(plane(pressure=nothing[0, 0]), "pressure")
    assert fig.axes[0].collections[0].get_array().mask.all()
    fig.savefig(tmp_path / "scalar.png")


def lattice():
    """A square lattice of unit discs with the pressure 1 between them, in a periodic cell of 4 x 6."""
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(4) + 0.5, np.arange(6) + 0.5, indexing="ij"))
    position, number = np.stack([x, y], axis=1), np.arange(24).reshape(4, 6)
    right, up = (np.stack([number.ravel(), np.roll(number, -1, axis).ravel()], axis=1) for axis in (0, 1))
    along = np.repeat([[1.0, 0.0], [0.0, 1.0]], 24, axis=0)
    pairs = np.concatenate([right, up])
    rest = {"radius": np.full(24, 0.5), "mass": np.ones(24), "velocity": np.zeros((24, 2)), "spin": np.zeros(24), "overlap": np.zeros(48)}
    return Snapshot(position, pairs=pairs, force=-along, point=position[pairs[:, 0]] + 0.5 * along, cell=[4.0, 6.0], **rest)


@pytest.mark.parametrize("kernel", [None, "lucy"])
def test_what_average_returns_on_a_grid_is_mapped(kernel):
    """Time means with errors; under isotropic pressure all arms are equally long."""
    dataset = average([lattice()] * 3, on="grid", width="2.0d", kernel=kernel, fields=["pressure", "stress"])
    axes, bar = plots.field_map(dataset, "pressure").axes
    np.testing.assert_allclose(axes.collections[0].get_array(), 1.0, atol=0.05)  # the lattice on a kernel as wide as two of its steps
    np.testing.assert_allclose(axes.collections[0].get_coordinates()[-1, -1], [4.0, 6.0])
    (lines,), _, _ = crosses(plots.field_map(dataset, "stress"))
    np.testing.assert_allclose(np.hypot(*(lines[:, 1] - lines[:, 0]).T), 1.9, rtol=0.02)  # the kernel, as above
    _, bar = plots.field_map(dataset, "pressure_error").axes
    assert bar.get_ylabel() == "standard error of $p$ [N/m]"


def test_a_part_of_a_map_keeps_its_place():
    """The borders in the attributes are those of the whole grid."""
    dataset = plane(pressure=np.arange(6.0).reshape(2, 3))
    axes = plots.field_map(dataset.isel(y=slice(1, None)), "pressure").axes[0]
    assert axes.get_ylim() == (2.0, 6.0)
    mesh = plots.field_map(dataset.isel(y=slice(None, None, -1)), "pressure").axes[0].collections[0]
    np.testing.assert_array_equal(mesh.get_array()[0], [2.0, 5.0])
    np.testing.assert_array_equal(mesh.get_coordinates()[:, 0, 1], [6, 4, 2, 0])
    dataset = plane(stress=np.random.default_rng(1).random((2, 2, 2, 3)))
    whole, turned = (crosses(plots.field_map(d, "stress"))[0] for d in (dataset, dataset.isel(y=slice(None, None, -1))))
    for one, other in zip(whole, turned, strict=True):
        assert sorted(one.tolist()) == sorted(other.tolist())


def test_what_is_no_map_is_refused():
    dataset = plane(pressure=np.ones((2, 3)), stress=uniform(np.eye(2)))
    with pytest.raises(InputError, match=r"no field 'presure' in the dataset; it has pressure, stress"):
        plots.field_map(dataset, "presure")
    box = average(lattice(), fields=["pressure"])
    with pytest.raises(InputError, match=r"pressure has the dimensions \(\); they must be \(x, y\)"):
        plots.field_map(box, "pressure")
    points = average(lattice(), on="points", points=[[1.0, 1.0]], fields=["stress"])
    with pytest.raises(InputError, match=r"\(i: 2, j: 2, point: 1\)"):
        plots.field_map(points, "stress")
    with pytest.raises(InputError, match="velocity has the dimensions"):
        plots.field_map(average(lattice(), on="grid", fields=["velocity"]), "velocity")
    with pytest.raises(InputError, match="i: 3, j: 3"):
        plots.field_map(dataset.pad(i=(0, 1), j=(0, 1)), "stress")
    with pytest.raises(InputError, match="no principal axes"):
        plots.field_map(dataset.rename(stress="stress_error"), "stress_error")
    with pytest.raises(InputError, match="no coordinate x"):
        plots.field_map(dataset.drop_vars("x"), "pressure")
    with pytest.raises(InputError, match="1 point along y has no width"):
        plots.field_map(dataset.isel(y=[0]), "pressure")
