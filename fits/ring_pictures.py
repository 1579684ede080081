"""Force chains, kinetic energy, rotations and stress crosses in the ring: `python fits/ring_pictures.py STUDY.h5 FIGURE.png [SWEEP]`.

Slides "2D shear cell - force chains", "2D shear cell - energy", "Stress tensor". The file is made by data_generation/ring_paper.py or
ring_lecture.py (SWEEP "lecture" is the lecture's cell at constant volume, "smooth" one with smooth rings; default: the first). The stress
is averaged over two mean diameters, on a grid of three.
"""

import sys

import numpy as np

import anisogran as ag
from anisogran import plots
from anisogran.files import read_snapshot

APART, WIDTH = 3.0, "2.0d"  # of the crosses, in mean diameters; of the average


def main(file, figure, sweep=None):
    """Save the picture of the last snapshot of the first case of a sweep (default the first one); return the Snapshot."""
    study = ag.open(file)
    kept = study[f"{sweep or next(iter(study.children))}/snapshots"]
    snapshot = read_snapshot(next(iter(kept.children.values()))["end"])
    d = 2 * float(snapshot.radius[snapshot.free].mean())
    reach = np.hypot(*snapshot.position[snapshot.free].T)
    side = np.arange(-reach.max(), reach.max(), APART * d)
    points = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    inside = (np.hypot(*points.T) > reach.min()) & (np.hypot(*points.T) < reach.max())
    stress = ag.average(snapshot, on="points", points=points[inside], width=WIDTH, fields=["stress"]).stress.values
    plots.ring_pictures(snapshot, points[inside], stress).savefig(figure, dpi=150)
    return snapshot


if __name__ == "__main__":
    main(*sys.argv[1:]) if len(sys.argv) in (3, 4) else sys.exit(__doc__)
