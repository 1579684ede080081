"""Paths of the element test: what is prescribed, as turning points. Each returns a dict that `element_test` takes, and that you may edit.

Keys are eps_ or sigma_ with xx, zz, xz, V, D (half/half, eps_D = (eps_zz - eps_xx)/2), three of them and independent (eps_xz = 0 need
not be said); `spin`, the rotation of the material in rad, counter-clockwise; and `time` in s. Strains are true, all are totals, compression
is positive. z is the second axis: vertical in the biaxial box, along the velocity gradient in simple shear. Numbers are held constant.
"""

from typing import NamedTuple

import numpy as np

from anisogran.outcome import InputError, closest

# sigma_xx and so on from (sigma_V, sigma_1, sigma_2), likewise for the strain
ROWS = {
    name: np.array(row)
    for name, row in {
        "xx": (1.0, 1.0, 0.0),
        "zz": (1.0, -1.0, 0.0),
        "xz": (0.0, 0.0, 1.0),
        "V": (1.0, 0.0, 0.0),
        "D": (0.0, -1.0, 0.0),
    }.items()
}
_KEYS = [*(f"{kind}_{name}" for kind in ("eps", "sigma") for name in ROWS), "spin", "time"]


def biaxial(eps_zz, pressure):
    """The biaxial box: vertical strain at constant sigma_xx = pressure. eps_zz: turning points, as [0, 0.1] or [0, 0.02, -0.02]."""
    return {"eps_zz": eps_zz, "sigma_xx": pressure}


def pure_shear(eps_D):
    """Isochoric pure shear, compressed along z by eps_D."""
    return {"eps_D": eps_D, "eps_V": 0.0}


def simple_shear(gamma, sigma_zz=None):
    """Simple shear v_x = rate z with the amount gamma: at constant volume, or at a constant normal stress sigma_zz on the planes of shear.

    The compressive axis of the strain lies at -45 degrees from x for gamma > 0; the material rotates by -gamma/2.
    """
    half = -0.5 * np.asarray(gamma, dtype=float)
    normal = {"eps_zz": 0.0} if sigma_zz is None else {"sigma_zz": sigma_zz}
    return {"eps_xz": half, "spin": half, "eps_xx": 0.0, **normal}


def isotropic_compression(pressure):
    """All-round compression from pressure to pressure, without shear stress."""
    return {"sigma_V": pressure, "sigma_D": 0.0}


def cyclic(amplitude, cycles, middle=0.0):
    """Turning points of a cyclic strain or stress: middle, middle + amplitude, middle - amplitude, ..., middle."""
    return np.array([middle, *([middle + amplitude, middle - amplitude] * cycles), middle])


KINDS = {"biaxial": biaxial, "pure_shear": pure_shear, "simple_shear": simple_shear, "isotropic_compression": isotropic_compression}


class Plan(NamedTuple):
    """A control as the driver takes it: row i says of_strain[i] . strain + of_stress[i] . stress = goals[:, i] in (V, 1, 2)."""

    rows: tuple  # names of the three prescribed components
    path: dict  # name: (n + 1,), also spin and time
    goals: np.ndarray  # (n, 3), strains from the start on
    of_strain: np.ndarray
    of_stress: np.ndarray
    first_strain: np.ndarray  # (3,)

    @property
    def spin(self):
        return self.path["spin"]

    @property
    def time(self):
        return self.path["time"]

    @property
    def sheared(self):
        """Whether the path has shear strain or stress xz, or a rotation."""
        return bool(np.any(self.spin)) or any(key.endswith("xz") and np.any(self.path[key]) for key in self.rows)

    def place(self, index):
        """Where point `index` of the path is, in words."""
        moving = [key for key, values in self.path.items() if key != "time" and np.any(values != values[0])] or list(self.rows)
        return ", ".join(f"{key} = {self.path[key][index]:.6g}" for key in moving)


def planned(control, steps):
    """The `Plan` of a control. Raises InputError naming the key for whatever makes no sense."""
    where = "element_test: control"
    for key in control:
        if key not in _KEYS:
            raise InputError(f"{where}: unknown key {key!r}, did you mean {closest(key, _KEYS)!r}? It may have {', '.join(_KEYS)}")
    given = {key: _turns(where, key, values) for key, values in control.items()}
    rows = tuple(key for key in given if key not in ("spin", "time"))
    if len(rows) == 2 and not any(key.endswith("_xz") for key in rows):
        given["eps_xz"], rows = np.zeros(1), (*rows, "eps_xz")
    if len(rows) != 3:
        raise InputError(f"{where}: {', '.join(rows) or 'nothing'} prescribed; three components are needed (eps_xz = 0 need not be said)")
    lengths = {len(values) for values in given.values()} - {1}
    if len(lengths) != 1:
        told = ", ".join(f"{key}: {len(values)}" for key, values in given.items())
        raise InputError(f"{where}: turning points must be two or more, and as many in every key that has not one number ({told})")
    turns = lengths.pop()
    if steps is not None and (not isinstance(steps, (int, np.integer)) or not 1 <= steps * (turns - 1) <= 10_000_000):
        raise InputError(f"element_test: steps = {steps!r} must be a whole number from 1, and at most 10000000 in all")
    fine = np.linspace(0.0, turns - 1.0, (turns - 1) * (steps or 1) + 1)
    at = np.arange(turns)
    path = {key: np.interp(fine, at, np.broadcast_to(values, turns)) for key, values in given.items()}
    path.setdefault("spin", np.zeros(fine.size))
    path.setdefault("time", fine / (turns - 1.0))
    if len(given.get("time", at)) != turns or np.any(np.diff(path["time"]) <= 0.0):
        raise InputError(f"{where}: time must have a value for each turning point and grow")
    of_strain, of_stress = np.zeros((3, 3)), np.zeros((3, 3))
    for i, key in enumerate(rows):
        kind, name = key.split("_")
        (of_strain if kind == "eps" else of_stress)[i] = ROWS[name]
    if abs(np.linalg.det(of_strain + of_stress)) < 0.1:  # the entries are 0 and 1
        raise InputError(f"{where}: {', '.join(rows)} are not independent, each component is prescribed once, by strain or by stress")
    offset = np.array([path[key][0] if key.startswith("eps") else 0.0 for key in rows])
    goals = np.column_stack([path[key] for key in rows])[1:] - offset
    return Plan(rows, path, np.ascontiguousarray(goals), of_strain, of_stress, np.linalg.solve(of_strain + of_stress, offset))


def _turns(where, key, values):
    try:
        values = np.atleast_1d(np.asarray(values, dtype=float))
    except (TypeError, ValueError):
        raise InputError(f"{where}: {key} = {values!r} must be a number or a row of numbers") from None
    if values.ndim != 1 or values.size == 0 or not np.all(np.isfinite(values)):
        raise InputError(f"{where}: {key} must be a number or a row of finite numbers, has shape {values.shape}")
    return values
