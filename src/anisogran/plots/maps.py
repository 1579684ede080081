"""Fields over the plane: a scalar as colours, a tensor as crosses of its principal axes."""

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D

from anisogran import tensors
from anisogran.glossary import label
from anisogran.outcome import InputError
from anisogran.plots.style import COLOURS, figure

SIGNS = {  # what a positive and a negative eigenvalue mean, where they are more than that
    **dict.fromkeys(("stress", "stress_static", "stress_dynamic"), ("compression", "tension")),
    **dict.fromkeys(("strain_rate", "elastic_strain", "elastic_strain_raw"), ("compression", "extension")),
}
SIGN_COLOURS = COLOURS["dem"], COLOURS["fit"]
LONGEST = 0.95  # of the cells, from end to end
ROUNDING = 1e-9  # an eigenvalue must exceed this share of the largest, or it is zero with a sign by chance


def field_map(dataset, name, title=""):
    """A field over (x, y), as `average(..., on="grid")` returns it, as a Figure with equal axes; cells that are NaN are left blank.

    A scalar is shown as colours, those of one that has both signs symmetric about 0. A 2x2 tensor over (i, j, x, y) is shown by its
    principal axes, at the middle of each cell, as long as the eigenvalue is large, in one colour where it is positive (a stress:
    compression) and another where it is negative; the longest is as long as a cell, and the legend tells its value. Only the symmetric
    part has such axes; what else there is of the tensor is not shown. `dataset.where(dataset.area_fraction > 0.3)` blanks the cells
    that are not in the sample.
    Raises InputError if the dataset has no such field, or the field is neither a scalar nor a 2x2 tensor over (x, y).
    """
    field, edges = plane_field(dataset, name), [cell_edges(dataset, axis) for axis in "xy"]
    fig, ((axes,),) = figure(1, width=5.6, height=4.8)
    axes.set(xlim=edges[0][[0, -1]], ylim=edges[1][[0, -1]], aspect="equal", xlabel=label("x"), ylabel=label("y"))
    fig.suptitle(title)
    fig.set_layout_engine("compressed")  # a colour bar as high as axes of fixed aspect
    if field.ndim == 2:
        mesh = axes.pcolormesh(*edges, np.ma.masked_invalid(field.values.T), **colour_scale(field))
        fig.colorbar(mesh, ax=axes, label=caption(field))
    else:
        draw_crosses(axes, field, 0.5 * LONGEST * min(np.abs(np.diff(edge)).min() for edge in edges))
    return fig


def plane_field(dataset, name):
    """The field with the dims (x, y) or (i, j, x, y) in this order. Raises InputError if it is none."""
    if name not in dataset.data_vars:
        raise InputError(f"field_map: no field {name!r} in the dataset; it has {', '.join(map(str, dataset.data_vars)) or 'none'}")
    field = dataset[name]
    tensor = "i" in field.dims
    order = ("i", "j", "x", "y") if tensor else ("x", "y")
    if set(field.dims) != set(order) or field.sizes.get("i", 2) != 2 or field.sizes.get("j", 2) != 2:
        sizes = ", ".join(f"{dim}: {size}" for dim, size in field.sizes.items())
        raise InputError(f"field_map: {name} has the dimensions ({sizes}); they must be (x, y), or (i: 2, j: 2, x, y) of a tensor")
    if tensor and is_error(field):
        raise InputError(f"field_map: {name} holds errors of components, which have no principal axes; map one of them, a scalar")
    return field.transpose(*order)


def cell_edges(dataset, axis):
    """Borders of the cells along the axis: those of the grid, or halfway between points. Raises InputError if there are none."""
    if axis not in dataset.coords:
        raise InputError(f"field_map: the dataset has no coordinate {axis}")
    middle = dataset[axis].values
    edges = np.asarray(dataset.attrs.get(f"{axis}_edges", ()))
    if len(edges) == len(middle) + 1 and np.allclose(0.5 * (edges[1:] + edges[:-1]), middle):  # not if a part was chosen since
        return edges
    if len(middle) < 2:
        raise InputError(f"field_map: {len(middle)} point along {axis} has no width; a map needs two or more, or the edges of cells")
    between = 0.5 * (middle[1:] + middle[:-1])
    return np.concatenate([[2 * middle[0] - between[0]], between, [2 * middle[-1] - between[-1]]])


def is_error(field):
    return str(field.name).endswith("_error")


def colour_scale(field):
    """Colours from the lowest to the highest value; about 0 if there are both signs, around the circle if it is an angle of an axis."""
    if "period" in field.attrs and not is_error(field):
        half = 0.5 * field.attrs["period"]
        return {"cmap": "twilight", "vmin": -half, "vmax": half}
    known = field.values[np.isfinite(field.values)]
    if known.min(initial=0.0) < 0 < known.max(initial=0.0):
        largest = np.abs(known).max()
        return {"cmap": "RdBu", "vmin": -largest, "vmax": largest}
    return {"cmap": "viridis"}


def caption(field):
    """Symbol and unit, which the glossary gave the field as attributes (in space a unit is another); without them its name."""
    symbol, unit = field.attrs.get("symbol"), field.attrs.get("units", "1")
    text = field.name if symbol is None else f"${symbol}$"
    return ("standard error of " if is_error(field) and symbol else "") + text + (f" [{unit}]" if unit != "1" else "")


def draw_crosses(axes, field, longest):
    """The principal axes of a tensor (2, 2, x, y); `longest` is half the length of the longest, in m."""
    whole = np.isfinite(field.values).all(axis=(0, 1))
    t = field.values[:, :, whole]
    x, y = np.meshgrid(field.x, field.y, indexing="ij")
    angle, mean, size = tensors.principal_angle(t), tensors.mean(t), tensors.deviator_size(t)
    # the major axes of all cells, then the minor ones
    middle = np.tile(np.stack([x[whole], y[whole]], axis=1), (2, 1))
    value, turned = np.concatenate([mean + size, mean - size]), np.concatenate([angle, angle + 0.5 * np.pi])
    unit = np.stack([np.cos(turned), np.sin(turned)], axis=1)
    largest = np.abs(value).max(initial=0.0)
    handles = []
    for sense, colour, sign in zip((1, -1), SIGN_COLOURS, SIGNS.get(field.name, ("positive", "negative")), strict=True):
        shown = sense * value > ROUNDING * largest
        if shown.any():
            arm = (longest / largest * np.abs(value[shown]))[:, None] * unit[shown]
            lines = np.stack([middle[shown] - arm, middle[shown] + arm], axis=1)
            axes.add_collection(LineCollection(lines, colors=colour, linewidths=1.4, capstyle="round"))
            handles.append(Line2D([], [], color=colour, lw=1.4, label=f"{sign}, up to {np.abs(value[shown]).max():.3g}"))
    text = caption(field) + ("" if handles else " = 0" if len(middle) else " unknown")
    axes.legend(handles=handles, title=text, fontsize=8, frameon=False, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
