"""`anisogran cost`: what accuracy costs in time."""

from contextlib import nullcontext
from pathlib import Path
from typing import Annotated

import typer

from anisogran.cli.application import app
from anisogran.cli.folders import folder_to_fill
from anisogran.outcome import InputError

MINUTES = {"dem": 7, "averaging": 1, "models": 2, "fitting": 8, "continuum": 1, "whole": 60}  # of one core, kernels compiled anew
ROOMS = tuple(MINUTES)
EVERY = "all"


@app.command()
def cost(
    room: Annotated[str, typer.Argument(help=f"{', '.join(f'{room} ({minutes} min)' for room, minutes in MINUTES.items())} or {EVERY}.")],
    quick: Annotated[bool, typer.Option(help="Small samples, rough numbers, every row; all in 3 min on two cores.")] = False,
    force: Annotated[bool, typer.Option(help="Use a folder that is not empty.")] = False,
    out: Annotated[Path | None, typer.Option(help="Folder for the figures, cost-ROOM.png.")] = None,
    json_file: Annotated[Path | None, typer.Option("--json", help="File for the rows, one key a room.")] = None,
):
    """Error against seconds of the processor for each knob of a room, the default marked with a star, and the price of fields and effects.

    Minutes are those of one core, with all kernels to be compiled. `all` goes through the rooms one after the other, with --quick two at
    a time.
    """
    if room not in (*ROOMS, EVERY):
        raise InputError(f"cost {room}: must be one of {', '.join((*ROOMS, EVERY))}")
    if json_file is not None:
        from anisogran.files.numbers import check_writable

        check_writable(json_file, "--json ")
    with nullcontext() if out is None else folder_to_fill(out, "cost", force) as folder:
        go_through(room, quick, json_file, folder)


def go_through(room, quick, json_file, folder):
    """Prints the rows of a room, or of all; the file and the folder, if they are wanted, hold those that are done."""
    from anisogran import cost as costs

    found = {}
    for name, rows in costs.all_rows(quick) if room == EVERY else [(room, costs.rows_of(room, quick))]:
        found[name] = rows
        print(f"\n== {name} ==\n" if room == EVERY else "", end="")
        print(costs.table_text(rows), flush=True)
        if json_file is not None:
            from anisogran.files import write_json

            write_json(json_file, found)
        if folder is not None:
            from anisogran.plots import cost_figure

            cost_figure(rows).savefig(folder / f"cost-{name}.png", dpi=150)
            print(f"\n{folder / f'cost-{name}.png'}")
