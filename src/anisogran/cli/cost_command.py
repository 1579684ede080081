"""`anisogran cost`: what accuracy costs in time."""

from pathlib import Path
from typing import Annotated

import typer

from anisogran.cli.application import app
from anisogran.cli.folders import output_folder
from anisogran.outcome import InputError

ROOMS = ("averaging", "models")


@app.command()
def cost(
    room: Annotated[str, typer.Argument(help=f"{' or '.join(ROOMS)}.")],
    quick: Annotated[bool, typer.Option(help="Small samples: every row is there, the numbers are rough.")] = False,
    force: Annotated[bool, typer.Option(help="Use a folder that is not empty.")] = False,
    out: Annotated[Path | None, typer.Option(help="Folder for the figure, cost-ROOM.png.")] = None,
    json_file: Annotated[Path | None, typer.Option("--json", help="File for the rows, one key a room.")] = None,
):
    """Error against seconds for each knob of a room, the default marked with a star, and the price of each field."""
    if room not in ROOMS:
        raise InputError(f"cost {room}: must be one of {', '.join(ROOMS)}")
    if json_file is not None:
        from anisogran.files.numbers import check_writable

        check_writable(json_file, "--json ")
    folder = None if out is None else output_folder(out, "cost", force)
    from anisogran import cost as rooms

    rows = rooms.ROOMS[room](quick)
    if json_file is not None:
        from anisogran.files import write_json

        write_json(json_file, {room: rows})
    print(rooms.table_text(rows))
    if folder is not None:
        from anisogran.plots import cost_figure

        cost_figure(rows).savefig(folder / f"cost-{room}.png", dpi=150)
        print(f"\n{folder / f'cost-{room}.png'}")
