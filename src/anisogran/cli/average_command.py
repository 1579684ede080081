"""`anisogran average`: fields of a file of grains."""

from pathlib import Path
from typing import Annotated

import typer

from anisogran.cli.application import app
from anisogran.cli.folders import check_new_file
from anisogran.outcome import InputError


@app.command()
def average(
    grains: Annotated[Path, typer.Argument(help="Results (.h5), a LAMMPS dump custom, or a MercuryDPM .data file.")],
    contacts: Annotated[Path | None, typer.Argument(help="LAMMPS dump local or MercuryDPM .fstat; results hold their own.")] = None,
    on: Annotated[str, typer.Option(help="box, rings, grid or points.")] = "box",
    fields: Annotated[str | None, typer.Option(help="Names with commas between, as stress,fabric; default: those of the place.")] = None,
    width: Annotated[str | None, typer.Option(help="Of the averaging, in m or as 1.0d in mean diameters.")] = None,
    points: Annotated[Path | None, typer.Option(help="Text file of points, a line x y (z) each, for --on points.")] = None,
    kernel: Annotated[str | None, typer.Option(help="gaussian, lucy or heaviside, for points and grid.")] = None,
    code: Annotated[str | None, typer.Option(help="anisogran, lammps or mercury; default: told by the name of the file.")] = None,
    density: Annotated[float | None, typer.Option(help="Of the grains in kg/m3, where the file has no masses.")] = None,
    every: Annotated[int, typer.Option(help="Take one frame of so many.", min=1)] = 1,
    least_contacts: Annotated[
        int | None, typer.Option(help="A grain with fewer is a rattler; default: 2 with friction, else 3 or 4.")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="HDF5 file for the fields.")] = None,
    json_file: Annotated[Path | None, typer.Option("--json", help="JSON file for the fields.")] = None,
    force: Annotated[bool, typer.Option(help="Replace a file that is there.")] = False,
):
    """Fields of a run: stress, fabric, velocity and more on the box, rings, a grid or points, with errors if there are several frames."""
    from anisogran.averaging import average as average_of
    from anisogran.files import save_results, snapshot_stream, write_json

    check_new_file("--out", out, force)
    check_new_file("--json", json_file, force)
    stream = snapshot_stream(grains, contacts, code, density, every)
    names = None if fields is None else [name.strip() for name in fields.split(",")]
    places = None if points is None else read_points(points)
    data = average_of(stream, on, names, width, points=places, kernel=kernel, least_contacts=least_contacts)
    if out is not None:
        save_results(out, {"average": data}, {"source": str(grains)})
    if json_file is not None:
        write_json(json_file, {"source": str(grains), **plain_dataset(data)})
    for name, variable in data.data_vars.items():
        if not name.endswith("_error"):
            print(in_one_line(name, variable, data.get(f"{name}_error")))


def read_points(path):
    """The points (P, d) of a text file, a line each. Raises InputError naming the file."""
    import numpy as np

    try:
        return np.loadtxt(path, ndmin=2)
    except (OSError, ValueError) as error:
        raise InputError(f"--points {path}: {' '.join(str(error).split())}") from None


def plain_dataset(data):
    """A Dataset as nested plain values: each variable and coordinate with its dims, unit and values; and the attributes."""
    parts = {}
    for kind, variables in (("fields", data.data_vars), ("coords", data.coords)):
        parts[kind] = {
            name: {"dims": list(variable.dims), "units": variable.attrs.get("units", "1"), "values": variable.values.tolist()}
            for name, variable in variables.items()
        }
    attributes = {name: value.tolist() if hasattr(value, "tolist") else value for name, value in data.attrs.items()}
    return {"attributes": attributes, **parts}


def in_one_line(name, variable, error=None):
    """A field's name, its value with its error where that is known, or its range, and its unit."""
    values = variable.values.ravel()
    if set(variable.dims) <= set("ijk"):  # one cell only
        errors = [None] * len(values) if error is None else error.values.ravel()
        told = [f"{value:.5g}" + (f" +- {e:.2g}" if e is not None and e == e else "") for value, e in zip(values, errors, strict=True)]
        text = ", ".join(told)
    else:
        known = values[values == values]
        text = f"{known.min():.4g} .. {known.max():.4g}" if known.size else "not known"
        text += f"  over {' x '.join(f'{size} {dim}' for dim, size in variable.sizes.items())}"
    unit = variable.attrs.get("units", "1")
    return f"{name:24} {text}{'' if unit == '1' else ' ' + unit}"
