"""How stress ratio and anisotropy approach their largest values: `python fits/evolution.py [FOLDER [FIGURE.png]]`.

Slides "An-isotropy (Stress)" and "An-isotropy (Structure)": s_D = s_max (1 - exp(-beta_s eps_D)), A likewise with A_max and beta_F, as
functions of pressure, friction and density. The folder (fits/data/ if none is named) holds what data_generation/ makes,
biaxial_friction.h5, biaxial_pressure.h5, biaxial_density.h5 and simple_shear.h5, of which those are read that are there. eps_D is
half/half (with eps_zz - eps_xx whole, all betas are half as large); A stands for the anisotropy a_2 of the contacts that bear force. Every
seed is fitted by itself, up to its peak; means and standard errors are those of the fits that are trustworthy, of which the last column
tells how many there are.
"""

import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np

import anisogran as ag
from anisogran import plots

DATA = Path(__file__).parent / "data"
FILES = "biaxial_friction", "biaxial_pressure", "biaxial_density", "simple_shear"
LARGEST = 0.06  # eps_D: later, samples may have localised


class Case(NamedTuple):
    """Curves of one kind of sample over seeds: conditions, eps_D, s_D and anisotropy (seed, n), area fraction at the start."""

    conditions: dict
    eps_D: np.ndarray
    s_D: np.ndarray
    anisotropy: np.ndarray
    density: float


def cases(folder):
    """{file: [Case]} of the files in the folder. Raises InputError if none is there."""
    found = {}
    for name in FILES:
        path = Path(folder) / f"{name}.h5"
        if path.exists():
            data = ag.open(path)
            groups = [group for group in data.children if "-" not in group]
            found[name] = [case for group in groups for case in cases_of(group, data[f"{group}/series"].to_dataset())]
    if not found:
        raise ag.InputError(f"{folder}: none of {', '.join(f'{name}.h5' for name in FILES)} is there")
    return found


def cases_of(group, series):
    """The Cases of one sweep: all that was varied but the seed."""
    eps_D = 0.5 * series.strain if "strain" in series else 0.5 * (series.eps_zz - series.eps_xx)  # simple shear: half the shear strain
    series = series.assign(eps_D=eps_D)
    varied = [dim for dim in series.dims if dim not in ("seed", "sample")]
    stacked = series.stack(case=varied) if varied else series.expand_dims("case")
    for k in range(stacked.sizes["case"]):
        one = stacked.isel(case=k).transpose("seed", "sample")
        conditions = {"p": float(group[1:])} if group[1:].isdigit() else {}
        conditions |= {dim.removeprefix("friction_"): float(one[dim]) for dim in varied}
        yield Case(conditions, *(one[name].values for name in ("eps_D", "s_D", "anisotropy")), float(one.area_fraction[:, 0].mean()))


def fitted(case):
    """{"s_D": (s_max, beta), "anisotropy": (A_max, beta)} of the trustworthy fits (2, n), one for each seed at most."""
    values = {}
    for name in ("s_D", "anisotropy"):
        fits = []
        for eps, row in zip(case.eps_D, getattr(case, name), strict=True):
            used = (eps >= 0.0) & (eps <= LARGEST)  # the side wall may settle by a hair before the sample is loaded
            fits.append(ag.fit.relaxation(eps[used], row[used]))
        values[name] = np.array([(fit.values["s_max"], fit.values["beta"]) for fit in fits if fit.verdict]).reshape(-1, 2).T
    return values


def cell(values, digits):
    """Mean and standard error."""
    if not values.size:
        return f"{'-':^19}"
    mean, error = ag.fit.mean_and_error(values)
    return f"{mean:8.{digits}f} +- {error:<7.{digits}f}"


def main(folder=DATA, figure=None):
    """Print the table, save the picture if a file is named; return [(file, Case, values of `fitted`)]."""
    result = []
    for name, found in cases(folder).items():
        print(f"{name}\n{'':42}  density       s_max            beta_s              A_max             beta_F         seeds")
        for case in found:
            values = fitted(case)
            result.append((name, case, values))
            stress, structure = values.values()
            told = ", ".join(f"{key} = {value:g}" for key, value in case.conditions.items())
            row = " ".join([cell(stress[0], 3), cell(stress[1], 0), cell(structure[0], 3), cell(structure[1], 0)])
            print(f"  {told:40}  {case.density:7.4f} {row} {stress.shape[1]}, {structure.shape[1]} of {len(case.eps_D)}")
    if figure is not None:
        draw(figure, result)
    return result


def draw(figure, result):
    """Curves with their laws at p = 100, and the parameters against pressure and friction."""
    curves, dashed = {}, {}
    for name, case, values in result:
        if name == "biaxial_friction" and case.conditions["p"] == 100:
            grid = np.linspace(0.0, 1.3 * LARGEST, 300)
            label = f"$\\mu$ = {case.conditions['mu']:g}"
            curves[label] = grid, np.mean([np.interp(grid, *pair) for pair in zip(case.eps_D, case.s_D, strict=True)], axis=0)
            if values["s_D"].size:
                s_max, beta = values["s_D"].mean(axis=1)
                dashed[label] = grid, s_max * (1 - np.exp(-beta * grid))
    strain = r"$\varepsilon_D$ (half/half)"
    panels = [plots.Panel(strain, "$s_D$, mean over seeds", curves, dashed=dashed, title="p = 100 N/m; dashed: the law")] if curves else []
    dense = [(case.conditions, values) for name, case, values in result if name in FILES[:2]]
    by_pressure = sorted(((c["p"], values) for c, values in dense if c.get("mu", 0.5) == 0.5), key=lambda point: point[0])
    by_friction = [(c["mu"], values) for c, values in dense if c.get("mu") is not None and c["p"] == 100]
    for points, axis, log in ((by_pressure, "p [N/m]", "xy"), (by_friction, r"contact friction $\mu$", "")):
        if not points:
            continue
        rates = {r"$\beta_s$": row(points, "s_D", 1), r"$\beta_F$": row(points, "anisotropy", 1)}
        largest = {r"$s_\mathrm{max}$": row(points, "s_D", 0), r"$A_\mathrm{max}$": row(points, "anisotropy", 0)}
        panels += [plots.Panel(axis, "rate", {}, rates, log=log)] if log else []
        panels += [plots.Panel(axis, "largest value", {}, largest, log=log.replace("y", ""))]
    plots.panels_figure(panels, columns=2).savefig(figure, dpi=150)


def row(points, name, which):
    """(x, mean, standard error) of s_max or beta over the points where there is one."""
    known = [(x, *ag.fit.mean_and_error(values[name][which])) for x, values in points if values[name].size]
    return tuple(np.reshape(known, (-1, 3)).T)


if __name__ == "__main__":
    main(*sys.argv[1:3])
