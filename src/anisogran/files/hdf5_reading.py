"""The bytes that `hdf5_writing` makes, back as labelled data; everything else that HDF5 can be is refused before it is read.

HDF5 can name other files (external links, external storage, virtual datasets), unpack to any size, run filters and go round in circles.
The files written here do none of this, so a file that does was forged: it is refused by its first object that is not plain.
"""

import io

import h5py
import numpy as np
import xarray as xr
from h5py import h5a, h5d, h5g, h5l, h5o, h5s, h5t

from anisogran.files.hdf5_writing import NUMBERS, ONLY_A_DIMENSION, STR

DEEPEST = 8  # groups within groups
MOST_OBJECTS = 100_000
MOST_TEXTS = 1000  # in the list of one attribute
OF_THE_FORMAT = ("CLASS", "DIMENSION_LIST", "REFERENCE_LIST", "_Netcdf4Dimid", "_Netcdf4Coordinates", "NAME")  # attributes of no meaning


class NotPlain(ValueError):
    """The file holds something that `hdf5_writing` never writes; the message names it."""


def read_tree(content):
    """({"/group": Dataset}, attributes of the root) of the bytes of a file.

    Raises NotPlain for what is refused, and whatever h5py and xarray make of bytes that are damaged. The C library of HDF5 has had faults
    that a forged file could use: open files of strangers in a sandbox only.
    """
    with h5py.File(io.BytesIO(content), "r") as file:
        reader = _Reader(len(content))
        reader.read_group(h5g.open(file.id, b"/"), "", 0)
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
        variables, sizes, numbers, waiting = {}, {}, {}, []
        for name in self.names(group, path):
            where = f"{path}/{name}"
            opened = self.opened(group, name, where)
            if isinstance(opened, h5g.GroupID):
                self.datasets[where] = None  # keeps the order
                self.read_group(opened, where, depth + 1)
                continue
            self.check_dataset(opened, where)
            attributes = self.attributes(opened, where)
            number, axes, label = (attributes.pop(key, None) for key in ("_Netcdf4Dimid", "_Netcdf4Coordinates", "NAME"))
            if number is None:
                waiting.append((name, opened, where, attributes, np.atleast_1d([] if axes is None else axes)))
                continue
            if len(opened.shape) != 1:
                raise NotPlain(f"{where} is the scale of more than one dimension")
            sizes[name], numbers[int(number)] = opened.shape[0], name
            if not str(label).startswith(ONLY_A_DIMENSION):
                variables[name] = self.variable(opened, where, (name,), attributes)
        for name, opened, where, attributes, axes in waiting:
            dims = tuple(numbers[int(axis)] for axis in axes)
            if tuple(sizes[dim] for dim in dims) != opened.shape:
                raise NotPlain(f"{where} does not have the shape of its dimensions")
            variables[name] = self.variable(opened, where, dims, attributes)
        attributes = self.attributes(group, path or "/")
        labels = str(attributes.pop("coordinates", "")).split()
        self.datasets[path or "/"] = xr.Dataset(variables, attrs=attributes).set_coords(labels)

    def names(self, group, path):
        """The names of what a group holds, in the order in which they were written; InputError for links that are not hard."""
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

    def check_dataset(self, opened, where):
        """Raises NotPlain for a dataset whose bytes are not simply in this file."""
        made = opened.get_create_plist()
        if made.get_layout() == h5d.VIRTUAL:
            raise NotPlain(f"{where} is a virtual dataset, whose values lie in other files")
        if made.get_layout() == h5d.CONTIGUOUS and made.get_external_count():
            raise NotPlain(f"{where} has its values in another file, {made.get_external(0)[0]!r}")
        if made.get_layout() != h5d.CONTIGUOUS or made.get_nfilters():
            raise NotPlain(f"{where} is stored in chunks or through filters")

    def variable(self, opened, where, dims, attributes):
        """The variable of a dataset; the bytes that it has in the file are those that it will take."""
        kind = self.kind(opened.get_type(), where)
        count = int(np.prod(opened.shape, dtype=object))
        itemsize = 16 if kind is None else kind.itemsize
        if count and count * itemsize != opened.get_storage_size():
            raise NotPlain(f"{where} of shape {opened.shape} has {opened.get_storage_size()} bytes in the file")
        self.use(count * itemsize, where)
        if kind is not None:
            values = np.empty(opened.shape, kind)
            if count:
                opened.read(h5s.ALL, h5s.ALL, values)
        else:
            values = self.texts(opened, where)
        if attributes.get("dtype") == "bool":
            values = values.astype(bool)
            del attributes["dtype"]
        return xr.Variable(dims, values, attributes)

    def texts(self, opened, where):
        """An array of texts, one by one: many of them could be the same large one."""
        values, space, one = np.empty(opened.shape, object), opened.get_space(), np.empty((1,), object)
        for place in np.ndindex(values.shape):
            if place:
                space.select_hyperslab(place, (1,) * len(place))
            opened.read(h5s.create_simple((1,)), space, one, STR)
            values[place] = self.text(one[0], where)
        return values

    def text(self, raw, where):
        """As str, and counted."""
        self.use(len(raw), where)
        return raw.decode() if isinstance(raw, bytes) else str(raw)

    def attributes(self, opened, where):
        """The attributes of a group or dataset; as scalars where there is one value, for the format knows no others."""
        found = {}
        for index in range(h5a.get_num_attrs(opened)):
            attribute = h5a.open(opened, index=index)
            name = attribute.name.decode()
            if name not in OF_THE_FORMAT[:3]:
                found[name] = self.attribute(attribute, f"{where}, attribute {name!r}")
        return found

    def attribute(self, attribute, where):
        """The value of one attribute."""
        kind = attribute.get_type()
        shape = attribute.shape
        count = int(np.prod(shape, dtype=object))
        if len(shape) > 1:
            raise NotPlain(f"{where} has more than one axis")
        if isinstance(kind, h5t.TypeStringID) and not kind.is_variable_str():
            self.use(count * kind.get_size(), where)
            raw = np.empty(shape, f"S{kind.get_size()}")
            attribute.read(raw, mtype=kind)
            return raw.reshape(-1)[0].decode()
        number = self.kind(kind, where)
        if number is None:
            if count > MOST_TEXTS:
                raise NotPlain(f"{where} is a list of {count} texts, more than {MOST_TEXTS}")
            raw = np.empty(shape, object)
            attribute.read(raw, mtype=STR)
            texts = [self.text(part, where) for part in raw.flat]
            return texts if shape and count != 1 else texts[0]
        self.use(count * number.itemsize, where)
        values = np.empty(shape, number)
        if count:
            attribute.read(values)
        return values.reshape(-1)[0] if count == 1 else values

    def kind(self, kind, where):
        """The dtype of numbers, or None of text."""
        if isinstance(kind, h5t.TypeStringID) and kind.is_variable_str():
            return None
        if isinstance(kind, h5t.TypeIntegerID | h5t.TypeFloatID) and kind.dtype.str[1:] in NUMBERS:
            return kind.dtype.newbyteorder("=")
        raise NotPlain(f"{where} is neither of numbers nor of text")

    def use(self, size, where):
        """Counts bytes that are unpacked."""
        self.unpacked += size
        if self.unpacked > self.size:
            raise NotPlain(f"with {where} it unpacks to more than its own {self.size} bytes")
