"""How one wall moves: held, driven along the lecture's cosine, or free under a pressure. One record and one function each.

A motion turns (position, velocity, force of the grains on the wall, length that the pressure acts on, sense, time, step) into the new
position and velocity. `sense` is +1 if outward is the positive direction of the wall's coordinate, else -1; the force is outward.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

from anisogran.dem.kernel import specialised
from anisogran.outcome import checked


class FixedParameters(NamedTuple):
    """No parameter is needed, but a kernel needs a type."""

    unused: float


class CosineParameters(NamedTuple):
    start: float
    end: float
    begin: float
    duration: float


class PressureParameters(NamedTuple):
    pressure: float
    mass: float
    damping: float


@dataclass(frozen=True)
class Fixed:
    """A wall that stays where it is."""

    def parameters(self):
        return FixedParameters(0.0)


@dataclass(frozen=True)
class Cosine:
    """The lecture's strain control z(t) = z_f + (z_0 - z_f)/2 (1 + cos(pi t/duration)), from `start` to `end` (m) in `duration` (s).

    The motion begins at time `begin` and rests afterwards, with zero speed at both ends.
    """

    start: float
    end: float
    duration: float
    begin: float = 0.0

    def __post_init__(self):
        checked("Cosine", "duration", self.duration, above=0, unit="s")

    def parameters(self):
        return CosineParameters(float(self.start), float(self.end), float(self.begin), float(self.duration))


@dataclass(frozen=True)
class Pressure:
    """A wall of `mass` (kg) under `pressure` (N/m, towards the grains), slowed by a dashpot `damping` (kg/s).

    mass a = force of the grains - pressure * length - damping v. The dashpot is taken implicitly, so no damping is too strong. It
    bounds the speed of a wall that meets no grain to pressure * length / damping. Raises InputError for values out of bounds.
    """

    pressure: float
    mass: float
    damping: float

    def __post_init__(self):
        checked("Pressure", "pressure", self.pressure, above=0, unit="N/m")
        checked("Pressure", "mass", self.mass, above=0, unit="kg")
        checked("Pressure", "damping", self.damping, at_least=0, unit="kg/s")

    def parameters(self):
        return PressureParameters(float(self.pressure), float(self.mass), float(self.damping))


def _hold(motion, position, velocity, force, length, sense, time, dt):
    return position, 0.0


def _follow(motion, position, velocity, force, length, sense, time, dt):
    phase = math.pi * min(max((time - motion.begin) / motion.duration, 0.0), 1.0)
    half = 0.5 * (motion.start - motion.end)
    position = motion.end + half * (1.0 + math.cos(phase))
    return position, -half * math.pi / motion.duration * math.sin(phase)


def _yield(motion, position, velocity, force, length, sense, time, dt):
    push = sense * (force - motion.pressure * length)
    velocity = (velocity + dt * push / motion.mass) / (1.0 + dt * motion.damping / motion.mass)
    return position + dt * velocity, velocity


move = specialised({FixedParameters: _hold, CosineParameters: _follow, PressureParameters: _yield})
