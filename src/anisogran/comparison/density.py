"""How dense the continuum says that the grains of a ring are: the law of homogeneous shear at the inertial numbers of a flow."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from anisogran.comparison.measured import measured
from anisogran.comparison.measures import near, ring_edges

POINTS = 400  # of the radius at which the density is integrated


@dataclass(frozen=True, eq=False)
class Packing:
    """area_fraction (rings,) of the law and of the grains with its error; `rms`, the difference over the rings nearer than 8 d but the
    first, which the wall orders; the radius of the outer ring (m) that holds all grains at these densities, and that of the run."""

    area_fraction: np.ndarray
    area_fraction_dem: np.ndarray
    area_fraction_dem_error: np.ndarray
    rms: float
    outer_radius: float
    outer_radius_dem: float


def packing(run, flow, nu_max, a):
    """The Packing of nu = nu_max - a I on the rings of a RingShear run, with I of a solved Flow.

    What grains find between the discs of the rings is not counted, so that the outer radius comes out large by some tenths of a diameter.
    Raises InputError for a run without ring profiles.
    """
    run = measured(run, "packing")
    profiles, scene = run.profiles, run.scene
    on_rings = nu_max - a * np.asarray(flow.ring_average(ring_edges(profiles)).inertial_number)
    found, used = profiles.area_fraction.values, near(profiles) & (np.arange(len(on_rings)) > 0)
    inner, outer = scene.inner_radius, flow.problem.r_outer
    r = np.linspace(inner, outer, POINTS)
    nu = nu_max - a * np.asarray(flow.at(r).inertial_number)
    held = np.pi * float(np.sum(scene.radii()[0] ** 2))

    def missing(radius):
        """Area of the grains that does not fit within the radius; beyond the flow they are as dense as at its end."""
        inside = np.minimum(r, radius)
        return held - np.trapezoid(2 * np.pi * inside * nu, inside) - np.pi * nu[-1] * max(0.0, radius**2 - outer**2)

    return Packing(
        area_fraction=on_rings,
        area_fraction_dem=found,
        area_fraction_dem_error=profiles.area_fraction_error.values,
        rms=float(np.sqrt(np.mean((on_rings - found)[used] ** 2))),
        outer_radius=float(brentq(missing, inner, 2 * outer)),
        outer_radius_dem=float(scene.steady(run.series).outer_radius.mean()),
    )
