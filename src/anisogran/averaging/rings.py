"""Averages over concentric rings, in the polar frame: densities of one instant, their mean over time, and the profiles made of them.

Only extensive quantities are averaged over time (mass, momentum, contact moments, each per area); velocity, shear rate and the like are
quotients of these means. A disc cut by a ring's edge counts with its exact share of area, and so do all its contacts.
"""

import numpy as np
import xarray as xr

from anisogran import tensors
from anisogran.averaging.grain_sums import body_area, contact_ends, contact_fabric, stress_moment
from anisogran.averaging.weights import ring_weights
from anisogran.glossary import CONVENTIONS, attributes


def ring_densities(snapshot, edges):
    """Extensive quantities per area in each ring; a dict of arrays whose last axis is the ring.

    area_fraction; momentum (2, rings): area fraction times velocity (v_r, v_phi); rotation: area fraction times spin; stress
    (2, 2, rings): contact stress and fluctuation stress relative to the ring's linear mean velocity profile; fabric (2, 2, rings);
    mass and grains: mass and number of grains per area.
    """
    n = len(snapshot.radius)
    weights = ring_weights(snapshot.position, snapshot.radius, edges) * snapshot.free
    ring_area = np.pi * np.diff(np.asarray(edges) ** 2)
    azimuth = np.arctan2(snapshot.position[:, 1], snapshot.position[:, 0])
    distance = np.hypot(*snapshot.position.T)
    turn = tensors.rotation(-azimuth)
    velocity = np.einsum("abp,pb->ap", turn, snapshot.velocity)
    ends = contact_ends(snapshot)
    area = body_area(snapshot)
    moment = tensors.in_polar_frame(np.moveaxis(stress_moment(ends, n), 0, -1), azimuth)
    fabric = tensors.in_polar_frame(np.moveaxis(contact_fabric(ends, n), 0, -1), azimuth)
    fluctuation = velocity[:, None, :] - linear_profile(distance, velocity, weights * snapshot.mass)  # (2, rings, N)
    dynamic = np.einsum("kp,akp,bkp->abk", weights * snapshot.mass, fluctuation, fluctuation)

    def density(quantity):
        return quantity @ weights.T / ring_area

    return {
        "area_fraction": density(area),
        "momentum": density(area * velocity),
        "rotation": density(area * snapshot.spin),
        "stress": density(moment) + dynamic / ring_area,
        "fabric": density(area * fabric),
        "mass": density(snapshot.mass),
        "grains": density(np.ones(n)),
    }


def linear_profile(distance, velocity, weights):
    """The weighted least-squares line velocity(distance) of each ring, at every grain: shape (2, rings, N).

    The fluctuation stress has to be taken relative to the local mean field, else the gradient within a ring counts as agitation.
    """
    total = weights.sum(axis=1)
    total = np.where(total > 0, total, 1.0)  # an empty ring has no grain to give the value to
    centre = weights @ distance / total
    offset = distance - centre[:, None]
    spread = np.einsum("kp,kp->k", weights, offset**2)
    level = np.einsum("kp,ap->ak", weights, velocity) / total
    slope = np.einsum("kp,kp,ap->ak", weights, offset, velocity) / np.where(spread > 0, spread, 1.0)
    return level[:, :, None] + slope[:, :, None] * offset


def ring_profiles(densities, edges):
    """The profiles that follow from (mean) densities: a Dataset over r, tensors in the frame (r, phi).

    shear_rate = |r d(v_phi/r)/dr| and continuum_spin = (dv/dr + v/r)/2 by central differences between the rings (one-sided at the
    ends), so they see the profile at the width of a ring. inertial_number = shear_rate sqrt(mean grain mass/pressure).
    """
    edges = np.asarray(edges)
    r = 0.5 * (edges[1:] + edges[:-1])
    nu = densities["area_fraction"]
    v_phi = densities["momentum"][1] / nu
    spin = densities["rotation"] / nu
    stress = densities["stress"]
    pressure = tensors.mean(stress)
    gradient = np.gradient(v_phi / r, r, edge_order=2) * r
    shear_rate = np.abs(gradient)
    continuum_spin = 0.5 * gradient + v_phi / r
    shear = 0.5 * (stress[0, 1] + stress[1, 0])
    grain_mass = densities["mass"] / densities["grains"]
    values = {
        "area_fraction": nu,
        "v_phi": v_phi,
        "shear_rate": shear_rate,
        "spin": spin,
        "continuum_spin": continuum_spin,
        "eigen_rotation": spin - continuum_spin,
        "stress": stress,
        "pressure": pressure,
        "stress_ratio": np.abs(shear) / pressure,
        "s_D": tensors.deviator_size(stress) / pressure,
        "fabric": densities["fabric"],
        "fabric_trace": tensors.trace(densities["fabric"]),
        "fabric_deviator": tensors.deviator_size(densities["fabric"]),
        "inertial_number": shear_rate * np.sqrt(grain_mass / pressure),
    }
    dataset = xr.Dataset(attrs={"conventions": CONVENTIONS, "frame": "(r, phi)", "edges": edges})
    for name, value in values.items():
        dims = ("i", "j", "r") if np.ndim(value) == 3 else ("r",)
        dataset[name] = (dims, value, attributes(name))
    return dataset.assign_coords(r=("r", r, attributes("r")))
