"""What hangs together: the clusters of grains that contacts connect."""

import numpy as np
import xarray as xr
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from anisogran.glossary import CONVENTIONS, attributes
from anisogran.outcome import checked


def fragments(snapshot, least_force=0.0):
    """Clusters of the free grains of a Snapshot, connected by the contacts that bear a force, as a Dataset over `grain` and `fragment`.

    A contact connects if its force, of either sign, is above `least_force` in N: with 0 any that bears something. Walls, and grains that
    belong to a wall, connect nothing and are in no fragment. A cluster that reaches around a periodic cell is one.
    fragment_of (grain): number of its fragment, -1 for a grain of a wall; fragment 0 has the largest mass. fragment_grains and
    fragment_mass (kg) of each fragment, down to single grains. fragments: their number. largest_fragment: mass of the largest over that
    of all free grains; mean_fragment_mass (kg): over the fragments. The last two are NaN without free grains.
    Raises InputError for a least_force that is negative or no number.
    """
    least_force = checked("fragments", "least_force", least_force, at_least=0, unit="N")
    free, n = snapshot.free, len(snapshot.radius)
    first, second = snapshot.pairs.T
    connects = (second >= 0) & (np.linalg.norm(snapshot.force, axis=1) > least_force)
    connects[connects] = free[first[connects]] & free[second[connects]]
    bonds = csr_array((np.ones(connects.sum(), bool), (first[connects], second[connects])), shape=(n, n))
    count, cluster = connected_components(bonds, directed=False)
    grains = np.bincount(cluster[free], minlength=count)
    mass = np.bincount(cluster[free], snapshot.mass[free], count)
    order = np.argsort(-mass, kind="stable")[: np.count_nonzero(grains)]  # those without a free grain, of no mass, come last
    number = np.full(count, -1)
    number[order] = np.arange(len(order))
    mass = mass[order]
    values = {
        "fragment_of": ("grain", number[cluster]),
        "fragment_grains": ("fragment", grains[order]),
        "fragment_mass": ("fragment", mass),
        "fragments": ((), len(order)),
        "largest_fragment": ((), mass[0] / mass.sum() if len(order) else np.nan),
        "mean_fragment_mass": ((), mass.mean() if len(order) else np.nan),
    }
    variables = {name: (*value, attributes(name)) for name, value in values.items()}
    return xr.Dataset(variables, attrs={"conventions": CONVENTIONS, "least_force": least_force})
