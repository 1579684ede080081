"""How fast it is: fixed pieces of work, so that figures can be compared from machine to machine and from version to version."""

from anisogran.benchmark.averages import averaging_benchmark, seconds_of, sheared_snapshot
from anisogran.benchmark.point_laws import models_benchmark
from anisogran.benchmark.ring_flows import continuum_benchmark
from anisogran.benchmark.shear import AREA_FRACTION, EFFECTS, check_effects, dem_benchmark, made_packing, read_packing, sheared_packing

__all__ = [
    "AREA_FRACTION", "EFFECTS", "averaging_benchmark", "check_effects", "continuum_benchmark", "dem_benchmark", "made_packing",
    "models_benchmark", "read_packing", "seconds_of", "sheared_packing", "sheared_snapshot",
]  # fmt: skip
