"""What accuracy costs in the laws at a point: integrators and steps along two paths with a reversal, the tolerance, and the price of each.

The reference is Runge-Kutta with a tolerance of 1e-12. A prescribed stress is met at the ends of steps only, so that it needs many steps
as well: its own error of second order is taken out by extrapolation.
"""

import numpy as np

from anisogran.benchmark.point_laws import EXACT, PARAMETERS, PRESSURE, some_points
from anisogran.cost.tables import row
from anisogran.cost.timing import timed
from anisogran.models import INTEGRATORS, LAWS, RungeKutta45, biaxial, element_test, pure_shear, simple_shear, updated

PATHS = {  # to and back by a half
    "scalar law, biaxial box": ("scalar", biaxial([0.0, 0.003, 0.0015], PRESSURE)),
    "tensorial law, simple shear": ("tensorial", simple_shear([0.0, 0.003, 0.0015], PRESSURE)),
}
DEFAULT = "midpoint"


def models_cost(quick=False):
    """Rows {knob, value, error, seconds, default} for the laws at a point, a list; processor seconds, medians."""
    rows, repeats = [], 1 if quick else 5
    for name, (law, control) in PATHS.items():
        rows += steps_rows(name, law, control, (100, 200, 400) if quick else (50, 100, 200, 400, 800, 1600), repeats)
    return rows + tolerance_rows(repeats) + price_rows(1_000 if quick else 100_000, repeats)


def end_of(law, control, steps, integrator):
    """The stress (4,) at the end of a path."""
    test = element_test(law, PARAMETERS[law], control, PRESSURE, steps, integrator)
    test.status.require()
    return test.stress[..., -1].ravel()


def relative(stress, exact):
    return float(np.max(np.abs(stress - exact)) / np.abs(exact).max())


def steps_rows(name, law, control, counts, repeats):
    """Error of the last stress against steps for each integrator, with the measured order; and the integrators at one number of steps."""
    fine, finest = (end_of(law, control, parts * counts[-1], EXACT) for parts in (2, 4))
    exact = finest + (finest - fine) / 3.0
    rows, beside = [], []
    for integrator in INTEGRATORS:
        found = [timed(lambda n=n, integrator=integrator: end_of(law, control, n, integrator), repeats) for n in counts]
        errors, seconds = [relative(stress, exact) for stress, _ in found], [time for _, time in found]
        order = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
        knob = f"steps to a turn, {integrator}, order {order:.2f}: {name}"
        rows += [row(knob, n, error, time) for n, error, time in zip(counts, errors, seconds, strict=True)]
        beside.append(row(f"integrator at {counts[2]} steps to a turn: {name}", integrator, errors[2], seconds[2], integrator == DEFAULT))
    return rows + beside


def tolerance_rows(repeats):
    """Error of the last stress against the tolerance of Runge-Kutta, in a path of strain of two increments."""
    control = pure_shear([0.0, 0.003, 0.0015])
    exact, rows = end_of("tensorial", control, 1, RungeKutta45(1e-13)), []
    for tolerance in (1e-3, 1e-5, 1e-7, 1e-9, 1e-11):
        method = RungeKutta45(tolerance)
        stress, seconds = timed(lambda method=method: end_of("tensorial", control, 1, method), repeats)
        knob = "tolerance of rk45: tensorial law, pure shear"
        rows.append(row(knob, tolerance, relative(stress, exact), seconds, method == RungeKutta45()))
    return rows


def price_rows(points, repeats):
    """What an update of many points costs with each law, without and with its tangent."""
    rows = []
    for law in LAWS:
        batch = some_points(law, points)
        for tangent in (False, True):
            _, seconds = timed(lambda batch=batch, tangent=tangent: updated(**batch, tangent=tangent), repeats)
            rows.append(row(f"price of an update of {points} points", f"{law}{', tangent' if tangent else ''}", None, seconds))
    return rows
