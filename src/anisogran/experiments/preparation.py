"""What all preparations share: start density, time step, damping, and the gate: a state not in equilibrium is refused, not used."""

import math

import numpy as np

from anisogran.dem import longest_step
from anisogran.outcome import RunFailed

LOOSE = 0.4  # area fraction of the random start


def quasi_static_step(contact, friction, mass):
    """The time step of the experiments in s: a twentieth of the shortest contact time (restitution to 1.6 %), less for strong dashpots."""
    return 0.25 * longest_step(contact, friction, None, mass)


def background_drag(contact, mass):
    """Damping of the preparation in kg/s: a mean grain loses its velocity within fifty of the shortest contact times."""
    return float(mass.mean()) / (50 * math.pi * math.sqrt(0.5 * float(mass.min()) / contact.stiffest))


def elastic_energy(snapshot, stiffness):
    """sum f^2/(2 k) over the contacts in J, with the whole contact force; an estimate to compare kinetic energy with."""
    return float(np.einsum("cd,cd->", snapshot.force, snapshot.force) / (2.0 * stiffness))


def relax(simulation, watch, stiffness, stress_error, chunk, attempts=200, energy_ratio=1e-5, stress_tolerance=0.01):
    """Runs chunks of steps until E_kin/E_pot < energy_ratio and stress_error() < stress_tolerance; raises RunFailed if it never is."""
    for _ in range(attempts):
        watch.run(simulation, chunk)
        potential = elastic_energy(simulation.snapshot(), stiffness)
        kinetic = simulation.kinetic_energy()
        error = stress_error()
        if potential > 0 and kinetic < energy_ratio * potential and error < stress_tolerance:
            return
    raise RunFailed(
        f"no equilibrium after {attempts * chunk} steps of relaxation: E_kin/E_pot = {kinetic:.2g}/{potential:.2g} J "
        f"(wanted < {energy_ratio:g}), stress off by {error:.2%} (wanted < {stress_tolerance:.0%})"
    )
