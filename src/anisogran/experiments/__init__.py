"""The experiments: a scene and its protocol (prepare, relax, load), one per file; scene files; runs in folders, and sweeps."""

from anisogran.experiments.biaxial import Biaxial
from anisogran.experiments.doubts import doubts_of
from anisogran.experiments.experiment import Experiment
from anisogran.experiments.kinds import KINDS
from anisogran.experiments.ring_shear import RingShear
from anisogran.experiments.run import Run
from anisogran.experiments.run_folder import run_in_folder
from anisogran.experiments.scene_file import changed, read_scene
from anisogran.experiments.scene_writing import scene_template, scene_text
from anisogran.experiments.schemas import scene_schema
from anisogran.experiments.simple_shear import SimpleShear
from anisogran.experiments.sweep_collect import collect_sweep
from anisogran.experiments.sweep_folder import sweep_status
from anisogran.experiments.sweep_run import sweep

__all__ = [
    "KINDS", "Biaxial", "Experiment", "RingShear", "Run", "SimpleShear", "changed", "collect_sweep", "doubts_of", "read_scene",
    "run_in_folder", "scene_schema", "scene_template", "scene_text", "sweep", "sweep_status",
]  # fmt: skip
