"""Force chains, kinetic energy and rotations in the biaxial box: `python fits/biaxial_pictures.py results.h5 FIGURE.png`.

Slides "Simulation results (closer look)" and "Bi-axial box (stress chains, kinetic energy, rotations)". The file is that of a run:
`anisogran run data_generation/biaxial.toml --out box` leaves box/results.h5.
"""

import sys

import anisogran as ag
from anisogran import plots
from anisogran.files import read_snapshot

STRAINS = "0.000", "0.011", "0.042", "0.091"  # of the slides, as far as the run has gone


def main(file, figure):
    """Save the picture; return the titles of its columns."""
    kept = ag.open(file, holds="snapshots/start")["snapshots"]
    names = {"0.000": "start"} | {strain: f"eps_zz-{strain}" for strain in STRAINS[1:]}
    shown = {strain: read_snapshot(kept[name]) for strain, name in names.items() if name in kept.children}
    titles = [rf"$\varepsilon_{{zz}}$ = {100 * float(strain):.1f} %" for strain in shown]
    plots.biaxial_pictures(list(shown.values()), titles).savefig(figure, dpi=150)
    return titles


if __name__ == "__main__":
    main(*sys.argv[1:]) if len(sys.argv) == 3 else sys.exit(__doc__)
