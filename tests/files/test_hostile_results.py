"""Forged results files: good seals upon HDF5 that names other files, unpacks without bound or goes round in circles."""

import io
import struct

import h5py
import numpy as np
import pytest
from h5py import h5d, h5p, h5s, h5t

from anisogran import InputError
from anisogran import open as open_results
from anisogran.files import hdf5_reading, save_results
from anisogran.files.results import MARK, sealed
from anisogran.whole_file import DIGITS

SECRET = b"the password is swordfish -------"


def resealed(content):
    """The bytes of an HDF5 file with our mark and a good seal behind them."""
    return bytes(sealed(bytearray(content + bytes(len(MARK) + DIGITS))))


def forged(make):
    """The sealed bytes of an HDF5 file in which `make` has been at work."""
    stream = io.BytesIO()
    with h5py.File(stream, "w") as file:
        make(file)
    return resealed(stream.getvalue())


def complaint(path, content):
    """The one line with which a file of that content is refused."""
    path.write_bytes(content)
    with pytest.raises(InputError) as caught:
        open_results(path)
    line = str(caught.value)
    assert line.startswith(f"{path}: ")
    assert "\n" not in line
    return line


def external_storage(file):
    file.create_dataset("x", (len(SECRET),), "u1", external=[("secret.txt", 0, len(SECRET))])


def virtual(file):
    layout = h5py.VirtualLayout((3,), "f8")
    layout[:] = h5py.VirtualSource("other.h5", "x", (3,))
    file.create_virtual_dataset("x", layout)


def circle(file):
    file.create_group("a")["b"] = file


def second_name(file):
    file["x"] = np.arange(3.0)
    file["y"] = file["x"]


def deep(file):
    file.create_group("/".join("abcdefghijk"))


def unknown_filter(file):
    made = h5p.create(h5p.DATASET_CREATE)
    made.set_chunk((4,))
    made.set_filter(32000, h5py.h5z.FLAG_OPTIONAL, ())
    h5d.create(file.id, b"x", h5t.NATIVE_DOUBLE, h5s.create_simple((4,)), made)


def plane_dimension(file):
    file["x"] = np.zeros((2, 2))
    file["x"].make_scale("x")
    file["x"].attrs["_Netcdf4Dimid"] = np.int32(0)


def wrong_shape(file):
    file["t"] = np.arange(3.0)
    file["t"].make_scale("t")
    file["t"].attrs["_Netcdf4Dimid"] = np.int32(0)
    file["x"] = np.arange(4.0)
    file["x"].attrs["_Netcdf4Coordinates"] = np.zeros(1, np.int32)


def put(name, value):
    return lambda file: file.__setitem__(name, value)


def label(value):
    return lambda file: file.attrs.__setitem__("note", value)


CASES = {
    "external link": (put("a/x", h5py.ExternalLink("other.h5", "/x")), "/a/x is a link to another place or file"),
    "soft link": (put("x", h5py.SoftLink("/")), "/x is a link to another place or file"),
    "external storage": (external_storage, "/x has its values in another file"),
    "virtual dataset": (virtual, "/x is a virtual dataset"),
    "circle": (circle, "/a/b is another name of something"),
    "second name": (second_name, "/y is another name of something"),
    "deep": (deep, "lies deeper than 8 groups"),
    "bomb": (lambda file: file.create_dataset("x", data=np.zeros(10**7), compression="gzip"), "/x is stored in chunks or through filters"),
    "unknown filter": (unknown_filter, "/x is stored in chunks or through filters"),
    "huge": (lambda file: file.create_dataset("x", (10**15,), "f8"), r"/x of shape (1000000000000000,) has 0 bytes in the file"),
    "huge text": (lambda file: file.create_dataset("x", (10**15,), h5py.string_dtype("utf-8", 9)), "has 0 bytes in the file"),
    "compound": (put("x", np.zeros(2, "i4,f8")), "/x is neither of numbers nor of text"),
    "references": (lambda file: file.create_dataset("x", (2,), h5py.ref_dtype), "/x is neither of numbers nor of text"),
    "enum": (lambda file: file.create_dataset("x", (2,), h5py.enum_dtype({"a": 1})), "/x is neither of numbers nor of text"),
    "lists": (lambda file: file.create_dataset("x", (2,), h5py.vlen_dtype(np.int32)), "/x is neither of numbers nor of text"),
    "opaque": (put("x", np.zeros(2, "V7")), "/x is neither of numbers nor of text"),
    "fixed text": (put("x", np.array([b"a"])), "/x is of characters that make no text"),
    "long text": (put("x", np.array([b"abc"])), "/x is of characters that make no text"),
    "pointers to text": (put("x", ["a"]), "/x is neither of numbers nor of text of a fixed length"),
    "type": (put("x", np.dtype("f8")), "/x is neither group nor variable"),
    "reference as attribute": (lambda file: file.attrs.create("note", file.ref, dtype=h5py.ref_dtype), "attribute 'note' is neither"),
    "attribute of two axes": (label(np.zeros((2, 2))), "/, attribute 'note' has more than one axis"),
    "attribute of pointers": (label("a"), "/, attribute 'note' is neither of numbers nor of text of a fixed length"),
    "dimension of two axes": (plane_dimension, "/x does not have the shape of its dimensions"),
    "wrong shape": (wrong_shape, "/x does not have the shape of its dimensions"),
    "no dimension": (put("x", np.arange(3.0)), "/x does not have the shape of its dimensions"),
    "name of two lines": (put("a\nb", h5py.SoftLink("/")), "is a link to another place or file"),
}  # fmt: skip


@pytest.mark.hard_case("S3")
@pytest.mark.parametrize("case", CASES)
def test_what_we_never_write_is_refused_by_its_place(case, tmp_path, monkeypatch, answer):
    make, message = CASES[case]
    monkeypatch.chdir(tmp_path)
    told = complaint(tmp_path / "a.h5", forged(make))
    assert message in told
    answer.refused(told)


@pytest.mark.hard_case("S3")
def test_a_forger_gets_no_other_file(tmp_path, monkeypatch):
    """h5py alone hands out the text of a file beside it; this shows that the attack is real, and that it is refused."""
    (tmp_path / "secret.txt").write_bytes(SECRET)
    monkeypatch.chdir(tmp_path)
    content = forged(external_storage)
    (tmp_path / "a.h5").write_bytes(content)
    with h5py.File(tmp_path / "a.h5") as file:
        assert file["x"][()].tobytes() == SECRET
    assert "swordfish" not in complaint(tmp_path / "a.h5", content)


@pytest.mark.hard_case("S4")
def test_nothing_is_unpacked_twice(tmp_path):
    """Variables that share their bytes would make a small file large."""

    def one_with_room_for_more(file):
        file["t"] = np.arange(1000.0)
        file["t"].make_scale("t")
        file["t"].attrs["_Netcdf4Dimid"] = np.int32(0)
        for name in "abc":
            file.create_dataset(name, (1000,), "f8").attrs["_Netcdf4Coordinates"] = np.zeros(1, np.int32)

    content = forged(one_with_room_for_more)[: -len(MARK) - DIGITS]
    with h5py.File(io.BytesIO(content)) as file:
        place = file["t"].id.get_offset()
    nowhere, there = struct.pack("<qq", -1, 8000), struct.pack("<qq", place, 8000)
    assert content.count(nowhere) == 3
    shared = resealed(content.replace(nowhere, there))
    assert complaint(tmp_path / "a.h5", shared).endswith(f"it unpacks to more than its own {len(shared)} bytes")


@pytest.mark.hard_case("S4")
def test_there_is_an_end_to_small_things(tmp_path, monkeypatch):
    monkeypatch.setattr(hdf5_reading, "MOST_OBJECTS", 10)
    content = forged(lambda file: [file.create_group(f"g{k}/h") for k in range(9)])
    assert "to more than 10 variables and groups" in complaint(tmp_path / "a.h5", content)


def test_a_plain_file_with_a_seal_is_read(tmp_path):
    """What is refused above is refused for what it is, not for being made by hand."""
    (tmp_path / "a.h5").write_bytes(forged(lambda file: file.create_dataset("a/x", data=3.0)))
    assert open_results(tmp_path / "a.h5")["a/x"].item() == 3.0
    save_results(tmp_path / "b.h5", {}, {})
    assert resealed((tmp_path / "b.h5").read_bytes()[: -len(MARK) - DIGITS]) == (tmp_path / "b.h5").read_bytes()
