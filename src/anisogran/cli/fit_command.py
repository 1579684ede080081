"""`anisogran fit`: a law from files, with errors and a verdict."""

from pathlib import Path
from typing import Annotated

import typer

from anisogran.cli.application import NOT_TRUSTWORTHY, OK, app
from anisogran.cli.folders import check_new_file
from anisogran.outcome import InputError

NAMES = "relaxation, mohr_coulomb, cohesion, mu_of_I, area_fraction, shear_band, exponential_decay, moduli, path_moduli or law"


@app.command()
def fit(
    kind: Annotated[str, typer.Argument(help=f"{NAMES}.")],
    files: Annotated[list[Path], typer.Argument(help="Results (.h5), or tables with a header line and `# key = value` conditions.")],
    x: Annotated[str | None, typer.Option(help="Column of the abscissa; in results as NAME or GROUP/NAME.")] = None,
    y: Annotated[str | None, typer.Option(help="Column that is fitted.")] = None,
    y_error: Annotated[str | None, typer.Option(help="Column of its errors; default: the one named Y_error, if there.")] = None,
    shared: Annotated[
        str | None,
        typer.Option(
            help="Fit the files at once: s_max=mu,beta=all (by equal conditions, a+b for two; the rest is own, for law shared by all)."
        ),
    ] = None,
    law: Annotated[str | None, typer.Option(help="For fit law: scalar, tensorial, mohr_coulomb; all files are fitted at once.")] = None,
    fixed: Annotated[str | None, typer.Option(help="For fit law: parameters that are not fitted, as beta_F=40.")] = None,
    errors: Annotated[str, typer.Option(help="covariance, profile or bootstrap: where the 95 % intervals come from.")] = "covariance",
    out: Annotated[Path | None, typer.Option(help="HDF5 file for data and curves.")] = None,
    json_file: Annotated[Path | None, typer.Option("--json", help="JSON file for values, errors and verdict.")] = None,
    figure: Annotated[Path | None, typer.Option(help="Picture of data, curve and residuals, .png, .pdf or .svg.")] = None,
    force: Annotated[bool, typer.Option(help="Replace the --out file that is there.")] = False,
):
    """Parameters of a law, with errors and a verdict; exit code 5 if a fit is not trustworthy."""
    check_files(files, out, json_file, figure, force)
    from anisogran.cli import fit_report, fit_sources
    from anisogran.cli.fit_law import numbers_of

    entry, way = fit_sources.kind_of(kind), fit_report.way_of(errors)
    sets = fit_sources.data_sets(kind, entry, files, x, y, y_error, apart=shared is not None)
    chosen = y.split(",") if y and entry.whole else None
    fitted = fit_sources.fits(kind, entry, sets, fit_sources.sharing(shared), law, numbers_of(fixed), chosen)
    done = [fit_report.Told(one, way(one.result)) for one in fitted]
    print("\n\n".join(fit_report.text(one) for one in done))
    if json_file is not None:
        from anisogran.files import write_json

        write_json(json_file, fit_report.numbers(kind, files, done))
    if out is not None or figure is not None:
        curves = [curve for one in done for curve in fit_report.curves(entry, one.fitted)]
        if out is not None:
            fit_report.save(out, kind, done, curves)
        if figure is not None:
            from anisogran.plots import fit_figure

            fit_figure(curves, entry.log).savefig(figure, dpi=150)
    raise typer.Exit(OK if all(one.fitted.result.verdict for one in done) else NOT_TRUSTWORTHY)


def check_files(files, out, json_file, figure, force):
    """Raises InputError for a file that cannot be written, before any work, and for one that is read as well."""
    from anisogran.files.numbers import check_writable

    check_new_file("--out", out, force)
    inputs = {path.resolve() for path in files}
    for option, path in (("--out", out), ("--json", json_file), ("--figure", figure)):
        if path is not None:
            check_writable(path, f"{option} ")
            if path.resolve() in inputs:
                raise InputError(f"{option} {path}: is one of the files to be fitted")
    if figure is not None and figure.suffix.lower() not in (".png", ".pdf", ".svg"):
        raise InputError(f"--figure {figure}: the name must end in .png, .pdf or .svg")
