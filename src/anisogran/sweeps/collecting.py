"""The results of all cases of a sweep as labelled arrays with a dimension for each key that is varied."""

import json

import numpy as np
import xarray as xr

from anisogran.files import open as open_results
from anisogran.outcome import InputError
from anisogran.scenes.keys import keys_of
from anisogran.scenes.writing import scene_text
from anisogran.sweeps.cases import text_of
from anisogran.sweeps.folder import read_sweep

CASES = {  # of the state of a case, and what it says
    "state": "of the case: finished, or else its other variables are NaN",
    "message": "status of the result, or why there is none",
    "folder": "folder of the case in that of the sweep",
    "version": "anisogran that left the result",
    "fraction": "share of the work that is done",
    "grain_steps": "grains times steps",
    "seconds": "in the time loop",
}
UNITS = {"seconds": "s"}


def collect_sweep(folder):
    """The sweep in a folder as one xarray.DataTree; every group has a dimension for each key, `contact_kc` of contact.kc.

    "cases": state, message, folder, version, fraction, grain_steps and seconds of every case. "series": what the cases recorded, over
    `sample`, with `time` as a variable; shorter ones end in NaN. "profiles" and "blocks" likewise, if the experiment has them; a
    coordinate that is the same in all cases stays one, another becomes a variable; attributes that differ are left in the files. Cases
    that are not finished are NaN.

    A key that bears the name of a quantity is called after it, `pressure_asked`; one with the value none is labelled in words. Raises
    InputError if there is no sweep, no case is finished, or a file of a finished one cannot be read.
    """
    sweep = read_sweep(folder)
    states = sweep.states()
    trees = {k: open_results(sweep.path / one["case"] / "results.h5") for k, one in enumerate(states) if one["state"] == "finished"}
    if not trees:
        raise InputError(f"{folder}: none of its {len(states)} cases is finished")
    groups = list(dict.fromkeys(name for tree in trees.values() for name in tree.children if name != "snapshots"))
    tables = {group: {k: tree[group].to_dataset() for k, tree in trees.items() if group in tree.children} for group in groups}
    recorded = {name for parts in tables.values() for data in parts.values() for name in [*data.variables, *data.dims]}
    axes = axes_of(sweep, recorded | {"sample", *CASES})
    shape, places = tuple(map(len, sweep.vary.values())), places_of(sweep)
    version = {k: str(tree.attrs["anisogran"]) for k, tree in trees.items()}
    rows = [{**one, "folder": one["case"], "version": version.get(k, "")} for k, one in enumerate(states)]
    variables = {name: (list(axes), filled([one[name] for one in rows], places, shape), told(name)) for name in CASES}
    collected = {"cases": xr.Dataset(variables, axes)}
    collected |= {group: joined(parts, places, shape, axes) for group, parts in tables.items()}
    attributes = {"experiment": sweep.scene.kind, "scene": scene_text(sweep.scene), "vary": json.dumps(sweep.vary)}
    return xr.DataTree.from_dict({"/": xr.Dataset(attrs=attributes), **{f"/{name}": data for name, data in collected.items()}})


def told(name):
    """Attributes of a variable of the cases."""
    return {"units": UNITS.get(name, "1"), "long_name": CASES[name]}


def axes_of(sweep, recorded):
    """{name: coordinate} of the varied keys, with unit and meaning as in a scene file; no name is one of those recorded."""
    axes = {}
    for key, values in sweep.vary.items():
        name = key.replace(".", "_")
        while name in recorded:
            name += "_asked"
        table, _, inner = key.rpartition(".")
        records = keys_of(sweep.scene)[table].records if table else [sweep.scene]
        one = next((keys[inner] for keys in map(keys_of, records) if inner in keys), None)
        meaning = {"units": one.unit, "long_name": one.meaning} if one else {"units": "1", "long_name": "contact law"}
        texts = any(value is None or isinstance(value, str) for value in values)
        axes[name] = (name, [text_of(value) for value in values] if texts else values, {**meaning, "key": key})
    return axes


def places_of(sweep):
    """For each case its place (a tuple of indices) on the axes."""
    return [tuple(axis.index(value) for axis, value in zip(sweep.vary.values(), case, strict=True)) for case in sweep.cases.values()]


def filled(values, places, shape):
    """The values of all cases in the shape of the axes."""
    result = np.empty(shape, np.asarray(values).dtype)
    for place, value in zip(places, values, strict=True):
        result[place] = value
    return result


def joined(parts, places, shape, axes):
    """One Dataset of those of the finished cases, {number of the case: Dataset}."""
    parts = {k: as_rows(data, "time", "sample") for k, data in parts.items()}
    for name in {name for data in parts.values() for name in data.indexes} - common_coordinates(parts):
        parts = {k: as_rows(data, name, f"{name}_index") for k, data in parts.items()}
    common, first = common_coordinates(parts), next(iter(parts.values()))
    sizes = {}
    for data in parts.values():
        sizes |= {dim: max(size, sizes.get(dim, 0)) for dim, size in data.sizes.items()}
    variables = {}
    for name in dict.fromkeys(name for data in parts.values() for name in data.variables if name not in common):
        those = [data[name] for data in parts.values() if name in data.variables]
        dims, attributes = (*axes, *those[0].dims), common_attributes(those)
        variables[name] = (dims, stacked(name, those[0], parts, places, shape, sizes), attributes)
    return xr.Dataset(variables, axes | {name: first[name].variable for name in common}, common_attributes(list(parts.values())))


def common_attributes(those):
    """The attributes that are the same in all of some Datasets or variables."""
    first, *others = (one.attrs for one in those)
    return {key: value for key, value in first.items() if all(key in one and np.array_equal(one[key], value) for one in others)}


def as_rows(data, name, dim):
    """The Dataset with its coordinate `name`, if it has one, as a variable over `dim`."""
    return data.reset_index(name).reset_coords(name).rename_dims({name: dim}) if name in data.indexes else data


def common_coordinates(parts):
    """The names of the coordinates that are the same in all parts."""
    first, *others = parts.values()
    return {
        name for name in first.coords if all(name in data.coords and first[name].variable.identical(data[name].variable) for data in others)
    }


def stacked(name, like, parts, places, shape, sizes):
    """The values of one variable in all cases, NaN (or an empty text) where there are none."""
    inner = tuple(sizes[dim] for dim in like.dims)
    numbers = like.dtype.kind in "fiub"
    result = np.full(shape + inner, np.nan) if numbers else np.full(shape + inner, "", dtype=object)
    for k, data in parts.items():
        if name in data.variables:
            values = data[name].transpose(*like.dims).values
            result[(*places[k], *(slice(size) for size in values.shape))] = values
    return result if numbers else result.astype(str)
