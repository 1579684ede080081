"""Constitutive laws at a point, one per file: stateless functions of arrays, tensors t[i, j, ...] with the batch behind."""

from anisogran.models.anisotropic import directional_stiffness, stiffness, stress_increment
from anisogran.models.contact_moduli import Network, NetworkModuli, fabric_moduli, fabric_of_moduli, network_moduli, network_of_moduli
from anisogran.models.controls import biaxial, cyclic, isotropic_compression, pure_shear, simple_shear
from anisogran.models.critical_state import CriticalFlow, critical_flow, distance_from_flow
from anisogran.models.element import ElementTest, element_test
from anisogran.models.evolution import relax, relax_tensor
from anisogran.models.ill_posedness import ill_posed, neutral_inertial_numbers, well_posed_ranges, well_posedness
from anisogran.models.inertial_flow import I_of_area_fraction, area_fraction_of_I, inertial_number, viscosity
from anisogran.models.integrators import INTEGRATORS, Explicit, Midpoint, RungeKutta45
from anisogran.models.laws import LAWS, law_parameters
from anisogran.models.local_fluidity import cooperativity_length, g_local
from anisogran.models.mohr_coulomb import (
    FailureLines,
    StressCircles,
    YieldLine,
    failure_lines,
    macro_cohesion,
    mobilised_angle,
    mohr_coulomb_line,
    peak_stress,
    stress_circles,
    total_friction_line,
)
from anisogran.models.mu_of_i import LINEAR_LIMIT, I_linear, I_of_mu, mu_linear, mu_of_I, within_linear_range
from anisogran.models.regularisation import mu_regularised
from anisogran.models.scalar import ScalarParameters, softening
from anisogran.models.shear_kinematics import (
    FiniteShear,
    ShearIncrement,
    displacement_gradient,
    finite_shear,
    in_axes_at_45_degrees,
    shear_increment,
)
from anisogran.models.update import PointState, Updated, updated

__all__ = [
    "INTEGRATORS",
    "LAWS",
    "LINEAR_LIMIT",
    "CriticalFlow",
    "ElementTest",
    "Explicit",
    "FailureLines",
    "FiniteShear",
    "I_linear",
    "I_of_area_fraction",
    "I_of_mu",
    "Midpoint",
    "Network",
    "NetworkModuli",
    "PointState",
    "RungeKutta45",
    "ScalarParameters",
    "ShearIncrement",
    "StressCircles",
    "Updated",
    "YieldLine",
    "area_fraction_of_I",
    "biaxial",
    "cooperativity_length",
    "critical_flow",
    "cyclic",
    "directional_stiffness",
    "displacement_gradient",
    "distance_from_flow",
    "element_test",
    "fabric_moduli",
    "fabric_of_moduli",
    "failure_lines",
    "finite_shear",
    "g_local",
    "ill_posed",
    "in_axes_at_45_degrees",
    "inertial_number",
    "isotropic_compression",
    "law_parameters",
    "macro_cohesion",
    "mobilised_angle",
    "mohr_coulomb_line",
    "mu_linear",
    "mu_of_I",
    "mu_regularised",
    "network_moduli",
    "network_of_moduli",
    "neutral_inertial_numbers",
    "peak_stress",
    "pure_shear",
    "relax",
    "relax_tensor",
    "shear_increment",
    "simple_shear",
    "softening",
    "stiffness",
    "stress_circles",
    "stress_increment",
    "total_friction_line",
    "updated",
    "viscosity",
    "well_posed_ranges",
    "well_posedness",
    "within_linear_range",
]
