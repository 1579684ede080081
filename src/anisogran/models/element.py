"""The element test: one point of any law along any path, each component controlled by strain or by stress, as in MFront's MTest."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from anisogran.glossary import attributes
from anisogran.models.controls import ROWS
from anisogran.models.driver import LOST_CONTROL, MOST_ITERATIONS, NOT_REACHABLE
from anisogran.models.integrators import INTEGRATORS
from anisogran.models.laws import LAWS, law_parameters
from anisogran.models.point import MEANING, OK
from anisogran.models.prepared_path import PreparedPath
from anisogran.models.update import state_of
from anisogran.outcome import InputError, Status
from anisogran.tensors import plane_parts, plane_tensor

_SMALL_PRESSURE = 1e-6  # of E: below, the ratio s_D is made of rounding
_REASONS = {
    **MEANING,
    NOT_REACHABLE: f"the prescribed stress is not reachable (no solution in {MOST_ITERATIONS} Newton iterations); "
    "if it should be, try smaller steps",
    LOST_CONTROL: "the prescribed stress is not reachable, the sample gives way: "
    "its tangent is no longer positive definite in the directions of the prescribed stress",
}


@dataclass(frozen=True)
class ElementTest:
    """Curves along the path, start included, and how it ended; if it failed they end at the last state that was reached.

    strain, stress   (2, 2, n): true strain, compression positive; axes x and z
    internal         name: (n,), the internal variables of the law
    spin, time       (n,): rotation of the material in rad, time in s, totals
    work             (n,): work done on the sample per area, by the trapezoidal rule [unit of stress]
    status           `status.require()` raises if the path was not completed
    reproduction     "" or the text of a small file that repeats the step that failed, for `anisogran element`
    """

    law: str
    parameters: dict
    strain: np.ndarray
    stress: np.ndarray
    internal: dict
    spin: np.ndarray
    time: np.ndarray
    work: np.ndarray
    status: Status
    reproduction: str = field(repr=False)

    @property
    def eps_xx(self):
        return self.strain[0, 0]

    @property
    def eps_zz(self):
        return self.strain[1, 1]

    @property
    def eps_V(self):
        """(eps_xx + eps_zz)/2, half of the trace."""
        return 0.5 * (self.strain[0, 0] + self.strain[1, 1])

    @property
    def eps_D(self):
        """(eps_zz - eps_xx)/2, signed: positive for compression along z."""
        return 0.5 * (self.strain[1, 1] - self.strain[0, 0])

    @property
    def sigma_xx(self):
        return self.stress[0, 0]

    @property
    def sigma_zz(self):
        return self.stress[1, 1]

    @property
    def sigma_V(self):
        """(sigma_xx + sigma_zz)/2, the pressure."""
        return 0.5 * (self.stress[0, 0] + self.stress[1, 1])

    @property
    def sigma_D(self):
        """(sigma_zz - sigma_xx)/2, signed as eps_D; in the axes of the box only, see `stress_ratio`."""
        return 0.5 * (self.stress[1, 1] - self.stress[0, 0])

    @property
    def s_D(self):
        """sigma_D/sigma_V, signed as eps_D; NaN where there is no stress."""
        return _ratio(self.sigma_D, self.sigma_V)

    @property
    def stress_ratio(self):
        """Size of the stress deviator over sigma_V, sin(mobilised friction angle) >= 0, for any axes; NaN where there is no stress."""
        return _ratio(np.hypot(self.sigma_D, self.stress[0, 1]), self.sigma_V)

    def dataset(self):
        """The curves as an xarray.Dataset over `step`, with units."""
        import xarray  # here, since fits drive many element tests and never ask for it

        names = ("eps_xx", "eps_zz", "eps_V", "eps_D", "sigma_xx", "sigma_zz", "sigma_V", "s_D", "stress_ratio", "time", "work")
        columns = {name: getattr(self, name) for name in names}
        columns |= {"eps_xz": self.strain[0, 1], "sigma_xz": self.stress[0, 1], "rotation": self.spin, **self.internal}
        variables = {name: ("step", values, attributes(name)) for name, values in columns.items()}
        facts = {"law": self.law, "status": str(self.status), **{f"parameter_{key}": value for key, value in self.parameters.items()}}
        return xarray.Dataset(variables, attrs={key: value for key, value in facts.items() if value is not None})


def _ratio(part, whole):
    return np.divide(part, whole, out=np.full(np.shape(part), np.nan), where=whole != 0.0)


def element_test(law, parameters, control, start=None, steps=None, integrator="midpoint"):
    """Drives one point of a law along a path: an `ElementTest`.

    law           a name of `LAWS`: scalar, tensorial, mohr_coulomb, mu_of_I
    parameters    dict of the law's parameters, see `law_parameters`
    control       dict of what is prescribed, see `controls`: numbers, or turning points of one length
    start         pressure of an isotropic sample, or dict of sigma_xx, sigma_zz, sigma_xz and internal variables; what it does not say is
                  taken from the prescribed stress (the pressure of a biaxial box), and 0 for internal variables
    steps         equal steps from one turning point to the next; None: one, the points are the path
    integrator    "midpoint" (second order), "rk45" (error control) or "explicit" (first order), or dict of its name and settings

    Where a stress is prescribed, Newton's method finds the strain of each step to 1e-11 of the largest stress, with the consistent tangent.
    A path that cannot be followed ends with status failed, by name: tension, a stiffness that is not positive definite, a stress that is
    not reachable, a sample that gives way, and what the law itself knows. Raises InputError for input that makes no sense.
    """
    record = law_parameters(law, **_mapping("parameters", parameters))
    path = PreparedPath(law, _mapping("control", control), start, steps, integrator)
    driven, plan = path.driven(record), path.plan
    reached = len(driven.states)
    test = _curves(law, dict(parameters), driven, plan.spin[:reached], plan.time[:reached])
    status = _remarked(test, parameters)
    if driven.outcome == OK:
        return replace(test, status=status)
    status = status.fail(f"stopped at {plan.place(reached - 1)}, {_told(test)}: {_REASONS[driven.outcome]}")
    return replace(test, status=status, reproduction=_reproduction(test, plan.path, reached - 1, path.method))


def _mapping(key, value):
    if not isinstance(value, Mapping):
        raise InputError(f"element_test: {key} must be a dict of names and numbers, is {value!r}")
    return value


def _curves(law, parameters, driven, spin, time):
    """The ElementTest of what was `driven`, its status still to be told."""
    state = state_of(law, np.ascontiguousarray(driven.states.T), (len(driven.states),))
    strain = plane_tensor(driven.strains.T)
    mean_stress = 0.5 * (state.stress[..., 1:] + state.stress[..., :-1])
    work = np.concatenate([[0.0], np.cumsum(np.einsum("ijn,ijn->n", mean_stress, np.diff(strain)))])
    return ElementTest(law, parameters, strain, state.stress, state.internal, spin, time, work, Status(), "")


def _remarked(test, parameters):
    """What a user should know of a path that went well so far."""
    status = Status()
    smallest = float(test.sigma_V[1:].min()) if test.sigma_V.size > 1 else np.inf
    if "E" in parameters and 0.0 <= smallest < _SMALL_PRESSURE * parameters["E"]:
        status = status.warn(f"sigma_V falls to {smallest:.3g}, below {_SMALL_PRESSURE:g} E: stress ratios are not accurate there")
    steps = np.abs(np.diff(test.work)).sum()
    away = np.max(np.abs(test.strain - test.strain[..., :1]), axis=(0, 1))
    at_start = test.work[away <= 1e-9 * away.max()]  # a cyclic path comes back again and again
    gained = -np.diff(at_start).min() if at_start.size > 1 else 0.0
    if gained > 1e-10 * steps:
        status = status.warn(f"a closed strain path gave {gained / steps:.3g} of all work back: stored before, or made by the law")
    if np.any(test.stress_ratio > 1.0 + 1e-12):  # rounding
        status = status.warn(f"the smaller principal stress is tensile: sigma_D/sigma_V reaches {np.nanmax(test.stress_ratio):.3g}")
    return status


def _told(test):
    """The last state in words."""
    xx, zz, xz = test.stress[0, 0, -1], test.stress[1, 1, -1], test.stress[0, 1, -1]
    inner = ", ".join(f"{name} = {values[-1]:.6g}" for name, values in test.internal.items())
    return f"where sigma_xx = {xx:.6g}, sigma_zz = {zz:.6g}, sigma_xz = {xz:.6g}, {inner}"


def _reproduction(test, path, done, method):
    """The text of a file for `anisogran element` with the step that failed alone."""
    stress = test.stress[..., -1]
    whole = LAWS[test.law].STRESS_IS_STATE
    start = {"sigma_xx": stress[0, 0], "sigma_zz": stress[1, 1], "sigma_xz": stress[0, 1]} if whole else {}
    start |= {name: values[-1] for name, values in test.internal.items()}
    name = next(name for name, known in INTEGRATORS.items() if type(known) is type(method))
    settings = ", ".join([f'name = "{name}"', *(f"{key} = {value!r}" for key, value in method._asdict().items())])
    integrator = f'"{name}"' if method == INTEGRATORS[name] else f"{{ {settings} }}"
    lines = [f'law = "{test.law}"', f"integrator = {integrator}", "", "[parameters]"]
    lines += [f"{key} = {float(value)!r}" for key, value in test.parameters.items() if value is not None]
    lines += ["", "[start]", *(f"{key} = {float(value)!r}" for key, value in start.items()), "", "[control]"]
    for key, values in path.items():
        last, goal = (float(value) for value in values[done : done + 2])
        if key.startswith("sigma") and whole:
            last = float(_component(key, stress))  # as the last state has it, to its last digit
        lines.append(f"{key} = [{last!r}, {goal!r}]")
    return "\n".join(lines) + "\n"


def _component(key, stress):
    """sigma_xx, sigma_zz, sigma_xz, sigma_V or sigma_D of a stress (2, 2)."""
    return ROWS[key.removeprefix("sigma_")] @ plane_parts(stress)
