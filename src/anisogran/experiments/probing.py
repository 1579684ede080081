"""Probes of a state of grains at rest in a periodic cell: a small strain of a copy, forth and back, and the stresses that it makes.

The copy is strained homogeneously and comes to rest, then the strain is taken back and it comes to rest again. The way forth is first
loading: contacts slide, or load plastically. The way back is elastic as long as the probe is small: what has slid sticks, and what has
loaded unloads. What is left of the stress at the end did not come back.

The stress is that of the contacts, per deformed area, seen from the material: the rotation of simple shear is undone.
"""

from itertools import product
from typing import NamedTuple

import numpy as np

from anisogran.averaging import average
from anisogran.dem import Periodic
from anisogran.tensors import rotate, symmetric

DIRECTIONS = {  # of the strain, compression positive, of unit size in the half/half measures
    "isotropic": np.array([[1.0, 0.0], [0.0, 1.0]]),
    "pure_shear": np.array([[-1.0, 0.0], [0.0, 1.0]]),
    "simple_shear": np.array([[0.0, 1.0], [1.0, 0.0]]),
}
LOOKS = 200  # for rest, each after half as many steps as the strain took


class Way(NamedTuple):
    """One way of a probe: strain and stress increments (2, 2), compression positive; how it ended."""

    direction: str
    sign: float
    way: str  # "forth" or "back"
    d_eps: np.ndarray
    d_sigma: np.ndarray  # N/m
    opened: int  # contacts there were before but not after
    closed: int  # contacts there were not before
    imbalance: float  # mean net force over mean contact force at the end


def probes(simulation, size, steps, rest, drag=None, directions=tuple(DIRECTIONS)):
    """The `Way`s of probes of both signs in all `directions`, forth and back; the simulation, at rest in its cell, stays as it is.

    size: of the strain, half/half (eps_V, eps_D or eps_xy); steps: in which it is reached; rest: the `imbalance` below which a stress is
    taken; drag: background damping in kg/s. A way that does not come to rest says so by its `imbalance`. Raises RunFailed as
    `Simulation.run`.
    """
    cases = product(directions, (1.0, -1.0))
    return [way for name, sign in cases for way in _there_and_back(simulation, name, sign, size, steps, rest, drag)]


def _there_and_back(simulation, name, sign, size, steps, rest, drag):
    d_eps = sign * size * DIRECTIONS[name]
    there = strained(simulation, d_eps, steps, rest, drag)
    back = strained(there, -d_eps, steps, rest, drag)
    stresses = [contact_stress(simulation), rotate(contact_stress(there), -d_eps[0, 1]), contact_stress(back)]
    contacts = [_contacts(state) for state in (simulation, there, back)]
    for k, (way, strain, end) in enumerate((("forth", d_eps, there), ("back", -d_eps, back))):
        before, after = contacts[k : k + 2]
        changes = len(before - after), len(after - before)
        yield Way(name, sign, way, strain, stresses[k + 1] - stresses[k], *changes, imbalance(end))


def contact_stress(simulation):
    """The stress of the contacts over the whole sample, (2, 2), symmetric, compression positive, in N/m."""
    return symmetric(average(simulation.snapshot(), fields="stress_static").stress_static.values)


def imbalance(simulation):
    """Mean net force on a grain, or mean torque over its radius if that is larger, over the mean contact force; 0 without forces."""
    contact = np.linalg.norm(simulation.snapshot().force, axis=1)
    if not contact.any():
        return 0.0
    net, turning = np.linalg.norm(simulation.net_force, axis=1), np.abs(simulation.torque) / simulation.grains.radius
    return float(max(net.mean(), turning.mean()) / contact.mean())


def _contacts(simulation):
    """The closed contacts as a set of pairs."""
    return {tuple(sorted(pair)) for pair in simulation.snapshot().pairs.tolist()}


def strained(simulation, d_eps, steps, rest, drag=None):
    """A Simulation of the same grains and memory after the strain d_eps (2, 2) of the cell, in `steps` steps, at rest again.

    All of a shear strain is in the flow along x, as in simple shear: the material turns by d_eps[0, 1] counter-clockwise.
    """
    rate = np.array([[d_eps[0, 0], 2.0 * d_eps[0, 1]], [0.0, d_eps[1, 1]]]) / (steps * simulation.dt)
    flow = {"shear_rate": -rate[0, 1], "stretch_rate": (-rate[0, 0], -rate[1, 1])}
    moving = in_cell(simulation, flow, drag=None)  # drag would hold back the flow
    moving.run(steps)
    still = in_cell(moving, {}, drag=drag)
    for _ in range(LOOKS):
        still.run(max(1, steps // 2))
        if imbalance(still) < rest:
            break
    return still


def in_cell(simulation, flow, **changes):
    """The next stage of a simulation in its periodic cell as it is now, which from here has this `flow`: arguments of Periodic by name.

    The grains leave the affine flow of the cell before and take up that of the next.
    """
    width, height, offset = (float(length) for length in simulation.walls.lattice[:3])
    cell = Periodic(width, height, offset=offset, **flow)
    change = _gradient(cell) - _gradient(simulation.boundary)
    velocity = simulation.velocity + simulation.position @ change.T
    return simulation.next_stage(boundary=cell, velocity=velocity, **changes)


def _gradient(cell):
    """The velocity gradient that the cell prescribes, [i, j] = d v_i/d x_j."""
    return np.array([[cell.stretch_rate[0], cell.shear_rate], [0.0, cell.stretch_rate[1]]])
