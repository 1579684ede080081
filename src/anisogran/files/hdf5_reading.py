"""The bytes that `hdf5_writing` makes, back as labelled data; everything else that HDF5 can be is refused before it is read.

HDF5 can name other files (external links, external storage, virtual datasets), unpack to any size, run filters and go round in circles.
The files written here do none of this, so a file that does was forged: it is refused by its first object that is not plain.
"""

import io
from math import prod

import h5py
import numpy as np
import xarray as xr
from h5py import h5a, h5d, h5g, h5l, h5o, h5s, h5t

from anisogran.files.hdf5_writing import NUMBERS, ONLY_A_DIMENSION

DEEPEST = 8  # groups within groups
MOST_OBJECTS = 100_000
POINTERS = ("CLASS", "DIMENSION_LIST", "REFERENCE_LIST")  # attributes by which other programs find dimensions; here they have numbers


class NotPlain(ValueError):
    """The file holds something that `hdf5_writing` never writes; the message names it."""


def read_tree(content):
    """{"/group": Dataset} of the bytes of a file; the Dataset "/" has the attributes of its root.

    Raises NotPlain for what is refused, and whatever h5py and xarray make of bytes that are damaged. The C library of HDF5 has had faults
    that a forged file could use: open files of strangers in a sandbox only.
    """
    with h5py.File(io.BytesIO(content), "r") as file:
        reader = _Reader(len(content))
        reader.read_group(reader.opened(file.id, "/", "/"), "", 0)
        return reader.datasets


class _Reader:
    """What has been read so far, and what was used up of the limits."""

    def __init__(self, size):
        self.size = size  # bytes; no sum of what is unpacked may be larger
        self.unpacked = 0
        self.seen = set()  # addresses
        self.datasets = {}

    def read_group(self, group, path, depth):
        """A group and all within."""
        if depth > DEEPEST:
            raise NotPlain(f"{path} lies deeper than {DEEPEST} groups")
        found, sizes, dims = {}, {}, {}
        for name in self.names(group, path):
            where = f"{path}/{name}"
            opened = self.opened(group, name, where)
            if isinstance(opened, h5g.GroupID):
                self.datasets[where] = None  # keeps the order
                self.read_group(opened, where, depth + 1)
                continue
            kind, attributes = self.kind_of(opened, where), self.attributes(opened, where)
            number, axes, label = (attributes.pop(key, None) for key in ("_Netcdf4Dimid", "_Netcdf4Coordinates", "NAME"))
            if number is not None:
                dims[int(number)], sizes[name] = name, opened.shape[0] if opened.shape else 1
            if not str(label).startswith(ONLY_A_DIMENSION):
                found[name] = opened, kind, attributes, ([] if number is None else [number]) if axes is None else axes
        variables = {name: self.variable(*parts, dims, sizes, f"{path}/{name}") for name, parts in found.items()}
        attributes = self.attributes(group, path or "/")
        labels = str(attributes.pop("coordinates", "")).split()
        self.datasets[path or "/"] = xr.Dataset(variables, attrs=attributes).set_coords(labels)

    def names(self, group, path):
        """The names of what a group holds, in the order in which they were written; NotPlain for links that are not hard."""
        found = list(h5py.Group(group))
        if len(self.seen) + len(found) > MOST_OBJECTS:
            raise NotPlain(f"{path or '/'} brings it to more than {MOST_OBJECTS} variables and groups")
        for name in found:
            if group.links.get_info(name.encode()).type != h5l.TYPE_HARD:
                raise NotPlain(f"{path}/{name} is a link to another place or file")
        return found

    def opened(self, group, name, where):
        """A group or dataset that has not been met before."""
        opened = h5o.open(group, name.encode())
        if not isinstance(opened, h5g.GroupID | h5d.DatasetID):
            raise NotPlain(f"{where} is neither group nor variable")
        address = h5o.get_info(opened).addr
        if address in self.seen:
            raise NotPlain(f"{where} is another name of something that has one")
        self.seen.add(address)
        return opened

    def kind_of(self, opened, where):
        """The dtype of a dataset. Raises NotPlain where the bytes are of another kind, or are not simply in this file."""
        made = opened.get_create_plist()
        if made.get_layout() == h5d.VIRTUAL:
            raise NotPlain(f"{where} is a virtual dataset, whose values lie in other files")
        if made.get_layout() == h5d.CONTIGUOUS and made.get_external_count():
            raise NotPlain(f"{where} has its values in another file, {made.get_external(0)[0]!r}")
        if made.get_layout() != h5d.CONTIGUOUS or made.get_nfilters():
            raise NotPlain(f"{where} is stored in chunks or through filters")
        return self.kind(opened.get_type(), where)

    def variable(self, opened, kind, attributes, axes, dims, sizes, where):
        """A variable over the dimensions numbered in `axes`; of all in its group, `dims` holds the names and `sizes` the lengths."""
        size = prod(opened.shape) * kind.itemsize
        if size and size != opened.get_storage_size():
            raise NotPlain(f"{where} of shape {opened.shape} has {opened.get_storage_size()} bytes in the file")
        self.use(size, where)
        text = attributes.pop("_Encoding", None) == "utf-8" and bool(opened.shape)
        if text != (kind.kind == "S") or (text and kind.itemsize > 1):
            raise NotPlain(f"{where} is of characters that make no text")
        names = tuple(dims.get(int(axis)) for axis in np.atleast_1d(axes))
        if tuple(sizes.get(name) for name in names) != opened.shape:
            raise NotPlain(f"{where} does not have the shape of its dimensions")
        values = np.empty(opened.shape, kind)
        if size:
            opened.read(h5s.ALL, h5s.ALL, values)
        if text:
            names, values = names[:-1], np.char.decode(values.view(f"S{values.shape[-1]}")[..., 0], "utf-8")
        if attributes.pop("dtype", None) == "bool":
            values = values.astype(bool)
        return xr.Variable(names, values, attributes)

    def attributes(self, opened, where):
        """The attributes of a group or dataset."""
        found = {}
        for index in range(h5a.get_num_attrs(opened)):
            attribute = h5a.open(opened, index=index)
            name = attribute.name.decode()
            if name not in POINTERS:
                found[name] = self.attribute(attribute, f"{where}, attribute {name!r}")
        return found

    def attribute(self, attribute, where):
        """The value of one attribute; a list of one value is that value, as everywhere in netCDF."""
        kind = attribute.get_type()
        shape = attribute.shape
        count = prod(shape)
        if len(shape) > 1:
            raise NotPlain(f"{where} has more than one axis")
        number = self.kind(kind, where)
        self.use(count * number.itemsize, where)
        values = np.zeros(shape, number)
        if count:
            attribute.read(values, mtype=kind if number.kind == "S" else None)
        if number.kind == "S":
            texts = [text.decode() for text in values.flat]
            return texts[0] if count == 1 else texts
        return values.flat[0] if count == 1 else values

    def kind(self, kind, where):
        """The dtype of numbers or text."""
        if isinstance(kind, h5t.TypeStringID) and not kind.is_variable_str():
            return np.dtype(f"S{kind.get_size()}")
        if isinstance(kind, h5t.TypeIntegerID | h5t.TypeFloatID) and kind.dtype.str[1:] in NUMBERS:
            return kind.dtype.newbyteorder("=")
        raise NotPlain(f"{where} is neither of numbers nor of text of a fixed length")

    def use(self, size, where):
        """Counts bytes that are unpacked."""
        self.unpacked += size
        if self.unpacked > self.size:
            raise NotPlain(f"with {where} it unpacks to more than its own {self.size} bytes")
