"""The experiments by their kind in a scene file: the one list that a new one joins."""

from anisogran.experiments.biaxial import Biaxial
from anisogran.experiments.cohesive_gas import CohesiveGas
from anisogran.experiments.ring_shear import RingShear
from anisogran.experiments.ring_shear_volume import RingShearVolume
from anisogran.experiments.simple_shear import SimpleShear
from anisogran.experiments.stiffness import Stiffness
from anisogran.experiments.tablet import Tablet
from anisogran.scenes.keys import chosen

KINDS = {experiment.kind: experiment for experiment in (Biaxial, CohesiveGas, RingShear, RingShearVolume, SimpleShear, Stiffness, Tablet)}


def experiment_of(kind, where="kind"):
    """The class of experiments of that kind. Raises InputError with the nearest one."""
    return chosen(KINDS.values(), kind, where)
