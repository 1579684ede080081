"""Data and a law in, parameters with honest errors and a verdict out; one file per fit. The only room that imports lmfit."""

from anisogran.fitting.adhesion_series import cohesion
from anisogran.fitting.band_profile import shear_band
from anisogran.fitting.calibrated import Comparison, LawFit, Misfit
from anisogran.fitting.exponential_approach import relaxation, relaxations
from anisogran.fitting.exponential_tail import exponential_decay
from anisogran.fitting.gate import Verdict
from anisogran.fitting.implied_modulus import ComparedB, compared_B
from anisogran.fitting.inertial_density import area_fraction
from anisogran.fitting.inertial_friction import mu_of_I
from anisogran.fitting.initial_slope import initial_moduli
from anisogran.fitting.law_calibration import calibrate
from anisogran.fitting.law_curves import Curve
from anisogran.fitting.observations import DataSet
from anisogran.fitting.peak import Peak, peak
from anisogran.fitting.probes import probed_moduli
from anisogran.fitting.result import FitResult
from anisogran.fitting.seed_mean import mean_and_error
from anisogran.fitting.whole_curve import path_moduli
from anisogran.fitting.yield_line import mohr_coulomb, mohr_coulomb_lines

__all__ = [
    "ComparedB",
    "Comparison",
    "Curve",
    "DataSet",
    "FitResult",
    "LawFit",
    "Misfit",
    "Peak",
    "Verdict",
    "area_fraction",
    "calibrate",
    "cohesion",
    "compared_B",
    "exponential_decay",
    "initial_moduli",
    "mean_and_error",
    "mohr_coulomb",
    "mohr_coulomb_lines",
    "mu_of_I",
    "path_moduli",
    "peak",
    "probed_moduli",
    "relaxation",
    "relaxations",
    "shear_band",
]
