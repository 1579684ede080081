"""One contact driven along a given path of overlaps: the force that the grains of a simulation would feel, branch by branch."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from anisogran.dem.laws import NORMAL_LAWS, normal_force, reloading_line, stored_energy
from anisogran.outcome import InputError, checked


@dataclass(frozen=True, eq=False)
class ContactPath:
    """What one contact did: arrays (n,), and the marks of the un- and reloading line that starts from the largest overlap of the path.

    `branch` is "loading" where the contact memory grows, "limit" where it is lowered along the adhesive limit, "elastic" where it stays
    (un- and reloading), "open" where the grains are apart.
    """

    law: Any
    size: float  # m, 2 a1 a2/(a1 + a2)
    overlap: np.ndarray  # m
    force: np.ndarray  # N, repulsion positive
    largest: np.ndarray  # m, the memory of the contact
    stored: np.ndarray  # J that the contact can give back
    branch: np.ndarray  # of str

    @property
    def delta_max(self):
        """The largest overlap of the path in m, 0 if the grains never touch."""
        return max(float(self.overlap.max()), 0.0)

    @property
    def stiffness(self):
        """Slope of the un- and reloading line from delta_max in N/m."""
        return float(reloading_line(self.law.parameters(), self.delta_max, self.size)[0])

    @property
    def delta_0(self):
        """Overlap in m at which this line has no force."""
        return float(reloading_line(self.law.parameters(), self.delta_max, self.size)[1])

    @property
    def delta_min(self):
        """Overlap in m at which this line meets the adhesive limit; delta_0 without adhesion."""
        return float(reloading_line(self.law.parameters(), self.delta_max, self.size)[2])

    @property
    def f_min(self):
        """Force in N at delta_min, the strongest attraction; not above 0."""
        return self.stiffness * (self.delta_min - self.delta_0)


def contact_path(law, overlaps, rate=0.0, size=None):
    """The ContactPath of one contact along `overlaps` (n,) in m, negative where the grains are apart.

    law: Linear or Luding; rate: speed of separation in m/s, a number or (n,), 0 for quasi-static; size: 2 a1 a2/(a1 + a2) of the radii
    in m (twice the radius at a wall), needed by a law with a plastic depth. The branches are as fine as the path: a kink lies somewhere
    within a step. Raises InputError naming what cannot be used.
    """
    if type(law) not in NORMAL_LAWS:
        raise InputError(f"contact_path: law = {law!r} must be a contact law ({', '.join(kind.__name__ for kind in NORMAL_LAWS)})")
    if size is None and getattr(law, "plastic_depth", None) is not None:
        raise InputError(f"contact_path: size = None, but plastic_depth = {law.plastic_depth:g} is a share of 2 a1 a2/(a1 + a2) in m")
    size = 1.0 if size is None else checked("contact_path", "size", size, above=0, unit="m")
    overlap = np.array(overlaps, dtype=float)
    if overlap.ndim != 1 or overlap.size == 0:
        raise InputError(f"contact_path: overlaps has shape {overlap.shape}; it must be (n,) with n > 0")
    try:
        rate = np.broadcast_to(np.asarray(rate, dtype=float), overlap.shape)
    except ValueError:
        raise InputError(f"contact_path: rate of shape {np.shape(rate)} does not fit {overlap.shape}") from None
    for name, values in (("overlaps", overlap), ("rate", rate)):
        for i in np.flatnonzero(~np.isfinite(values))[:1]:
            raise InputError(f"contact_path: {name}[{i}] = {values[i]} is not finite")

    parameters = law.parameters()
    force, largest, stored = np.zeros((3, overlap.size))
    branch, memory = [], 0.0
    for k, (depth, speed) in enumerate(zip(overlap.tolist(), rate.tolist(), strict=True)):
        if depth <= 0.0:
            memory = 0.0
            branch.append("open")
            continue
        force[k], _, largest[k] = normal_force(parameters, depth, speed, memory, size)
        stored[k] = stored_energy(parameters, depth, float(largest[k]), size)
        branch.append("loading" if largest[k] > memory else "limit" if largest[k] < memory else "elastic")
        memory = float(largest[k])
    return ContactPath(law, size, overlap, force, largest, stored, np.array(branch))
