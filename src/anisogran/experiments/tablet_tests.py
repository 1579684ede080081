"""What is done to a free tablet: crushed between platens, torn between platens that its end layers are glued to, or shaken.

Each test is how it begins and what a row of its series says.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from anisogran.averaging import average, fragments
from anisogran.dem import Box, Cosine, Path
from anisogran.outcome import InputError
from anisogran.scenes.keys import MANY

WIDE, HIGH = 3.0, 4.0  # the box around a tablet, in its widths and, where it is shaken, heights
GRIP = 1.5  # mean diameters of each end of the tablet that are glued to the platen in tension
POINTS = 64  # of the path of the floor in a period; the cubics between them are exact to 1e-6 of the amplitude
NO_BOND = 1e-3  # of the low pressure times the mean diameter: the force of a contact without adhesion that is but its dashpot's


class Test(NamedTuple):
    """begin(scene, free simulation): the Simulation of the test; row(scene, simulation, snapshot): a row of the series, a dict."""

    begin: Callable
    row: Callable


def check_path(scene):
    """Raises InputError if the path of the floor has more than MANY points."""
    points = scene.duration * scene.frequency * POINTS
    if points > MANY:
        raise InputError(
            f"Tablet: duration = {scene.duration:g} s and frequency = {scene.frequency:g} 1/s make {points:g} points of the path of the "
            f"floor, {POINTS} in a period; at most {MANY:g} are kept"
        )


def placed(free):
    """Positions (N, 2) of a tablet that stands on the floor in the middle of the box; its width and height in m."""
    position, radius = free.position, free.grains.radius[:, None]
    low, high = (position - radius).min(axis=0), (position + radius).max(axis=0)
    width, height = high - low
    return position - low + (0.5 * (WIDE - 1.0) * width, 0.0), float(width), float(height)


def crushed(scene, free):
    """Between two smooth platens, the upper one coming down."""
    position, width, height = placed(free)
    box = Box(WIDE * width, height, top=Cosine(height, height * math.exp(-scene.strain), scene.duration))
    return free.next_stage(boundary=box, position=position, friction=scene.friction, drag=None)


def torn(scene, free):
    """Between two platens that the grains of the end layers are glued to, the upper one going up."""
    position, width, height = placed(free)
    grip = GRIP * 2.0 * scene.mean_radius
    bottom, top = position[:, 1] < grip, position[:, 1] > height - grip
    nowhere = np.zeros(len(position), bool)
    pulled = Cosine(height, height * math.exp(scene.strain), scene.duration)
    box = Box(WIDE * width, height, top=pulled, glued=(0, 0, int(bottom.sum()), int(top.sum())))
    return free.next_stage(boundary=box, position=position, driven=[nowhere, nowhere, bottom, top], friction=scene.friction, drag=None)


def shaken(scene, free):
    """On a floor that moves as amplitude (1 - cos(2 pi frequency t)), under gravity."""
    position, width, height = placed(free)
    count = max(2, math.ceil(scene.duration * scene.frequency * POINTS)) + 1
    time = np.arange(count) / (POINTS * scene.frequency)
    omega = 2.0 * math.pi * scene.frequency
    floor = Path(time, scene.amplitude * (1.0 - np.cos(omega * time)), scene.amplitude * omega * np.sin(omega * time))
    box = Box(WIDE * width, HIGH * height, bottom=floor)
    gravity = (0.0, -scene.gravity) if scene.gravity else None
    return free.next_stage(boundary=box, position=position, gravity=gravity, friction=scene.friction, drag=None)


def platen_row(scene, simulation, snapshot):
    """Strain and stress of the platens: the mean of the forces on both, over the width that the tablet had."""
    box, force = simulation.boundary, simulation.walls.force
    _, _, bottom, top = box.glued
    push = simulation.net_force[len(snapshot.radius) - bottom - top :, 1]  # on the glued grains, those at the bottom first
    lower, upper = force[2] - push[:bottom].sum(), force[3] + push[bottom:].sum()
    strain = math.log(box.height / (simulation.walls.position[3] - simulation.walls.position[2]))
    row = {"time": simulation.time, "eps_zz": strain, "sigma_zz": stress(simulation, 0.5 * (lower + upper))}
    return row | state_row(scene, simulation, snapshot)


def floor_row(scene, simulation, snapshot):
    """Height and stress of the floor."""
    floor = {"floor_height": float(simulation.walls.position[2]), "sigma_zz": stress(simulation, simulation.walls.force[2])}
    return {"time": simulation.time} | floor | state_row(scene, simulation, snapshot)


def stress(simulation, force):
    """A force in N over the width that the tablet had when the test began."""
    return float(force) * WIDE / simulation.boundary.width


def state_row(scene, simulation, snapshot):
    """The part of a row that all tests have."""
    adhesive = getattr(scene.contact, "kc", 0.0) > 0.0
    parts = fragments(snapshot, 0.0 if adhesive else NO_BOND * scene.pressure * 2.0 * scene.mean_radius)
    area, x = snapshot.radius**2, snapshot.position[:, 0]
    spread = np.average((x - np.average(x, weights=area)) ** 2, weights=area)
    return {
        "width": math.sqrt(12.0 * spread),
        "fragments": int(parts.fragments),
        "largest_fragment": float(parts.largest_fragment),
        "mean_fragment_mass": float(parts.mean_fragment_mass),
        "coordination_number": float(average(snapshot, fields="coordination_number", least_contacts=1).coordination_number),
        "kinetic_energy": simulation.kinetic_energy(),
        "elastic_energy": simulation.energy()["elastic"],
    }


TESTS = {"compression": Test(crushed, platen_row), "tension": Test(torn, platen_row), "vibration": Test(shaken, floor_row)}
