"""The main job: grains, averages, law, continuum and comparison in one go, with a report. Stands on all other rooms, below the command line."""

from anisogran.demo.pipeline import DemoScene, Findings, run_demo
from anisogran.demo.report import write_report

__all__ = ["DemoScene", "Findings", "run_demo", "write_report"]
