"""The averages: from grains to fields, with the lecture's formalism. This room knows snapshots, never where they came from."""

import numpy as np

from anisogran.averaging.blocks import drift, mean_and_error
from anisogran.averaging.box import average_box, contact_network
from anisogran.averaging.rings import ring_densities, ring_profiles
from anisogran.averaging.weights import ring_weights
from anisogran.outcome import InputError

__all__ = ["average", "average_box", "contact_network", "drift", "mean_and_error", "ring_densities", "ring_profiles", "ring_weights"]


def average(snapshot, on="box", fields=None, edges=None, least_contacts=3):
    """Fields of one two-dimensional snapshot as a labelled Dataset, units in the attributes, tensors over (i, j).

    on="box": the whole sample; on="rings": between the radii `edges` (m, ascending, four or more) about the origin, over r, tensors
    in the frame (r, phi). `fields` is a name or several (default: all of the place; see average_box and ring_profiles). A grain with
    fewer than `least_contacts` contacts is a rattler and left out of coordination_number: 3 without friction, 2 with it.
    Raises InputError for an unknown place or field, bad edges, or a snapshot in three dimensions.
    """
    if snapshot.position.shape[1] != 2:
        raise InputError("average: the snapshot is three-dimensional; only two dimensions are averaged so far")
    fields = (fields,) if isinstance(fields, str) else fields
    if on == "box":
        return average_box(snapshot, **({} if fields is None else {"fields": tuple(fields)}), least_contacts=least_contacts)
    if on == "rings":
        edges = np.asarray([] if edges is None else edges, dtype=float)
        if edges.ndim != 1 or edges.size < 4 or not np.all(np.diff(edges) > 0) or edges[0] < 0:
            raise InputError("average on='rings': edges must be at least four ascending radii, none below 0")
        dataset = ring_profiles(ring_densities(snapshot, edges), edges)
        unknown = set(fields or ()) - set(dataset.data_vars)
        if unknown:
            raise InputError(f"average on='rings': unknown field {sorted(unknown)[0]!r}; known are {', '.join(dataset.data_vars)}")
        return dataset if fields is None else dataset[list(fields)]
    raise InputError(f"average: on = {on!r} must be 'box' or 'rings'")
