"""A protocol as a list of stages, each with the steps at which it is looked at, and the gates between them.

A stage says all that it does in terms of the scene and of its simulation, so that a run can be left at any step and taken up from a
checkpoint: nothing else has to be remembered but the stage, the marks that are done, and the records.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from anisogran.outcome import RunFailed


@dataclass(frozen=True)
class Stage:
    """One part of a protocol, such as prepare, relax, load.

    marks: steps since the stage began, rising, at which it is looked at. begin(simulation of the stage before, or None): the Simulation
    of this stage; None goes on with the one before. look(simulation, records, k) records what is wanted at mark k. A stage with a gate
    ends at the first mark where gate(simulation) is empty; what the gate says at the last mark is why the run is refused. `expected`:
    how many of the marks such a stage takes as a rule, `beside`: how many steps its looks take of copies of the simulation; both only move
    the estimate of the time.
    """

    name: str
    marks: np.ndarray
    begin: Callable | None = None
    look: Callable | None = None
    gate: Callable | None = None
    expected: int | None = None
    beside: int = 0

    @property
    def steps(self):
        """Steps that the stage takes, or is expected to take."""
        return self.beside + int(self.marks[-1 if self.expected is None else min(self.expected, len(self.marks)) - 1])

    def is_over(self, simulation, done):
        """Whether the stage ends after `done` of its marks. Raises RunFailed naming the stage if it may not end as it is."""
        if self.gate is None:
            return done == len(self.marks)
        trouble = self.gate(simulation)
        if trouble and done == len(self.marks):
            raise RunFailed(f"stage {self.name}: no equilibrium after {self.marks[-1]} steps: {trouble}")
        return not trouble


def equilibrium(stiffness, stress_error, energy_ratio=1e-5, stress_tolerance=0.01):
    """A gate: E_kin/E_pot < energy_ratio and stress_error(simulation) < stress_tolerance.

    E_kin is that of translation: a rattler in a sample with friction may spin for ever, and bears nothing. E_pot is an estimate, sum
    f^2/(2 stiffness) over the contacts with their whole force.
    """

    def gate(simulation):
        force = simulation.snapshot().force
        potential = float(np.einsum("cd,cd->", force, force) / (2.0 * stiffness))
        kinetic, error = simulation.kinetic_energy(rotation=False), stress_error(simulation)
        if kinetic < energy_ratio * potential and error < stress_tolerance:
            return ""
        return (
            f"E_kin/E_pot = {kinetic:.2g}/{potential:.2g} J (wanted < {energy_ratio:g}), "
            f"stress off by {error:.2%} (wanted < {stress_tolerance:.0%})"
        )

    return gate
