"""Sweeps: one scene with other values, one folder a case, on any executor; and all cases as one labelled dataset."""

from anisogran.sweeps.collecting import collect_sweep
from anisogran.sweeps.folder import sweep_status
from anisogran.sweeps.running import sweep
from anisogran.sweeps.study import study

__all__ = ["collect_sweep", "study", "sweep", "sweep_status"]
