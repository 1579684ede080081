"""Grains and contacts of a LAMMPS run, from its `dump custom` and `dump local` files."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from anisogran.files.foreign import (
    FINE,
    Contacts,
    Grains,
    branches,
    cell_of,
    edges_of,
    mass_law,
    nearest_image,
    pair_points,
    positive_step,
    snapshot_of,
    type_list,
)
from anisogran.files.frames import Frame, frames, matched
from anisogran.outcome import InputError, checked

CONTACT = ("first", "second", "dist", "fx", "fy", "fz", "p1", "p2", "p3")  # of a dump local, in the default order
NEEDED = ("first", "second", "fx", "fy")
AXES = ("x", "y", "z")


def read_lammps(
    grains, contacts=None, *, density=None, mass_of="sphere", wall_types=(), walls=(), columns=None, dimension=None, timestep=None, every=1
):
    """A stream of Snapshots, one for each `every`-th frame of the file `grains`; one frame is in memory at a time.

    `grains`: a `dump custom` in text, with the columns id, x y (z) or their forms xu, xs, xsu, radius or diameter, and mass, in any
    order and among others; vx vy vz and omegax omegay omegaz where there are, else velocity or spin is zero. Without mass, that of a
    sphere or of a disc (`mass_of`) of `density` in kg/m3 or kg/m2. Grains are in the order of their ids.

    `contacts`: the `dump local` of the same steps, of
        compute ids all property/local patom1 patom2 cutoff radius
        compute pairs all pair/local dist fx fy fz p1 p2 p3 cutoff radius
    in this order; for another order, or other columns, `columns` maps first, second, dist, fx, fy, fz, p1, p2, p3 to their names, such
    as {"first": "c_ids[1]", ...}; dist, without friction p1 p2 p3, and in two dimensions fz and p3 may be left out. The force on the
    first grain is (fx, fy, fz) + (p1, p2, p3): so in the source of compute pair/local and of pair gran/hooke/history, and checked by
    running LAMMPS of 22 July 2025 (sums over the pairs against the force on each atom, and the stress against compute pressure, to the
    digits of the dump after a `run 0`; within a run LAMMPS damps its atoms with the velocities of the half step, but the pairs here with
    those of the full step). Grains that do not touch are no contact, with or without a force. The contact point is on the line of
    centres, in the middle of the overlap; `dump_modify ... format float %.12g` keeps the digits that overlaps need.

    `walls`: names such as "f_left" of `fix wall/gran ... contacts`, dumped with the grains as f_left[1] to f_left[8]. A contact of a
    grain with the wall walls[w] is (grain, -1 - w), the point on the wall. A fix keeps one contact a grain, so each wall needs its own.
    `wall_types`: atom types that belong to a wall (Snapshot.fixed).

    The sample is the box, and `volume` is that of the box. A periodic box is the `cell`. If only some directions are periodic, the
    others have a lattice vector too, so long that no contact crosses it; if none is, there is no cell. `dimension` 2 takes x, y and
    omegaz; by default it is 2 if z is missing or the same for all grains of the first frame. Units are those of the dump, SI expected.
    `time` is the number of the step times `timestep` (s) if that is given, else the ITEM: TIME, else the number of the step.
    Raises InputError at once for a bad argument, and from the stream, with file and line, for whatever does not fit.
    """
    every = positive_step("read_lammps", every)
    step = None if timestep is None else checked("read_lammps", "timestep", timestep, above=0, unit="s")
    if dimension not in (None, 2, 3):
        raise InputError(f"read_lammps: dimension = {dimension!r} must be 2 or 3")
    law = None if density is None else mass_law("read_lammps", density, mass_of)
    if columns is not None:
        if not isinstance(columns, Mapping):
            raise InputError(f"read_lammps: columns = {columns!r} must map our names to those in the dump")
        for name in columns:
            if name not in CONTACT:
                raise InputError(f"read_lammps: columns has an unknown key {name!r}; known are {', '.join(CONTACT)}")
        for name in NEEDED:
            if name not in columns:
                raise InputError(f"read_lammps: columns has no {name!r}")
    walls = (walls,) if isinstance(walls, str) else tuple(walls)
    return _snapshots(grains, contacts, law, type_list("read_lammps", wall_types), walls, columns, dimension, step, every)


def _snapshots(path, contact_path, law, wall_types, walls, columns, dimension, step, every):
    contact_frames = None if contact_path is None else frames(contact_path, _next_frame)
    for frame, contact in matched(frames(path, _next_frame), contact_frames, every):
        if frame.header["title"] != "ATOMS":
            frame.refuse(f"the table is called {frame.header['title']}, not ATOMS; this is no dump custom")
        table = _grain_table(frame, law, wall_types, walls)
        if dimension is None:
            dimension = 3 if "z" in table and len(table) and np.ptp(table["z"]) > 0 else 2
        order = np.argsort(table.whole("id"), kind="stable")
        grains = _grains(frame, table, order, dimension, wall_types)
        found = [] if contact is None else [_pairs(contact, columns, grains, table["id"][order])]
        found += [_wall_contacts(table, wall, np.argsort(order), grains) for wall in range(len(walls))]
        yield snapshot_of(frame, grains, found, frame.header["time"] if step is None else frame.label * step)


def _next_frame(lines):
    """The next Frame of a dump: header {title, names, box, time}; None at the end of the file."""
    items, line = {}, lines.next_filled()
    start = lines.number
    if line is None:
        return None
    while line is not None:
        if not line.startswith("ITEM: "):
            lines.refuse(f"expected a line 'ITEM: ...', found {line[:40]!r}; is this a LAMMPS dump in text?")
        item = line[6:]
        if item.startswith("BOX BOUNDS"):
            items["BOX BOUNDS"] = _box(lines, item.split()[2:])
        elif item == "UNITS":
            lines.next()
        elif item == "TIME":
            items[item] = lines.numbers(lines.next(), (1,), "the time")[0]
        elif item == "TIMESTEP" or item.startswith("NUMBER OF "):
            items[item[:9]] = lines.count(*lines.numbers(lines.next(), (1,), item), item)
        else:
            break
        line = lines.next()
    if line is None:
        lines.refuse("the file ends within the header of a frame")
    for needed in ("TIMESTEP", "NUMBER OF", "BOX BOUNDS"):
        if needed not in items:
            lines.refuse(f"the frame has no ITEM: {needed} before its table", start)
    title, *names = item.split() or [""]
    frame = Frame(lines, items["TIMESTEP"], "step", items["NUMBER OF"], title=title, names=names, box=items["BOX BOUNDS"])
    frame.header["time"] = items.get("TIME", float(frame.label))
    return frame


class _Box(NamedTuple):
    origin: np.ndarray  # (3,)
    lattice: np.ndarray  # (3, 3), rows are lattice vectors
    periodic: np.ndarray  # (3,) bool


def _box(lines, words):
    """The box below a line ITEM: BOX BOUNDS [xy xz yz] pp pp pp."""
    tilted = words[:3] == ["xy", "xz", "yz"]
    flags = words[3:] if tilted else words
    if len(flags) != 3 or not all(len(flag) == 2 and set(flag) <= set("pfsm") for flag in flags):
        lines.refuse(f"box bounds {' '.join(words)[:40]!r} are not '[xy xz yz]' and three flags such as pp or ff; no other box can be read")
    rows = [lines.numbers(lines.next(), (2 + tilted,), "low and high" + " and tilt" * tilted) for _ in range(3)]
    low, high = np.array([row[:2] for row in rows]).T
    xy, xz, yz = [row[2] for row in rows] if tilted else (0.0, 0.0, 0.0)
    # the bounds are those of the box's corners along the axes: take off what the tilts add (LAMMPS manual, Howto triclinic)
    low = low - [min(0, xy, xz, xy + xz), min(0, yz), 0]
    high = high - [max(0, xy, xz, xy + xz), max(0, yz), 0]
    edges = edges_of(lines, low, high)
    lattice = np.array([[edges[0], 0, 0], [xy, edges[1], 0], [xz, yz, edges[2]]])
    return _Box(low, lattice, np.array([flag == "pp" for flag in flags]))


def _grain_table(frame, law, wall_types, walls):
    """The Table of the grains, in the file's order: id, x, y, z, radius, mass, and those of motion, type and walls that are there."""
    names = frame.header["names"]
    family = next((form for form in ("", "u", "s", "su") if f"x{form}" in names), "")
    size = "diameter" if "diameter" in names and "radius" not in names else "radius"
    wanted = {"id": "id", "x": f"x{family}", "y": f"y{family}", size: size}
    wanted |= {"z": f"z{family}"} if f"z{family}" in names else {}
    wanted |= {"type": "type"} if wall_types.size else {}
    wanted |= {"mass": "mass"} if "mass" in names or law is None else {}
    for group in (("vx", "vy"), ("vz",), ("omegax", "omegay"), ("omegaz",)):
        wanted |= {name: name for name in group if set(group) & set(names)}
    for w, wall in enumerate(walls):
        wanted |= {f"wall{w}_{k}": f"{wall}[{k}]" for k in range(1, 8)}
    table = _columns(frame, wanted)
    if size == "diameter":
        table.columns["radius"] = table["diameter"] / 2
    table.refuse(~(table["radius"] > 0), "radius = {radius:g} must be above 0")
    if "mass" not in table:
        table.columns["mass"] = law(table["radius"])
    table.refuse(~(table["mass"] > 0), "mass = {mass:g} must be above 0")
    if family.startswith("s"):
        box, axes = frame.header["box"], AXES[: 2 + ("z" in table)]
        real = box.origin[: len(axes)] + table.stacked(axes) @ box.lattice[: len(axes), : len(axes)]
        table.columns |= dict(zip(axes, real.T, strict=True))
    return table


def _columns(frame, wanted):
    """The Table of a frame's columns `wanted`, our name to that in the dump."""
    names = frame.header["names"]
    for name in wanted.values():
        if name not in names:
            frame.refuse(f"no column {name!r}; present are {', '.join(names)}"[:500])
    return frame.table(len(names), {ours: names.index(theirs) for ours, theirs in wanted.items()})


def _grains(frame, table, order, dimension, wall_types):
    """The Grains of a frame, rows of its table in that order, which is that of the ids."""
    twice = np.zeros(len(order), bool)
    twice[order[1:]] = np.diff(table["id"][order]) == 0
    table.refuse(twice, "atom {id:.0f} stands there a second time")
    if dimension == 3 and "z" not in table:
        frame.refuse("no column for z in a dump of dimension 3")
    if dimension == 2 and "z" in table:
        table.refuse(table["z"] != table["z"][:1], "z = {z:.12g} differs from that of the first grain; give dimension=3")
    if len(order) == 0:
        frame.refuse("the frame holds no grain")
    position = table.stacked(AXES[:dimension])[order]
    zero = np.zeros(len(table))  # what the dump leaves out of the motion
    velocity, spin = (np.stack([table.get(word + axis, zero)[order] for axis in AXES], axis=-1) for word in ("v", "omega"))
    radius, box = table["radius"][order], frame.header["box"]
    lattice = box.lattice[:dimension, :dimension]
    return Grains(
        position, radius, table["mass"][order], velocity[:, :dimension], spin[:, 2] if dimension == 2 else spin,
        fixed=np.isin(table["type"][order], wall_types) if wall_types.size else np.zeros(len(order), bool),
        cell=cell_of(lattice, box.periodic[:dimension], position, radius),
        volume=float(np.prod(np.diagonal(lattice))),
    )  # fmt: skip


def _pairs(frame, columns, grains, ids):
    """The Contacts between grains in a frame of a dump local; `ids` of the grains ascend."""
    names = frame.header["names"]
    if frame.header["title"] == "ATOMS":
        frame.refuse("the table is called ATOMS; this is no dump local")
    if columns is None and len(names) < len(CONTACT):
        frame.refuse(f"{len(names)} columns, not the {len(CONTACT)} of {', '.join(CONTACT)}; say with columns= which they are")
    table = _columns(frame, dict(zip(CONTACT, names, strict=False)) if columns is None else columns)
    pairs = np.empty((len(table), 2), np.int64)
    for place, name in enumerate(("first", "second")):
        atom = table.whole(name)
        pairs[:, place] = np.minimum(np.searchsorted(ids, atom), len(ids) - 1)
        table.refuse(ids[pairs[:, place]] != atom, f"atom {{{name}:.0f}} is not among the grains")
    d = grains.position.shape[1]
    tangential = ("p1", "p2", "p3")[:d]
    for name in (f"f{AXES[d - 1]}", *(tangential if set(tangential) & set(table.columns) else ())):
        if name not in table:
            frame.refuse(f"columns= does not say which column is {name}")
    force = np.zeros((len(pairs), d))
    for axis in range(d):
        for name in (f"f{AXES[axis]}", f"p{axis + 1}"):
            force[:, axis] += table.get(name, 0)
    branch, length = branches(table, grains, pairs, table.get("dist", None))
    # the file's own distance has more digits than the difference of two rounded positions
    overlap = grains.radius[pairs].sum(axis=1) - table.get("dist", length)
    point = pair_points(grains, pairs, branch, length, overlap)
    touching = overlap > 0
    return Contacts(pairs[touching], force[touching], point[touching], overlap[touching])


def _wall_contacts(table, wall, rank, grains):
    """The Contacts with one wall: columns wall_1 flag, 2 to 4 force on the grain, 5 to 7 point; `rank` is the index of each row's grain."""
    d = grains.position.shape[1]
    rows = np.flatnonzero(table[f"wall{wall}_1"])
    grain = rank[rows]
    force, point = (table.stacked([f"wall{wall}_{k}" for k in range(start, start + d)])[rows] for start in (2, 5))
    arm = nearest_image(grains.cell, point - grains.position[grain])  # the point is near the atom's image in the box, not near xu
    length = np.sqrt(np.einsum("cd,cd->c", arm, arm))
    bad = np.zeros(len(rank), bool)
    bad[rows] = (length == 0) | (length > (1 + FINE) * grains.radius[grain])
    table.refuse(bad, f"the contact with wall {wall} is not on the grain")
    pairs = np.stack([grain, np.full(len(grain), -1 - wall)], axis=-1)
    return Contacts(pairs, force, grains.position[grain] + arm, grains.radius[grain] - length)
