"""The average over a whole homogeneous sample: one number, or one tensor, for each field."""

from typing import NamedTuple

import numpy as np
import xarray as xr

from anisogran import tensors
from anisogran.averaging.grain_sums import backbone, body_area, contact_ends, contact_fabric, nearest_image, stress_moment
from anisogran.glossary import CONVENTIONS, attributes
from anisogran.outcome import InputError

FIELDS = (
    "area_fraction", "stress", "stress_static", "stress_dynamic", "fabric", "fabric_trace", "fabric_deviator", "anisotropy",
    "coordination_number",
)  # fmt: skip
FROM_FABRIC = {"fabric", "fabric_trace", "fabric_deviator", "anisotropy"}
FROM_MOTION = {"area_fraction", "stress_dynamic"}


def average_box(snapshot, fields=FIELDS, least_contacts=3):
    """The fields of the whole sample as a Dataset (tensors with dims i, j). Raises InputError for an unknown field.

    `stress` = stress_static (contacts, walls included; [force, branch]) + stress_dynamic (fluctuations relative to the linear mean
    velocity field), compression positive, N/m.
    `anisotropy` is a_2 = 2 (F_1 - F_2)/tr F; NaN, with the reason in its attributes, where there is no contact.
    Source: the lecture's averaging formalism with w_V^p = 1.
    """
    unknown = set(fields) - set(FIELDS)
    if unknown:
        raise InputError(f"average on='box': unknown field {sorted(unknown)[0]!r}; known are {', '.join(FIELDS)}")
    n = len(snapshot.radius)
    ends = contact_ends(snapshot) if set(fields) - FROM_MOTION else None
    area = body_area(snapshot)
    values = {}
    if "area_fraction" in fields:
        values["area_fraction"] = area.sum() / snapshot.volume
    if {"stress", "stress_static"} & set(fields):
        values["stress_static"] = stress_moment(ends, n).sum(axis=0) / snapshot.volume
    if {"stress", "stress_dynamic"} & set(fields):
        fluctuation = velocity_fluctuation(snapshot)
        values["stress_dynamic"] = np.einsum("p,pi,pj->ij", snapshot.mass, fluctuation, fluctuation) / snapshot.volume
    if "stress" in fields:
        values["stress"] = values["stress_static"] + values["stress_dynamic"]
    if FROM_FABRIC & set(fields):
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


def velocity_fluctuation(snapshot):
    """Velocity of each grain less the linear field v = a + G x that fits all free grains best (by mass), shape (N, d); 0 for wall grains.

    In a box sheared or compressed at large the gradient would otherwise count as agitation.
    """
    weight = np.sqrt(snapshot.mass * snapshot.free)[:, None]
    design = np.column_stack([np.ones(len(snapshot.radius)), snapshot.position])
    field = np.linalg.lstsq(weight * design, weight * snapshot.velocity, rcond=None)[0]
    return (snapshot.velocity - design @ field) * snapshot.free[:, None]


class ContactNetwork(NamedTuple):
    """The directions and the size of a contact network, as the affine moduli need them."""

    a2: float  # second Fourier coefficient of the contact directions, along the axis of the fabric
    a4: float  # fourth Fourier coefficient
    scale: float  # (1/V) sum over contacts of the squared branch length, each contact once


def contact_network(snapshot, angle=None):
    """The ContactNetwork of a whole 2D sample; `angle` of the axis in radians, default the major axis of the normals.

    f(theta) = (1 + a2 cos 2 theta + a4 cos 4 theta)/(2 pi) from that axis; contacts weighted by their squared branch length, as in the
    stiffness. A wall contact has the branch from the grain's centre to the wall.
    """
    ends = contact_ends(snapshot)
    # the branch of a contact between two grains runs along one line of centres: the sum of both arms
    arm = np.sqrt(np.einsum("ed,ed->e", ends.arm, ends.arm))
    inner = (ends.partner >= 0) & (ends.grain < ends.partner)
    wall = ends.partner < 0
    first, second = ends.grain[inner], ends.partner[inner]
    branch = nearest_image(snapshot, snapshot.position[second] - snapshot.position[first])
    square = np.concatenate([np.einsum("cd,cd->c", branch, branch), arm[wall] ** 2])
    normal = np.concatenate([ends.normal[inner], ends.normal[wall]])
    theta = np.arctan2(normal[:, 1], normal[:, 0])
    if angle is None:
        angle = 0.5 * np.arctan2(np.sum(square * np.sin(2 * theta)), np.sum(square * np.cos(2 * theta)))
    weight = square / square.sum()
    a2, a4 = (2 * float(np.sum(weight * np.cos(order * (theta - angle)))) for order in (2, 4))
    return ContactNetwork(a2, a4, float(square.sum() / snapshot.volume))
