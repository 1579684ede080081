"""The main job: grains, averages, law, continuum and comparison in one go, with a report. Only the command line stands above it."""

from anisogran.demo.pipeline import DemoScene, Findings, run_demo
from anisogran.demo.report import write_report

__all__ = ["DemoScene", "Findings", "run_demo", "write_report"]
