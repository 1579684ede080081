"""`anisogran compare`: rings of grains beside the continuum, with parameters that were fitted elsewhere."""

from pathlib import Path
from typing import Annotated

import typer

from anisogran.cli.application import app
from anisogran.cli.folders import output_folder
from anisogran.outcome import InputError


@app.command()
def compare(
    runs: Annotated[list[Path], typer.Argument(help="Results (.h5) or folders of ring shear runs, which are predicted.")],
    calibrate: Annotated[
        list[Path] | None, typer.Option(help="Run that the nonlocal parameters are fitted on, or runs that differ in the seed.")
    ] = None,
    friction: Annotated[Path | None, typer.Option(help="Study of homogeneous shear (.h5, ring_friction_law.py), for mu_s and b.")] = None,
    mu_s: Annotated[float | None, typer.Option(help="Static friction of the law mu_s + b I, instead of --friction.")] = None,
    b: Annotated[float | None, typer.Option(help="Its slope.")] = None,
    out: Annotated[Path | None, typer.Option(help="Folder for compare.h5 and compare.png; default: a new numbered folder.")] = None,
    json_file: Annotated[Path | None, typer.Option("--json", help="JSON file for the numbers.")] = None,
    force: Annotated[bool, typer.Option(help="Use a folder that is not empty.")] = False,
):
    """Predicts ring shear runs by the local law, the nonlocal one and two base lines, with parameters from other runs only.

    mu_s and b come from homogeneous shear, the rest from the runs of --calibrate; without it the first run is fitted, and told so.
    """
    if json_file is not None:
        from anisogran.files.numbers import check_writable

        check_writable(json_file, "--json ")
    from anisogran.comparison import frozen, predictions

    law, own = friction_law(friction, mu_s, b), calibrate or runs[:1]
    measured = {path: ring_run(path) for path in dict.fromkeys([*own, *runs])}
    law["source"] += "".join(other_grains(friction, path, run.scene) for path, run in measured.items() if friction is not None)
    parameters = frozen([measured[path] for path in own], law["mu_s"], law["b"])
    tables = {str(path): predictions(parameters, measured[path]) for path in runs}
    folder = output_folder(out, "compare", force)
    print(parameters_text(law, parameters, own))
    for path, table in tables.items():
        print(f"\n{path}{' (fitted on this very run)' if Path(path) in own else ''}\n{table_text(table)}")
    from anisogran.files import save_results, write_json
    from anisogran.files.numbers import json_text
    from anisogran.plots import predictions_figure

    told = plain_parameters(law, parameters, own)
    groups = {f"run{k}": table.assign_attrs(file=path) for k, (path, table) in enumerate(tables.items(), 1)}
    save_results(folder / "compare.h5", groups, {"parameters": json_text(told)})
    predictions_figure(dict(zip(titles(tables), tables.values(), strict=True))).savefig(folder / "compare.png", dpi=150)
    if json_file is not None:
        write_json(json_file, {"parameters": told, "runs": [{"file": path, **plain_table(table)} for path, table in tables.items()]})
    print(f"\n{folder / 'compare.h5'}, {folder / 'compare.png'}")


def friction_law(path, mu_s, b):
    """{mu_s, b, and where from} of the options. Raises InputError unless it is one of --friction and --mu-s with --b."""
    if (path is None) == (mu_s is None) or (mu_s is None) != (b is None):
        raise InputError("compare: give --friction FILE, or --mu-s and --b")
    if path is None:
        return {"mu_s": mu_s, "b": b, "source": "given"}
    from anisogran.comparison import homogeneous_friction
    from anisogran.files import open as open_results

    fit = homogeneous_friction(open_results(path, holds="shear/steady")["shear/steady"].to_dataset())
    remarks = "" if fit.verdict else f"; not trustworthy: {'; '.join(fit.verdict.reasons)}"
    return {**fit.values, "mu_s_error": fit.errors["mu_s"], "b_error": fit.errors["b"], "source": f"fitted to {path}{remarks}"}


def other_grains(study, path, scene):
    """What a reader must know if the grains of a study of homogeneous shear are others than those of a run, as text."""
    from anisogran.experiments.scene_file import scene_from
    from anisogran.files import open as open_results

    results = open_results(study)
    if "shear/cases" not in {group.lstrip("/") for group in results.groups}:
        return ""
    pairs = zip(grain_numbers(scene_from(results["shear/cases"].attrs["scene"], str(study))), grain_numbers(scene), strict=True)
    words = [f"{name} = {there}, in {path} {here}" for (name, there), (_, here) in pairs if there != here]
    return f"; of other grains: {', '.join(words)}" if words else ""


def grain_numbers(scene):
    """((name, value), ...) of what makes the friction of a sample and does not depend on units."""
    return (("mu", None if scene.friction is None else scene.friction.mu), ("size_ratio", getattr(scene, "size_ratio", None)))


def ring_run(path):
    """The results of a run that a file or folder holds. Raises InputError if it has no profiles, or is a whole study."""
    from anisogran.comparison import measured
    from anisogran.files import open as open_results

    path = path / "results.h5" if path.is_dir() else path
    return measured(open_results(path), str(path))


def titles(paths):
    """A title for each: the name if these are different, else the whole path."""
    names = [Path(path).name for path in paths]
    return names if len(set(names)) == len(names) else list(paths)


def parameters_text(law, parameters, own):
    """What is given and what was fitted, before any prediction."""
    errors = parameters.errors
    top, length = parameters.exponential
    lines = [
        f"parameters, fixed before the predictions; fitted on {', '.join(map(str, own))}:",
        f"  friction law         mu_s = {law['mu_s']:.4g}, b = {law['b']:.4g} ({law['source']})",
        f"  nonlocal             A = {parameters.amplitude:.4g} +- {errors['amplitude']:.2g} d",
        f"  nonlocal with wall   A = {parameters.amplitude_with_wall:.4g} +- {errors['amplitude_with_wall']:.2g} d, "
        f"kappa = {parameters.wall:.4g} +- {errors['wall']:.2g}",
        f"  exponential          v = {top:.4g} V exp(-depth/{length:.4g} d)",
        *(f"  warning: {reason}" for reason in parameters.reasons),
    ]
    return "\n".join(lines)


def table_text(table):
    """The misfits of the rivals, the error bars of the grains and of the continuum beside them."""
    lines = [f"{'':20} L2 (x < 8 d)  of the solver  rms of ln v  tau/sigma at the inner ring"]
    plain = plain_table(table)
    for name, one in plain["rivals"].items():
        lines.append(f"{name:20} {one['l2']:12.3g} {one['l2_continuum']:14.1g} {one['log_rms']:12.3g} {one['stress_ratio_wall']:10.4g}")
    ratio = f"{float(table.stress_ratio_wall_dem):10.4g} +- {float(table.stress_ratio_wall_dem_error):.2g}"
    lines.append(f"{'grains':20} {float(table.l2_noise):12.3g} {'(error bars)':>27} {ratio}")
    return "\n".join([*lines, *(f"warning: {reason}" for reason in plain["warnings"])])


def plain_parameters(law, parameters, own):
    """The parameters as plain values."""
    names = "amplitude", "amplitude_with_wall", "wall", "exponential", "errors"
    return {
        **law,
        **{name: getattr(parameters, name) for name in names},
        "fitted_on": [str(path) for path in own],
        "warnings": list(parameters.reasons),
    }


def plain_table(table):
    """The numbers of a run as plain values."""
    figures = "l2", "l2_continuum", "log_rms", "stress_ratio_wall"
    rivals = {name: {key: float(table[key].sel(rival=name)) for key in figures} for name in table.rival.values}
    whole = {key: float(table[key]) for key in ("l2_noise", "stress_ratio_wall_dem", "stress_ratio_wall_dem_error")}
    return {"rivals": rivals, **whole, "warnings": [reason for reason in [table.attrs["reasons"]] if reason]}
