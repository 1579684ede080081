"""The experiments: a scene and its protocol (prepare, relax, load), one per file; and how a scene is run, here or in a folder."""

from anisogran.experiments.biaxial import Biaxial
from anisogran.experiments.experiment import Experiment
from anisogran.experiments.ring_shear import RingShear
from anisogran.experiments.run import Run
from anisogran.experiments.run_folder import run_in_folder
from anisogran.experiments.simple_shear import SimpleShear

__all__ = ["Biaxial", "Experiment", "RingShear", "Run", "SimpleShear", "run_in_folder"]
