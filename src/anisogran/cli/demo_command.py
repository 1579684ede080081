"""`anisogran demo`: the main job."""

import time
from pathlib import Path
from typing import Annotated

import typer

from anisogran.cli.application import app
from anisogran.cli.folders import folder_to_fill
from anisogran.outcome import InputError, Interrupted, checked


@app.command()
def demo(
    out: Annotated[Path | None, typer.Option(help="Folder for the report; default: a new numbered folder.")] = None,
    seed: Annotated[int, typer.Option(help="Seed of every random number.", min=0)] = 1,
    json_file: Annotated[Path | None, typer.Option("--json", help="File for the numbers.")] = None,
    force: Annotated[bool, typer.Option(help="Use a folder that is not empty.")] = False,
    quick: Annotated[bool, typer.Option(help="Tiny sizes: every stage runs, the numbers are rough.")] = False,
    accuracy: Annotated[
        float | None,
        typer.Option(help="Relative error expected of the worst answer: chooses travel, grains, time steps, ... and checks itself."),
    ] = None,
):
    """The main job: grains, averages, law, continuum, comparison; writes report.html and results.h5."""
    clock = time.perf_counter()
    if quick and accuracy is not None:
        raise InputError("demo: --quick and --accuracy do not go together; --accuracy chooses the sizes")
    if accuracy is not None:
        checked("demo", "--accuracy", accuracy, above=0, below=1)
    if json_file is not None:
        from anisogran.files.numbers import check_writable

        check_writable(json_file, "--json ")
    with folder_to_fill(out, "demo", force) as folder:
        try:
            findings = run_and_report(seed, quick, accuracy, folder, clock)
        except KeyboardInterrupt:  # typer would give it an exit code, but no word
            raise Interrupted("interrupted; nothing was written") from None
    if json_file is not None:
        from anisogran.files import write_json

        write_json(json_file, findings.numbers)
    summarise(findings, folder)


def run_and_report(seed, quick, accuracy, folder, clock):
    """Runs the demo behind a progress bar and writes its report; returns the Findings."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    from anisogran.demo import MainJob, described, promised, run_demo, shared_out, write_report

    promise = None if accuracy is None else promised(accuracy, seed)
    if promise is not None:
        print(promise.text(), flush=True)
        clock = time.perf_counter()  # the promise holds from here on
        job = promise.job
    else:
        job = MainJob.small(seed) if quick else MainJob(seed)
    console = Console(stderr=True)
    columns = (TextColumn("{task.description:24}"), BarColumn(), TaskProgressColumn(), TimeElapsedColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console) as bars:
        tasks = [bars.add_task(described(experiments), total=1.0) for experiments in shared_out(job.experiments())]
        rest = bars.add_task("law, continuum, report", total=1.0)

        def show(fractions):
            for task, fraction in zip(tasks, fractions, strict=True):
                bars.update(task, completed=fraction)

        findings = run_demo(job, show)
        show([1.0] * len(tasks))
        bars.update(rest, completed=0.5)
        if promise is not None:
            findings = promise.held_against(findings, time.perf_counter() - clock)
        findings.numbers["wall_s"] = time.perf_counter() - clock
        write_report(findings, folder)
        findings.numbers["wall_s"] = time.perf_counter() - clock
        bars.update(rest, completed=1.0)
    return findings


def summarise(findings, folder):
    """The findings in a few lines on the terminal."""
    n = findings.numbers
    print(f"friction angle   peak {n['friction_angle_peak_deg']:.1f} deg, final {n['friction_angle_final_deg']:.1f} deg (biaxial box)")
    for name in ("s_D", "anisotropy"):
        print(f"{name:16} {findings.law.fits[name]}")
    print(f"{'mu(I)':16} {findings.friction}")
    continuum = n["decay_length_continuum"]
    grains = n["decay_length_dem"]
    if grains != grains:
        print("decay of v_phi   not determined: fewer than three rings whose velocity is three times its error")
    else:
        words = "at rest within three rings" if continuum != continuum else f"{continuum:.3g} d"
        print(f"decay of v_phi   grains {grains:.3g} +- {n['decay_length_dem_err']:.2g} d, nonlocal continuum {words}")
    print(
        f"L2 of v_phi      local {n['l2_local']:.3g}, nonlocal {n['l2_nonlocal']:.3g} (1 parameter fitted on this ring), "
        f"exponential {n['l2_exponential']:.3g} (2 parameters), error bars of the grains {n['l2_noise']:.2g}"
    )
    if findings.kept is not None:
        print(findings.kept.text())
    for reason in findings.reasons:
        print(f"warning: {reason}")
    print(f"{folder / 'report.html'} ({n['wall_s']:.0f} s)")
