"""Macroscopic cohesion from contact adhesion, beside the lecture: `python fits/cohesion.py [biaxial_cohesion.h5 [FIGURE.png]]`.

Slides "Cohesion - no friction" and "Micro-macro for cohesion". The file is made by data_generation/biaxial_cohesion.py; that of the full
run is in fits/data/. Errors are standard errors over seeds, each with its own line.
"""

import sys
import tomllib
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


def yield_lines(found):
    """phi in degrees and c of the line of each seed, shape (2, seed), of the peaks {pressure: (seed,)} of one kind of sample."""
    lines = [ag.models.mohr_coulomb_line(list(found), peaks) for peaks in zip(*found.values(), strict=True)]
    return np.array([(np.degrees(line.phi), line.c) for line in lines]).T


def beside(value, error, slide, within):
    """A cell of a table: value, error, the slide's number, and whether it lies outside the tolerance."""
    told = "" if slide is None else f" ({slide:4d}{'' if abs(value - slide) <= within else ' NOT'})"
    return f"{value:7.1f} +- {error:4.1f}{told}"


def main(file=DATA, figure=None):
    """Print the tables, save the picture if a file is named; return {kc/k2: (phi in degrees, c), each with its error} and c0."""
    data = ag.open(file, holds="p100/series")
    tests = {int(name[1:]): peaks(data, name) for name in data.children if "-" not in name}
    ratios = [float(kc) / K2 for kc in next(iter(tests.values())).contact_kc]
    by_ratio = {ratio: {p: found.sel(contact_kc=ratio * K2).values for p, found in tests.items()} for ratio in ratios}
    print("peak of sigma_zz (moving average over 0.4 % strain) and yield line; in brackets the lecture, NOT: outside the tolerance")
    print("kc/k2  " + "".join(f"p = {p:<22g}" for p in tests) + "phi [deg]        c [N/m]")
    lines = {}
    for ratio, found in by_ratio.items():
        phi, c = lines[ratio] = [ag.fit.mean_and_error(row) for row in yield_lines(found)]
        cells = []
        for p, values in found.items():
            slide = PEAKS.get(ratio, {}).get(p)
            cells.append(beside(*ag.fit.mean_and_error(values), slide, WITHIN.get(p, 0) * (slide or 0)))
        cohesion = beside(*c, COHESION.get(ratio), C_WITHIN)
        print(f"{ratio:5.1f}  {'  '.join(f'{cell:24}' for cell in cells)}  {phi[0]:5.1f} +- {phi[1]:3.1f}  {cohesion}")
    c0, error = through_the_origin(lines)
    print(f"c = c0 (1 - k1/k2)/(1 + k2/kc), kc > 0: c0 = {c0 / K2:.2e} +- {error / K2:.0e} k2 (lecture: 1.8e-3)")
    fit = all_at_once(by_ratio)
    print(f"the same with one phi for all peaks: phi = {np.degrees(fit.values['phi']):.1f} degrees, c0 = {fit.values['c0'] / K2:.2e} k2,")
    print(
        f"  c at kc = 0: {fit.values['c_rest']:.1f} N/m; {'trustworthy' if fit.verdict else 'not trustworthy: ' + fit.verdict.reasons[0]}"
    )
    pressed = first_pressures(data)
    if pressed:
        scene = tomllib.loads(data["p100/cases"].attrs["scene"])
        pressed[str(scene["overconsolidation"])] = lines[1.0][1]
    if figure is not None:
        draw(figure, lines, c0, pressed)
    return lines, c0


def through_the_origin(lines):
    """c0 by least squares from the cohesions with kc > 0, and its standard error: the formula says nothing about kc = 0."""
    sticky = [ratio for ratio in lines if ratio > 0.0]
    factor = np.array([macro_cohesion(1.0, K1, K2, ratio * K2) for ratio in sticky])
    c = np.array([lines[ratio][1][0] for ratio in sticky])
    c0 = float(factor @ c / (factor @ factor))
    free = len(sticky) - 1
    return c0, float(np.sqrt(np.sum((c - c0 * factor) ** 2) / free / (factor @ factor))) if free else np.nan


def all_at_once(by_ratio):
    """The fit of phi, c0 and a cohesion at kc = 0, common to all adhesions, to all peaks."""
    rows = [(p, ratio * K2, value) for ratio, found in by_ratio.items() for p, values in found.items() for value in values]
    return ag.fit.cohesion(*np.array(rows).T, K1, K2, offset=True)


def first_pressures(data):
    """Print and return {pressure under which samples were pressed first: (c, error)} at kc = k2, if the file has that study."""
    names = [name for name in data.children if name.endswith("-pressed")]
    found = {int(name[1:].removesuffix("-pressed")): peaks(data, name) for name in names}
    if not found:
        return {}
    print("c at kc = k2 by the pressure under which the samples were pressed first (none: by that of the test)")
    result = {}
    for first in next(iter(found.values())).overconsolidation.values:
        phi, c = yield_lines({p: values.sel(overconsolidation=first).values for p, values in found.items()})
        result[str(first)] = ag.fit.mean_and_error(c)
        told = "c = {:5.1f} +- {:.1f} N/m, phi = {:.1f} +- {:.1f} degrees".format(*ag.fit.mean_and_error(c), *ag.fit.mean_and_error(phi))
        print(f"  {first!s:>6} N/m: {told}")
    return result


def draw(figure, lines, c0, pressed):
    """Cohesion against kc/k2 with the lecture's, and against the pressure by which the samples were pressed."""
    ratio = np.linspace(0.0, 4.2, 200)
    laws = {name: (ratio, [macro_cohesion(one, K1, K2, x * K2) for x in ratio]) for name, one in (("here", c0), ("lecture", 1.8e-3 * K2))}
    points = {
        "here": (list(lines), *np.array([c for _, c in lines.values()]).T),
        "lecture": (list(COHESION), list(COHESION.values()), None),
    }
    panels = [plots.Panel(r"$k_c/k_2$", "$c$ [N/m]", laws, points)]
    by = dict(sorted((float(first), c) for first, c in pressed.items() if first != "none"))
    if by:
        x, (c, error) = list(by), np.array(list(by.values())).T
        panels.append(plots.Panel("pressed first by [N/m]", "$c$ at $k_c = k_2$ [N/m]", {}, {"here": (x, c, error)}))
    plots.panels_figure(panels).savefig(figure, dpi=150)


if __name__ == "__main__":
    main(*sys.argv[1:3])
