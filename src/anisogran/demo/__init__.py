"""The main job: grains, averages, law, continuum and comparison in one go, with a report. Only the command line stands above it."""

from anisogran.cost.main_job import MainJob
from anisogran.demo.grains import described, shared_out
from anisogran.demo.pipeline import Findings, run_demo
from anisogran.demo.promise import promised
from anisogran.demo.report import write_report

__all__ = ["Findings", "MainJob", "described", "promised", "run_demo", "shared_out", "write_report"]
