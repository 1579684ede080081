"""The one hand-over from grains to averages: what every particle code can write down at one instant."""

from dataclasses import dataclass, replace

import numpy as np

from anisogran.outcome import InputError, checked


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
    finite = np.isfinite(array)
    if not finite.all():
        raise InputError(f"Snapshot: {name}[{np.argwhere(~finite)[0, 0]}] is not finite")
    return array


@dataclass(frozen=True, eq=False)
class Snapshot:
    """Grains, contacts and volume at one instant; N grains, C contacts, dimension d.

    position, velocity (N, d) in m, m/s; radius, mass (N,); spin (N,) in 2D, (N, 3) in 3D, 1/s; pairs (C, 2) of grain indices, where
    a contact of grain i with wall w is (i, -1 - w); force (C, d), the whole force on the first grain of the pair, N; point (C, d), the
    contact point, seen from the first grain in a periodic cell; overlap (C,), m. `fixed` (N,) marks the grains of a rough wall, which
    count as wall in every average. `cell` holds the lattice vectors of a periodic cell as the rows of a lower triangular matrix (d, d)
    in m, or its sides (d,), else None; `cell_velocity` (d, d) in m/s is how fast these vectors change, so that an image moves with its
    lattice vector (Lees-Edwards shear: the second row is (rate * height, 0)). `sector` is the angle in rad of a ring sector that stands
    for the whole ring, images being turned by it about the origin (the z axis), else None. `volume` is the area (2D) or volume of the
    sample, by default that of the cell, or else of the bounding box of the grains; `time` in s.
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
    cell_velocity: np.ndarray | None = None
    sector: float | None = None

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
            array = np.ascontiguousarray(value, kinds.get(name, float))
            if name == "pairs" and (array != value).any():
                raise InputError(f"Snapshot: pairs[{np.argwhere(array != value)[0, 0]}] is not of whole numbers")
            object.__setattr__(self, name, array)
        for name, wrong in (("radius", self.radius <= 0), ("mass", (self.mass <= 0) & self.free)):
            if wrong.any():
                k = int(np.argmax(wrong))
                raise InputError(f"Snapshot: {name}[{k}] = {getattr(self, name)[k]:g} must be above 0")
        if c and (self.pairs[:, 0].min() < 0 or self.pairs.max() >= n):
            raise InputError(f"Snapshot: pairs must hold grain indices 0..{n - 1}, and -1 - wall in the second place only")
        self._check_images(d)
        if self.volume is None:
            extent = (self.position + self.radius[:, None]).max(axis=0) - (self.position - self.radius[:, None]).min(axis=0)
            volume = np.prod(extent) if self.cell is None else abs(np.linalg.det(self.cell))
            object.__setattr__(self, "volume", float(volume))
        elif not 0 < self.volume < np.inf:
            raise InputError(f"Snapshot: volume = {self.volume} must be above 0, and finite")

    def _check_images(self, d):
        """Brings the cell into its form; refuses what the nearest image cannot be found in."""
        if self.sector is not None:
            parts = 2 * np.pi / checked("Snapshot", "sector", self.sector, above=0, at_most=np.pi, unit="rad")
            if abs(parts - round(parts)) > 1e-9 * parts:
                raise InputError(f"Snapshot: sector = {self.sector:g} rad must be a whole part of the full turn")
            if self.cell is not None:
                raise InputError("Snapshot: a sample is periodic in a cell or in a ring sector, not both")
        if self.cell is None:
            if self.cell_velocity is not None:
                raise InputError("Snapshot: cell_velocity without a cell")
            return
        cell = _numbers("cell", self.cell)
        cell = _numbers("cell", np.diag(cell) if cell.shape == (d,) else cell, (d, d))
        if np.triu(cell, 1).any() or not (np.diag(cell) > 0).all():
            raise InputError(f"Snapshot: cell = {cell.tolist()} must be lower triangular with a positive diagonal, lattice vectors as rows")
        object.__setattr__(self, "cell", cell)
        if self.cell_velocity is not None:
            object.__setattr__(self, "cell_velocity", _numbers("cell_velocity", self.cell_velocity, (d, d)))

    @property
    def free(self):
        """(N,) bool: the grains that are not part of a wall."""
        return ~self.fixed

    @property
    def dimension(self):
        """2 or 3."""
        return self.position.shape[1]

    @property
    def mean_diameter(self):
        """Mean diameter of the free grains in m; of all if none is free."""
        return float(2 * (self.radius[self.free] if self.free.any() else self.radius).mean())

    def bearing(self, share):
        """The Snapshot of the contacts whose force is at least this share of the mean one."""
        size = np.linalg.norm(self.force, axis=1)
        kept = size >= share * size.mean() if len(size) else slice(None)
        return replace(self, **{name: getattr(self, name)[kept] for name in ("pairs", "force", "point", "overlap")})


def frames(snapshots):
    """Of the named snapshots of a run (a dict) those of its steady state, "frame-...", in order; without any, the last one of all."""
    steady = [snapshot for name, snapshot in sorted(snapshots.items()) if name.startswith("frame-")]
    return steady or sorted(snapshots.values(), key=lambda snapshot: snapshot.time)[-1:]
