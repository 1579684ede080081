"""The one hand-over from grains to averages: what every particle code can write down at one instant."""

from dataclasses import dataclass

import numpy as np

from anisogran.outcome import InputError


def _numbers(name, value, shape=None):
    """The value as an array of finite floats of that shape; an empty list has any shape without entries."""
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"Snapshot: {name} is no array of numbers") from None
    if shape is None:
        return array
    if array.size == 0 and 0 in shape:
        array = array.reshape(shape)
    if array.shape != shape:
        raise InputError(f"Snapshot: {name} has shape {array.shape}, expected {shape}")
    bad = np.flatnonzero(~np.isfinite(array).all(axis=tuple(range(1, array.ndim))))
    if bad.size:
        raise InputError(f"Snapshot: {name}[{bad[0]}] is not finite")
    return array


@dataclass(frozen=True, eq=False)
class Snapshot:
    """Grains, contacts and volume at one instant; N grains, C contacts, dimension d.

    position, velocity (N, d) in m, m/s; radius, mass (N,); spin (N,) in 2D, (N, 3) in 3D, 1/s; pairs (C, 2) of grain indices, where
    a contact of grain i with wall w is (i, -1 - w); force (C, d), the whole force on the first grain of the pair, N; point (C, d), the
    contact point, seen from the first grain in a periodic cell; overlap (C,), m. `fixed` (N,) marks the grains of a rough wall, which
    count as wall in every average. `cell` is the matrix of lattice vectors (rows, (d, d)) of a periodic cell, else None; `volume` the
    area (2D) or volume of the sample, by default that of the cell, or else of the bounding box of the grains; `time` in s.
    Raises InputError for shapes that do not fit and for numbers that are not finite.
    """

    position: np.ndarray
    radius: np.ndarray
    mass: np.ndarray
    velocity: np.ndarray
    spin: np.ndarray
    pairs: np.ndarray
    force: np.ndarray
    point: np.ndarray
    overlap: np.ndarray
    cell: np.ndarray | None = None
    volume: float | None = None
    fixed: np.ndarray | None = None
    time: float = 0.0

    def __post_init__(self):
        position = _numbers("position", self.position)
        if position.ndim != 2 or position.shape[1] not in (2, 3) or len(position) == 0:
            raise InputError(f"Snapshot: position has shape {position.shape}; it must be (N, 2) or (N, 3) with N > 0")
        n, d = position.shape
        c = len(self.pairs)
        fixed = np.zeros(n) if self.fixed is None else self.fixed
        shapes = {
            "position": (n, d), "radius": (n,), "mass": (n,), "velocity": (n, d), "spin": (n,) if d == 2 else (n, 3), "fixed": (n,),
            "pairs": (c, 2), "force": (c, d), "point": (c, d), "overlap": (c,),
        }  # fmt: skip
        kinds = {"fixed": bool, "pairs": np.int64}
        for name, shape in shapes.items():
            value = _numbers(name, fixed if name == "fixed" else getattr(self, name), shape)
            object.__setattr__(self, name, value.astype(kinds.get(name, float), copy=False))
        if c and (self.pairs[:, 0].min() < 0 or self.pairs.max() >= n):
            raise InputError(f"Snapshot: pairs must hold grain indices 0..{n - 1}, and -1 - wall in the second place only")
        if self.volume is None:
            extent = (self.position + self.radius[:, None]).max(axis=0) - (self.position - self.radius[:, None]).min(axis=0)
            volume = np.prod(extent) if self.cell is None else abs(np.linalg.det(self.cell))
            object.__setattr__(self, "volume", float(volume))
        elif not self.volume > 0:
            raise InputError(f"Snapshot: volume = {self.volume} must be above 0")

    @property
    def free(self):
        """(N,) bool: the grains that are not part of a wall."""
        return ~self.fixed
