"""What the user says about the grains: a checked record of arrays."""

from dataclasses import dataclass

import numpy as np

from anisogran.outcome import InputError, checked


def _array(name, value, shape):
    """A fresh float64 array of that shape; InputError names the first entry that is not finite."""
    try:
        array = np.array(np.broadcast_to(np.asarray(value, dtype=float), shape))
    except (TypeError, ValueError):
        raise InputError(f"Grains: {name} of shape {np.shape(value)} does not fit {shape}") from None
    finite = np.isfinite(array)
    if not finite.all():
        bad = np.argmin(finite.reshape(shape[0], -1).all(axis=1))
        raise InputError(f"Grains: {name}[{bad}] = {array[bad]} is not finite")
    return array


@dataclass(frozen=True, eq=False)
class Grains:
    """Discs in the plane: position (N, 2) in m, radius (N,) in m; mass is that of a sphere, 4/3 pi density radius^3, unless given.

    density in kg/m3 (or `mass` (N,) in kg); velocity (N, 2) in m/s and spin (N,) in 1/s, default at rest; the moment of inertia is
    inertia_factor * mass * radius^2 (0.4 for a sphere). The last `driven` grains belong to a wall and move only with it.
    Raises InputError naming the first bad grain.
    """

    position: np.ndarray
    radius: np.ndarray
    density: float = 2000.0
    velocity: np.ndarray | None = None
    spin: np.ndarray | None = None
    inertia_factor: float = 0.4
    mass: np.ndarray | None = None
    driven: int = 0

    def __post_init__(self):
        try:
            shape = np.shape(self.position)
        except ValueError:
            shape = "ragged"
        if len(shape) != 2 or shape[1] != 2 or shape[0] == 0:
            spheres = "; three dimensions are not there yet" if shape[1:] == (3,) else ""
            raise InputError(f"Grains: position has shape {shape}; it must be (N, 2) with N > 0{spheres}")
        n = shape[0]
        radius = _array("radius", self.radius, (n,))
        mass = 4.0 / 3.0 * np.pi * checked("Grains", "density", self.density, above=0, unit="kg/m3") * radius**3
        checked("Grains", "inertia_factor", self.inertia_factor, above=0, at_most=1)
        values = {
            "position": _array("position", self.position, (n, 2)),
            "radius": radius,
            "mass": mass if self.mass is None else _array("mass", self.mass, (n,)),
            "velocity": _array("velocity", 0.0 if self.velocity is None else self.velocity, (n, 2)),
            "spin": _array("spin", 0.0 if self.spin is None else self.spin, (n,)),
        }
        for name in ("radius", "mass"):
            bad = np.flatnonzero(values[name] <= 0)
            if bad.size:
                raise InputError(f"Grains: {name}[{bad[0]}] = {values[name][bad[0]]:g} must be above 0")
        if not isinstance(self.driven, (int, np.integer)) or not 0 <= self.driven <= n:
            raise InputError(f"Grains: driven = {self.driven!r} must be a whole number between 0 and the number of grains {n}")
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def __len__(self):
        return len(self.radius)


def driven_last(n, driven):
    """(old numbers (n,) in an order that ends with the driven grains, how many these are); `driven`: (n,) bool, or a list of such.

    Raises InputError for a mask of another shape and for a grain that is in two of them.
    """
    try:
        masks = np.atleast_2d(np.asarray(driven))
    except ValueError:
        raise InputError(f"next_stage: driven has masks of different lengths; each must be ({n},) bool") from None
    if masks.dtype != bool or masks.shape[1:] != (n,):
        raise InputError(f"next_stage: driven has the shape {masks.shape} of {masks.dtype}; it must be ({n},) bool, or a list of such")
    twice = np.flatnonzero(masks.sum(axis=0) > 1)
    if twice.size:
        raise InputError(f"next_stage: driven has grain {twice[0]} twice; it can ride on one wall only")
    order = np.concatenate([np.flatnonzero(~masks.any(axis=0)), *(np.flatnonzero(mask) for mask in masks)])
    return order, int(masks.sum())
