"""The command line. Heavy imports stand inside the commands, so that help is quick."""

import contextlib
import itertools
import signal
import sys
import tempfile
import time
from pathlib import Path
from typing import Annotated

import typer

from anisogran import __version__
from anisogran.outcome import InputError, Interrupted, NotConverged, RunFailed

OK, BAD_INPUT, RUN_FAILED, NOT_CONVERGED, INTERRUPTED = 0, 2, 3, 4, 130

app = typer.Typer(
    help="From particle simulations to continuum theory for granular matter.", add_completion=False,
    pretty_exceptions_enable=False, rich_markup_mode=None,
)  # fmt: skip
bench = typer.Typer(help="How fast it is, on work that other codes have been timed on.", rich_markup_mode=None)
app.add_typer(bench, name="bench")


@app.callback(invoke_without_command=True)
def anisogran(version: Annotated[bool, typer.Option("--version", help="Show the version and exit.")] = False):
    """From particle simulations to continuum theory for granular matter."""
    if version:
        print(f"anisogran {__version__}")
        raise typer.Exit


@app.command()
def demo(
    out: Annotated[Path | None, typer.Option(help="Folder for the report; default: a new numbered folder.")] = None,
    seed: Annotated[int, typer.Option(help="Seed of every random number.", min=0)] = 1,
    json_file: Annotated[Path | None, typer.Option("--json", help="File for the numbers.")] = None,
    force: Annotated[bool, typer.Option(help="Use a folder that is not empty.")] = False,
    quick: Annotated[bool, typer.Option(help="Tiny sizes: every stage runs, the numbers are rough.")] = False,
):
    """The main job: grains, averages, law, continuum, comparison; writes report.html and results.h5."""
    clock = time.perf_counter()
    if json_file is not None:
        from anisogran.files.numbers import check_writable

        check_writable(json_file, "--json ")
    folder = output_folder(out, "demo", force)
    try:
        findings = run_and_report(seed, quick, folder, clock)
    except BaseException as error:
        with contextlib.suppress(OSError):
            folder.rmdir()  # nothing was found: leave no empty folder behind; a folder that holds anything stays
        if isinstance(error, KeyboardInterrupt):  # typer would give it an exit code, but no word
            raise Interrupted("interrupted; nothing was written") from None
        raise
    if json_file is not None:
        from anisogran.files import write_json

        write_json(json_file, findings.numbers)
    summarise(findings, folder)


@bench.callback(invoke_without_command=True)
def bench_rooms(context: typer.Context):
    """How fast it is, on work that other codes have been timed on."""
    if context.invoked_subcommand is None:
        print(context.get_help())


@bench.command("dem")
def bench_dem(
    packing: Annotated[Path | None, typer.Option(help="Packing to shear, .npz with x (N, 3), r (N,), L in m; default: made here.")] = None,
    grains: Annotated[int, typer.Option(help="Size of the packing that is made.", min=20, max=10_000_000)] = 10_000,
    effects: Annotated[str, typer.Option(help="frictionless, friction, or luding (with friction).")] = "friction",
    steps: Annotated[int, typer.Option(help="Steps that are timed.", min=1)] = 2000,
    warmup: Annotated[int, typer.Option(help="Steps before.", min=0)] = 300,
    rate: Annotated[float, typer.Option(help="Rate of the pure shear, 1/s.")] = 5.0,
    ledger: Annotated[bool, typer.Option("--ledger", help="Keep the book of energies as well.")] = False,
    json_file: Annotated[Path | None, typer.Option("--json", help="File for the numbers.")] = None,
):
    """Pure shear of a dense periodic packing on one core: particle-steps a second, memory, neighbour lists."""
    from anisogran.benchmark import check_effects, dem_benchmark, made_packing, read_packing

    check_effects(effects)
    if json_file is not None:
        from anisogran.files.numbers import check_writable

        check_writable(json_file, "--json ")
    numbers = dem_benchmark(*(made_packing(grains) if packing is None else read_packing(packing)), effects, steps, warmup, rate, ledger)
    if json_file is not None:
        from anisogran.files import write_json

        write_json(json_file, numbers)
    for name, value in numbers.items():
        print(f"{name:22} {value:.4g}" if isinstance(value, float) else f"{name:22} {value}")


def run_and_report(seed, quick, folder, clock):
    """Runs the demo behind a progress bar and writes its report; returns the Findings."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    console = Console(stderr=True)
    columns = (TextColumn("{task.description:24}"), BarColumn(), TaskProgressColumn(), TimeElapsedColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console) as bars:
        tasks = [bars.add_task(name, total=1.0) for name in ("ring shear cell", "biaxial box, shear tests")]
        rest = bars.add_task("law, continuum, report", total=1.0)

        from anisogran.demo import DemoScene, run_demo, write_report

        def show(fractions):
            for task, fraction in zip(tasks, fractions, strict=True):
                bars.update(task, completed=fraction)

        findings = run_demo(DemoScene.small(seed) if quick else DemoScene(seed=seed), show)
        show([1.0] * len(tasks))
        bars.update(rest, completed=0.5)
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
    for reason in findings.reasons:
        print(f"warning: {reason}")
    print(f"{folder / 'report.html'} ({n['wall_s']:.0f} s)")


def output_folder(out, name, force):
    """The folder to write to: `out`, or the first free of name-001, name-002, ...; made, empty (unless forced) and writable.

    Raises InputError otherwise; nothing in it is touched.
    """
    try:
        if out is None:
            folder = numbered_folder(name)
        elif str(out) in ("", "."):
            raise InputError("--out: name a folder of its own for the report")
        elif out.exists() and not out.is_dir():
            raise InputError(f"--out {out}: is not a folder")
        else:
            folder = out
            folder.mkdir(parents=True, exist_ok=True)
            if any(folder.iterdir()) and not force:
                raise InputError(f"--out {out}: the folder is not empty; choose another or add --force")
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise InputError(f"--out {out if out is not None else name + '-NNN'}: cannot be written ({error.strerror})") from None
    return folder


def numbered_folder(name):
    """Makes the first folder of name-001, name-002, ... that does not exist yet."""
    for k in itertools.count(1):
        folder = Path(f"{name}-{k:03d}")
        with contextlib.suppress(FileExistsError):
            folder.mkdir()
            return folder


def main(arguments=None):
    """Runs the command line and leaves with its exit code; a user's mistake is one line on stderr, never a traceback."""
    arguments = sys.argv[1:] if arguments is None else arguments
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # ended politely is interrupted: workers are stopped, folders left clean
    try:
        code = app(args=arguments or ["--help"], prog_name="anisogran", standalone_mode=False)
    except typer.Exit as end:
        code = end.exit_code
    except InputError as error:
        code = complain(error, BAD_INPUT)
    except RunFailed as error:
        code = complain(error, RUN_FAILED)
    except NotConverged as error:
        code = complain(error, NOT_CONVERGED)
    except (KeyboardInterrupt, Interrupted) as error:
        code = complain(str(error) or "interrupted", INTERRUPTED)
    except Exception as error:
        if not hasattr(error, "format_message"):  # typer's own errors: a wrong option, a value of the wrong type
            raise
        code = complain(error.format_message(), BAD_INPUT)
    sys.exit(code or OK)


def complain(error, code):
    """One line on stderr; returns the exit code."""
    print(f"anisogran: {' '.join(str(error).split())}", file=sys.stderr)
    return code
