"""Extensive quantities per volume: what is summed over grains and may be averaged over time. Everything else is made of their means.

Each is Q = (1/V) sum_p w_V^p Q^p of the lecture, with the shares w of a place; one line each, so that only what is asked for is summed.
Moments about the middle of a cell carry the local linear mean field of the velocity and of the spin. On points, the contact stress is
spread along the branches instead, and the forces of walls have a density of their own (Weinhart, Thornton, Luding & Bokhove, Granular
Matter 14, 289, 2012), so that the balance of momentum holds up to the wall.
"""

import numpy as np

from anisogran.averaging.grain_sums import torque
from anisogran.averaging.sample import Sample


def flat_in_plane(sums):
    """(cells, ...) of spins and couples: in the plane their one component loses its axis."""
    return sums[:, 0] if sums.shape[1] == 1 else sums


# name: function of a Sample that gives (cells, ...)
EXTENSIVE = {
    "solid_fraction": lambda s: s.sums(s.grain_volume),
    "density": lambda s: s.sums(s.mass),
    "number_density": lambda s: s.sums(np.ones(len(s.mass))),
    "diameter_density": lambda s: s.sums(s.scalar(2 * s.snapshot.radius)),
    # motion, and its moments about the middle of a cell
    "momentum_density": lambda s: s.sums(s.mass[:, None] * s.velocity),
    "momentum_offset": lambda s: s.offset_sums(s.mass[:, None] * s.velocity),
    "momentum_flux": lambda s: s.sums(s.mass[:, None, None] * s.velocity[:, :, None] * s.velocity[:, None, :]),
    "mass_offset": lambda s: s.offset_sums(s.mass),
    "mass_spread": lambda s: s.spread_sums(s.mass),
    "mass_spin": lambda s: s.sums(s.mass[:, None] * s.spin),
    "mass_spin_offset": lambda s: s.offset_sums(s.mass[:, None] * s.spin),
    "velocity_density": lambda s: s.sums(s.grain_volume[:, None] * s.velocity),
    "spin_density": lambda s: flat_in_plane(s.sums(s.grain_volume[:, None] * s.spin)),
    # contacts
    "stress_static": lambda s: s.line_stress() if s.place.name == "points" else 0.0 - s.sums(s.end_dyads(s.ends.force, s.ends.arm)),
    "fabric": lambda s: s.sums(s.grain_volume[:, None, None] * s.end_dyads(s.ends.normal, s.ends.normal)),
    "overlap_moment": lambda s: s.sums(s.end_dyads(s.ends.overlap[:, None] * s.ends.normal, s.ends.arm)),
    "branch_moment": lambda s: s.sums(s.end_dyads(s.ends.arm, s.ends.arm)),
    "couple_stress": lambda s: flat_in_plane(s.sums(s.end_dyads(torque(s.ends), s.ends.arm))),
    "carrying_grains": lambda s: s.sums(s.scalar(s.backbone[0].astype(float))),
    "carrying_contacts": lambda s: s.sums(s.scalar(np.bincount(s.ends.grain[s.backbone[1]], minlength=len(s.snapshot.radius)))),
}
# those that only points have
OF_POINTS = {
    "wall_force_density": lambda s: s.wall_forces(),
    "stress_divergence": lambda s: s.line_divergence(),
    "density_gradient": lambda s: s.gradient_sums(s.mass),
    "momentum_gradient": lambda s: s.gradient_sums(s.mass[:, None] * s.velocity),
}
SUMS = EXTENSIVE | OF_POINTS


def densities(snapshot, place, names, least_contacts=None):
    """The extensive quantities `names` of one snapshot per volume, a dict of arrays (..., cells), tensor indices first; and "volume".

    A grain with fewer than `least_contacts` contacts is a rattler; see `average`.
    """
    sample = Sample(snapshot, place, least_contacts)
    volume = place.volume(snapshot)
    return {"volume": volume} | {name: np.moveaxis(SUMS[name](sample), 0, -1) / volume for name in names}
