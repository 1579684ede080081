"""The command line. Heavy imports stand inside the commands, so that help is quick."""

from anisogran.cli import (
    average_command,
    bench_command,
    compare_command,
    cost_command,
    demo_command,
    element_command,
    fit_command,
    run_command,
    scene_commands,
    solve_command,
    sweep_commands,
)
from anisogran.cli.application import app, main
from anisogran.cli.folders import numbered_folder

__all__ = [
    "app", "average_command", "bench_command", "compare_command", "cost_command", "demo_command", "element_command", "fit_command",
    "main", "numbered_folder", "run_command", "scene_commands", "solve_command", "sweep_commands",
]  # fmt: skip
