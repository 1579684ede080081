"""`anisogran solve`: a continuum problem, in a folder of its own."""

from pathlib import Path
from typing import Annotated

import typer

from anisogran.cli.application import app
from anisogran.cli.folders import output_folder
from anisogran.outcome import InputError

ROWS = 11  # of the printed table
COLUMNS = ("v_phi", "shear_rate", "inertial_number", "pressure", "shear_stress", "fluidity")


@app.command()
def solve(
    file: Annotated[Path | None, typer.Argument(help="TOML file of the problem; see --template.")] = None,
    template: Annotated[bool, typer.Option("--template", help="Print a commented file with all keys and laws.")] = False,
    changes: Annotated[list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Another value, as law.b=0.9.")] = None,
    out: Annotated[Path | None, typer.Option(help="Folder for the results; default: a new numbered one.")] = None,
    json_file: Annotated[Path | None, typer.Option("--json", help="JSON file for the numbers and profiles.")] = None,
    force: Annotated[bool, typer.Option(help="Use a folder that is not empty.")] = False,
):
    """Solves a steady ring flow of the continuum; leaves flow.toml, results.h5, profile.csv and flow.png in a folder.

    Ends with 4 if there is no solution or none is found: what it then leaves is the last iterate, and marked as such.
    """
    from anisogran.files import check_writable
    from anisogran.outcome import NotConverged
    from anisogran.scenes.flow_file import flow_template, read_flow

    if template == (file is not None):
        raise InputError("solve: give one of a file and --template")
    if template:
        print(flow_template(), end="")
        return
    if json_file is not None:
        check_writable(json_file, "--json ")
    problem = read_flow(file, changes or ())
    problem.elements_along()  # refused before there is a folder
    folder = output_folder(out, problem.kind, force)
    try:
        flow = problem.solve()
    except NotConverged as error:
        leave(error.best, folder, json_file)
        raise NotConverged(f"{error}; {folder} holds the last iterate, which is no solution", error.history, error.best) from None
    leave(flow, folder, json_file)
    print(flow_table(flow))
    print(f"\nstress ratio at the inner ring {flow.stress_ratio_wall:.6g}, torque {flow.torques.inner:.6g}, {flow.seconds:.2g} s")
    if flow.status.level == "warned":
        print(flow.status)
    print(folder)


def leave(flow, folder, json_file):
    """Writes all that belongs to a flow into the folder."""
    from anisogran.continuum import flow_dataset
    from anisogran.files import save_results, write_json, write_text
    from anisogran.plots import flow_figure
    from anisogran.scenes.writing import scene_text

    problem = scene_text(flow.problem)
    write_text(folder / "flow.toml", problem)
    save_results(folder / "results.h5", {"flow": flow_dataset(flow)}, {"problem": problem})
    write_text(folder / "profile.csv", csv_text(flow))
    flow_figure(flow).savefig(folder / "flow.png", dpi=150)
    if json_file is not None:
        write_json(json_file, plain_flow(flow))


def columns(flow):
    """{name: values} of the profiles that are there."""
    values = {name: flow.stress[0, 1] if name == "shear_stress" else getattr(flow, name) for name in COLUMNS}
    return {"r": flow.r, **{name: column for name, column in values.items() if column is not None}}


def csv_text(flow):
    """The profiles, one row a node, under names and units; a first line marks what is no solution."""
    from anisogran.glossary import GLOSSARY

    table = columns(flow)
    head = [] if flow.status else ["# NOT CONVERGED: the last iterate, no solution"]
    names = [f"{name} [{GLOSSARY[name].unit}]" for name in table]
    return "\n".join([*head, ",".join(names), *(",".join(f"{x:.17g}" for x in row) for row in zip(*table.values(), strict=True))]) + "\n"


def flow_table(flow):
    """Some rows of the profiles as aligned text."""
    table = columns(flow)
    index = sorted({round(k * (flow.r.size - 1) / (ROWS - 1)) for k in range(ROWS)})
    lines = [" ".join(f"{name:>15}" for name in table)]
    return "\n".join(lines + [" ".join(f"{values[k]:15.6g}" for values in table.values()) for k in index])


def plain_flow(flow):
    """The numbers and profiles of a flow, and how it ended, as plain values."""
    import dataclasses

    from anisogran.continuum import flow_numbers
    from anisogran.glossary import GLOSSARY

    law = flow.problem.law
    return {
        "law": {"law": law.kind, **dataclasses.asdict(law)},
        "converged": bool(flow.status),
        "status": {"level": flow.status.level, "reasons": list(flow.status.reasons)},
        **flow_numbers(flow),
        "profiles": {name: {"units": GLOSSARY[name].unit, "values": values.tolist()} for name, values in columns(flow).items()},
    }
