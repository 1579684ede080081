"""A ring flow of the continuum: velocity, stress, stress ratio and inertial number over the radius."""

import numpy as np

from anisogran.glossary import label
from anisogran.plots.style import SERIES, figure


def flow_figure(flow):
    """A Figure of four panels for a `Flow`; one that is no solution, as NotConverged hands it over, says so in its title."""
    fig, ((velocity, tail), (stress, ratio)) = figure(2, 2)
    speed = flow.problem.speed
    velocity.plot(flow.r, flow.v_phi, color=SERIES[0])
    velocity.set(ylabel=label("v_phi"))
    moving = np.abs(flow.v_phi) > 0.0
    tail.plot(flow.r[moving], np.abs(flow.v_phi[moving]) / speed, color=SERIES[0], label=r"$|v_\phi|$ / speed of the ring")
    tail.plot(flow.r, flow.inertial_number, color=SERIES[1], label=label("inertial_number"))
    top = np.max(flow.inertial_number, initial=1.0, where=np.isfinite(flow.inertial_number))
    tail.set(yscale="log", ylim=(1e-9 * top, 2.0 * top), ylabel="speed, inertial number")
    for colour, (name, values) in zip(
        SERIES,
        (
            (r"$\sigma_{rr}$", flow.stress[0, 0]), (r"$\sigma_{\phi\phi}$", flow.stress[1, 1]),
            (r"$\sigma_{r\phi}$", flow.stress[0, 1]), ("$p$", flow.pressure),
        ), strict=False,
    ):  # fmt: skip
        stress.plot(flow.r, values, color=colour, label=name, ls="--" if values is flow.pressure else "-")
    stress.set(ylabel="stress [N/m]")
    ratio.plot(flow.r, np.abs(flow.stress[0, 1]) / flow.pressure, color=SERIES[0], label=r"$|\sigma_{r\phi}|/p$")
    with np.errstate(invalid="ignore"):
        ratio.plot(flow.r, flow.problem.law.friction(flow.inertial_number), color=SERIES[4], ls="--", label=r"$\mu(I)$ of the law")
    ratio.set(ylabel=label("stress_ratio"))
    for axes in (velocity, tail, stress, ratio):
        axes.set(xlabel=label("r"))
        axes.grid(alpha=0.25)
    for axes in (tail, stress, ratio):
        axes.legend(fontsize=8, frameon=False)
    if not flow.status:
        fig.suptitle("NOT CONVERGED: the last iterate, no solution", color=SERIES[4], fontsize=11)
    return fig
