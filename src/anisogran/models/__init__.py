"""Constitutive laws at a point, one per file: stateless functions of arrays, tensors t[i, j, ...] with the batch behind."""

from anisogran.models.anisotropic import directional_stiffness, stiffness, stress_increment
from anisogran.models.contact_moduli import NetworkModuli, network_moduli
from anisogran.models.critical_state import CriticalFlow, critical_flow
from anisogran.models.element import ElementTest, isobaric_biaxial
from anisogran.models.evolution import relax
from anisogran.models.mohr_coulomb import YieldLine, macro_cohesion, mobilised_angle, mohr_coulomb_line, peak_stress
from anisogran.models.mu_of_i import ill_posed, mu_linear, mu_of_I, mu_regularised, neutral_inertial_numbers, well_posedness
from anisogran.models.scalar import ScalarParameters, ScalarState, scalar_step, softening

__all__ = [
    "CriticalFlow",
    "ElementTest",
    "NetworkModuli",
    "ScalarParameters",
    "ScalarState",
    "YieldLine",
    "critical_flow",
    "directional_stiffness",
    "ill_posed",
    "isobaric_biaxial",
    "macro_cohesion",
    "mobilised_angle",
    "mohr_coulomb_line",
    "mu_linear",
    "mu_of_I",
    "mu_regularised",
    "network_moduli",
    "neutral_inertial_numbers",
    "peak_stress",
    "relax",
    "scalar_step",
    "softening",
    "stiffness",
    "stress_increment",
    "well_posedness",
]
