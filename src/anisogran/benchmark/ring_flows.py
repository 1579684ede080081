"""How fast the continuum ring is solved, on a line and in 2D, each beside its error against a fine solution on a line."""

from dataclasses import replace
from statistics import median
from time import process_time

import numpy as np

from anisogran.continuum import LocalMuI, Nonlocal, RingFlow, local_mu_i
from anisogran.continuum.exact import local_stress_ratio

LAWS = {"local": LocalMuI(0.26, 1.0), "nonlocal": Nonlocal(0.26, 1.0, 0.9)}
RING = {"r_inner": 13.0, "r_outer": 33.0, "wall_speed": 1e-3, "outer_pressure": 1.0}  # units: grain diameter, grain mass, pressure
FINE = 1024  # elements of the solution that errors are measured against
ECCENTRICITY = 3.0  # of the flow that has no axis


def continuum_benchmark(along=48, around=60, repeats=5):
    """Seconds, seconds of the processor, unknowns, iterations and errors of steady ring flows, a dict.

    For each law the default mesh on a line; then `along` x `around` elements in 2D, started from nothing, for the nonlocal law in the
    same ring, and with the inner ring off centre. Errors are relative: of v_phi in L2 over the area, and of the stress ratio at the
    wall, against the closed form (local law) or 1024 elements on a line; of the flow off centre, the difference of the torques.
    """
    numbers = {"along": along, "around": around, "repeats": repeats}
    for name, law in LAWS.items():
        problem = RingFlow(law=law, **RING)
        problem.solve()
        flow, one = timed(f"{name}_1d", problem, repeats)
        numbers |= one | errors(f"{name}_1d", flow, law)
    plane = replace(problem, dimension=2, elements=along, elements_around=around)
    flow, one = timed("nonlocal_2d", plane, 1)
    numbers |= one | errors("nonlocal_2d", flow, law)
    flow, one = timed("eccentric_2d", replace(plane, eccentricity=ECCENTRICITY), 1)
    return numbers | one | {"eccentric_2d_torque_difference": flow.torques.difference}


def timed(name, problem, repeats):
    """The Flow and its figures; seconds are medians."""
    flows, used = [], []
    for _ in range(repeats):
        clock = process_time()
        flows.append(problem.solve())
        used.append(process_time() - clock)
    return flows[0], {
        f"{name}_s": median(flow.seconds for flow in flows),
        f"{name}_processor_s": median(used),
        f"{name}_unknowns": flows[0].unknowns.size,
        f"{name}_iterations": flows[0].iterations,
    }


def errors(name, flow, law):
    """Relative errors of v_phi, in L2 over the area, and of the stress ratio at the wall."""
    r = np.linspace(RING["r_inner"], RING["r_outer"], 4001)
    given = RING["wall_speed"], law, RING["r_inner"], RING["r_outer"], RING["outer_pressure"]
    if isinstance(law, LocalMuI):
        exact, ratio = local_mu_i(r, *given), local_stress_ratio(*given)
    else:
        fine = RingFlow(law=law, elements=FINE, **RING).solve()
        exact, ratio = fine.at(r).v_phi, fine.stress_ratio_wall
    difference = np.sqrt(np.trapezoid((flow.at(r).v_phi - exact) ** 2 * r, r) / np.trapezoid(exact**2 * r, r))
    return {f"{name}_error": float(difference), f"{name}_stress_ratio_error": float(abs(flow.stress_ratio_wall / ratio - 1.0))}
