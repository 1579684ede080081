"""The way in: fields of a snapshot, of a stream of snapshots, or of a run, at the place and of the kind that is asked for."""

from collections.abc import Iterable
from itertools import chain

from anisogran.averaging.blocks import TimeBlocks, field_profiles, labelled
from anisogran.averaging.choosing import place_of
from anisogran.averaging.densities import densities
from anisogran.averaging.fields import check_fields, extensive_needs, field_values, objection
from anisogran.outcome import InputError
from anisogran.snapshot import Snapshot

DEFAULT = {  # fields of each place if none are asked for, in as far as they are known in its dimension
    "box": (
        "area_fraction", "volume_fraction", "stress", "stress_static", "stress_dynamic", "fabric", "fabric_trace", "fabric_deviator",
        "anisotropy", "coordination_number",
    ),
    "rings": (
        "area_fraction", "volume_fraction", "velocity", "v_phi", "shear_rate", "spin", "continuum_spin", "eigen_rotation", "stress",
        "pressure", "stress_ratio", "s_D", "fabric", "fabric_trace", "fabric_deviator", "inertial_number",
    ),
    "grid": ("area_fraction", "density", "velocity", "stress", "pressure", "fabric"),
    "points": ("area_fraction", "volume_fraction", "density", "velocity", "stress", "pressure", "fabric"),
}  # fmt: skip


def average(grains, on="box", fields=None, width=None, *, edges=None, points=None, kernel=None, least_contacts=None):
    """Fields as a labelled Dataset: units, frame, averaging width and volume in it, compression positive, tensors over (i, j).

    grains: a Snapshot; or an iterable of them, or a run (its `frames`), averaged over time, with the standard error `name_error` of each
    field from blocks of time and the number of `independent_blocks` in the field's attributes (NaN and fewer than two: unknown).
    fields: a name or several, see `averaging.KNOWN` and the glossary; only what these need is computed.
    on: "box", the whole sample; "rings" about the origin, in space (r, z), tensors along (r, phi[, z]); "grid" of rectangles in (x, y);
    with the exact share of each grain in each cell. "points": coarse graining at `points` (P, d).
    width: of rings and rectangles (in space also of levels), or of the kernel; in m, or as "1.0d" in mean diameters, which is the default.
    edges: instead, those of the rings (in space: (rings, levels)) or of the rectangles (x edges, y edges), ascending, in m.
    kernel: "gaussian" (default on points; `width` is its standard deviation), "lucy" (reach of two widths) or "heaviside" (reach of one);
    with on="grid" the fields are smoothed at the middles of the rectangles.
    least_contacts: a grain with fewer is a rattler and left out of coordination_number; default 2 if any contact bears a tangential force,
    else one more than the dimension.
    velocity, spin and their gradients are those of the linear field that fits the grains of a cell best by mass, told at the middle of the
    cell (of the box: at the centre of mass); stress_dynamic is the rest. A fit to few grains takes part of their agitation and, in cells
    narrower than a grain, tells its slope badly: average over time, where all grains of all snapshots count in one fit, or over wider
    cells. NaN, with the `reason` in the field's attributes, where a cell holds no grain, no contact, or too few.
    Raises InputError for whatever is not known, does not fit, or is not there.
    Source: the lecture's averaging formalism; Weinhart, Thornton, Luding & Bokhove, Granular Matter 14 (2012) 289 for the points.
    """
    stream = snapshots_of(grains)
    first = next(stream, None)
    if first is None:
        raise InputError("average: there is no snapshot to average")
    place = place_of(first, on, width, edges, points, kernel)
    if fields is None:
        names = [name for name in DEFAULT[place.name] if objection(name, place) is None]
    else:
        names = list(dict.fromkeys([fields] if isinstance(fields, str) else fields))
    check_fields(names, place)
    needs = extensive_needs(names)
    if isinstance(grains, Snapshot):
        quantities = densities(first, place, needs, least_contacts)
        return labelled(field_values(quantities, place, names), place, quantities["volume"])
    blocks = TimeBlocks()
    for snapshot in chain([first], stream):
        if not isinstance(snapshot, Snapshot) or snapshot.dimension != first.dimension:
            raise InputError(f"average: the stream must hold snapshots of {first.dimension} dimensions, not {snapshot!r:.60}")
        blocks.add(densities(snapshot, place, needs, least_contacts))
    return field_profiles(blocks, place, names)[0]


def snapshots_of(grains):
    """An iterator over the snapshots of what `average` is given."""
    if isinstance(grains, Snapshot):
        return iter([grains])
    source = getattr(grains, "frames", grains)
    if not isinstance(source, Iterable):
        raise InputError(f"average: {type(grains).__name__} is no Snapshot, no stream of them and no run")
    return iter(source)
