"""What a run tells while it runs: what it will take, its stages with their effects, how far it is, and how it ended."""

import sys
import time

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from anisogran.runs import estimate, free_memory, run_in_folder
from anisogran.runs.estimates import SPEED
from anisogran.scenes import doubts_of

PLAIN_EVERY = 30.0  # s between two lines where there is no terminal
FIGURES_EVERY = 0.5  # s between two looks at the grains
BEGINS = "begins; the first time its kernels are compiled"


def opening(scene, folder):
    """Says what is run where, and what it will take."""
    expected, free = estimate(scene), free_memory()
    memory = f"{expected.memory / 1e9:.1f} GB of memory" + ("" if free is None else f" ({free / 1e9:.1f} GB free)")
    print(f"{scene.kind}: {scene.n} grains, seed {scene.seed}, in {folder}")
    print(
        f"stages: {', '.join(stage.name for stage in scene.stages())}; about {expected.grain_steps / 1e6:,.0f} million grain-steps, "
        f"{duration(expected.seconds)} at {SPEED / 1e6:.0f} million a second on one core; about {memory}"
    )
    for doubt in doubts_of(scene):
        print(f"warning: {doubt}")
    sys.stdout.flush()  # what is told before the start is to be read before the end, in a file too


def duration(seconds):
    """In seconds, minutes or hours, whichever reads best."""
    for unit, length in (("h", 3600), ("min", 60)):
        if seconds >= 2 * length:
            return f"{seconds / length:.1f} {unit}"
    return f"{max(1, round(seconds))} s"


def shown_run(scene, folder, resume, force):
    """Runs the scene in its folder behind a progress bar; returns the Run."""
    clock = time.perf_counter()
    console = Console(stderr=True)
    columns = [TextColumn("{task.description:8}"), BarColumn(20), TaskProgressColumn(), TimeElapsedColumn(), TimeRemainingColumn()]
    with Progress(*columns, TextColumn("{task.fields[figures]}"), console=console, transient=True, disable=not console.is_terminal) as bar:
        display = Display(scene, bar)
        result = run_in_folder(scene, folder, resume, force, display.hear)
    saving = result.provenance["saving_seconds"]
    print(f"{folder / 'results.h5'}: {described(result)} ({time.perf_counter() - clock:.0f} s, {saving:.1f} s of them for saving)")
    print(last_row(result))
    for reason in result.status.reasons:
        print(f"warning: {reason}")
    return result


class Display:
    """Listens to a session: a line for each stage that begins, a bar on a terminal, and else a line now and then."""

    def __init__(self, scene, bar):
        self.inertial_number, self.bar = scene.nominal_inertial_number(), bar
        self.task = bar.add_task("", total=1.0, figures=BEGINS)
        self.stage, self.looked, self.told = None, 0.0, time.monotonic()

    def hear(self, session):
        """What run_in_folder calls several times a second."""
        if session.begun is not None and self.stage != session.stage:
            self.stage = session.stage
            self.bar.console.print(stage_line(session), highlight=False, soft_wrap=True)
        now = time.monotonic()
        if session.begun is None:
            self.bar.update(self.task, description=session.stage_name, completed=session.fraction, figures=BEGINS)
            return
        if now - self.looked < FIGURES_EVERY:
            return
        self.looked = now
        figures = self.figures(session)
        self.bar.update(self.task, description=session.stage_name, completed=session.fraction, figures=figures)
        if self.bar.disable and now - self.told >= PLAIN_EVERY:
            self.told = now
            print(f"{session.stage_name} {session.fraction:.0%}  {figures}", file=sys.stderr, flush=True)

    def figures(self, session):
        """Speed, inertial number, unbalanced force and kinetic energy at present."""
        imbalance = session.simulation.force_imbalance()
        return (
            f"{session.speed / 1e6:.0f} million grain-steps/s  I {self.inertial_number:.1e}  "
            f"unbalanced {'-' if imbalance is None else f'{imbalance:.1e}'}  E_kin {session.simulation.kinetic_energy():.1e} J"
        )


def stage_line(session):
    """The stage that begins: its steps, its effects, and those that are absent."""
    stage, (active, absent) = session.stages[session.stage], session.simulation.active_effects()
    steps = f"{stage.steps:,} steps of {session.simulation.dt:.3g} s"
    steps = f"until equilibrium, about {steps}" if stage.gate is not None else steps
    return f"stage {stage.name}: {steps}; {', '.join(active)}; absent: {', '.join(absent)}"


def described(result):
    """What a Run holds, in a few words."""
    parts = [f"{result.series.sizes['time']} rows", f"{len(result.snapshots)} snapshots"]
    if result.profiles is not None:
        parts.append(f"profiles over {result.profiles.sizes['r']} rings")
    return ", ".join(parts) + f"; {result.status.level}"


def last_row(result):
    """The end of the series in one line."""
    row = result.series.isel(time=-1)
    return "at the end: " + ", ".join(f"{name} {float(row[name]):.4g}" for name in row.data_vars)


def summary(result, folder):
    """How a run went, as plain values."""
    last = {name: float(value) for name, value in result.series.isel(time=-1).data_vars.items()}
    status = {"level": result.status.level, "reasons": list(result.status.reasons)}
    return {"folder": str(folder), "status": status, "last": last, "provenance": result.provenance}
