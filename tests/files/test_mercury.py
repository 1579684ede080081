from dataclasses import fields

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mutations import complaint, damaged

from anisogran import InputError, average, read_mercury
from anisogran.snapshot import Snapshot

FLAT = "{n} {time} 0 0 4 3 \n"
SOLID = "{n} {time} 0 0 0 4 3 2 \n"
TWO = ["1 1 2 3 .375 0 -7 0", "1.75 1 4 6 .5 0 -5 1"]  # x y vx vy radius angle, minus the spin, info
# grain 0 feels -3 n + tangential (0, 2): the normal runs from grain 1 to grain 0; then the same pair from the other side
PAIR = ["{t} 0 1 1.3 1 0 .125 0 3 2 -1 0 0 0 1 0", "{t} 1 0 1.3 1 0 .125 0 3 2 1 -0 -0 -0 -1 -0"]


def grain_frame(rows=TWO, time=0.5, n=None, header=FLAT):
    return header.format(n=len(rows) if n is None else n, time=time) + "".join(f"{row}\n" for row in rows)


def contact_frame(rows=PAIR, time=0.5, start="# {t} 1"):
    head = [start, "# 0 0 0 4 3 0", "# .375 .5 0 0 0 0"]
    return "".join(f"{line.format(t=time)}\n" for line in [*head, *rows])


@pytest.fixture
def written(tmp_path):
    """Writes the texts of the two files and returns their paths."""

    def write(grains, contacts=None):
        paths = [tmp_path / "run.data", tmp_path / "run.fstat"]
        for path, text in zip(paths, (grains, contacts), strict=True):
            if text is not None:
                path.write_text(text)
        return paths[: 1 if contacts is None else 2]

    return write


def test_a_frame_in_two_dimensions_comes_back_exactly(written):
    (snapshot,) = read_mercury(*map(str, written(grain_frame(), contact_frame())), density=1 / np.pi, mass_of="disc", wall_types=[1])
    expected = {
        "position": [[1, 1], [1.75, 1]], "radius": [0.375, 0.5], "mass": [0.375**2, 0.5**2], "velocity": [[2, 3], [4, 6]],
        "spin": [7, 5], "pairs": [[0, 1]], "force": [[-3, 2]], "point": [[1.3125, 1]], "overlap": [0.125], "cell": None,
        "volume": 12, "fixed": [False, True], "time": 0.5, "cell_velocity": None, "sector": None,
    }  # fmt: skip
    assert {field.name: np.asarray(getattr(snapshot, field.name)).tolist() for field in fields(Snapshot)} == expected


def test_a_frame_in_three_dimensions_comes_back_exactly(written):
    rows = ["1 1 1 1 2 3 .5 0 0 0 4 5 6 0", "1 1 1.75 -1 -2 -3 .5 0 0 0 -4 -5 -6 0"]
    contact = ["0 1 0 1 1 1.4 .25 0 3 2 0 0 1 0 1 0", "0 0 1 1 1 1.4 .25 0 3 2 0 0 -1 0 -1 0"]
    (snapshot,) = read_mercury(*written(grain_frame(rows, header=SOLID), contact_frame(contact)), density=6 / np.pi, periodic="xyz")
    assert snapshot.position.tolist() == [[1, 1, 1], [1, 1, 1.75]]
    assert snapshot.velocity.tolist() == [[1, 2, 3], [-1, -2, -3]]
    assert snapshot.spin.tolist() == [[4, 5, 6], [-4, -5, -6]]
    np.testing.assert_allclose(snapshot.mass, [1, 1], rtol=1e-15)  # 4 pi/3 a^3 with one rounding
    assert snapshot.pairs.tolist() == [[1, 0]]
    assert snapshot.force.tolist() == [[0, 2, 3]]
    assert snapshot.point.tolist() == [[1, 1, 1.375]]
    assert snapshot.cell.tolist() == np.diag([4, 3, 2]).tolist()
    assert snapshot.volume == 24


def test_a_contact_that_is_written_once_counts_as_much_as_one_that_is_written_twice(written):
    twice, first, second = (
        next(read_mercury(*written(grain_frame(), contact_frame(rows)), density=1.0)) for rows in (PAIR, PAIR[:1], PAIR[1:])
    )
    assert [len(snapshot.pairs) for snapshot in (twice, first, second)] == [1, 1, 1]
    assert second.pairs.tolist() == [[1, 0]]
    assert second.force.tolist() == (-twice.force).tolist()
    np.testing.assert_array_equal(average(first).stress.values, average(twice).stress.values)
    # the sums are the same but for their order
    np.testing.assert_allclose(average(second).stress.values, average(twice).stress.values, rtol=1e-15)


def test_the_vectors_of_a_wall_contact_are_turned_round(written):
    """The source writes them from the grain to the wall: a wall below pushes its grain up, along minus n."""
    rows = ["t 1 -2 1 0 0 .125 0 3 2 0 -1 0 1 0 0".replace("t", "0")]
    data = ["1 1 0 0 .375 0 0 0", "1.75 .375 0 0 .5 0 0 0"]
    (snapshot,) = read_mercury(*written(grain_frame(data), contact_frame(rows)), density=1.0)
    assert snapshot.pairs.tolist() == [[1, -2]]
    assert snapshot.force.tolist() == [[-2, 3]]
    assert snapshot.point.tolist() == [[1.75, 0]]  # on the wall


def test_pressure_is_positive_under_compression(written):
    (snapshot,) = read_mercury(*written(grain_frame(), contact_frame()), density=1.0)
    # branch 0.75 along x, normal force 3, area 12
    assert average(snapshot).stress_static.values[0, 0] == pytest.approx(0.75 * 3 / 12, rel=1e-15)  # one rounding


def test_a_pair_across_the_border_needs_to_be_told_that_there_is_one(written):
    data = ["3.875 1 0 0 .375 0 0 0", ".625 1 0 0 .5 0 0 0"]
    paths = written(grain_frame(data), contact_frame())
    for periodic, cell in [("x", [[4, 0], [0, 4 * (0 + 2 * 0.5)]]), ("xy", [[4, 0], [0, 3]])]:
        (snapshot,) = read_mercury(*paths, density=1.0, periodic=periodic)
        assert snapshot.point.tolist() == [[3.875 + 0.3125, 1]]
        assert snapshot.cell.tolist() == cell
    with pytest.raises(InputError, match=r"run.fstat, line 4: the centres are 3.25 apart by their positions, but 0.75 by the contact"):
        list(read_mercury(*paths, density=1.0))


def test_frames_are_matched_by_their_time(written):
    data = "".join(grain_frame(time=time) for time in (0, 0.1, 0.2, 0.3, 0.4)) + "\n"
    fstat = "".join(contact_frame(time=time) for time in (0, 0.2, 0.4))
    for every, times in [(2, [0, 0.2, 0.4]), (4, [0, 0.4])]:
        assert [snapshot.time for snapshot in read_mercury(*written(data, fstat), density=1.0, every=every)] == times
    with pytest.raises(InputError, match=r"run.data, line 4: no contacts at time 0.1$"):
        list(read_mercury(*written(data, fstat), density=1.0))
    with pytest.raises(InputError, match=r"run.fstat, line 16: no grains at time 0.5$"):
        list(read_mercury(*written(data, fstat + contact_frame(time=0.5)), density=1.0, every=2))
    with pytest.raises(InputError, match=r"run.data, line 4: time 0.5 follows time 0.5; it must be later"):
        list(read_mercury(*written(2 * grain_frame()), density=1.0))
    assert [len(s.pairs) for s in read_mercury(*written(grain_frame(), contact_frame([])), density=1.0)] == [0]


ONE = grain_frame()
MALFORMED = {
    "": "run.data: holds no frame",
    "\x00\x01\n": "line 1: expected N, time and the corners of the box: 8 numbers, or 6 in two dimensions, found",
    ONE.replace("4 3", "4"): "line 1: expected N, time and the corners of the box",
    ONE.replace("4 3", "4 0"): "line 1: the box has no volume",
    ONE.replace("2 0.5", "2.5 0.5"): "line 1: number of grains = 2.5 must be a whole number, not below 0",
    ONE.replace("2 0.5", "-2 0.5"): "line 1: number of grains = -2 must be a whole number, not below 0",
    ONE.replace("1.75", "1.75 2"): "line 3: 9 entries instead of 8",
    ONE.replace("1.75", "a"): "line 3: not a number in 'a 1 4 6 .5 0 -5 1'",
    ONE.replace("1.75", "nan"): "line 3: x = nan must be a finite number below 1e+30",
    ONE.replace(".375", "0"): "line 2: radius = 0 must be above 0",
    ONE.replace(".375", "1e-200"): "line 2: radius = 1e-200 is too small to have a mass",
    ONE[:-1]: "line 3: the file breaks off within this line",
    grain_frame(n=10**12): "line 3: the file ends after 2 of 1000000000000 lines of this frame",
    grain_frame([], n=0): "line 1: the frame holds no grain",
}


@pytest.mark.parametrize("text", MALFORMED, ids=MALFORMED.values())
def test_malformed_grains_get_one_line_that_names_the_place(written, text):
    message = complaint(read_mercury(*written(text), density=1.0))
    assert MALFORMED[text] in message
    assert "run.data" in message
    assert "\n" not in message


BAD_CONTACTS = {
    "": "run.fstat: holds no frame",
    "0 1\n": "line 1: expected '# time ...', found '0 1'; is this an .fstat file?",
    contact_frame(start="# "): "line 1: expected the time, found ''",
    contact_frame(start="# now"): "line 1: expected the time, found 'now'",
    contact_frame().replace("# .375", ".375"): "line 3: expected three lines that begin with #",
    contact_frame([PAIR[0] + " 1"]): "line 4: 17 entries instead of 16",
    contact_frame([PAIR[0].replace(" 0 1 1.3", " 0 2 1.3")]): "line 4: a contact of grain 0 with 2, but the grains are 0 to 1",
    contact_frame([PAIR[0].replace(" 0 1 1.3", " -1 1 1.3")]): "line 4: a contact of grain -1 with 1, but",
    contact_frame([PAIR[0].replace(" 0 1 1.3", " 0 0 1.3")]): "line 4: a grain in contact with itself, or two in one place",
    contact_frame([PAIR[0].replace(" 0 1 1.3", " 0 .5 1.3")]): "line 4: j = 0.5 must be a whole number",
    contact_frame([PAIR[0].replace("-1 0 0", "-.5 0 0")]): "line 4: the normal is no unit vector",
    contact_frame([PAIR[0].replace("-1 0 0", "1 0 0")]): "line 4: the normal does not point from grain 1 to grain 0",
    contact_frame([PAIR[0].replace(".125", ".25")]): "line 4: the centres are 0.75 apart by their positions, but 0.625 by the contact",
    contact_frame([PAIR[0].replace("3 2", "nan 2")]): "line 4: fn = nan must be a finite number",
}


@pytest.mark.parametrize("text", BAD_CONTACTS, ids=BAD_CONTACTS.values())
def test_malformed_contacts_get_one_line_that_names_the_place(written, text):
    message = complaint(read_mercury(*written(grain_frame(), text), density=1.0))
    assert BAD_CONTACTS[text] in message
    assert "run.fstat" in message
    assert "\n" not in message


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"density": 0}, "density = 0 must be above 0 kg/m3"),
        ({"density": 1, "mass_of": "rod"}, "mass_of = 'rod' must be 'sphere' or 'disc'"),
        ({"density": 1, "periodic": "r"}, "periodic = 'r' must be made of x, y and z"),
        ({"density": 1, "periodic": True}, "periodic = True must be made of x, y and z"),
        ({"density": 1, "every": -1}, "every = -1 must be at least 1"),
    ],
)
def test_bad_arguments_are_refused_at_once(arguments, message):
    with pytest.raises(InputError, match=message):
        read_mercury("run.data", **arguments)


DATA = (grain_frame() + grain_frame(time=0.75)).encode()
FSTAT = (contact_frame([*PAIR, "0 1 -1 0 0 0 .1 0 1 0 0 -1 0 0 0 0"]) + contact_frame(time=0.75)).encode()


@pytest.mark.hard_case("S10")
@given(data=st.one_of(st.just(DATA), damaged(DATA)), fstat=st.one_of(st.just(FSTAT), damaged(FSTAT)))
@settings(max_examples=200, deadline=None)
def test_a_damaged_file_gives_snapshots_or_one_line(tmp_path_factory, data, fstat):
    folder = tmp_path_factory.getbasetemp()
    paths = [folder / "damaged.data", folder / "damaged.fstat"]
    for path, content in zip(paths, (data, fstat), strict=True):
        path.write_bytes(content)
    message = complaint(read_mercury(*paths, density=1.0, periodic="x"))
    assert "\n" not in message
    assert not message or "damaged." in message
