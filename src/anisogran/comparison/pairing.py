"""DEM averages beside the continuum: the same rings, the same averaging width, error bars on both sides, and numbers for the misfit."""

from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from anisogran.comparison.measured import measured, remarks
from anisogran.comparison.measures import decay_length, log_rms, near, near_l2, relative_l2, ring_edges
from anisogran.continuum import Flow, RingFlow
from anisogran.fitting import mean_and_error
from anisogran.glossary import attributes
from anisogran.outcome import InputError
from anisogran.scenes.writing import scene_text

FEW_BLOCKS = 10  # with fewer the error bars of the grains are themselves uncertain by a quarter or more


@dataclass(frozen=True, eq=False)
class Comparison:
    """Profiles of DEM and continuum on the same rings (`table`, over r) and what they differ by.

    l2 is the relative L2 difference of v_phi over the rings less than 8 d from the inner one, l2_noise what the DEM's own error bars
    amount to in the same measure, l2_continuum how far the flow is from one on a mesh twice as fine with a tenth of the rate floor;
    log_rms the root mean square difference of ln v_phi on the resolved rings, infinite for a continuum at rest there; decay lengths are
    in grain diameters, from the same exponential fit on the same rings, NaN where nothing decays; stress ratios are those of the inner
    ring, shear over normal stress. `reasons` say what a reader must know of the error bars.
    """

    name: str
    table: xr.Dataset
    l2: float
    l2_noise: float
    l2_continuum: float
    log_rms: float
    decay_length_dem: float
    decay_length_continuum: float
    stress_ratio_wall_dem: float
    stress_ratio_wall_dem_error: float
    stress_ratio_wall_continuum: float
    reasons: tuple[str, ...] = ()


def ring_flow(run, law):
    """The RingFlow of the cell that `run` (a RingShear) simulated: its radii, speed and the DEM's own mean radial stress as pressure."""
    run = measured(run, "ring_flow")
    scene, steady = run.scene, run.scene.steady(run.series)
    return RingFlow(
        r_inner=scene.inner_radius,
        r_outer=float(steady.outer_radius.mean()),
        law=law,
        wall_speed=scene.wall_speed,
        outer_pressure=float(steady.outer_pressure.mean()),
        grain_diameter=scene.mean_diameter,
        grain_mass=float(scene.mass().mean()),
    )


def wall_stress_ratio(run):
    """Mean shear over mean normal stress of the steady part on the inner ring, and its standard error from blocks (NaN for one)."""
    steady = run.scene.steady(run.series)
    count = max(1, run.profiles.attrs.get("blocks", 1))
    shear, normal = (np.array_split(steady[name].values, count) for name in ("wall_shear_stress", "wall_pressure"))
    ratios = [np.mean(tau) / np.mean(sigma) for tau, sigma in zip(shear, normal, strict=True)]
    return float(steady.wall_shear_stress.mean() / steady.wall_pressure.mean()), float(mean_and_error(ratios)[1])


def finer(flow):
    """The same flow on a mesh twice as fine and with a tenth of the rate floor, a Flow. Raises what `solve` raises.

    One element more than twice as many: else both meshes share the point where a local law ends, beside which its kink lies, and with it
    an error.
    """
    problem = flow.problem
    return replace(problem, elements=len(flow.r), rate_floor=0.1 * problem.floor).solve()  # r has the middles too


def compare(run, flow, name="continuum"):
    """The Comparison of a RingShear run, or a results file of one as `open` gives it, with a solved RingFlow, on the rings of the run.

    The flow is solved once more, finer, for its own error. Raises InputError for a run without ring profiles, and for a flow that is not
    solved; NotConverged if the finer one has no solution.
    """
    if not isinstance(flow, Flow):
        raise InputError(f"compare: the flow is a {type(flow).__name__}; it must be what RingFlow(...).solve() returns")
    run = measured(run, "compare")
    profiles, scene = run.profiles, run.scene
    edges, used, problem = ring_edges(profiles), near(profiles), flow.problem
    if edges[0] < problem.r_inner * (1 - 1e-9) or edges[-1] > problem.r_outer * (1 + 1e-9):
        raise InputError(
            f"compare: the rings of the run, {edges[0]:g} to {edges[-1]:g} m, leave the flow, {problem.r_inner:g} to "
            f"{problem.r_outer:g} m; ring_flow(run, law) gives the problem of the run"
        )
    rings, better = flow.ring_average(edges), finer(flow).ring_average(edges)
    v_phi = np.asarray(rings.v_phi)
    table = xr.Dataset(
        {
            "v_phi": ("r", v_phi, attributes("v_phi", source=name)),
            "v_phi_dem": ("r", profiles.v_phi.values, attributes("v_phi", source="DEM")),
            "v_phi_dem_error": ("r", profiles.v_phi_error.values, profiles.v_phi_error.attrs),
            "shear_rate": ("r", np.abs(np.asarray(rings.shear_rate)), attributes("shear_rate", source=name)),
            "inertial_number": ("r", np.asarray(rings.inertial_number), attributes("inertial_number", source=name)),
        },
        coords={"r": profiles.r, "depth": profiles.depth},
        attrs={"law": str(problem.law), "scene": scene_text(scene)},
    )
    ratio, ratio_error = wall_stress_ratio(run)
    blocks = profiles.attrs.get("blocks", 0)
    few = (f"the error bars of the grains come from {blocks} blocks only",) if blocks < FEW_BLOCKS else ()
    return Comparison(
        name=name,
        table=table,
        l2=near_l2(profiles, v_phi),
        l2_noise=near_l2(profiles, profiles.v_phi.values + profiles.v_phi_error.values),
        l2_continuum=relative_l2(np.asarray(better.v_phi)[used], v_phi[used], profiles.r.values[used]),
        log_rms=log_rms(profiles, v_phi),
        decay_length_dem=decay_length(profiles, profiles.v_phi.values),
        decay_length_continuum=decay_length(profiles, v_phi),
        stress_ratio_wall_dem=ratio,
        stress_ratio_wall_dem_error=ratio_error,
        stress_ratio_wall_continuum=float(flow.stress_ratio_wall),
        reasons=(*few, *remarks(run)),
    )
