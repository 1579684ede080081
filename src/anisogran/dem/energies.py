"""The energies of a simulation's state, and the balance of its ledger."""

import numpy as np

from anisogran.dem.ledger import BOUNDARY, SUMS, stored_in_contacts
from anisogran.dem.rows import INVERSE_INERTIA, INVERSE_MASS, SPIN, VX, VY


def kinetic_energy(state, rotation=True):
    """Kinetic energy of the movable grains in J, with `rotation` that of the spins too, where they take part."""
    rows = state.body.rows[: state.movable]
    energy = 0.5 * np.sum((rows[:, VX] ** 2 + rows[:, VY] ** 2) / rows[:, INVERSE_MASS])
    if rotation and state.spin is not None:
        energy += 0.5 * np.sum(rows[:, SPIN] ** 2 / rows[:, INVERSE_INERTIA])
    return float(energy)


def potential_energy(state):
    """- m g x of the movable grains in J, against the origin."""
    rows = state.body.rows[: state.movable]
    return float(-np.sum(rows[:, :2] @ np.array(state.gravity) / rows[:, INVERSE_MASS]))


def energies(state):
    """The dict that Simulation.energy describes."""
    s = state
    stored = stored_in_contacts(
        s.body, s.pairs, s.wall_list, s.memory, s.wall_memory, s.normal, s.friction, s.wall_friction, s.boundary, s.out
    )
    energy = {"kinetic": kinetic_energy(s), "elastic": float(stored)}
    if s.gravity is not None:
        energy["potential"] = potential_energy(s)
    if s.ledger is not None:
        present = sum(energy.values())
        energy |= {name: float(value) for name, value in zip(SUMS, s.ledger[: len(SUMS)], strict=True)}
        energy["imbalance"] = float(present + sum(s.ledger[:BOUNDARY]) - s.ledger[BOUNDARY] - s.energy_at_start)
    return energy
