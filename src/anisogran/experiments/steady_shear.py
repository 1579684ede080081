"""The steady state of homogeneous shear with its errors, from blocks of strain."""

import math

import numpy as np
import xarray as xr

from anisogran.averaging import mean_and_error
from anisogran.glossary import attributes

BLOCK = 0.25  # of shear strain
RATE_ANGLE = -0.25 * math.pi  # of the fastest compression in simple shear along x


def blocks_of(steady, size=BLOCK):
    """Means over blocks of `size` shear strain, dimension "block": longer than the memory of the stress, about a tenth of strain.

    Ratios to the pressure are ratios of the means: at constant volume the pressure may all but vanish for a moment. Angles are those of
    the mean tensors, from x; that of the strain rate is the one of simple shear.
    """
    count = max(2, int((steady.strain.values[-1] - steady.strain.values[0]) / size))
    parts = [steady.isel(time=part) for part in np.array_split(np.arange(steady.sizes["time"]), count)]
    blocks = xr.concat([part.mean("time", keep_attrs=True) for part in parts], "block")
    for name in ("stress_ratio", "s_D"):
        blocks[name].values[:] = [float((part[name] * part.pressure).mean() / part.pressure.mean()) for part in parts]
    for name, tensor in (("stress_angle", "sigma"), ("fabric_angle", "fabric")):
        xx, xy, yy = (blocks[f"{tensor}_{axes}"].values for axes in ("xx", "xy", "yy"))
        blocks[name] = ("block", 0.5 * np.arctan2(2 * xy, xx - yy), attributes(name))
    for name, axis in (("rate_to_stress_angle", "stress_angle"), ("rate_to_fabric_angle", "fabric_angle")):
        blocks[name] = ("block", blocks[axis].values - RATE_ANGLE, attributes(name))
    return blocks


def state_of(steady):
    """Mean and standard error (`name_error`) of the variables of a steady series, from blocks of strain; see `steady_state`."""
    state = mean_and_error(blocks_of(steady))
    inertial = float(steady.inertial_number[0]) * np.sqrt(float(steady.pressure[0]) / state.pressure)
    state["inertial_number"].values[...] = inertial
    state["inertial_number_error"].values[...] = 0.5 * inertial * state.pressure_error / state.pressure
    return state


def steady_state(run):
    """Mean and standard error (`name_error`) of every series of a SimpleShear run after its transient, from blocks of strain.

    Beside them the angles of stress and fabric, from x and from the strain rate. The inertial number is that of the mean pressure.
    """
    return state_of(run.scene.steady(run.series))
