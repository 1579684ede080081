"""The stiffness of an anisotropic material along every direction, as a polar curve."""

import numpy as np
from matplotlib.figure import Figure

from anisogran.models import directional_stiffness
from anisogran.plots.style import SERIES


def stiffness_figure(states, title=""):
    """Polar picture of the stiffness n n : C : n n along every direction n, over the largest, a curve for each of `states`.

    `states` {label: dict(E=, A=, B=, phi_C=, G=)}, the arguments of `directional_stiffness`, all of one unit; {"isotropic": ...,
    "sheared": ...} is the picture of the lecture: stiffer against the shear (C_2, along the compression), softer across (C_1). The
    axes of the last state are drawn, unless it is isotropic. Raises InputError as `directional_stiffness`.
    """
    fig = Figure(figsize=(5.2, 4.6), layout="constrained")
    axes = fig.add_subplot(projection="polar")
    circle = np.linspace(0.0, 2.0 * np.pi, 361)
    curves = {name: directional_stiffness(circle, **state) for name, state in states.items()}
    largest = max(float(curve.max()) for curve in curves.values())
    for k, (name, curve) in enumerate(curves.items()):
        axes.plot(circle, curve / largest, color=SERIES[-1 - k % len(SERIES)] if k else "0.55", lw=1.8, ls="-" if k else "--", label=name)
    last = next(reversed(states.values()))
    if last["A"] != 0.0:
        draw_axes(axes, last, largest)
    axes.set(title=title or "stiffness along each direction, over the largest", ylim=(0.0, 1.2), yticks=[0.5, 1.0])
    axes.set_rlabel_position(np.degrees(last.get("phi_C", 0.0)) + 45.0)  # between the axes
    axes.legend(fontsize=8, frameon=False, loc="upper center", bbox_to_anchor=(0.5, -0.08), ncols=2)
    return fig


def draw_axes(axes, state, largest):
    """The stiff axis, C_2, and the soft one across, C_1, as long as the stiffness along them."""
    stiff = state.get("phi_C", 0.0) + (0.0 if state["A"] > 0.0 else 0.5 * np.pi)
    for angle, name in ((stiff, "$C_2$"), (stiff + 0.5 * np.pi, "$C_1$")):
        length = float(directional_stiffness(angle, **state)) / largest
        axes.plot([angle, angle + np.pi], [length, length], color="0.3", lw=1.0)
        axes.annotate(name, (angle, length), textcoords="offset points", xytext=(8 * np.cos(angle) + 3, 8 * np.sin(angle) + 3))
