"""Macroscopic cohesion from peak stresses on a slide of S. Luding's lecture: `python fits/lecture_cohesion.py [FIGURE.png]`.

Slide "Cohesion - no friction"; no simulation needed.
"""

import sys

import numpy as np

import anisogran as ag
from anisogran import plots
from anisogran.models import macro_cohesion, mohr_coulomb_line

K1, K2 = 5e4, 1e5  # N/m; the slide gives their ratio 1/2; k2 = 1e5 N/m turns its c0 = 1.8e-3 k2 into 180 N/m
PRESSURES = 100.0, 500.0  # N/m
PEAKS = {0.0: (183, 798), 0.5: (234, 853), 1.0: (264, 915), 2.0: (310, 941), 4.0: (336, 972)}  # kc/k2: sigma_zz at both
COHESION = {0.0: 11, 0.5: 32, 1.0: 40, 2.0: 60, 4.0: 71}  # N/m, as printed on the slide


def main(figure=None):
    """Print the table, save stress circles and lines if a file is named; return {kc/k2: (phi in degrees, c)} and c0, both in N/m."""
    lines = {ratio: mohr_coulomb_line(PRESSURES, peaks) for ratio, peaks in PEAKS.items()}
    print("kc/k2   phi [deg]   c [N/m]   c on the slide (phi about 13 deg)")
    for ratio, (phi, c) in lines.items():
        print(f"{ratio:5.1f}   {np.degrees(phi):9.1f}   {c:7.1f}   {COHESION[ratio]:8d}")
    sticky = [ratio for ratio in COHESION if ratio > 0.0]  # at kc = 0 the formula gives c = 0 for any c0: no information on c0
    factor = np.array([macro_cohesion(1.0, K1, K2, ratio * K2) for ratio in sticky])
    slide = np.array([COHESION[ratio] for ratio in sticky])
    c0 = float(factor @ slide / (factor @ factor))
    error = float(np.sqrt(np.sum((slide - c0 * factor) ** 2) / (len(sticky) - 1) / (factor @ factor)))
    print(f"c = c0 (1 - k1/k2)/(1 + k2/kc), least squares through the origin, c of the slide: c0 = {c0:.0f} N/m (slide: 180)")
    print(f"  +- {error:.0f} N/m, one standard error from {len(sticky)} points with {len(sticky) - 1} degrees of freedom")
    print(f"Note: the formula gives c = 0 at kc = 0, where the table has {COHESION[0.0]} N/m; it cannot describe this point. There is no")
    print("attraction; that the tangent has an intercept is put down to the yield line, which is not straight for soft grains.")
    together = all_at_once()
    print(f"All ten stresses in one fit:\n{together.table}\n{together}")
    if figure is not None:
        circles = {f"$k_c/k_2$ = {ratio:g}": (PRESSURES, peaks) for ratio, peaks in PEAKS.items()}
        plots.mohr_circles_figure(circles).savefig(figure, dpi=150)
    return {ratio: (float(np.degrees(phi)), c) for ratio, (phi, c) in lines.items()}, c0


def all_at_once():
    """The fit of phi and c0, shared by all adhesions, to the ten peak stresses."""
    return ag.fit.cohesion(PRESSURES * len(PEAKS), np.repeat(list(PEAKS), 2) * K2, np.ravel(list(PEAKS.values())), K1, K2)


if __name__ == "__main__":
    main(*sys.argv[1:2])
