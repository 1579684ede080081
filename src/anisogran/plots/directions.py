"""Where contacts point and what they bear, from `averaging.contact_directions`."""

import numpy as np
from matplotlib.figure import Figure

from anisogran.glossary import label
from anisogran.plots.style import COLOURS, GRAIN, SERIES, WALL


def direction_figure(directions, title=""):
    """Of `contact_directions`: the contact normals as a polar histogram with its error bars and harmonics, and beside it the forces."""
    fig = Figure(figsize=(8.4, 3.8), layout="constrained")
    polar, forces = fig.add_subplot(1, 2, 1, projection="polar"), fig.add_subplot(1, 2, 2)
    if directions.contacts == 0:
        polar.set(title=title or "no contacts", yticks=[])
        return fig
    angle, density = directions.angle.values, directions.contact_density
    circle = np.linspace(0, 2 * np.pi, 361)

    def second(axis, turn=np.cos):
        return turn(2 * (circle - float(directions[axis])))

    polar.bar(angle, density, 2 * np.pi / len(angle), color=GRAIN, edgecolor="white", lw=0.4, label="contacts")
    polar.errorbar(angle, density, directions.contact_density_error, fmt="none", ecolor=WALL, elinewidth=0.8)
    wave = float(directions.a2) * second("axis") + float(directions.a4) * np.cos(4 * (circle - float(directions["axis"])))
    text = ", ".join(f"{label(name)} = {float(directions[name]):.2f}" for name in ("a2", "a4"))
    polar.plot(circle, (1 + wave) / (2 * np.pi), color=COLOURS["fit"], lw=1.6, label=text)
    polar.set(title=title, yticks=[], ylim=(0, None))
    polar.legend(fontsize=8, frameon=False, loc="upper center", bbox_to_anchor=(0.5, -0.1), ncols=2)
    # the harmonics are those of f0 = <f_n>/(1 + a2 a_n cos 2(axes)/2), the mean over directions instead of contacts
    a_n, a_t = float(directions.a_n), float(directions.a_t)
    tilt = 2 * (float(directions["axis"]) - float(directions.normal_axis))
    level = 1 / (1 + 0.5 * float(directions.a2) * a_n * np.cos(tilt))
    for name, wave, text, colour in (
        ("normal_force", 1 + a_n * second("normal_axis"), "a_n", COLOURS["dem"]),
        ("tangential_force", -a_t * second("tangential_axis", np.sin), "a_t", SERIES[1]),
    ):
        text = f"{label(name)}, {label(text)} = {float(directions[text]):.2f}"
        forces.plot(np.degrees(angle), directions[name], "o", ms=3, color=colour)
        forces.plot(np.degrees(circle), level * wave, lw=1.6, color=colour, label=text)
    forces.axhline(0, color="0.7", lw=0.8)
    forces.set(xlabel=r"angle $\theta$ of the contact normal [degrees]", xlim=(0, 360), xticks=range(0, 361, 90))
    forces.legend(fontsize=8, frameon=False, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
    return fig
