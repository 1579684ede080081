"""Data and a law in, parameters with honest errors and a verdict out; one file per fit. The only room that imports lmfit."""

from anisogran.fitting.adhesion_series import cohesion
from anisogran.fitting.band_profile import shear_band
from anisogran.fitting.exponential_approach import relaxation, relaxations
from anisogran.fitting.exponential_tail import exponential_decay
from anisogran.fitting.gate import Verdict
from anisogran.fitting.inertial_friction import mu_of_I
from anisogran.fitting.observations import DataSet
from anisogran.fitting.result import FitResult
from anisogran.fitting.yield_line import mohr_coulomb, mohr_coulomb_lines

__all__ = [
    "DataSet",
    "FitResult",
    "Verdict",
    "cohesion",
    "exponential_decay",
    "mohr_coulomb",
    "mohr_coulomb_lines",
    "mu_of_I",
    "relaxation",
    "relaxations",
    "shear_band",
]
