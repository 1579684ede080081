"""The comparison of grains and continuum in the ring shear cell, and the prediction of runs that no parameter was fitted on."""

from anisogran.comparison.calibration import Calibration, fitted_amplitude, fitted_wall
from anisogran.comparison.density import Packing, packing
from anisogran.comparison.friction import homogeneous_friction
from anisogran.comparison.measured import Measured, measured
from anisogran.comparison.measures import (
    best_exponential,
    decay_length,
    decay_length_error,
    equilibrium,
    exponential_fit,
    log_rms,
    near_angle,
    near_l2,
    relative_l2,
    resolved,
    ring_edges,
)
from anisogran.comparison.pairing import Comparison, compare, ring_flow, wall_stress_ratio
from anisogran.comparison.prediction import RIVALS, Frozen, frozen, predictions
from anisogran.comparison.rotation import Asymmetry, asymmetry, spin_length
from anisogran.comparison.studies import study_runs

__all__ = [
    "RIVALS", "Asymmetry", "Calibration", "Comparison", "Frozen", "Measured", "Packing", "asymmetry", "best_exponential", "compare",
    "decay_length", "decay_length_error", "equilibrium", "exponential_fit", "fitted_amplitude", "fitted_wall", "frozen",
    "homogeneous_friction", "log_rms", "measured", "near_angle", "near_l2", "packing", "predictions", "relative_l2", "resolved",
    "ring_edges", "ring_flow", "spin_length", "study_runs", "wall_stress_ratio",
]  # fmt: skip
