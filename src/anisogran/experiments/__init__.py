"""The experiments: a scene and its protocol (prepare, relax, load), one per file."""

from anisogran.experiments.biaxial import Biaxial
from anisogran.experiments.experiment import Experiment, Run
from anisogran.experiments.ring_shear import RingShear
from anisogran.experiments.simple_shear import SimpleShear

__all__ = ["Biaxial", "Experiment", "RingShear", "Run", "SimpleShear"]
