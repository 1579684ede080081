"""The averages: from grains to fields, with the lecture's formalism. This room knows snapshots, never where they came from."""

from anisogran.averaging.blocks import drift, mean_and_error
from anisogran.averaging.box import average_box, contact_network
from anisogran.averaging.rings import ring_densities, ring_profiles
from anisogran.averaging.weights import ring_weights
from anisogran.outcome import InputError

__all__ = ["average", "average_box", "contact_network", "drift", "mean_and_error", "ring_densities", "ring_profiles", "ring_weights"]


def average(snapshot, on="box", fields=None, edges=None, least_contacts=3):
    """Fields of one snapshot as a labelled Dataset: on="box" (whole sample) or on="rings" (between the radii `edges`, about the origin).

    `fields` selects from the fields of the place (default: all); see average_box and ring_profiles for their definitions.
    Raises InputError for an unknown place or field, or rings without edges.
    """
    if on == "box":
        return average_box(snapshot, **({} if fields is None else {"fields": tuple(fields)}), least_contacts=least_contacts)
    if on == "rings":
        if edges is None or len(edges) < 4:
            raise InputError("average on='rings': edges must be at least four increasing radii")
        dataset = ring_profiles(ring_densities(snapshot, edges), edges)
        unknown = set(fields or ()) - set(dataset.data_vars)
        if unknown:
            raise InputError(f"average on='rings': unknown field {sorted(unknown)[0]!r}; known are {', '.join(dataset.data_vars)}")
        return dataset if fields is None else dataset[list(fields)]
    raise InputError(f"average: on = {on!r} must be 'box' or 'rings'")
