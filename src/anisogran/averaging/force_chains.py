"""How unevenly the contacts bear the load: the statistics of the normal forces, and the chains of strongly loaded grains, in the plane."""

import numpy as np
import xarray as xr
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from anisogran import tensors
from anisogran.averaging.directions import at_walls, axis_of, complex_vectors, planar
from anisogran.averaging.grain_sums import contact_ends, stress_moment
from anisogran.glossary import CONVENTIONS, attributes
from anisogran.outcome import InputError, checked

ROUNDING = 1e-9  # a value must be above a mean by this share of it, or all would be above it that are equal


def force_network(snapshot, bins=40):
    """Statistics of the normal contact forces of a 2D snapshot, as a Dataset over `relative_force` f/<f>.

    f is the normal force, compression positive; <f> its mean over all contacts, each once, those with a wall or a wall grain among them.
    force_density: probability density of f/<f>, with its Poisson error (contacts taken as independent), NaN in an empty bin; `bins` is
    their number, from 0 (from the smallest force if there is tension) to the largest force, or their edges, in units of <f>.
    strong_share: share of the contacts with f above <f>, the strong network; strong_pressure_share and strong_deviator_share: what they
    bear of the trace, and of the deviator along its own axis, of the contact stress; the rest is the weak network's, so the share of the
    deviator may exceed 1 (Radjai, Wolf, Jean & Moreau 1998, PRL 80, 61: the strong network bears it all; from memory).
    participation: (sum f)^2/(c sum f^2), 1 if all forces are equal and 1/c if one contact of c bears all (Makse, Johnson & Schwartz
    2000, PRL 84, 4160, from memory). largest_force: in units of <f>.
    Where <f> is not above 0, also without contacts, all but the number and the mean is NaN, with the reason in the attributes; so is the
    share of a deviator, or of a trace, that vanishes. Raises InputError in three dimensions and for bins that are none.
    """
    ends = contact_ends(planar(snapshot, "force_network"))
    force = -np.einsum("ed,ed->e", ends.force, ends.normal)
    once = np.where(at_walls(snapshot, ends), 1.0, 0.5)  # the other half of a contact is its other end
    contacts = once.sum()
    mean = once @ force / contacts if contacts else np.nan
    loaded = mean > 0
    relative = force / mean if loaded else np.zeros(0)
    edges = bin_edges(bins, relative)
    count = np.histogram(relative, edges, weights=once if loaded else None)[0].astype(float)
    width = np.diff(edges)
    density = count / (contacts * width) if loaded else np.full(len(count), np.nan)
    error = np.divide(density, np.sqrt(count), out=np.full(len(count), np.nan), where=count > 0)
    strong = force > (1 + ROUNDING) * mean
    pressure_share, deviator_share = stress_shares(ends, strong) if loaded else (np.nan, np.nan)
    scalars = {
        "contacts": contacts,
        "mean_normal_force": mean,
        "largest_force": relative.max() if loaded else np.nan,
        "strong_share": once @ strong / contacts if loaded else np.nan,
        "strong_pressure_share": pressure_share,
        "strong_deviator_share": deviator_share,
        "participation": contacts / (once @ relative**2) if loaded else np.nan,
    }
    variables = {name: ((), value, attributes(name)) for name, value in scalars.items()}
    for name, value in (("force_density", density), ("force_density_error", error)):
        variables[name] = ("relative_force", value, attributes(name))
    centre = ("relative_force", 0.5 * (edges[1:] + edges[:-1]), attributes("relative_force"))
    reason = {} if loaded else {"reason": f"the mean normal force is {mean:g} N" if contacts else "no contacts"}
    return xr.Dataset(variables, {"relative_force": centre}, {"conventions": CONVENTIONS, "edges": edges, **reason})


def bin_edges(bins, relative):
    """Edges of the bins of f/<f>, given or from 0 or the smallest to the largest; from 0 to 1 without forces."""
    if np.ndim(bins) == 0:
        count = checked("force_network", "bins", bins, at_least=1)
        if count != int(count):
            raise InputError(f"force_network: bins = {bins!r} must be a whole number, or edges")
        low, high = (min(0.0, relative.min()), relative.max()) if relative.size else (0.0, 1.0)
        return np.linspace(low, high, int(count) + 1)
    edges = np.asarray(bins, dtype=float)
    if edges.ndim != 1 or edges.size < 2 or not np.isfinite(edges).all() or not (np.diff(edges) > 0).all():
        raise InputError("force_network: bins must be a number of bins, or two or more ascending edges")
    return edges


def stress_shares(ends, strong):
    """Share of the trace and of the deviator of the contact stress that the ends marked `strong` (E,) bear; NaN of what vanishes."""
    whole, part = (-np.einsum("ei,ej->ij", ends.force[mask], ends.arm[mask]) for mask in (slice(None), strong))
    direction = tensors.direction(tensors.principal_angle(whole))
    trace, deviator = tensors.trace(whole), np.sum(direction * whole)
    scale = np.abs(ends.force * ends.arm).sum()
    return tuple(
        float(some / all_) if abs(all_) > ROUNDING * scale else np.nan
        for some, all_ in ((tensors.trace(part), trace), (np.sum(direction * part), deviator))
    )


def grain_chains(snapshot, angle=np.pi / 4, least_grains=3):
    """Force chains of a 2D snapshot, as a Dataset over `grain`, `chain` and `link`.

    A grain is strong if its major principal stress (of the symmetric part of -sum f l/V^p, compression positive) exceeds the mean over
    all free grains, rattlers included. Two strong grains that touch are linked if the contact lies within `angle` (rad, up to pi/2) of
    the major principal direction of both; a grain without such a direction, its stress being isotropic, links to none. A chain is a
    set of `least_grains` or more grains held together by links, so chains may branch (Peters, Muthuswamy, Wibowo & Tordesillas 2005,
    PRE 72, 041307, from memory).
    chain_of (grain): number of its chain, -1 for none; chain 0 has most grains. major_stress (grain), N/m, 0 for a wall grain.
    links (link, end): the grains that each link joins. chain_grains, chain_length (sum of its branch lengths in mean diameters of the
    free grains) and chain_axis (mean direction of its links, in (-pi/2, pi/2], weighed by length) of each chain.
    chain_share: share of the free grains that are in chains. mean_axis: as chain_axis, of all links; alignment: |<exp(2 i theta)>| of
    them, 1 if all are parallel, both NaN without chains. chain_share is NaN without free grains.
    Raises InputError in three dimensions and for an angle or a number out of bounds.
    """
    ends = contact_ends(planar(snapshot, "grain_chains"))
    cosine = np.cos(checked("grain_chains", "angle", angle, above=0, at_most=np.pi / 2, unit="rad"))
    least_grains = checked("grain_chains", "least_grains", least_grains, at_least=2)
    free, n = snapshot.free, len(snapshot.radius)
    major, direction, strong = grain_loads(snapshot, ends)
    linked = linked_ends(snapshot, ends, direction, strong, cosine)
    chain_of, sizes = chains_by_size(ends.grain[linked], ends.partner[linked], n, least_grains)
    linked &= chain_of[ends.grain] >= 0
    grain, partner, arm = ends.grain[linked], ends.partner[linked], complex_vectors(ends.arm[linked])
    # each end adds its own half of the branch
    length = np.abs(arm)
    doubled = arm**2 / length
    chain, chains = chain_of[grain], len(sizes)
    total_length, real, imaginary = (np.bincount(chain, part, chains) for part in (length, doubled.real, doubled.imag))
    diameter = 2 * snapshot.radius[free].mean() if chains else np.nan
    values = {
        "chain_of": ("grain", chain_of),
        "major_stress": ("grain", major),
        "links": (("link", "end"), np.stack([grain, partner], axis=1)[grain < partner]),
        "chain_grains": ("chain", sizes),
        "chain_length": ("chain", total_length / diameter),
        "chain_axis": ("chain", 0.5 * np.arctan2(imaginary, real)),
        "chain_share": ((), sizes.sum() / free.sum() if free.any() else np.nan),
        "mean_axis": ((), axis_of(doubled.sum() / length.sum()) if chains else np.nan),
        "alignment": ((), np.abs(doubled.sum()) / length.sum() if chains else np.nan),
    }
    variables = {name: (*value, attributes(name)) for name, value in values.items()}
    return xr.Dataset(variables, attrs={"conventions": CONVENTIONS, "angle": float(angle)})


def grain_loads(snapshot, ends):
    """Major principal stress of each grain (N,), N/m, its direction as a unit complex number, and (N,) bool: the strong grains.

    Strong is a free grain with a stress above the mean that is not isotropic, or it would have no direction.
    """
    stress = np.moveaxis(stress_moment(ends, len(snapshot.radius)), 0, -1) / (np.pi * snapshot.radius**2)
    size = tensors.deviator_size(stress)
    major = tensors.mean(stress) + size
    free = snapshot.free
    mean = major[free].mean() if free.any() else np.inf
    strong = (major > mean + ROUNDING * np.abs(mean)) & (size > ROUNDING * np.abs(major))  # a wall grain bears nothing
    return major, np.exp(1j * tensors.principal_angle(stress)), strong


def linked_ends(snapshot, ends, direction, strong, cosine):
    """(E,) bool: ends of contacts that link two strong grains, both seeing the contact close to their direction."""
    along = np.abs((complex_vectors(ends.normal) * direction[ends.grain].conj()).real)
    # the rounding lets a contact just on the limit pass
    passes = ~at_walls(snapshot, ends) & strong[ends.grain] & (along >= cosine - ROUNDING)
    grain, partner, n = ends.grain[passes], ends.partner[passes], len(snapshot.radius)
    passes[passes] = np.isin(partner * n + grain, grain * n + partner)  # the other end passes too
    return passes


def chains_by_size(grain, partner, grains, least):
    """Number of the chain of each grain (grains,), -1 for none, and the grains of each chain, from the largest down to `least`."""
    graph = csr_array((np.ones(len(grain), bool), (grain, partner)), shape=(grains, grains))
    _, group = connected_components(graph, directed=False)
    sizes = np.bincount(group)
    order = np.argsort(-sizes, kind="stable")
    order = order[sizes[order] >= least]
    number = np.full(len(sizes), -1)
    number[order] = np.arange(len(order))
    return number[group], sizes[order]
