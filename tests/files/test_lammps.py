from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mutations import complaint, damaged

from anisogran import InputError, average, read_lammps
from anisogran.snapshot import Snapshot

DATA = Path(__file__).parent / "data"  # made with LAMMPS by the .in files that lie there
PLAIN = "ITEM: BOX BOUNDS pp pp pp\n0 4\n0 3\n-.5 .5"
GRAINS = "ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{count}\n{box}\nITEM: ATOMS {names}\n{rows}\n"
ENTRIES = "ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ENTRIES\n{count}\n{box}\nITEM: ENTRIES {names}\n{rows}\n"
NINE = "c_a[1] c_a[2] c_b[1] c_b[2] c_b[3] c_b[4] c_b[5] c_b[6] c_b[7]"


def grain_frame(names="id x y z radius mass", rows=("1 1 1 0 .5 2", "2 1.75 1 0 .5 2"), step=0, count=None, box=PLAIN):
    return GRAINS.format(step=step, count=len(rows) if count is None else count, box=box, names=names, rows="\n".join(rows))


def contact_frame(rows=("1 2 .75 -3 0 0 0 2 0",), step=0, count=None, names=NINE):
    return ENTRIES.format(step=step, count=len(rows) if count is None else count, box=PLAIN, names=names, rows="\n".join(rows))


@pytest.fixture
def written(tmp_path):
    """Writes the texts of the two files and returns their paths."""

    def write(grains, contacts=None):
        paths = [tmp_path / "grains.dump", tmp_path / "contacts.dump"]
        for path, text in zip(paths, (grains, contacts), strict=True):
            if text is not None:
                path.write_text(text)
        return paths[: 1 if contacts is None else 2]

    return write


def forces_on_atoms(path):
    """(frames, N, 2): the columns fx fy of a dump, in the order of the ids."""
    found = []
    for part in path.read_text().split("ITEM: ATOMS ")[1:]:
        names, *lines = part.split("ITEM:")[0].splitlines()
        names, rows = names.split(), np.loadtxt(lines)
        rows = rows[np.argsort(rows[:, names.index("id")])]
        found.append(rows[:, [names.index("fx"), names.index("fy")]])
    return found


RUNS = {"periodic": {}, "walls": {"walls": ("f_bottom", "f_top"), "wall_types": 2}}


@pytest.mark.parametrize("run", RUNS)
def test_the_forces_at_the_contacts_add_up_to_those_that_lammps_has_on_its_atoms(run):
    grains, contacts = DATA / f"{run}_grains.dump", DATA / f"{run}_contacts.dump"
    forces = forces_on_atoms(grains)
    for snapshot, expected in zip(read_lammps(grains, str(contacts), **RUNS[run]), forces, strict=True):
        total = np.zeros_like(expected)
        inner = snapshot.pairs[:, 1] >= 0
        np.add.at(total, snapshot.pairs[:, 0], snapshot.force)
        np.add.at(total, snapshot.pairs[inner, 1], -snapshot.force[inner])
        # sums of up to six pairs of numbers of ten digits, the largest below 1e4
        np.testing.assert_allclose(total[snapshot.free], expected[snapshot.free], rtol=0, atol=1e-5)


def test_the_average_over_the_box_is_the_pressure_of_lammps():
    stored = np.loadtxt(DATA / "periodic_pressure.txt")
    snapshots = list(read_lammps(DATA / "periodic_grains.dump", DATA / "periodic_contacts.dump", timestep=1e-4))
    for snapshot, (step, *pressure) in zip(snapshots, stored, strict=True):
        static = average(snapshot, on="box").stress_static.values
        motion = np.einsum("p,pi,pj->ij", snapshot.mass, snapshot.velocity, snapshot.velocity) / snapshot.volume
        # LAMMPS has [branch, force] for xy, and the motion relative to the box. Ten digits are stored of coordinates, forces, pressure
        np.testing.assert_allclose([static[0, 0], static[1, 1], static[1, 0]], pressure[3:], rtol=3e-9)
        np.testing.assert_allclose((static + motion)[[0, 1, 1], [0, 1, 0]], pressure[:3], rtol=3e-9)
        assert snapshot.time == pytest.approx(step * 1e-4, rel=1e-15)  # one rounding
    np.testing.assert_allclose(snapshots[0].cell, [[4.75, 0], [0.5, 4.75]], rtol=0, atol=1e-12)  # the box as it was squeezed and sheared
    first, second = (snapshots[0].position[snapshots[0].pairs[:, k]] for k in (0, 1))
    assert np.any(np.abs(first - second) > 2)  # the run has pairs across the border


def test_walls_and_wall_grains_of_a_run():
    (snapshot,) = read_lammps(DATA / "walls_grains.dump", DATA / "walls_contacts.dump", **RUNS["walls"])
    assert snapshot.fixed.tolist() == [k == 5 for k in range(12)]
    wall = snapshot.pairs[:, 1] < 0
    assert snapshot.pairs[wall].tolist() == [[i, -1] for i in range(4)] + [[i, -2] for i in range(8, 12)]
    bottom = snapshot.pairs[:, 1] == -1
    np.testing.assert_allclose(snapshot.point[wall, 1], np.where(bottom[wall], 0.05, 2.95), rtol=0, atol=1e-9)  # ten digits
    assert np.all(snapshot.force[bottom, 1] > 0)
    assert np.all(snapshot.force[snapshot.pairs[:, 1] == -2, 1] < 0)
    gap = snapshot.position[:4, 1] - 0.05
    np.testing.assert_allclose(snapshot.overlap[bottom], snapshot.radius[:4] - gap, rtol=0, atol=1e-9)
    assert snapshot.volume == pytest.approx(4 * 3.4, rel=1e-15)  # one rounding
    assert snapshot.cell[0].tolist() == [4, 0]
    assert snapshot.cell[1, 1] > 2 * 3.4  # nothing is nearer through the plates
    across = np.abs(snapshot.position[snapshot.pairs[~wall, 0], 0] - snapshot.position[snapshot.pairs[~wall, 1], 0]) > 2
    assert across.any()
    arm = snapshot.point[~wall] - snapshot.position[snapshot.pairs[~wall, 0]]
    assert np.all(np.hypot(*arm.T) < snapshot.radius[snapshot.pairs[~wall, 0]])


def test_a_frame_in_two_dimensions_comes_back_exactly(written):
    rows = ["6 9 1.75 .1 .5 1 5 4 8", "3 4 1 .1 .375 1 7 2 16"]
    paths = written(grain_frame("vy id x z radius y omegaz vx mass", rows, step=7), contact_frame(["9 4 .75 3 0 0 .5 2 0"], 7))
    (snapshot,) = read_lammps(*paths)
    expected = {
        "position": [[1, 1], [1.75, 1]], "radius": [0.375, 0.5], "mass": [16, 8], "velocity": [[2, 3], [4, 6]], "spin": [7, 5],
        "pairs": [[1, 0]], "force": [[3.5, 2]], "point": [[1.75 - (0.5 - 0.0625), 1]], "overlap": [0.125], "cell": [[4, 0], [0, 3]],
        "volume": 12, "fixed": [False, False], "time": 7, "cell_velocity": None, "sector": None,
    }  # fmt: skip
    assert {field.name: np.asarray(getattr(snapshot, field.name)).tolist() for field in fields(Snapshot)} == expected


def test_a_frame_in_three_dimensions_comes_back_exactly(written):
    names = "id x y z radius mass vx vy vz omegax omegay omegaz"
    rows = ["1 1 1 1 .5 2 1 2 3 4 5 6", "2 1 1 1.75 .5 2 -1 -2 -3 -4 -5 -6"]
    box = PLAIN.replace("-.5 .5", "0 2")
    (snapshot,) = read_lammps(*written(grain_frame(names, rows, box=box), contact_frame(["1 2 .75 0 0 -3 .5 .25 0"])))
    assert snapshot.position.tolist() == [[1, 1, 1], [1, 1, 1.75]]
    assert snapshot.velocity.tolist() == [[1, 2, 3], [-1, -2, -3]]
    assert snapshot.spin.tolist() == [[4, 5, 6], [-4, -5, -6]]
    assert snapshot.force.tolist() == [[0.5, 0.25, -3]]
    assert snapshot.point.tolist() == [[1, 1, 1.375]]
    assert snapshot.cell.tolist() == np.diag([4, 3, 2]).tolist()
    assert snapshot.volume == 24


def test_the_dimension_can_be_told(written):
    layer = written(grain_frame())
    assert next(read_lammps(*layer)).position.shape == (2, 2)
    assert next(read_lammps(*layer, dimension=3)).position.shape == (2, 3)
    uneven = written(grain_frame(rows=["1 1 1 0 .5 2", "2 2 1 1 .5 2"]))
    assert next(read_lammps(*uneven)).position.shape == (2, 3)
    with pytest.raises(InputError, match=r"line 11: z = 1 differs from that of the first grain; give dimension=3"):
        next(read_lammps(*uneven, dimension=2))
    assert next(read_lammps(*written(grain_frame("id x y radius mass", ["1 1 1 .5 2"])))).position.tolist() == [[1, 1]]


@pytest.mark.parametrize(
    ("names", "row", "position"),
    [
        ("id xu yu zu diameter mass", "1 9 -8 7 1 2", [9, -8, 7]),
        ("id xs ys zs radius mass", "1 .5 .5 .5 .5 2", [2.75, 1.5, 0]),
        ("id xsu ysu zsu radius mass", "1 1.5 -.5 1 .5 2", [6, -1.5, 0.5]),
    ],
)
def test_positions_are_understood_in_all_their_forms(written, names, row, position):
    # the corner is at (0, 0, -1/2), the lattice vectors are (4, 0, 0), (1, 3, 0) and (1/2, 0, 1)
    box = "ITEM: BOX BOUNDS xy xz yz pp pp pp\n0 5.5 1\n0 3 .5\n-.5 .5 0"
    (snapshot,) = read_lammps(*written(grain_frame(names, [row], box=box)), dimension=3)
    assert snapshot.position.tolist() == [position]
    assert snapshot.cell.tolist() == [[4, 0, 0], [1, 3, 0], [0.5, 0, 1]]
    assert snapshot.radius.tolist() == [0.5]
    assert snapshot.volume == 12


def test_bounds_of_a_box_tilted_backwards(written):
    # LAMMPS manual: low bound = low + min(0, xy, xz, xy + xz), high bound = high + max(0, ...)
    box = "ITEM: BOX BOUNDS xy xz yz pp pp pp\n-1.5 4 -1\n-1 3 -.5\n-.5 .5 -1"
    (snapshot,) = read_lammps(*written(grain_frame("id xs ys zs radius mass", ["1 0 0 0 .5 2"], box=box)), dimension=3)
    assert snapshot.cell.tolist() == [[4, 0, 0], [-1, 3, 0], [-0.5, -1, 1]]
    assert snapshot.position.tolist() == [[0, 0, -0.5]]


def test_a_pair_across_the_border_of_a_tilted_cell(written):
    box = "ITEM: BOX BOUNDS xy xz yz pp pp pp\n0 5.875 1.875\n0 3 0\n-.5 .5 0"
    # the lattice vectors are (4, 0) and (1.875, 3): grain 2 at (0.875, 0) has an image at (2.75, 3), a quarter left of grain 1
    rows = ["1 3 3 0 .5 2", "2 .875 0 0 .5 2"]
    (snapshot,) = read_lammps(*written(grain_frame(rows=rows, box=box), contact_frame(["1 2 .25 0 0 0 0 0 0"])))
    assert snapshot.point.tolist() == [[2.875, 3]]
    assert snapshot.overlap.tolist() == [0.75]


def test_a_box_that_is_not_periodic_has_no_cell_and_one_that_is_in_part_has_a_long_one(written):
    box = PLAIN.replace("pp pp pp", "{}")
    rows = ["1 .25 1 0 .5 2", "2 3.75 1 0 .5 2"]
    closed = written(grain_frame(rows=rows, box=box.format("ff fs pp")))
    assert next(read_lammps(*closed)).cell is None
    assert next(read_lammps(*closed)).volume == 12
    contact = contact_frame(["1 2 .5 0 0 0 0 0 0"])
    (snapshot,) = read_lammps(*written(grain_frame(rows=rows, box=box.format("pp fs pp")), contact))
    assert snapshot.point.tolist() == [[0, 1]]
    assert snapshot.cell.tolist() == [[4, 0], [0, 4]]
    with pytest.raises(InputError, match=r"contacts.dump, line 10: the centres are 3.5 apart by their positions, but 0.5 by the contact"):
        list(read_lammps(*written(grain_frame(rows=rows, box=box.format("fs pp pp")), contact)))


def test_mass_from_a_density(written):
    path = written(grain_frame("id x y radius", ["1 1 1 .5"]))
    assert next(read_lammps(*path, density=6)).mass == pytest.approx([np.pi], rel=1e-15)  # one rounding
    assert next(read_lammps(*path, density=4, mass_of="disc")).mass == pytest.approx([np.pi], rel=1e-15)
    with pytest.raises(InputError, match="no column 'mass'; present are id, x, y, radius"):
        next(read_lammps(*path))
    assert next(read_lammps(*written(grain_frame()), density=6)).mass.tolist() == [2, 2]


def test_what_a_dump_leaves_out_of_the_motion_is_zero(written):
    (snapshot,) = read_lammps(*written(grain_frame()))
    assert not snapshot.velocity.any()
    assert not snapshot.spin.any()


def test_pairs_that_do_not_touch_are_no_contact(written):
    rows = ["1 1 1 0 .5 2", "2 2 1 0 .5 2", "3 1 1.75 0 .5 2"]
    contacts = contact_frame(["1 2 1 0 0 0 0 0 0", "1 3 .75 0 -1 0 0 0 0", "2 3 1.25 0 0 0 0 0 0"])
    (snapshot,) = read_lammps(*written(grain_frame(rows=rows), contacts))
    assert snapshot.pairs.tolist() == [[0, 2]]


def test_columns_of_another_order_are_named(written):
    names = {"first": "i", "second": "j", "fx": "f1", "fy": "f2"}
    contacts = contact_frame(["x 2 1 9 -3 1"], names="t f2 i j f1 j2").replace("x 2 1 9 -3 1", "x 2 1 2 -3 1")
    (snapshot,) = read_lammps(*written(grain_frame(), contacts), columns=names)
    assert snapshot.force.tolist() == [[-3, 2]]
    assert snapshot.overlap.tolist() == [0.25]
    with pytest.raises(InputError, match="line 9: 6 columns, not the 9 of first, second, dist"):
        list(read_lammps(*written(grain_frame(), contacts)))
    with pytest.raises(InputError, match=r"line 9: columns= does not say which column is p2"):
        list(read_lammps(*written(grain_frame(), contacts), columns=names | {"p1": "j2"}))
    with pytest.raises(InputError, match=r"line 9: columns= does not say which column is fz"):
        list(read_lammps(*written(grain_frame(), contacts), columns=names, dimension=3))


def test_frames_are_matched_by_their_step(written):
    grains = "".join(grain_frame(step=step) for step in (0, 10, 20, 30, 40))
    contacts = "\n".join(contact_frame([f"1 2 .75 {-step} 0 0 0 0 0"], step) for step in (0, 20, 40))
    for every, steps in [(2, [0, 20, 40]), (4, [0, 40])]:
        snapshots = list(read_lammps(*written(grains, contacts), every=every))
        assert [(s.time, -s.force[0, 0]) for s in snapshots] == [(step, step) for step in steps]
    stream = read_lammps(*written(grains, contacts))
    assert next(stream).time == 0
    with pytest.raises(InputError, match=r"grains.dump, line 20: no contacts at step 10$"):
        next(stream)
    for extra, line in [(15, 19), (50, 39)]:
        parts = [contact_frame(step=step) for step in sorted((0, 20, 40, extra))]
        with pytest.raises(InputError, match=rf"contacts.dump, line {line}: no grains at step {extra}$"):
            list(read_lammps(*written(grains, "".join(parts)), every=2))
    with pytest.raises(InputError, match="step 10 follows step 20; it must be later"):
        list(read_lammps(*written(grain_frame(step=20) + grain_frame(step=10))))


def test_the_time_may_stand_in_the_dump(written):
    text = "ITEM: UNITS\nsi\nITEM: TIME\n0.25\n" + grain_frame(step=3)
    assert next(read_lammps(*written(text))).time == 0.25
    assert next(read_lammps(*written(text), timestep=0.5)).time == 1.5


ONE = grain_frame()
MALFORMED = {
    "": "grains.dump: holds no frame",
    "\n\n": "grains.dump: holds no frame",
    "\x00\x01\x02\n": "line 1: expected a line 'ITEM: ...', found",
    "ITEM: TIMESTEP\n": "line 1: expected TIMESTEP, found ''",
    ONE.replace("ITEM: TIMESTEP\n0\n", ""): "line 1: the frame has no ITEM: TIMESTEP before its table",
    ONE.replace(PLAIN + "\n", ""): "line 1: the frame has no ITEM: BOX BOUNDS",
    ONE.replace("ITEM: NUMBER OF ATOMS\n2", ""): "line 3: expected a line 'ITEM: ...', found ''",
    ONE.replace("TIMESTEP\n0", "TIMESTEP\n0.5"): "line 2: TIMESTEP = 0.5 must be a whole number, not below 0",
    ONE.replace("TIMESTEP\n0", "TIMESTEP\none"): "line 2: expected TIMESTEP, found 'one'",
    ONE.replace("0 3", "3 0"): "line 8: the box has no volume",
    ONE.replace("0 3", "0 3 1"): "line 7: expected low and high, found '0 3 1'",
    ONE.replace("0 3", "0 nan"): "line 7: expected low and high, found '0 nan'",
    ONE.replace("pp pp pp", "abc origin pp pp pp"): "no other box can be read",
    ONE.replace("pp pp pp", "pp pp"): "no other box can be read",
    ONE.replace("ATOMS id", "ENTRIES id"): "line 9: the table is called ENTRIES, not ATOMS; this is no dump custom",
    ONE.replace("radius", "size"): "line 9: no column 'radius'; present are id, x, y, z, size, mass",
    ONE.replace(" x ", " u "): "line 9: no column 'x'; present are id, u, y, z, radius, mass",
    ONE.replace("id", "atom"): "line 9: no column 'id'",
    ONE.replace("z radius", "vx radius"): "line 9: no column 'vy'",
    ONE.replace("2 1.75 1 0 .5 2", "2 1.75 1 0 .5"): "line 11: 5 entries instead of 6",
    ONE.replace("1.75", "1,75"): "line 11: not a number in '2 1,75 1 0 .5 2'",
    ONE.replace("1.75", "nan"): "line 11: x = nan must be a finite number below 1e+30",
    ONE.replace("1.75", "-1e400"): "line 11: x = -inf must be a finite number",
    ONE.replace("0 .5 2\n2", "0 .5 2\n1"): "line 11: atom 1 stands there a second time",
    ONE.replace("0 .5 2\n2", "0 .5 2\n2.5"): "line 11: id = 2.5 must be a whole number",
    ONE.replace(".5 2\n2", "0 2\n2"): "line 10: radius = 0 must be above 0",
    ONE.replace(".5 2\n2", ".5 -2\n2"): "line 10: mass = -2 must be above 0",
    ONE[:-1]: "line 11: the file breaks off within this line",
    ONE[:-16]: "line 10: the file ends after 1 of 2 lines of this frame",
    grain_frame(rows=[], count=0).rstrip() + "\n": "line 9: the frame holds no grain",
    grain_frame(count=10**12): "line 11: the file ends after 2 of 1000000000000 lines of this frame",
    grain_frame(count=3) + grain_frame(step=1): "line 12: 2 entries instead of 6",
    "ITEM: " + "x" * 10**6: "line 1: the line is too long for a header",
}


@pytest.mark.parametrize("text", MALFORMED, ids=MALFORMED.values())
def test_malformed_grains_get_one_line_that_names_the_place(written, text):
    paths = written(text)
    with pytest.raises(InputError) as caught:
        list(read_lammps(*paths))
    assert MALFORMED[text] in str(caught.value)
    assert "grains.dump" in str(caught.value)
    assert "\n" not in str(caught.value)


BAD_CONTACTS = {
    contact_frame(["1 3 .75 0 0 0 0 0 0"]): "line 10: atom 3 is not among the grains",
    contact_frame(["0 2 .75 0 0 0 0 0 0"]): "line 10: atom 0 is not among the grains",
    contact_frame(["1 1 .75 0 0 0 0 0 0"]): "line 10: a grain in contact with itself, or two in one place",
    contact_frame(["1 2 .7 0 0 0 0 0 0"]): "line 10: the centres are 0.75 apart by their positions, but 0.7 by the contact",
    contact_frame(["1 2 .75 0 inf 0 0 0 0"]): "line 10: fy = inf must be a finite number",
    contact_frame(count=2): "line 10: the file ends after 1 of 2 lines of this frame",
    ONE: "line 9: the table is called ATOMS; this is no dump local",
    "": "contacts.dump: holds no frame",
}


@pytest.mark.parametrize("text", BAD_CONTACTS, ids=BAD_CONTACTS.values())
def test_malformed_contacts_get_one_line_that_names_the_place(written, text):
    paths = written(grain_frame(), text)
    with pytest.raises(InputError) as caught:
        list(read_lammps(*paths))
    assert BAD_CONTACTS[text] in str(caught.value)
    assert "contacts.dump" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_walls_that_are_not_dumped_or_not_there(written):
    with pytest.raises(InputError, match=r"line 9: no column 'f_a\[1\]'; present are id"):
        next(read_lammps(*written(grain_frame()), walls="f_a"))
    names = "id x y z radius mass " + " ".join(f"f_a[{k}]" for k in range(1, 9))
    rows = ["3 .25 1 0 .5 2 0 0 0 0 0 0 0 0", "1 1.75 1 0 .5 2 1 -3 1 0 2.125 1 0 .5", "2 3 1 0 .5 2 0 0 0 0 0 0 0 0"]
    (snapshot,) = read_lammps(*written(grain_frame(names, rows)), walls="f_a")
    assert (snapshot.pairs.tolist(), snapshot.force.tolist(), snapshot.point.tolist()) == ([[0, -1]], [[-3, 1]], [[2.125, 1]])
    assert snapshot.overlap.tolist() == [0.125]
    rows[1] = rows[1].replace("2.125", "2.5")
    with pytest.raises(InputError, match=r"line 11: the contact with wall 0 is not on the grain"):
        next(read_lammps(*written(grain_frame(names, rows)), walls="f_a"))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"every": 0}, "every = 0 must be at least 1"),
        ({"every": 1.5}, "every = 1.5 must be a whole number"),
        ({"timestep": 0}, "timestep = 0 must be above 0 s"),
        ({"density": -1}, "density = -1 must be above 0 kg/m3"),
        ({"density": 1, "mass_of": "cube"}, "mass_of = 'cube' must be 'sphere' or 'disc'"),
        ({"dimension": 1}, "dimension = 1 must be 2 or 3"),
        ({"wall_types": "a"}, "wall_types = 'a' must be numbers"),
        ({"columns": "c_a"}, "columns = 'c_a' must map our names to those in the dump"),
        ({"columns": {"one": "c"}}, "columns has an unknown key 'one'"),
        ({"columns": {"first": "c", "second": "d", "fy": "e"}}, "columns has no 'fx'"),
    ],
)
def test_bad_arguments_are_refused_at_once(arguments, message):
    with pytest.raises(InputError, match=message):
        read_lammps("grains.dump", **arguments)


def test_files_that_cannot_be_opened_get_one_line(tmp_path):
    for path, message in [(tmp_path, "cannot be read"), (tmp_path / "no.dump", "no.dump: cannot be read"), (3.5, "3.5: is no path")]:
        with pytest.raises(InputError, match=message):
            next(read_lammps(path))


WALLS = (DATA / "walls_grains.dump").read_bytes()
PAIRS = (DATA / "walls_contacts.dump").read_bytes()


@pytest.mark.hard_case("S10")
@given(grains=st.one_of(st.just(WALLS), damaged(WALLS)), contacts=st.one_of(st.just(PAIRS), damaged(PAIRS)))
@settings(max_examples=200, deadline=None)
def test_a_damaged_file_gives_snapshots_or_one_line(tmp_path_factory, grains, contacts):
    folder = tmp_path_factory.getbasetemp()
    paths = [folder / "damaged_grains.dump", folder / "damaged_contacts.dump"]
    for path, content in zip(paths, (grains, contacts), strict=True):
        path.write_bytes(content)
    message = complaint(read_lammps(*paths, **RUNS["walls"]))
    assert "\n" not in message
    assert not message or "damaged_" in message
