"""The fields: what each is made of, by which formula, and how it is told. The listing is the list of what `average` knows.

An extensive quantity is a field of its own; the others are formulas of the fields and quantities named in `needs`, so that asking for one
asks for just what it takes. Formulas get arrays (..., cells), tensor indices first, and return such.
"""

import difflib
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from anisogran import tensors
from anisogran.averaging.densities import EXTENSIVE, OF_POINTS
from anisogran.averaging.mean_field import fluctuation_stress, inverse_spread, mean_slope, quotient, rotation_rate, strain_fit
from anisogran.glossary import GLOSSARY
from anisogran.outcome import InputError

ROUNDING = 1e-12  # a deviator smaller than that share of its tensor is none


class Field(NamedTuple):
    """`needs`: names whose values the formula gets, in that order ("place" is the place itself)."""

    needs: tuple
    formula: Callable
    dimensions: tuple = (2, 3)
    places: tuple = ("box", "rings", "grid", "points")


def half_turn(angle):
    """The angle in (-pi/2, pi/2]: axes have no sense."""
    return np.pi / 2 - np.mod(np.pi / 2 - angle, np.pi)


def true_deviator(tensor):
    """The size of the deviator; 0 where the tensor is isotropic but for rounding."""
    size, deviator = np.sqrt(np.einsum("ij...,ij...->...", tensor, tensor)), tensors.deviator_size(tensor)
    return np.where(deviator > ROUNDING * size, deviator, 0.0)


def axis_angle(tensor):
    """Angle of the major axis of a tensor in the plane; NaN where it is isotropic, and so has none."""
    return np.where(true_deviator(tensor) > 0, tensors.principal_angle(tensor), np.nan)


def flat(values):
    """(1, ...) of the plane without its first axis, as it is in space."""
    return values[0] if len(values) == 1 else values


def inertial_number(place, rate, pressure, density, numbers, diameters, solid):
    """rate sqrt(m / p) with the mean mass of a grain; in space rate d sqrt(rho / p) with their mean diameter and density."""
    inertia = quotient(density, numbers) if place.dimension == 2 else quotient(diameters, numbers) ** 2 * quotient(density, solid)
    # NaN where nothing presses
    return rate * np.sqrt(quotient(inertia, np.where(pressure > 0, pressure, 0.0)))


def curvature(place, spin, spread):
    """grad[j] = d spin / d x_j in the plane, grad[i, j] = d spin_i / d x_j in space; NaN where the grains of a cell do not tell it."""
    value, slope = spin
    return np.where(spread[1], place.scalar_gradient(slope[0]) if place.dimension == 2 else place.gradient(value, slope), np.nan)


LINEAR = ("place", "density", "mass_offset", "spread")  # what every linear mean field needs
PLANE, RINGS = (2,), ("rings",)

DERIVED = {
    "area_fraction": Field(("solid_fraction",), lambda nu: nu, PLANE),
    "volume_fraction": Field(("solid_fraction",), lambda nu: nu, (3,)),
    "mean_diameter": Field(("diameter_density", "number_density"), quotient),
    # motion
    "spread": Field(("density", "mass_offset", "mass_spread"), inverse_spread),
    "linear_velocity": Field((*LINEAR, "momentum_density", "momentum_offset"), mean_slope),
    "linear_spin": Field((*LINEAR, "mass_spin", "mass_spin_offset"), mean_slope),
    "velocity": Field(("linear_velocity",), lambda field: field[0]),
    "v_phi": Field(("velocity",), lambda v: v[1], places=RINGS),
    "velocity_gradient": Field(
        ("place", "linear_velocity", "spread"), lambda place, field, spread: np.where(spread[1], place.gradient(*field), np.nan)
    ),
    "strain_rate": Field(("velocity_gradient",), lambda gradient: -tensors.symmetric(gradient)),
    "shear_rate": Field(("velocity_gradient",), lambda gradient: 2 * tensors.deviator_size(gradient)),
    "continuum_spin": Field(("velocity_gradient",), rotation_rate),
    "spin": Field(("linear_spin",), lambda field: flat(field[0])),
    "eigen_rotation": Field(("spin", "continuum_spin"), lambda spin, continuum: spin - continuum),
    "curvature": Field(("place", "linear_spin", "spread"), curvature),
    # stress
    "stress_dynamic": Field((*LINEAR[1:], "momentum_density", "momentum_offset", "momentum_flux"), fluctuation_stress),
    "stress": Field(("stress_static", "stress_dynamic"), lambda static, dynamic: static + dynamic),
    "pressure": Field(("stress",), tensors.mean),
    "s_D": Field(("stress", "pressure"), lambda stress, p: quotient(tensors.deviator_size(stress), p)),
    "stress_ratio": Field(("stress", "pressure"), lambda stress, p: quotient(np.abs(tensors.symmetric(stress)[0, 1]), p), places=RINGS),
    "inertial_number": Field(
        ("place", "shear_rate", "pressure", "density", "number_density", "diameter_density", "solid_fraction"), inertial_number
    ),
    "torque_stiffness": Field(
        ("couple_stress", "curvature"), lambda couple, bend: quotient((couple * bend).sum(axis=0), (bend * bend).sum(axis=0)), PLANE
    ),
    # structure
    "fabric_trace": Field(("fabric",), tensors.trace),
    "fabric_deviator": Field(("fabric",), tensors.deviator_size),
    "anisotropy": Field(("fabric_deviator", "fabric_trace"), lambda deviator, trace: quotient(4 * deviator, trace), PLANE),
    "coordination_number": Field(
        ("carrying_contacts", "carrying_grains"), lambda contacts, grains: np.where(grains > 0, quotient(contacts, grains), 0.0)
    ),
    "rattler_fraction": Field(("carrying_grains", "number_density"), lambda carrying, grains: 1 - quotient(carrying, grains)),
    # elastic strain of the contacts
    "elastic_strain": Field(
        ("overlap_moment", "fabric"), lambda moment, fabric: tensors.symmetric(np.pi * strain_fit(moment, fabric)), PLANE
    ),
    "elastic_strain_raw": Field(
        ("overlap_moment", "branch_moment"), lambda moment, branches: tensors.symmetric(strain_fit(moment, branches))
    ),
    "bulk_modulus": Field(
        ("stress_static", "elastic_strain"), lambda stress, strain: quotient(tensors.trace(stress), tensors.trace(strain)), PLANE
    ),
    "shear_modulus": Field(
        ("stress_static", "elastic_strain"),
        lambda stress, strain: quotient(tensors.deviator_size(stress), true_deviator(strain)), PLANE,
    ),
    # directions of the major axes, and between them
    "stress_angle": Field(("stress",), axis_angle, PLANE),
    "fabric_angle": Field(("fabric",), axis_angle, PLANE),
    "elastic_strain_angle": Field(("elastic_strain",), axis_angle, PLANE),
    "strain_rate_angle": Field(("strain_rate",), axis_angle, PLANE),
    "fabric_to_stress_angle": Field(("stress_angle", "fabric_angle"), lambda stress, fabric: half_turn(stress - fabric), PLANE),
    "strain_to_stress_angle": Field(("stress_angle", "elastic_strain_angle"), lambda stress, strain: half_turn(stress - strain), PLANE),
    "rate_to_stress_angle": Field(("stress_angle", "strain_rate_angle"), lambda stress, rate: half_turn(stress - rate), PLANE),
    "rate_to_fabric_angle": Field(("fabric_angle", "strain_rate_angle"), lambda fabric, rate: half_turn(fabric - rate), PLANE),
}  # fmt: skip
KNOWN = tuple(name for name in (*EXTENSIVE, *DERIVED, *OF_POINTS) if name in GLOSSARY)  # the rest are ingredients


def objection(name, place):
    """Why a known field is not known at a place, or None."""
    field = DERIVED.get(name)
    places = ("points",) if name in OF_POINTS else field.places if field else (place.name,)
    if place.name not in places:
        return f"is known on {' and '.join(places)} only"
    if field and place.dimension not in field.dimensions:
        return f"is not known in {place.dimension} dimensions"
    return None


def known_at(place):
    """The names of all fields that are known at a place."""
    return [name for name in KNOWN if objection(name, place) is None]


def check_fields(names, place):
    """Raises InputError for a field that is not known, or not in this dimension or at this place."""
    for name in names:
        if name not in KNOWN:
            near = difflib.get_close_matches(str(name), KNOWN, 1)
            hint = f"did you mean {near[0]}?" if near else f"known are {', '.join(known_at(place))}"
            raise InputError(f"average on={place.name!r}: unknown field {name!r}; {hint}")
        reason = objection(name, place)
        if reason:
            raise InputError(f"average on={place.name!r}: the field {name!r} {reason}")


def extensive_needs(names):
    """The names of the extensive quantities that the fields are made of, each once."""
    needs = {}
    for name in names:
        if name in DERIVED:
            needs |= dict.fromkeys(extensive_needs(DERIVED[name].needs))
        elif name != "place":
            needs[name] = None
    return list(needs)


def field_values(quantities, place, names):
    """The fields `names` as a dict of arrays (..., cells), from extensive quantities (means over time, perhaps) of a place."""
    known = {**quantities, "place": place}

    def value(name):
        if name not in known:
            field = DERIVED[name]
            known[name] = field.formula(*(value(need) for need in field.needs))
        return known[name]

    return {name: value(name) for name in names}


REASONS = {
    "s_D": "no pressure",
    "stress_ratio": "no pressure",
    "inertial_number": "no pressure, or too few grains to tell a gradient",
    "shear_modulus": "no contacts, or an isotropic strain",
    "torque_stiffness": "no curvature, or too few grains to tell it",
}


def missing(name):
    """What a cell lacks where this field is NaN."""
    needs = extensive_needs([name])
    if name in REASONS:
        return REASONS[name]
    if name.endswith("_angle"):
        return "isotropic, or nothing to tell an axis from"
    if {"fabric", "overlap_moment", "branch_moment"} & set(needs):
        return "no contacts"
    return "no grains, or too few to tell a gradient" if "mass_spread" in needs else "no grains"
