"""How one wall moves: held, driven along the lecture's cosine or any other path, or free under a pressure. A record and a function each.

A motion turns (position, velocity, force of the grains on the wall, length that the pressure acts on, sense, time, step) into the new
position and velocity. `sense` is +1 if outward is the positive direction of the wall's coordinate, else -1; the force is outward.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from anisogran.compiled import specialised
from anisogran.outcome import InputError, checked


class FixedParameters(NamedTuple):
    """No parameter is needed, but a kernel needs a type."""

    unused: float


class CosineParameters(NamedTuple):
    start: float
    end: float
    begin: float
    duration: float
    half_periods: float


class PathParameters(NamedTuple):
    time: np.ndarray
    position: np.ndarray
    speed: np.ndarray


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

    The motion begins at time `begin`, goes back and forth for that many `half_periods`, a whole number, and rests afterwards; its speed
    is zero at all turns. Raises InputError for values out of bounds.
    """

    start: float
    end: float
    duration: float
    begin: float = 0.0
    half_periods: int = 1

    def __post_init__(self):
        checked("Cosine", "duration", self.duration, above=0, unit="s")
        if checked("Cosine", "half_periods", self.half_periods, at_least=1) != int(self.half_periods):
            raise InputError(f"Cosine: half_periods = {self.half_periods} must be a whole number")

    def parameters(self):
        return CosineParameters(*map(float, (self.start, self.end, self.begin, self.duration, self.half_periods)))


@dataclass(frozen=True, eq=False)
class Path:
    """Strain control by any z(t): `position` (n,) in m at the times `time` (n,) in s, with `speed` (n,) in m/s; n at least 2.

    Between the points the wall follows the cubic through position and speed at both ends (Hermite), so position and speed are continuous.
    Without `speed` the speeds are second-order differences of the positions. The error of a smooth z(t) falls as 1/n^4 with the exact
    speeds and as 1/n^3 with the differences. Before the first and after the last time the wall rests, so let z(t) begin and end at rest,
    or it starts and stops with a jerk. Raises InputError naming the first bad entry.
    """

    time: np.ndarray
    position: np.ndarray
    speed: np.ndarray | None = None

    def __post_init__(self):
        time = _entries("time", self.time)
        if len(time) < 2:
            raise InputError(f"Path: time has {len(time)} entries, at least 2 are needed")
        late = np.flatnonzero(np.diff(time) <= 0) + 1
        if late.size:
            i = late[0]
            raise InputError(f"Path: time[{i}] = {time[i]:g} s must be above time[{i - 1}] = {time[i - 1]:g} s")
        position = _entries("position", self.position, len(time))
        if self.speed is None:
            speed = np.gradient(position, time, edge_order=min(2, len(time) - 1))
        else:
            speed = _entries("speed", self.speed, len(time))
        for name, value in (("time", time), ("position", position), ("speed", speed)):
            object.__setattr__(self, name, value)

    def parameters(self):
        return PathParameters(self.time, self.position, self.speed)


def _entries(name, value, count=None):
    """A fresh array (count,) of finite numbers."""
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"Path: {name} is no array of numbers") from None
    if array.ndim != 1 or count not in (None, len(array)):
        raise InputError(f"Path: {name} has shape {array.shape}, it must be ({'n' if count is None else count},)")
    bad = np.flatnonzero(~np.isfinite(array))
    if bad.size:
        raise InputError(f"Path: {name}[{bad[0]}] = {array[bad[0]]} is not finite")
    return array


@dataclass(frozen=True)
class Pressure:
    """A wall of `mass` (kg) under `pressure` (N/m, towards the grains), slowed by a dashpot `damping` (kg/s).

    mass a = force of the grains - pressure * length - damping v. The dashpot is taken implicitly, so no damping is too strong. It
    bounds the speed of a wall that meets no grain to pressure * length / damping; a wall without damping is not bounded, and once it
    meets the grains nothing but their own dashpots stops it from ringing. How far it is from its pressure stands in the status of
    the simulation. Raises InputError for values out of bounds.
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
    phase = math.pi * min(max((time - motion.begin) / motion.duration, 0.0), motion.half_periods)
    half = 0.5 * (motion.start - motion.end)
    position = motion.end + half * (1.0 + math.cos(phase))
    return position, -half * math.pi / motion.duration * math.sin(phase)


def _trace(motion, position, velocity, force, length, sense, time, dt):
    last = motion.time.size - 1
    if time <= motion.time[0]:
        return motion.position[0], 0.0
    if time >= motion.time[last]:
        return motion.position[last], 0.0
    k = np.searchsorted(motion.time, time) - 1  # time[k] < time <= time[k + 1]
    span = motion.time[k + 1] - motion.time[k]
    s = (time - motion.time[k]) / span
    rise = motion.position[k + 1] - motion.position[k]
    begin = span * motion.speed[k] - rise  # how much steeper than the chord, at both ends
    end = rise - span * motion.speed[k + 1]
    position = motion.position[k] + s * rise + s * (1.0 - s) * ((1.0 - s) * begin + s * end)
    slope = rise + (1.0 - 2.0 * s) * ((1.0 - s) * begin + s * end) + s * (1.0 - s) * (end - begin)
    return position, slope / span


def _yield(motion, position, velocity, force, length, sense, time, dt):
    push = sense * (force - motion.pressure * length)
    velocity = (velocity + dt * push / motion.mass) / (1.0 + dt * motion.damping / motion.mass)
    return position + dt * velocity, velocity


move = specialised({FixedParameters: _hold, CosineParameters: _follow, PathParameters: _trace, PressureParameters: _yield})
