"""What accuracy costs in the continuum ring: mesh, rate floor, iterations, and the second dimension, for a local and a nonlocal law.

Errors are relative: of v_phi in L2 over the area, and of the stress ratio at the inner ring. The local law has a closed form. The
nonlocal one is compared with 1,024 elements and a hundredth of the default rate floor; how far that moves if both are made half and
ten times as coarse is told beside, and bounds its own error. An eccentric ring is compared with one of 96 elements around.
The elements have one order, and Newton's tolerance is no knob: what it leaves is below the error of any mesh.
"""

from dataclasses import replace

import numpy as np

from anisogran.benchmark.ring_flows import ECCENTRICITY, FINE, LAWS, RING
from anisogran.continuum import LocalMuI, RingFlow, local_mu_i
from anisogran.continuum.exact import local_stress_ratio
from anisogran.cost.tables import row
from anisogran.cost.timing import clocked, timed
from anisogran.outcome import NotConverged

RADII = np.linspace(RING["r_inner"], RING["r_outer"], 401)
ELEMENTS = (8, 16, 32, 64, 128, 256)
FLOORS = {"local": (1e-2, 1e-3, 1e-4, 1e-5, 1e-6), "nonlocal": (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9)}
ITERATIONS = {"local": (10, 20, 30, 40), "nonlocal": (4, 6, 8, 10, 12)}  # of all stages; more are not needed on the default mesh
AROUND, MOST_AROUND = (8, 12, 16, 24, 32, 48), 96


def continuum_cost(quick=False):
    """Rows {knob, value, error, seconds, default} for the steady ring, a list; seconds are those of the processor, medians of solutions."""
    rows, repeats = [], 1 if quick else 3
    for name, law in LAWS.items():
        problem = RingFlow(law=law, **RING)
        exact = exact_answer(problem)
        told = [f"{name} law"] * 2
        if not isinstance(law, LocalMuI):
            told = [f"{name} law, reference good to {error:.0e}" for error in own_errors(problem, exact)]
        rows += mesh_rows(told, problem, exact, repeats)
        rows += floor_rows(told, problem, exact, FLOORS[name], repeats)
        rows += iteration_rows(told, problem, exact, ITERATIONS[name], repeats)
        rows += dimension_rows(told, problem, exact, quick)
    return rows + around_rows(problem, quick)


def answer(flow):
    """(v_phi at RADII, stress ratio at the inner ring) of a Flow; in 2D the mean over phi."""
    return flow.at(RADII).v_phi, flow.stress_ratio_wall


def exact_answer(problem):
    """As `answer`, of the closed form for the local law, else of a fine mesh with a low rate floor."""
    given = problem.wall_speed, problem.law, problem.r_inner, problem.r_outer, problem.outer_pressure
    if isinstance(problem.law, LocalMuI):
        return local_mu_i(RADII, *given), local_stress_ratio(*given)
    return answer(replace(problem, elements=FINE, rate_floor=0.01 * problem.floor).solve())


def own_errors(problem, exact):
    """The two errors, against the reference, of half its elements with ten times its rate floor."""
    return errors(replace(problem, elements=FINE // 2, rate_floor=0.1 * problem.floor).solve(), exact)


def errors(flow, exact):
    """Relative errors (v_phi in L2 over the area, stress ratio) of a Flow."""
    (v, ratio), (v_exact, ratio_exact) = answer(flow), exact
    difference = np.sqrt(np.trapezoid((v - v_exact) ** 2 * RADII, RADII) / np.trapezoid(v_exact**2 * RADII, RADII))
    return float(difference), float(abs(ratio / ratio_exact - 1.0))


def both(knob, told, entries, default):
    """Rows for v_phi and for the stress ratio, of which two things are told, of (value, the two errors, seconds)."""
    return [
        row(f"{knob}: error of {quantity}, {told[k]}", value, error[k], seconds, value == default)
        for k, quantity in enumerate(("v_phi", "the stress ratio"))
        for value, error, seconds in entries
    ]


def entry(value, problem, exact, repeats):
    """(value, errors, seconds) of one solution."""
    flow, seconds = timed(problem.solve, repeats)
    return value, errors(flow, exact), seconds


def mesh_rows(told, problem, exact, repeats):
    """Errors against the number of elements along the radius."""
    default = problem.elements_along()
    entries = [entry(n, replace(problem, elements=n), exact, repeats) for n in sorted({*ELEMENTS, default})]
    return both("elements along the radius", told, entries, default)


def floor_rows(told, problem, exact, floors, repeats):
    """Errors against the rate floor, on the default mesh: what the mesh leaves is seen at the low end."""
    entries = [entry(floor, replace(problem, rate_floor=floor), exact, repeats) for floor in floors]
    return both("rate_floor", told, entries, problem.floor)


def iteration_rows(told, problem, exact, limits, repeats):
    """Errors of the last iterate where the iterations are cut off, and of the converged answer under the default limit."""
    limits = (*limits, problem.max_iterations)
    entries = [(n, *timed_error(replace(problem, max_iterations=n), exact, repeats)) for n in limits]
    return both("max_iterations, the last iterate", told, entries, problem.max_iterations)


def timed_error(problem, exact, repeats):
    """(errors, seconds) of the answer, or of the best iterate that comes with NotConverged."""

    def found():
        try:
            return problem.solve()
        except NotConverged as failure:
            return failure.best

    flow, seconds = timed(found, repeats)
    return errors(flow, exact), seconds


def dimension_rows(told, problem, exact, quick):
    """The same mesh along the radius on a line and in 2D: an axisymmetric flow gains nothing from the second dimension."""
    along, around = (16, 8) if quick else (32, 24)
    entries = [entry("1D", replace(problem, elements=along), exact, 1)]
    flow, seconds = clocked(replace(problem, elements=along, dimension=2, elements_around=around).solve)
    entries.append((f"2D, {around} around", errors(flow, exact), seconds))
    return both(f"dimension, {along} elements along", told, entries, "1D")


def around_rows(problem, quick):
    """Errors against the elements around in an eccentric ring, against the most of them on the same mesh along."""
    along, counts, most = (8, AROUND[::2], MOST_AROUND // 2) if quick else (32, AROUND, MOST_AROUND)
    problem = replace(problem, dimension=2, eccentricity=ECCENTRICITY, elements=along)
    default = problem.elements_around
    exact = answer(replace(problem, elements_around=most).solve())
    entries = []
    for around in sorted({*counts, default}):
        flow, seconds = clocked(replace(problem, elements_around=around).solve)
        entries.append((around, errors(flow, exact), seconds))
    told = f"nonlocal law, axes {ECCENTRICITY:g} d apart, {along} along, reference {most}"
    return both("elements_around", [told] * 2, entries, default)
