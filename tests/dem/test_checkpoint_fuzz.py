"""Checkpoints of no sense, damaged, and forged under a good seal: a simulation is made of them, or they are refused in one line, soon."""

import json
import time
import warnings

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from test_checkpoint import scene

from anisogran.dem import Simulation
from anisogran.dem.sealed import previous_of, read_sealed, write_sealed
from anisogran.outcome import InputError
from anisogran.whole_file import DIGITS, seal

MANY = settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
PLACE = st.floats(0, 1, exclude_max=True)
STRANGE = st.one_of(
    st.none(), st.booleans(), st.integers(-(2**70), 2**70), st.floats(), st.text(max_size=3), st.lists(st.integers(-1, 2), max_size=3),
    st.sampled_from([{}, {"Box": {}}, {"Linear": {"k": 1.0}}, {"a": 1, "b": 2}, "Luding", 10**400, [[[1]]], [1, [2, 3]]]),
)  # fmt: skip
GONE = object()


@pytest.fixture(scope="module", params=["box", "periodic", "ring"])
def good(request, tmp_path_factory):
    """The path of a checkpoint; what is made of it lies elsewhere."""
    path = tmp_path_factory.mktemp("good") / "a.npz"
    scene(np.random.default_rng(20050603), request.param, count=12).save(path)
    return path


def check(path):
    """The file is loaded or refused in one line; 5 s are for a busy machine, in which a kernel may have to be loaded."""
    clock = time.process_time()
    line = ""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # other versions are warned about, and forged ones are others
        try:
            assert isinstance(Simulation.load(path), Simulation)
        except InputError as error:
            line = str(error)
    assert time.process_time() - clock < 5.0
    assert len(line.splitlines()) <= 1
    return line


@pytest.mark.hard_case("S10")
@MANY
@given(content=st.binary(max_size=300), begin=st.sampled_from([b"", b"PK\3\4", b"PK\5\6"]), resealed=st.booleans())
def test_any_bytes(tmp_path, content, begin, resealed):
    content = begin + content + b"0" * DIGITS
    (tmp_path / "a.npz").write_bytes(content[:-DIGITS] + seal(content) if resealed else content)
    assert check(tmp_path / "a.npz")


@pytest.mark.hard_case("S10")
@MANY
@given(edits=st.lists(st.tuples(PLACE, st.booleans(), st.binary(min_size=1, max_size=12)), min_size=1, max_size=4))
def test_damage_under_a_new_seal(tmp_path, good, edits):
    content = good.read_bytes()
    for place, insert, piece in edits:
        start = int(place * (len(content) - DIGITS))
        content = content[:start] + piece + content[start if insert else start + len(piece) :]
    (tmp_path / "a.npz").write_bytes(content[:-DIGITS] + seal(content))
    check(tmp_path / "a.npz")


def leaves(tree):
    """(record or list, key) of every value in a tree of JSON."""
    for key, value in list(tree.items() if isinstance(tree, dict) else enumerate(tree)):
        yield tree, key
        if isinstance(value, dict | list):
            yield from leaves(value)


@pytest.mark.hard_case("S10")
@MANY
@given(place=PLACE, value=st.one_of(STRANGE, st.just(GONE)))
def test_a_strange_description(tmp_path, good, place, value):
    text, arrays = read_sealed(good)
    description = json.loads(text)
    places = list(leaves(description))
    record, key = places[int(place * len(places))]
    if value is GONE:
        del record[key]
    else:
        record[key] = value
    write_sealed(tmp_path / "a.npz", json.dumps(description), arrays)
    previous_of(tmp_path / "a.npz").unlink(missing_ok=True)
    check(tmp_path / "a.npz")


CHANGES = {
    "shorter": lambda array: array[:-1],
    "longer": lambda array: np.concatenate([array, array]),
    "flat": np.ravel,
    "empty": lambda array: array[:0],
    "scalar": lambda array: array.ravel()[0] if array.size else array,
    "single": lambda array: array.astype("f4"),
    "whole": lambda array: array.astype("i8"),
    "complex": lambda array: array.astype("c16"),
    "text": lambda array: array.astype("U3"),
    "largest": lambda array: np.full_like(array, np.iinfo(array.dtype).max if array.dtype.kind in "iu" else 1),
    "nan": lambda array: np.full_like(array, np.nan) if array.dtype.kind == "f" else array,
}


@pytest.mark.hard_case("S10")
@MANY
@given(place=PLACE, change=st.sampled_from(sorted(CHANGES)))
def test_a_strange_array(tmp_path, good, place, change):
    text, arrays = read_sealed(good)
    name = sorted(arrays)[int(place * len(arrays))]
    if arrays[name].ndim == 0:
        return
    with np.errstate(invalid="ignore"):  # nan as a whole number
        write_sealed(tmp_path / "a.npz", text, {**arrays, name: CHANGES[change](arrays[name])})
    previous_of(tmp_path / "a.npz").unlink(missing_ok=True)
    check(tmp_path / "a.npz")
