"""`anisogran run`: one scene, in a folder of its own."""

import contextlib
from pathlib import Path
from typing import Annotated

import typer

from anisogran.cli.application import RUN_FAILED, app, complain
from anisogran.cli.folders import output_folder
from anisogran.outcome import InputError


@app.command()
def run(
    scene_file: Annotated[Path | None, typer.Argument(metavar="SCENE", help="Scene file (TOML); see `anisogran new`.")] = None,
    out: Annotated[Path | None, typer.Option(help="Folder for the run; default: a new numbered one.")] = None,
    resume: Annotated[bool, typer.Option(help="Go on with the run in --out; SCENE may then be left out.")] = False,
    changes: Annotated[list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Another value, as contact.kc=1e5.")] = None,
    quick: Annotated[bool, typer.Option(help="The small size that the file gives in [quick].")] = False,
    json_file: Annotated[Path | None, typer.Option("--json", help="JSON file for the last row of the series and how it went.")] = None,
    force: Annotated[bool, typer.Option(help="Begin anew in a folder that is not empty.")] = False,
):
    """Runs a scene; leaves results.h5 and all that is needed to go on with it in a folder. Ctrl-C saves; --resume goes on bit for bit."""
    from anisogran.cli.run_display import opening, shown_run, summary
    from anisogran.experiments import read_scene
    from anisogran.files import check_writable, write_json
    from anisogran.runs import check_memory

    if resume and out is None:
        raise InputError("run: --resume needs the folder of the run, --out FOLDER")
    if resume and force:
        raise InputError("run: --resume goes on and --force begins anew; give one of them")
    if scene_file is None and not resume:
        raise InputError("run: SCENE is missing; `anisogran new biaxial > scene.toml` writes one")
    if json_file is not None:
        check_writable(json_file, "--json ")
    if resume and not out.is_dir():
        raise InputError(f"--out {out}: there is no such folder to resume")
    scene = read_scene(scene_file or out / "scene.toml", changes or (), quick)
    check_memory(scene)
    folder = out if resume else output_folder(out, scene.kind, force)
    try:
        opening(scene, folder)
        result = shown_run(scene, folder, resume, force)
    except BaseException:
        with contextlib.suppress(OSError):
            folder.rmdir()  # nothing was found: leave no empty folder behind; a folder that holds anything stays
        raise
    if json_file is not None:
        write_json(json_file, summary(result, folder))
    if not result.status:
        raise typer.Exit(complain("; ".join(result.status.reasons), RUN_FAILED))
