"""Macroscopic friction angle from contact friction, beside the lecture: `python fits/friction_angle.py [biaxial_friction.h5 [FIGURE.png]]`.

Slides "Friction - no cohesion" and "Micro-macro for friction": internal is the slope of the line that touches the circles of all pressures,
which may have an intercept c; total is the line through the origin that touches one circle, asin((sigma_zz - p)/(sigma_zz + p)). The slide
does not say so; this is the reading under which its two numbers go together. The file is made by data_generation/biaxial_friction.py; that
of the full run is in fits/data/. Errors are standard errors over seeds.
"""

import sys
from pathlib import Path

import numpy as np

import anisogran as ag
from anisogran import plots

DATA = Path(__file__).parent / "data" / "biaxial_friction.h5"
INTERNAL, TOTAL = {0.0: 13, 0.5: 27}, {0.5: 31}  # degrees by mu, as on the slides
WITHIN = 4.0  # degrees


def total_angle(p, sigma_zz):
    """In degrees."""
    return np.degrees(np.arcsin((sigma_zz - p) / (sigma_zz + p)))


def beside(value, error, slide):
    """A cell of a table: the angle, its error, the slide's number, and whether it lies outside the tolerance."""
    told = "" if slide is None else f" ({slide}{'' if abs(value - slide) <= WITHIN else ' NOT'})"
    return f"{value:5.1f} +- {error:4.1f}{told:10}"


def main(file=DATA, figure=None):
    """Print the tables, save the picture if a file is named; return {mu: FitResult of phi and c}."""
    data = ag.open(file, holds="p100/series")
    tests = {int(name[1:]): data[f"{name}/series"].to_dataset() for name in data.children if "-" not in name}
    peaks = {p: ag.fit.peak(series.eps_zz, series.sigma_zz).value for p, series in tests.items()}  # (mu, seed)
    friction = next(iter(tests.values())).friction_mu.values
    print(f"friction angles in degrees; in brackets the lecture, NOT: more than {WITHIN:g} degrees off")
    print("   mu   internal          c [N/m]         " + "".join(f"total, p = {p:<13}" for p in tests))
    lines = {}
    for k, mu in enumerate(friction):
        pressure = np.repeat(list(peaks), [values.shape[1] for values in peaks.values()])
        line = lines[float(mu)] = ag.fit.mohr_coulomb(pressure, np.concatenate([values[k] for values in peaks.values()]))
        phi, error = np.degrees(line.values["phi"]), np.degrees(line.errors["phi"])
        totals = [total_angle(p, values[k]) for p, values in peaks.items()]
        cells = "".join(beside(*ag.fit.mean_and_error(angle), TOTAL.get(mu)) for angle in totals)
        print(f"{mu:5.2f}  {beside(phi, error, INTERNAL.get(mu))}{line.values['c']:6.1f} +- {line.errors['c']:4.1f}   {cells}")
    drags(data)
    if figure is not None:
        draw(figure, lines, peaks, friction)
    return lines


def drags(data):
    """Print what a background damping while loading does to the peaks without friction, if the file has that study."""
    found = {}
    for name in data.children:
        if name.endswith("-drag"):
            series = data[f"{name}/series"].to_dataset()
            peaks = ag.fit.peak(series.eps_zz, series.sigma_zz).value
            found[int(name[1:].removesuffix("-drag"))] = dict(zip(series.drag.values, peaks, strict=True))
    if not found:
        return
    print("peak of sigma_zz [N/m] without friction, by the background damping of every grain while loading (lecture: 183 and 798)")
    for drag in next(iter(found.values())):
        cells = ["p = {}: {:6.1f} +- {:4.1f}".format(p, *ag.fit.mean_and_error(peaks[drag])) for p, peaks in found.items()]
        line = ag.fit.mohr_coulomb(*np.array([(p, value) for p, peaks in found.items() for value in peaks[drag]]).T)
        print(
            f"  {drag:5.3f} kg/s   {'   '.join(cells)}   phi = {np.degrees(line.values['phi']):.1f} degrees, c = {line.values['c']:.0f} N/m"
        )


def draw(figure, lines, peaks, friction):
    """Angles against contact friction."""
    angles = [np.degrees([(line.values["phi"], line.errors["phi"]) for line in lines.values()]).T]
    points = {"internal": (friction, *angles[0])}
    for p, values in peaks.items():
        total = total_angle(p, values)
        points[f"total, p = {p} N/m"] = friction, *ag.fit.mean_and_error(total)
    slide = {
        "lecture, internal": (list(INTERNAL), list(INTERNAL.values()), None),
        "lecture, total": (list(TOTAL), list(TOTAL.values()), None),
    }
    panel = plots.Panel(r"contact friction $\mu$", r"friction angle [degrees]", {}, points | slide)
    plots.panels_figure([panel], width=5.5, height=4.0).savefig(figure, dpi=150)


if __name__ == "__main__":
    main(*sys.argv[1:3])
