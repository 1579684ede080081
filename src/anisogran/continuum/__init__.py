"""The ring shear cell as a continuum; the only room that uses the finite element library scikit-fem."""

from anisogran.continuum.couple_stress import Spin, SpinEquation, SpinProfile, spin
from anisogran.continuum.exact import local_mu_i, newtonian_couette
from anisogran.continuum.flow import Flow, Profile
from anisogran.continuum.labelled import flow_dataset, flow_numbers
from anisogran.continuum.laws import LAWS, Jop, LocalMuI, Nonlocal, Regularised
from anisogran.continuum.ring import RingFlow
from anisogran.continuum.walls import CoulombSlip, NavierSlip

__all__ = [
    "LAWS",
    "CoulombSlip",
    "Flow",
    "Jop",
    "LocalMuI",
    "NavierSlip",
    "Nonlocal",
    "Profile",
    "Regularised",
    "RingFlow",
    "Spin",
    "SpinEquation",
    "SpinProfile",
    "flow_dataset",
    "flow_numbers",
    "local_mu_i",
    "newtonian_couette",
    "spin",
]
