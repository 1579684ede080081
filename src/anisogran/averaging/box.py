"""The average over a whole homogeneous sample: one number, or one tensor, for each field."""

import numpy as np
import xarray as xr

from anisogran import tensors
from anisogran.averaging.grain_sums import backbone, body_area, contact_ends, contact_fabric, stress_moment
from anisogran.glossary import CONVENTIONS, attributes
from anisogran.outcome import InputError

FIELDS = ("area_fraction", "stress", "fabric", "fabric_trace", "fabric_deviator", "anisotropy", "coordination_number")


def average_box(snapshot, fields=FIELDS, least_contacts=3):
    """The fields of the whole sample as a Dataset (tensors with dims i, j). Raises InputError for an unknown field.

    `stress` is the contact stress, momentum flux [force, branch], compression positive, N/m; wall contacts included.
    `anisotropy` is a_2 = 2 (F_1 - F_2)/tr F; NaN, with the reason in its attributes, where there is no contact.
    Source: the lecture's averaging formalism with w_V^p = 1.
    """
    unknown = set(fields) - set(FIELDS)
    if unknown:
        raise InputError(f"average on='box': unknown field {sorted(unknown)[0]!r}; known are {', '.join(FIELDS)}")
    n = len(snapshot.radius)
    ends = contact_ends(snapshot) if set(fields) - {"area_fraction"} else None
    area = body_area(snapshot)
    values = {}
    if "area_fraction" in fields:
        values["area_fraction"] = area.sum() / snapshot.volume
    if "stress" in fields:
        values["stress"] = stress_moment(ends, n).sum(axis=0) / snapshot.volume
    if {"fabric", "fabric_trace", "fabric_deviator", "anisotropy"} & set(fields):
        fabric = np.einsum("p,pij->ij", area, contact_fabric(ends, n)) / snapshot.volume
        total = tensors.trace(fabric)
        deviator = tensors.deviator_size(fabric)
        values |= {"fabric": fabric, "fabric_trace": total, "fabric_deviator": deviator}
        values["anisotropy"] = 4.0 * deviator / total if total > 0 else np.nan
    if "coordination_number" in fields:
        kept, live = backbone(snapshot, ends, least_contacts)
        values["coordination_number"] = live.sum() / kept.sum() if kept.any() else 0.0
    dataset = xr.Dataset(attrs={"volume": snapshot.volume, "conventions": CONVENTIONS})
    for name in fields:
        dims = ("i", "j")[: np.ndim(values[name])]
        dataset[name] = (dims, values[name], attributes(name))
        if name == "anisotropy" and not len(ends.grain):
            dataset[name].attrs["reason"] = "no contacts"
    return dataset
