"""`anisogran bench`: how fast it is."""

from pathlib import Path
from typing import Annotated

import typer

from anisogran.cli.application import app

bench = typer.Typer(help="How fast it is, on work that other codes have been timed on.", rich_markup_mode=None)
app.add_typer(bench, name="bench")


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

    def numbers():
        packed = made_packing(grains) if packing is None else read_packing(packing)
        return dem_benchmark(*packed, effects, steps, warmup, rate, ledger)

    tell(json_file, numbers)


@bench.command("averaging")
def bench_averaging(
    grains: Annotated[int, typer.Option(help="Size of the packing that is made.", min=200, max=10_000_000)] = 100_000,
    repeats: Annotated[int, typer.Option(help="Runs that are timed; the median is told.", min=1)] = 5,
    json_file: Annotated[Path | None, typer.Option("--json", help="File for the numbers.")] = None,
):
    """Averages of a dense packing on one core: rings, grid and points, and what they cost beside the run that makes the grains."""
    from anisogran.benchmark import averaging_benchmark

    tell(json_file, lambda: averaging_benchmark(grains, repeats))


@bench.command("models")
def bench_models(
    points: Annotated[int, typer.Option(help="Points that are updated at once.", min=1, max=10_000_000)] = 100_000,
    repeats: Annotated[int, typer.Option(help="Runs that are timed; the median is told.", min=1)] = 5,
    json_file: Annotated[Path | None, typer.Option("--json", help="File for the numbers.")] = None,
):
    """Laws at a point on one core: updates a second with and without tangent, and seconds of a curve, each beside its error."""
    from anisogran.benchmark import models_benchmark

    tell(json_file, lambda: models_benchmark(points, repeats))


@bench.command("continuum")
def bench_continuum(
    along: Annotated[int, typer.Option(help="Elements along the radius in 2D.", min=2, max=400)] = 48,
    around: Annotated[int, typer.Option(help="Elements around in 2D.", min=4, max=400)] = 60,
    repeats: Annotated[int, typer.Option(help="Runs in 1D that are timed; the median is told.", min=1)] = 5,
    json_file: Annotated[Path | None, typer.Option("--json", help="File for the numbers.")] = None,
):
    """Steady ring flows on a line and in 2D: seconds from nothing, unknowns, iterations, each beside its error."""
    from anisogran.benchmark import continuum_benchmark

    tell(json_file, lambda: continuum_benchmark(along, around, repeats))


def tell(json_file, benchmark):
    """Runs the benchmark and prints its numbers (a dict), as JSON too if a file is given, which is tried before any work is done."""
    if json_file is not None:
        from anisogran.files.numbers import check_writable

        check_writable(json_file, "--json ")
    numbers = benchmark()
    if json_file is not None:
        from anisogran.files import write_json

        write_json(json_file, numbers)
    width = max(22, *map(len, numbers))
    for name, value in numbers.items():
        print(f"{name:{width}} {value:.4g}" if isinstance(value, float) else f"{name:{width}} {value}")
