"""The experiments: a scene and its protocol (prepare, relax, load), one per file; and the files that hold scenes."""

from anisogran.experiments.biaxial import Biaxial
from anisogran.experiments.cohesive_gas import CohesiveGas
from anisogran.experiments.experiment import Experiment
from anisogran.experiments.kinds import KINDS, experiment_of
from anisogran.experiments.probing import probes
from anisogran.experiments.ring_shear import RingShear
from anisogran.experiments.ring_shear_volume import RingShearVolume
from anisogran.experiments.scene_file import read_scene
from anisogran.experiments.simple_shear import SimpleShear
from anisogran.experiments.stiffness import Stiffness
from anisogran.experiments.tablet import Tablet

__all__ = [
    "KINDS", "Biaxial", "CohesiveGas", "Experiment", "RingShear", "RingShearVolume", "SimpleShear", "Stiffness", "Tablet",
    "experiment_of", "probes", "read_scene",
]  # fmt: skip
