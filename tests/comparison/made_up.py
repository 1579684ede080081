"""A made-up ring shear cell whose velocity is the continuum's own."""

import numpy as np
import xarray as xr

from anisogran import RingShear
from anisogran.comparison import Measured
from anisogran.continuum import Nonlocal, RingFlow

LAW = Nonlocal(mu_s=0.28, b=1.1, amplitude=0.7)


def made_up_run(law=LAW, inner_radius=6.0, wall_speed=0.04, noise=0.0, seed=0):
    """A run whose rings hold the nonlocal flow (with noise), in perfect stress equilibrium."""
    rng = np.random.default_rng(seed)
    scene = RingShear(travel=100.0, discard=20.0, size_ratio=1.0, inner_radius=inner_radius, wall_speed=wall_speed)
    flow = RingFlow(inner_radius, inner_radius + 9.0, law, wall_speed, 1.0, grain_mass=np.pi / 6).solve()  # of a ball of diameter 1
    edges = inner_radius + np.arange(9.0)
    r = 0.5 * (edges[1:] + edges[:-1])
    exact = np.asarray(flow.ring_average(edges).v_phi)
    blocks = xr.Dataset({"v_phi": (("block", "r"), exact * (1 + noise * rng.normal(size=(8, r.size))))}, coords={"r": r})
    shear = 0.45 * (inner_radius / r) ** 2
    stress = np.array([[1.0 + 0 * r, shear], [shear, 1.0 + 0 * r]])
    profiles = xr.Dataset(
        {
            "v_phi": ("r", blocks.v_phi.values.mean(axis=0)),
            "v_phi_error": ("r", 0.01 * exact),
            "stress": (("i", "j", "r"), stress),
        },
        coords={"r": r, "depth": ("r", r - inner_radius)},
        attrs={"edges": edges, "blocks": 8},
    )
    time = np.linspace(0, 100 / wall_speed, 11)
    steady = {"outer_radius": inner_radius + 9.0, "outer_pressure": 1.0, "wall_shear_stress": 0.45, "wall_pressure": 1.0}
    transient = np.where(time > 20.0 / wall_speed, 1.0, 1.7)  # the discarded travel over the speed: nothing of it may count
    series = xr.Dataset({name: ("time", value * transient) for name, value in steady.items()}, coords={"time": time})
    series["wall_pressure"] = ("time", np.full(11, 0.9))
    return Measured(scene, series, profiles, blocks)
