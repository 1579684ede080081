"""Data and a law in, parameters with honest errors and a verdict out; one file per fit. The only room that imports lmfit."""

from anisogran.fitting.band_profile import shear_band
from anisogran.fitting.exponential_approach import relaxation
from anisogran.fitting.exponential_tail import exponential_decay
from anisogran.fitting.gate import Verdict
from anisogran.fitting.inertial_friction import mu_of_I
from anisogran.fitting.result import FitResult
from anisogran.fitting.yield_line import mohr_coulomb

__all__ = ["FitResult", "Verdict", "exponential_decay", "mohr_coulomb", "mu_of_I", "relaxation", "shear_band"]
