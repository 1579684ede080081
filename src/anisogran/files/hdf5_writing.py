"""Labelled data as the bytes of an HDF5 file that netCDF-4 programs read, xarray among them.

Written with h5py's low-level calls: xarray and h5netcdf take twenty times as long for the many small arrays of snapshots. Everything that
is written is as plain as it can be, so that the reader can refuse whatever is not: no filters, no chunks, hard links only, and text as
arrays of its bytes in UTF-8 (netCDF's characters), never as pointers to where it lies.
"""

import io
from itertools import count

import h5py
import numpy as np
from h5py import h5a, h5d, h5ds, h5g, h5p, h5s, h5t

NUMBERS = frozenset(f"{kind}{size}" for kind in "iu" for size in (1, 2, 4, 8)) | {"f4", "f8"}
CHARACTER = h5t.py_create(np.dtype("S1"))
SCALAR = h5s.create(h5s.SCALAR)
ONLY_A_DIMENSION = "This is a netCDF dimension but not a netCDF variable."  # the words of the netCDF-4 format
RESERVED = ("missing_value", "scale_factor", "add_offset", "dtype", "coordinates", "CLASS", "NAME")  # attributes that say how to read it

_DATASET, _GROUP = h5p.create(h5p.DATASET_CREATE), h5p.create(h5p.GROUP_CREATE)
for _kind in (_DATASET, _GROUP):
    _kind.set_obj_track_times(False)  # the same data make the same bytes
_GROUP.set_link_creation_order(h5p.CRT_ORDER_TRACKED | h5p.CRT_ORDER_INDEXED)  # variables come back in their order


def tree_bytes(datasets, attributes, room=0):
    """A BytesIO with the file of the Datasets by "group/name" and of the attributes (a dict) at its root, and `room` bytes more.

    Raises TypeError, naming group and variable, for what the format does not hold: objects, dates, complex numbers.
    """
    stream = io.BytesIO()
    with h5py.File(stream, "w", track_order=True, libver=("v108", "v110")) as file:
        dimensions = count()
        _write_attributes(file.id, attributes, "/")
        for name, dataset in datasets.items():
            if {"", ".", ".."} & set(name.split("/")):
                raise TypeError(f"group {name!r} has no plain name")
            if any(name.startswith(f"{other}/") and outer.variables for other, outer in datasets.items()):
                raise TypeError(f"group {name!r} lies in a group with variables, which xarray would hand down")
            try:
                _write_dataset(_group(file.id, name), dataset, dimensions)
            except TypeError as error:
                raise TypeError(f"group {name!r}: {error}") from None
    stream.seek(0, io.SEEK_END)
    stream.write(bytes(room))
    return stream


def _group(group, name):
    """The group of that name, made with all those it lies in."""
    for part in name.encode().split(b"/"):
        group = h5g.open(group, part) if group.links.exists(part) else h5g.create(group, part, gcpl=_GROUP)
    return group


def _write_dataset(group, dataset, dimensions):
    """The variables of a Dataset into a group; `dimensions` counts those of the whole file."""
    labels = [name for name in dataset.coords if name not in dataset.dims]
    for name in labels:
        if len(str(name).split()) != 1:
            raise TypeError(f"{name!r} is a coordinate with a space in its name")
    named = {"coordinates": " ".join(labels)} if labels else {}
    _write_attributes(group, dataset.attrs, "attributes", named)
    plain = {name: _plain(variable, f"variable {name!r}") for name, variable in dataset.variables.items()}
    for dims in (dims for name, (dims, _, _) in plain.items() if dims != dataset.variables[name].dims):
        if dims[-1] in dataset.sizes or dims[-1] in plain:
            raise TypeError(f"{dims[-1]!r} is a name that its texts need for the number of their characters")
    sizes = {dim: size for dims, values, _ in plain.values() for dim, size in zip(dims, values.shape, strict=True)}
    scales, numbers = {}, {dim: next(dimensions) for dim in sizes}
    for dim, size in sizes.items():
        if dim in plain:
            scales[dim] = _write_variable(group, dim, plain[dim][1])
            label = dim
        else:
            scales[dim] = h5d.create(group, _name(dim), h5t.IEEE_F32BE, h5s.create_simple((size,)), _DATASET)
            label = f"{ONLY_A_DIMENSION}{size:10d}"
        h5ds.set_scale(scales[dim], label.encode())
        _write_attribute(scales[dim], "_Netcdf4Dimid", np.int32(numbers[dim]))
    for name, (dims, values, told) in plain.items():
        written = scales.get(name) or _write_variable(group, name, values)
        _write_attributes(written, dataset.variables[name].attrs, f"variable {name!r}", told)
        if dims and dims != (name,):
            _write_attribute(written, "_Netcdf4Coordinates", np.array([numbers[dim] for dim in dims], np.int32))
        if name not in scales:
            for axis, dim in enumerate(dims):
                h5ds.attach_scale(written, scales[dim], axis)


def _plain(variable, where):
    """(dims, values, attributes) by which netCDF says what is no number, as xarray does it: bool as bytes, text as characters."""
    values = variable.values
    if values.dtype == bool:
        return variable.dims, values.astype("i1"), {"dtype": "bool"}
    if values.dtype.kind in "UOT":
        texts = _encoded(values, where)
        characters = texts.reshape(*texts.shape, 1).view("S1")
        return (*variable.dims, f"string{characters.shape[-1]}"), characters, {"_Encoding": "utf-8"}
    if values.dtype.str[1:] not in NUMBERS:
        raise TypeError(f"{where} has dtype {values.dtype}, which is neither numbers nor text nor bool")
    return variable.dims, values, {}


def _write_variable(group, name, values):
    """The HDF5 dataset of plain values."""
    kind = CHARACTER if values.dtype.kind == "S" else h5t.py_create(values.dtype)
    written = h5d.create(group, _name(name), kind, h5s.create_simple(values.shape) if values.shape else SCALAR, _DATASET)
    if values.size:
        written.write(h5s.ALL, h5s.ALL, np.asarray(values, order="C"))
    return written


def _write_attributes(place, attributes, where, told=()):
    """The attributes of a group or variable, and those that tell the reader something."""
    for name, value in attributes.items():
        if name in RESERVED or str(name).startswith(("_", "DIMENSION_", "REFERENCE_")):
            raise TypeError(f"{where}: attribute {name!r} has another meaning in a netCDF-4 file")
        try:
            _write_attribute(place, name, value)
        except (TypeError, ValueError) as error:
            raise TypeError(f"{where}: attribute {name!r} = {value!r} is neither numbers nor text ({error})") from None
    for name, value in dict(told).items():
        _write_attribute(place, name, value)


def _write_attribute(place, name, value):
    """One attribute: a text, a number, or a list of such."""
    values = np.asarray(value)
    if values.ndim > 1:
        raise TypeError("more than one axis")
    space = h5s.create_simple(values.shape) if values.shape else SCALAR
    if values.dtype.kind in "UO":
        values = _encoded(np.asarray(value, dtype=object), "text")
        kind = h5t.py_create(h5py.string_dtype("utf-8", values.dtype.itemsize))
    elif values.dtype.str[1:] in NUMBERS:
        kind = h5t.py_create(values.dtype)
    else:
        raise TypeError(f"dtype {values.dtype}")
    h5a.create(place, _name(name), kind, space).write(np.asarray(values, order="C"), mtype=kind)


def _encoded(values, where):
    """An array of str as bytes in UTF-8; two at least, for one alone is taken for a character."""
    for text in values.flat:
        if not isinstance(text, str) or "\0" in text:
            raise TypeError(f"{where}: {text!r} is no text that can be kept")
    try:
        texts = [text.encode() for text in values.flat]
    except UnicodeEncodeError as error:
        raise TypeError(f"{where} is no text that can be kept: {error}") from None
    return np.array(texts, f"S{max([2, *map(len, texts)])}").reshape(values.shape)


def _name(name):
    """The name of a variable, dimension or attribute as HDF5 takes it."""
    if not isinstance(name, str) or not name or "/" in name or "\0" in name or name == ".":
        raise TypeError(f"{name!r} is no name of a variable")
    return name.encode()
