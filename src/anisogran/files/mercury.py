"""Grains and contacts of a MercuryDPM run, from its .data and .fstat files."""

import numpy as np

from anisogran.files.foreign import (
    FINE,
    Contacts,
    Grains,
    branches,
    cell_of,
    edges_of,
    mass_law,
    pair_points,
    positive_step,
    snapshot_of,
    type_list,
)
from anisogran.files.frames import Frame, frames, matched
from anisogran.outcome import InputError

DATA = {  # names of the columns of a .data file, by the count of numbers in its header
    8: ("x", "y", "z", "vx", "vy", "vz", "radius", "qx", "qy", "qz", "omegax", "omegay", "omegaz", "info"),
    6: ("x", "y", "vx", "vy", "radius", "angle", "omega", "info"),
}
FSTAT = ("time", "i", "j", "x", "y", "z", "overlap", "slip", "fn", "ft", "nx", "ny", "nz", "tx", "ty", "tz")


def read_mercury(data, fstat=None, *, density, mass_of="sphere", wall_types=(), periodic="", every=1):
    """A stream of Snapshots, one for each `every`-th frame of the file `data`; one frame is in memory at a time.

    `data`: the .data file of MercuryDPM, all frames in one file. A frame has the header `N time xmin ymin zmin xmax ymax zmax` and N lines
    of 14 numbers (x y z, velocity, radius, three angles, spin, info), or in two dimensions `N time xmin ymin xmax ymax` and 8 numbers
    (x y, velocity, radius, angle, minus the spin, info). The mass is that of a sphere or of a disc (`mass_of`) of `density` in kg/m3 or
    kg/m2. Grains with info (the species, unless the user changed it) in `wall_types` are Snapshot.fixed.

    `fstat`: the .fstat file of the same times. A frame has three lines that begin with #, the first with the time, and a line
    `time i j x y z overlap slip fn ft nx ny nz tx ty tz` for each contact. A pair of grains stands there twice, once from each side, but
    once only if one of them is fixed; each pair is one contact here. For two grains the normal points from j to i and the force on i is
    fn n + ft t; for a wall, j = -1 - wall and both vectors are turned round, so that it is -(fn n + ft t). The contact point is worked
    out from centre, normal and overlap, as older versions wrote something else in its place: on the line of centres, in the middle of the
    overlap, or on the wall.

    The sample is the box of the header, which gives `volume`. The files do not say which directions are periodic: `periodic` does, such
    as "x" or "xy"; the others then have a lattice vector too, so long that no contact crosses it.
    Checked in the source of MercuryDPM: the header and order of both files, normal, signs and repetition in the .fstat
    (BaseInteraction::writeToFStat, setFStatData, BaseParticle::getInteractionWith), and that its own reader turns the sign of the spin in
    two dimensions (DPMBase::readNextDataFile); that its writer does so too is from memory, and no run of MercuryDPM was compared.
    Raises InputError at once for a bad argument, and from the stream, with file and line, for whatever does not fit.
    """
    every = positive_step("read_mercury", every)
    law = mass_law("read_mercury", density, mass_of)
    if not isinstance(periodic, str) or not set(periodic) <= set("xyz"):
        raise InputError(f"read_mercury: periodic = {periodic!r} must be made of x, y and z")
    return _snapshots(data, fstat, law, type_list("read_mercury", wall_types), periodic, every)


def _snapshots(path, fstat, law, wall_types, periodic, every):
    contact_frames = None if fstat is None else frames(fstat, _next_contacts)
    for frame, contact in matched(frames(path, _next_grains), contact_frames, every):
        grains = _grains(frame, law, wall_types, periodic)
        yield snapshot_of(frame, grains, [] if contact is None else [_contacts(contact, grains)], frame.label)


def _next_grains(lines):
    """The next Frame of a .data file: header {edges} of the box, (d,); None at the end of the file."""
    if (line := lines.next_filled()) is None:
        return None
    numbers = lines.numbers(line, DATA, "N, time and the corners of the box: 8 numbers, or 6 in two dimensions")
    rows = lines.count(numbers[0], "number of grains")
    low, high = np.reshape(numbers[2:], (2, -1))
    return Frame(lines, numbers[1], "time", rows, edges=edges_of(lines, low, high))


def _next_contacts(lines):
    """The next Frame of an .fstat file; None at the end of the file."""
    if (line := lines.next_filled()) is None:
        return None
    if not line.startswith("#"):
        lines.refuse(f"expected '# time ...', found {line[:40]!r}; is this an .fstat file?")
    words = line[1:].split()
    frame = Frame(lines, lines.numbers("".join(words[:1]), (1,), "the time")[0], "time", None)
    for _ in range(2):
        if not (lines.next() or "").startswith("#"):
            lines.refuse("expected three lines that begin with #")
    return frame


def _grains(frame, law, wall_types, periodic):
    """The Grains of a frame."""
    edges = frame.header["edges"]
    names, axes = DATA[2 + 2 * len(edges)], "xyz"[: len(edges)]
    table = frame.table(len(names), {name: place for place, name in enumerate(names) if name not in ("angle", "qx", "qy", "qz")})
    if frame.rows == 0:
        frame.refuse("the frame holds no grain")
    table.refuse(~(table["radius"] > 0), "radius = {radius:g} must be above 0")
    mass = law(table["radius"])
    table.refuse(~(mass > 0), "radius = {radius:g} is too small to have a mass")
    position = table.stacked(axes)
    return Grains(
        position, table["radius"], mass,
        velocity=table.stacked([f"v{axis}" for axis in axes]),
        spin=-table["omega"] if "omega" in table else table.stacked([f"omega{axis}" for axis in axes]),
        fixed=np.isin(table["info"], wall_types),
        cell=cell_of(np.diag(edges), [axis in periodic for axis in axes], position, table["radius"]),
        volume=float(np.prod(edges)),
    )  # fmt: skip


def _contacts(frame, grains):
    """The Contacts of a frame, each pair of grains once."""
    n, d = grains.position.shape
    table = frame.table(len(FSTAT), {name: place for place, name in enumerate(FSTAT) if name not in ("time", "x", "y", "z", "slip")})
    i, j = table.whole("i"), table.whole("j")
    table.refuse((i < 0) | (i >= n) | (j >= n), f"a contact of grain {{i:.0f}} with {{j:.0f}}, but the grains are 0 to {n - 1}")
    table = table.rows(_each_once(i, j, n))
    pairs = np.stack([table.whole("i"), table.whole("j")], axis=-1)
    normal, tangent = (table.stacked([letter + axis for axis in "xyz"[:d]]) for letter in "nt")
    table.refuse(np.abs(np.einsum("cd,cd->c", normal, normal) - 1) > FINE, "the normal is no unit vector")
    outward = np.where(pairs[:, 1] < 0, 1.0, -1.0)[:, None]  # from the grain to its partner the normal runs at a wall only
    force = -outward * (table["fn"][:, None] * normal + table["ft"][:, None] * tangent)
    arm = (grains.radius[pairs[:, 0]] - table["overlap"])[:, None] * outward * normal
    point = grains.position[pairs[:, 0]] + arm
    inner = np.flatnonzero(pairs[:, 1] >= 0)
    part, overlap = table.rows(inner), table["overlap"][inner]
    branch, length = branches(part, grains, pairs[inner], grains.radius[pairs[inner]].sum(axis=1) - overlap)
    away = np.einsum("cd,cd->c", branch, normal[inner]) > -(1 - FINE) * length
    part.refuse(away, "the normal does not point from grain {j:.0f} to grain {i:.0f}")
    point[inner] = pair_points(grains, pairs[inner], branch, length, overlap)
    return Contacts(pairs, force, point, table["overlap"])


def _each_once(i, j, n):
    """The rows to keep, ascending: every contact with a wall, and the first line of each pair of grains."""
    inner = np.flatnonzero(j >= 0)
    once = np.unique(np.minimum(i, j)[inner] * n + np.maximum(i, j)[inner], return_index=True)[1]
    return np.sort(np.concatenate([np.flatnonzero(j < 0), inner[once]]))
