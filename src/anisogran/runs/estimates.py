"""What a scene will take: memory, work and time, told before it starts."""

import os
from pathlib import Path
from typing import NamedTuple

from anisogran.outcome import InputError
from anisogran.runs.session import Session

SPEED = 5e7  # grain-steps a second, of a dense sample with friction on one core of an AMD EPYC (Zen 4), see `anisogran bench dem`
RANDOM_START = 1e-7  # s for each pair of grains, see dem/random_start.py
PROCESS = 3e8  # bytes of a process with its libraries and compiled kernels
STATE = 600  # bytes a grain: rows, forces, neighbour list and contact memory, and the record of the grains at the start
SNAPSHOT = 200  # bytes a grain, with two contacts
COPIES = 3  # of state and snapshots while they are written: as arrays, as a file in memory, and in the results
SHARE = 0.8  # of the free memory that a run may take


class Estimate(NamedTuple):
    """grain_steps and seconds on one core, and bytes of memory."""

    grain_steps: float
    seconds: float
    memory: float


def estimate(scene):
    """The Estimate of a scene, good to a factor of two; how long a preparation takes to reach equilibrium is a guess."""
    grains = scene.n
    grain_steps = float(grains) * Session(scene).steps_expected
    snapshots = 3 + getattr(scene, "frames", 0)
    memory = PROCESS + COPIES * grains * (STATE + snapshots * SNAPSHOT)
    return Estimate(grain_steps, grain_steps / SPEED + RANDOM_START * grains**2, memory)


def free_memory():
    """Bytes that are free for a new process, of the machine or of the job or container it is in; None if the system does not tell."""
    known = [part for part in (_free_on_machine(), _free_in_group()) if part is not None]
    return min(known, default=None)


def _free_on_machine():
    try:
        with open("/proc/meminfo", encoding="ascii") as file:
            kilobytes = {line.split(":")[0]: float(line.split()[1]) for line in file}
        return 1024 * kilobytes["MemAvailable"]
    except (OSError, KeyError):
        pass
    try:
        return float(os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, ValueError, OSError):
        return None


def _free_in_group(folder="/sys/fs/cgroup"):
    """What the control group of a job or a container leaves (version 2)."""
    try:
        limit, used = (Path(folder, f"memory.{name}").read_text(encoding="ascii").strip() for name in ("max", "current"))
        return None if limit == "max" else float(limit) - float(used)
    except (OSError, ValueError):
        return None


def check_memory(scene, free=None):
    """Raises InputError if the scene would take more than SHARE of the `free` memory in bytes (default: as the system says)."""
    needed, free = estimate(scene).memory, free_memory() if free is None else free
    if free is not None and needed > SHARE * free:
        raise InputError(
            f"{scene.kind}: n = {scene.n} take about {needed / 1e9:.1f} GB of memory, "
            f"more than {SHARE:.0%} of the {free / 1e9:.1f} GB that are free"
        )
