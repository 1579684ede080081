"""`anisogran sweep`: one scene with other values."""

import contextlib
from pathlib import Path
from typing import Annotated

import typer
from typer.core import TyperCommand, TyperGroup

from anisogran.cli.application import app
from anisogran.cli.folders import check_new_file, numbered_folder
from anisogran.outcome import InputError, Interrupted, RunFailed

RUN = "SCENE"  # the command that is meant if none is named
ROWS = 40  # of the printed table, unless the status is asked for


class SweepGroup(TyperGroup):
    """`sweep status` and `sweep collect` are commands; whatever else follows `sweep` is a scene to be run, or the help about that."""

    def parse_args(self, context, args):
        named = bool(args) and args[0] in self.commands and args[0] != RUN
        return super().parse_args(context, list(args) if named else [RUN, *(args or ["--help"])])


class SweepCommand(TyperCommand):
    """The command without a name of its own."""

    def make_context(self, info_name, args, parent=None, **extra):
        return super().make_context(None, args, parent=parent, **extra)

    def format_usage(self, context, formatter):
        formatter.write_usage(context.command_path.strip(), " ".join(self.collect_usage_pieces(context)))


sweeps = typer.Typer(cls=SweepGroup, help="Runs a scene with other values; tells of such runs, collects them.", rich_markup_mode=None)
app.add_typer(sweeps, name="sweep")


@sweeps.command(RUN, cls=SweepCommand, hidden=True)
def sweep_scene(
    scene: Annotated[Path, typer.Argument(metavar="SCENE", help="Scene file (TOML); see `anisogran new`.")],
    vary: Annotated[
        list[str] | None, typer.Option(metavar="KEY=VALUES", help="As contact.kc=0,5e4,1e5 or seed=1..6; at least one, once for each key.")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Folder of the sweep, new or to go on with; default: a new numbered one.")] = None,
    changes: Annotated[list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Another value, in all cases.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="With the table [quick] of the scene.")] = False,
    workers: Annotated[int | None, typer.Option(help="Cases at the same time; default: as many as cores.", min=1, max=1024)] = None,
    scheduler: Annotated[str | None, typer.Option(help="Address of a dask scheduler whose workers run the cases.")] = None,
    retry: Annotated[bool, typer.Option("--retry", help="Run failed cases again, too.")] = False,
    json_file: Annotated[Path | None, typer.Option("--json", help="File for the states of the cases.")] = None,
):
    """Runs a scene with all combinations of the values, one folder a case.

    Given again with the same folder, the command runs only what is not finished; values may have been added. Ctrl-C saves. See
    also `anisogran sweep status DIR` and `anisogran sweep collect DIR`.
    """
    if not vary:
        raise InputError("sweep: --vary KEY=VALUES is missing; to look at a sweep: sweep status DIR, sweep collect DIR")
    if scheduler is not None and workers is not None:
        raise InputError("sweep: --workers are processes of this machine; with --scheduler the scheduler has its own")
    if json_file is not None:
        from anisogran.files import check_writable

        check_writable(json_file, "--json ")
    from anisogran.experiments import read_scene
    from anisogran.sweeps.cases import case_scenes, parsed_vary
    from anisogran.sweeps.folder import check_sweep_folder

    base, varied = read_scene(scene, changes or (), quick), parsed_vary(vary)
    scenes = case_scenes(base, varied)[1]
    if out is not None and str(out) in ("", "."):
        raise InputError("--out: name a folder of its own for the sweep")
    if out is not None:
        check_sweep_folder(out)
    with executor_at(scheduler) as executor:
        folder = out or numbered_folder("sweep")
        try:
            run_behind_bar(base, varied, folder, scenes.values(), executor=executor, workers=workers, retry=retry)
        except (RunFailed, Interrupted):
            tell(folder, json_file, ROWS)
            raise
        except InputError:
            with contextlib.suppress(OSError):
                folder.rmdir()  # a new one is left as empty as it was made; one that holds anything stays
            raise
    tell(folder, json_file, ROWS)
    print(f"\nanisogran sweep collect {folder}   makes one file of them")


def run_behind_bar(base, varied, folder, scenes, executor, workers, retry):
    """Runs the sweep and shows how far it is."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    from anisogran.cli.run_display import duration
    from anisogran.runs.estimates import estimate
    from anisogran.scenes import doubts_of
    from anisogran.sweeps import sweep
    from anisogran.sweeps.running import cores

    seconds, at_once = sum(estimate(scene).seconds for scene in scenes), min(workers or cores(), len(scenes))
    on = "the workers of the scheduler" if executor else numbered(at_once, "worker")
    about = "" if executor else f", about {duration(seconds / at_once)} if none is done yet"
    print(f"{numbered(len(scenes), 'case')} in {folder} on {on}{about}")
    for doubt in dict.fromkeys(doubt for scene in scenes for doubt in doubts_of(scene)):
        print(f"warning: {doubt}")
    columns = (TextColumn("{task.description:28}"), BarColumn(), TaskProgressColumn(), TimeElapsedColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), speed_estimate_period=600.0) as bars:
        task = bars.add_task("starting", total=1.0)

        def show(now):
            failed = f", {now.failed} not" if now.failed else ""
            bars.update(task, completed=now.fraction, description=f"{now.finished}/{now.cases} finished{failed}")

        sweep(base, varied, folder, executor=executor, workers=workers, retry=retry, listen=show)


def executor_at(address):
    """A context with the executor of the dask scheduler at an address, None without one. Raises InputError if there is none."""
    if address is None:
        return contextlib.nullcontext()
    try:
        from distributed import Client
    except ImportError:
        raise InputError("--scheduler needs dask.distributed: pip install 'anisogran[sweep]'") from None

    @contextlib.contextmanager
    def connected():
        try:
            client = Client(address, timeout="10s", set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            raise InputError(f"--scheduler {address}: no dask scheduler answers there ({error})") from None
        with client:
            yield client.get_executor(pure=False)  # a folder has changed when it is run again

    return connected()


@sweeps.command("status")
def status(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of the sweep.")],
    json_file: Annotated[Path | None, typer.Option("--json", help="File for the states of the cases.")] = None,
):
    """Tells of each case of a sweep whether it is finished, or how far, or why not; at any time."""
    if json_file is not None:
        from anisogran.files import check_writable

        check_writable(json_file, "--json ")
    tell(folder, json_file)


@sweeps.command("collect")
def collect(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of the sweep.")],
    out: Annotated[Path | None, typer.Option(help="HDF5 file to write; default: collected.h5 in the folder of the sweep.")] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace the file if it is there.")] = False,
):
    """Makes one file of all cases, labelled arrays with a dimension for each varied key; what is not finished is NaN."""
    from anisogran.files import save_results
    from anisogran.sweeps import collect_sweep
    from anisogran.sweeps.folder import read_sweep

    if out is None:
        read_sweep(folder)  # tells of a wrong folder as such
    path = out or folder / "collected.h5"
    check_new_file("--out" if out else "collect", path, force)
    collected = collect_sweep(folder)
    save_results(path, {name: node.to_dataset() for name, node in collected.children.items()}, collected.attrs)
    for group, node in collected.children.items():
        for name, variable in node.to_dataset().data_vars.items():
            sizes = ", ".join(f"{dim} {size}" for dim, size in variable.sizes.items())
            print(f"{f'{group}/{name}':36} {variable.attrs.get('units', ''):8} {sizes}")
    states = collected["cases"].state.values
    print(
        f"\n{path}: {(states == 'finished').sum()} of {states.size} cases, the others are NaN"
        if (states != "finished").any()
        else f"\n{path}"
    )


def numbered(count, noun):
    """ "1 case" or "3 cases"."""
    return f"{count} {noun}{'s' * (count != 1)}"


def tell(folder, json_file, rows=None):
    """Prints the states of the cases, no more than `rows`, and writes them to a JSON file if one is given."""
    from anisogran.sweeps import sweep_status
    from anisogran.sweeps.cases import text_of

    states = sweep_status(folder)
    if json_file is not None:
        from anisogran.files import write_json

        write_json(json_file, {"folder": str(folder), "cases": states})
    keys = list(states[0]["values"])
    table = [["case", *keys, "state", "done", "message"]]
    for one in states[:rows]:
        table.append([one["case"], *map(text_of, one["values"].values()), one["state"], f"{one['fraction']:.0%}", one["message"]])
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    for line in table:
        print("  ".join(f"{part:{width}}" for part, width in zip(line, widths, strict=True)).rstrip())
    if len(states) > len(table) - 1:
        print(f"... and {len(states) - len(table) + 1} more: anisogran sweep status {folder}")
    counts = {name: sum(one["state"] == name for one in states) for name in dict.fromkeys(one["state"] for one in states)}
    print(f"{numbered(len(states), 'case')}: {', '.join(f'{count} {name}' for name, count in counts.items())}")
