"""The hysteretic contact law on a slide of S. Luding's lecture, and the one that grows stiffer: `python fits/contact_law.py [FIGURE.png]`.

Prints where un- and reloading cross zero force and meet the adhesive limit; no data needed.
"""

import sys
from itertools import pairwise

import numpy as np

import anisogran as ag
from anisogran import plots

K1, K2 = 5e4, 1e5  # N/m; the slide gives their ratio 1/2
ADHESION = 0.0, 0.5, 1.0, 2.0, 4.0  # kc/k2 of the slides
DEEPEST = 1e-5  # m, a hundredth of a radius
DEPTH, SIZE = 0.005, 1e-3  # plastic depth, and 2 a1 a2/(a1 + a2) in m: the stiffness has grown to k2 at an overlap of 1e-5 m
SHARES = 0.25, 0.5, 0.75, 1.0, 1.25  # largest overlaps, as shares of this one


def cycle(*turns, steps=400):
    """Overlaps that go straight from one turn to the next."""
    return np.concatenate([turns[:1], *(np.linspace(a, b, steps + 1)[1:] for a, b in pairwise(turns))])


def row(name, path):
    """A line of the table: overlaps in micrometres, force in N, stiffness in N/m."""
    marks = [1e6 * path.delta_max, 1e6 * path.delta_0, 1e6 * path.delta_min, path.f_min, path.force.min(), path.stiffness]
    return f"{name:>14} {marks[0]:10.3f} {marks[1]:10.3f} {marks[2]:10.3f} {marks[3]:10.4f} {marks[4]:10.4f} {marks[5]:11.0f}"


def main(figure=None):
    """Print the tables, save the figure if a file is named; return {kc/k2: path} and {share: path of the growing stiffness}."""
    laws = {ratio: ag.Luding(K1, K2, ratio * K2) for ratio in ADHESION}
    adhesive = {ratio: ag.contact_path(law, cycle(0.0, DEEPEST, -0.1 * DEEPEST)) for ratio, law in laws.items()}
    law = ag.Luding(K1, K2, K2, plastic_depth=DEPTH)
    growing = {share: ag.contact_path(law, cycle(0.0, share * DEEPEST, -0.1 * DEEPEST), size=SIZE) for share in SHARES}
    print("               delta_max    delta_0  delta_min      f_min   smallest   stiffness")
    print("                    [um]       [um]       [um]        [N]  force [N]       [N/m]")
    for ratio, path in adhesive.items():
        print(row(f"kc/k2 = {ratio:g}", path))
    print(f"with a plastic depth of {DEPTH:g} and kc/k2 = 1, for largest overlaps as shares of the one at which k2 is reached")
    for share, path in growing.items():
        print(row(f"share = {share:g}", path))
    if figure is not None:
        whole = ag.contact_path(laws[1.0], DEEPEST * cycle(0.0, 1.0, 0.6, 0.8, 0.12, 0.4, 0.0, -0.1))
        families = {
            r"adhesion, $k_1/k_2 = 1/2$": {f"$k_c/k_2$ = {ratio:g}": path for ratio, path in adhesive.items()},
            "stiffness grows with the damage": {
                rf"$\delta_\mathrm{{max}}$ = {share:g} $\delta_p$": path for share, path in growing.items()
            },
        }
        plots.contact_law_figure(whole, families).savefig(figure, dpi=150)
    return adhesive, growing


if __name__ == "__main__":
    main(*sys.argv[1:2])
