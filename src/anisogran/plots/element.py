"""An element test: stresses, stress ratio, change of volume and what the law remembers, along the path."""

import numpy as np

from anisogran.glossary import label
from anisogran.plots.style import SERIES, figure


def element_figure(test):
    """A Figure of four panels for an `ElementTest`, over the strain that moves most: eps_zz, or the amount of simple shear."""
    sheared = np.ptp(test.strain[0, 1]) > np.ptp(test.eps_zz)
    x = -2.0 * test.strain[0, 1] if sheared else test.eps_zz
    name = label("strain") if sheared else label("eps_zz")
    fig, ((stress, ratio), (volume, inner)) = figure(2, 2)
    for colour, (key, values) in zip(SERIES, (("xx", test.sigma_xx), ("zz", test.sigma_zz), ("xz", test.stress[0, 1])), strict=False):
        if key != "xz" or np.any(values):
            stress.plot(x, values, color=colour, label=label(f"sigma_{key}"))
    known = test.sigma_V > 0.0  # a law without stress at rest has no ratio there
    if sheared:
        ratio.plot(x[known], test.stress_ratio[known], color=SERIES[0], label=r"$\sigma_D/\sigma_V$")
    else:
        ratio.plot(x[known], test.s_D[known], color=SERIES[0], label=label("s_D"))
    volume.plot(x, test.eps_V, color=SERIES[0], label=label("eps_V") + " (half of the trace)")
    for colour, (key, values) in zip(SERIES, test.internal.items(), strict=False):
        inner.plot(x, values, color=colour, label=label(key))
    for axes, text in ((stress, "stress [N/m]"), (ratio, "stress ratio"), (volume, label("eps_V")), (inner, "internal variables")):
        axes.set(xlabel=name, ylabel=text)
        axes.legend(fontsize=8, frameon=False)
        axes.grid(alpha=0.25)
    if not test.status:
        fig.suptitle("stopped before the end of the path", color=SERIES[-1], fontsize=10)
    return fig
