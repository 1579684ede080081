"""`anisogran element`: one point of a law along a path."""

import itertools
from pathlib import Path
from typing import Annotated

import typer

from anisogran.cli.application import RUN_FAILED, app, complain
from anisogran.cli.folders import output_folder
from anisogran.outcome import InputError

ROWS = 11  # of the printed table


@app.command()
def element(
    file: Annotated[Path | None, typer.Argument(help="TOML file of law, parameters and path; see --template.")] = None,
    template: Annotated[str | None, typer.Option(help="Print a commented file: scalar, tensorial, mohr_coulomb or mu_of_I.")] = None,
    steps: Annotated[int | None, typer.Option(help="Steps from one turning point to the next, instead of the file's.")] = None,
    integrator: Annotated[str | None, typer.Option(help="midpoint, rk45 or explicit, instead of the file's.")] = None,
    out: Annotated[Path | None, typer.Option(help="Folder for element.h5 and element.png.")] = None,
    json_file: Annotated[Path | None, typer.Option("--json", help="JSON file for the curves.")] = None,
    force: Annotated[bool, typer.Option(help="Use a folder that is not empty.")] = False,
):
    """Drives one point of a law along a path, each component controlled by strain or stress; ends with 3 if the path cannot be followed.

    A failure leaves a small file that repeats it, element-failure.toml, in the folder of --out or here.
    """
    from anisogran.files.element_file import element_template, read_element

    if (template is None) == (file is None):
        raise InputError("element: give one of a file and --template LAW")
    if template is not None:
        print(element_template(template), end="")
        return
    if json_file is not None:
        from anisogran.files.numbers import check_writable

        check_writable(json_file, "--json ")
    arguments = read_element(file)
    arguments |= {key: value for key, value in (("steps", steps), ("integrator", integrator)) if value is not None}
    from anisogran.models import element_test

    try:
        test = element_test(**arguments)
    except InputError as error:
        raise InputError(f"{file}: {error}") from None
    folder = None if out is None else output_folder(out, "element", force)
    print(element_table(test))
    if json_file is not None:
        from anisogran.files import write_json

        write_json(json_file, {"source": str(file), **plain_element(test)})
    if folder is not None:
        from anisogran.files import save_results
        from anisogran.plots import element_figure

        save_results(folder / "element.h5", {"element": test.dataset()}, {"source": str(file)})
        element_figure(test).savefig(folder / "element.png", dpi=150)
        print(f"\n{folder / 'element.h5'}, {folder / 'element.png'}")
    if not test.status:
        repeats = failure_file(folder)
        from anisogran.files import write_text

        write_text(repeats, test.reproduction)
        raise typer.Exit(complain(f"{'; '.join(test.status.reasons)}; {repeats} repeats the step", RUN_FAILED))
    if test.status.level == "warned":
        print(f"\n{test.status}")


def failure_file(folder):
    """The first free name of element-failure.toml, element-failure-2.toml, ... in the folder, or in the current one."""
    for k in itertools.count(1):
        path = (folder or Path()) / ("element-failure.toml" if k == 1 else f"element-failure-{k}.toml")
        if not path.exists():
            return path


def element_table(test):
    """Some rows of the curves as aligned text."""
    from anisogran.models import LAWS

    data = test.dataset()
    idle = {"rotation", "work", "s_D" if test.strain[0, 1].any() else "stress_ratio"}
    if LAWS[test.law].STRESS_IS_STATE:
        idle.add("time")  # the law knows no rate
    names = [name for name in data.data_vars if name not in idle and data[name].values.any()]
    index = sorted({round(k * (data.sizes["step"] - 1) / (ROWS - 1)) for k in range(ROWS)})
    lines = [" ".join(f"{name:>13}" for name in names)]
    lines += [" ".join(f"{float(data[name][k]):13.6g}" for name in names) for k in index]
    return "\n".join(lines)


def plain_element(test):
    """The curves and how they ended, as plain values."""
    data = test.dataset()
    return {
        "law": test.law,
        "parameters": test.parameters,
        "status": {"level": test.status.level, "reasons": list(test.status.reasons)},
        "curves": {name: {"units": data[name].attrs["units"], "values": data[name].values.tolist()} for name in data.data_vars},
    }
