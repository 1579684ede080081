"""How a scene is run: in stages, from which it can go on, here or in a folder that survives whatever stops it."""

from anisogran.runs.estimates import check_memory, estimate, free_memory
from anisogran.runs.folder import run_in_folder, state_of
from anisogran.runs.run import Run
from anisogran.runs.session import Session
from anisogran.runs.stages import Stage, equilibrium

__all__ = ["Run", "Session", "Stage", "check_memory", "equilibrium", "estimate", "free_memory", "run_in_folder", "state_of"]
