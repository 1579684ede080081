"""`anisogran new` and `anisogran schema`: what a scene file may say."""

from typing import Annotated

import typer

from anisogran.cli.application import app

Kind = Annotated[str | None, typer.Argument(metavar="KIND", help="Of the experiment, such as biaxial; without it the list is told.")]


@app.command()
def new(kind: Kind = None):
    """Prints a commented scene file, every key with unit, range and meaning: anisogran new biaxial > scene.toml."""
    from anisogran.experiments import experiment_of
    from anisogran.scenes import scene_template

    print(scene_template(experiment_of(kind)), end="")


@app.command()
def schema(kind: Kind = None):
    """Prints the JSON schema of scene files, for editors that complete and check them."""
    import json

    from anisogran.experiments import experiment_of
    from anisogran.scenes import scene_schema

    print(json.dumps(scene_schema(experiment_of(kind)), indent=2))
