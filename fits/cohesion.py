"""Macroscopic cohesion from contact adhesion, beside the lecture: `python fits/cohesion.py [biaxial_cohesion.h5 [FIGURE.png]]`.

Slides "Cohesion - no friction" and "Micro-macro for cohesion". The file is made by data_generation/biaxial_cohesion.py; that of the full
run is in fits/data/. Errors are standard errors over seeds.
"""

import sys
from pathlib import Path

import numpy as np

import anisogran as ag
from anisogran import plots
from anisogran.models import macro_cohesion

DATA = Path(__file__).parent / "data" / "biaxial_cohesion.h5"
K1, K2 = 5e4, 1e5  # N/m
PEAKS = {
    0.0: {100: 183, 500: 798},
    0.5: {100: 234, 500: 853},
    1.0: {100: 264, 500: 915},
    2.0: {100: 310, 500: 941},
    4.0: {100: 336, 500: 972},
}
COHESION = {0.0: 11, 0.5: 32, 1.0: 40, 2.0: 60, 4.0: 71}  # N/m, as the peaks of kc/k2 on the slide, sigma_zz at both pressures
WITHIN = {
    100: 0.2,
    500: 0.13,
}  # of the slide: two runs of one protocol differ by half of that, and the lecture does not tell all of its own
C_WITHIN = 10.0  # N/m


def peaks(data, name):
    """Peaks of sigma_zz of one sweep of the file, a DataArray over what was varied."""
    series = data[f"{name}/series"].to_dataset()
    return series.sigma_zz.isel(sample=0).copy(data=ag.fit.peak(series.eps_zz, series.sigma_zz).value)


def yield_line(found):
    """The fit of phi and c to peaks {pressure: (seed,)} of one kind of sample, every seed a point."""
    pressure = np.repeat(list(found), [len(values) for values in found.values()])
    return ag.fit.mohr_coulomb(pressure, np.concatenate(list(found.values())))


def mean_and_error(values):
    """Over seeds."""
    return float(np.mean(values)), float(np.std(values, ddof=1) / np.sqrt(len(values))) if len(values) > 1 else np.nan


def beside(value, error, slide, within):
    """A cell of a table: value, error, the slide's number, and whether it lies outside the tolerance."""
    told = "" if slide is None else f" ({slide:4d}{'' if abs(value - slide) <= within else ' NOT'})"
    return f"{value:7.1f} +- {error:4.1f}{told}"


def main(file=DATA, figure=None):
    """Print the tables, save the picture if a file is named; return {kc/k2: (phi in degrees, c in N/m)} and the fit of c0."""
    data = ag.open(file)
    tests = {int(name[1:]): peaks(data, name) for name in data.children if "-" not in name}
    ratios = [float(kc) / K2 for kc in next(iter(tests.values())).contact_kc]
    by_ratio = {ratio: {p: found.sel(contact_kc=ratio * K2).values for p, found in tests.items()} for ratio in ratios}
    print("peak of sigma_zz (moving average over 0.4 % strain) and yield line; in brackets the lecture, NOT: outside the tolerance")
    print("kc/k2  " + "".join(f"p = {p:<22g}" for p in tests) + "phi [deg]        c [N/m]")
    lines = {}
    for ratio, found in by_ratio.items():
        line = yield_line(found)
        phi, c = np.degrees(line.values["phi"]), line.values["c"]
        lines[ratio] = float(phi), c
        cells = []
        for p, values in found.items():
            slide = PEAKS.get(ratio, {}).get(p)
            cells.append(beside(*mean_and_error(values), slide, WITHIN.get(p, 0) * (slide or 0)))
        cohesion = beside(c, line.errors["c"], COHESION.get(ratio), C_WITHIN)
        print(f"{ratio:5.1f}  {'  '.join(f'{cell:24}' for cell in cells)}  {phi:5.1f} +- {np.degrees(line.errors['phi']):3.1f}  {cohesion}")
    fit = all_at_once(by_ratio)
    print("all at once, c = c0 (1 - k1/k2)/(1 + k2/kc) + c_rest:")
    print(f"  phi = {np.degrees(fit.values['phi']):.1f} +- {np.degrees(fit.errors['phi']):.1f} degrees (lecture: about 13)")
    print(
        f"  c0 = {fit.values['c0'] / K2:.2e} +- {fit.errors['c0'] / K2:.0e} k2 (lecture: 1.8e-3), c_rest = {fit.values['c_rest']:.1f} N/m"
    )
    pressed = first_pressures(data)
    if figure is not None:
        draw(figure, lines, fit, pressed)
    return lines, fit


def all_at_once(by_ratio):
    """The fit of phi and c0, common to all adhesions, to all peaks."""
    rows = [(p, ratio * K2, value) for ratio, found in by_ratio.items() for p, values in found.items() for value in values]
    return ag.fit.cohesion(*np.array(rows).T, K1, K2, offset=True)


def first_pressures(data):
    """Print and return {pressure under which samples were pressed first: c} at kc = k2, if the file has that study."""
    names = [name for name in data.children if name.endswith("-pressed")]
    found = {int(name[1:].removesuffix("-pressed")): peaks(data, name) for name in names}
    if not found:
        return {}
    print("c at kc = k2 by the pressure under which the samples were pressed first (none: by that of the test)")
    result = {}
    for first in next(iter(found.values())).overconsolidation.values:
        line = yield_line({p: values.sel(overconsolidation=first).values for p, values in found.items()})
        phi, c, error = np.degrees(line.values["phi"]), line.values["c"], line.errors["c"]
        result[str(first)] = c, error
        print(f"  {first!s:>6} N/m: c = {c:5.1f} +- {error:.1f} N/m, phi = {phi:.1f} degrees")
    return result


def draw(figure, lines, fit, pressed):
    """Cohesion against kc/k2 with the lecture's, and against the pressure by which the samples were pressed."""
    ratio = np.linspace(0.0, 4.2, 200)
    law = [macro_cohesion(fit.values["c0"], K1, K2, x * K2) + fit.values["c_rest"] for x in ratio]
    slide = [macro_cohesion(1.8e-3 * K2, K1, K2, x * K2) for x in ratio]
    points = {"here": (list(lines), [c for _, c in lines.values()], None), "lecture": (list(COHESION), list(COHESION.values()), None)}
    panels = [plots.Panel(r"$k_c/k_2$", "$c$ [N/m]", {"here": (ratio, law), "lecture": (ratio, slide)}, points)]
    by = {float(first): c for first, c in pressed.items() if first != "none"}
    if by:
        x, (c, error) = list(by), np.array(list(by.values())).T
        panels.append(plots.Panel("pressed first by [N/m]", "$c$ at $k_c = k_2$ [N/m]", {}, {"here": (x, c, error)}))
    plots.panels_figure(panels).savefig(figure, dpi=150)


if __name__ == "__main__":
    main(*sys.argv[1:3])
