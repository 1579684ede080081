"""Where contacts point and what they bear there: the distribution of the contact normals and the forces by direction, in the plane.

Directions are unit complex numbers z = exp(i theta), so that z^2 and z^4 carry the second and fourth harmonic, and the polar frame is a
division by the e_r of the grain. Everything is a sum over contact ends, so that snapshots add up.
"""

from typing import NamedTuple

import numpy as np
import xarray as xr

from anisogran.averaging.grain_sums import contact_ends
from anisogran.averaging.sample import contact_lines
from anisogran.glossary import CONVENTIONS, attributes
from anisogran.outcome import InputError
from anisogran.snapshot import Snapshot

ROUNDING = 1e-12  # a harmonic below it, relative to the largest possible one, is none


def fourier_coefficients(theta, weight=None, angle=None):
    """(a2, a4, angle) of f(theta) = (1 + a2 cos 2(theta - angle) + a4 cos 4(theta - angle))/(2 pi): a_n = 2 <cos n(theta - angle)>.

    theta (n,) in radians, weight (n,) not negative, default 1. `angle` is the major axis of the second harmonic, in (-pi/2, pi/2],
    unless given; 0 where there is no second harmonic. NaN (the angle too, unless given) for no directions, or none with a weight.
    Raises InputError for directions or weights that are no such numbers.
    """
    theta = np.asarray(theta, dtype=float)
    weight = np.ones(theta.shape) if weight is None else np.asarray(weight, dtype=float)
    if theta.ndim != 1 or weight.shape != theta.shape:
        raise InputError(f"fourier_coefficients: theta and weight have the shapes {theta.shape}, {weight.shape}; both must be (n,)")
    if not (np.isfinite(theta).all() and np.isfinite(weight).all() and (weight >= 0).all()):
        raise InputError("fourier_coefficients: theta must be finite, and weight finite and at least 0")
    return coefficients(harmonics(np.exp(1j * theta), weight), angle)


def harmonics(z, weight):
    """Sums of w, w z^2 and w z^4 over the directions z, shape (3,), complex."""
    square = z * z
    return np.array([weight.sum(), (weight * square).sum(), (weight * square * square).sum()], dtype=complex)


def coefficients(sums, angle=None):
    """(a2, a4, angle) of the sums of `harmonics`; see fourier_coefficients."""
    if sums[0] == 0:
        return np.nan, np.nan, np.nan if angle is None else float(angle)
    second, fourth = sums[1:] / sums[0].real
    angle = axis_of(second) if angle is None else float(angle)
    a2, a4 = (2 * float((mean * np.exp(-1j * n * angle)).real) for n, mean in ((2, second), (4, fourth)))
    return a2, a4, angle


def axis_of(second):
    """The angle, in (-pi/2, pi/2], of a second harmonic (complex); 0 where it is none."""
    return 0.5 * float(np.angle(second)) if abs(second) > ROUNDING else 0.0


class AngularSums(NamedTuple):
    """Sums over contact ends, by direction and over all."""

    ends: np.ndarray  # (bins,) number
    normal: np.ndarray  # (bins,) normal force
    tangential: np.ndarray  # (bins,) tangential force
    contacts: float  # each contact once
    harmonics: np.ndarray  # (3,) of 1, z^2, z^4
    normal_harmonics: np.ndarray  # (3,) the same times the normal force
    tangential_harmonics: np.ndarray  # (3,) the same times the tangential force

    def __add__(self, other):
        return AngularSums(*(mine + theirs for mine, theirs in zip(self, other, strict=True)))


def contact_directions(snapshots, bins=36, where=None, frame="lab", walls=True):
    """Distribution of the contact normals of a 2D Snapshot, or of several taken together, as a Dataset over `angle` (rad).

    Bin k of `bins` (at least 4) covers [k, k + 1) 2 pi/bins, all of them [0, 2 pi); a direction on an edge falls to either side by
    rounding. Each contact counts at both its grains, with opposite normals, one with a wall or a wall grain once; with walls=False not
    at all. `where` selects the grains whose contacts are counted: (N,) bool, or a function of the snapshot that returns it. With
    frame="polar" the angles are counted from e_r of each grain, away from the origin.

    contact_density f(theta): its integral over 2 pi is 1. Its error is Poisson's, f/sqrt(ends in the bin), NaN in an empty bin: it takes
    contacts as independent (opposite bins hold the same ones), and so snapshots as further apart than contacts live.
    normal_force, tangential_force: mean in the bin over the mean normal force; of the force that the grain exerts, compression and the
    turn counter-clockwise from the normal positive; NaN in an empty bin, or if the mean normal force is not above 0.
    a2, a4, axis: fourier_coefficients of the normals, every end alike; a2_error from the spread over independent contacts. An isotropic
    network of c contacts has a2 of about sqrt(pi/c) by chance. a_n, a_t, with the axes normal_axis, tangential_axis: least-squares
    f_n = f0 (1 + a_n cos 2(theta - axis)), f_t = -f0 a_t sin 2(theta - axis); NaN if the directions are too few to tell (fewer than
    three) or f0 is not above 0. Then s_D is about (a2 + a_n + a_t)/2 where the axes agree (Rothenburg & Bathurst 1989, Geotechnique 39,
    601, from memory).
    Without contacts all but the numbers (0) is NaN. Raises InputError in three dimensions and for options that are none.
    """
    if isinstance(bins, bool) or not isinstance(bins, int | np.integer) or bins < 4:
        raise InputError(f"contact_directions: bins = {bins!r} must be a whole number, at least 4")
    if frame not in ("lab", "polar"):
        raise InputError(f"contact_directions: frame = {frame!r} must be 'lab' or 'polar'")
    sums = None
    for snapshot in (snapshots,) if isinstance(snapshots, Snapshot) else snapshots:
        part = angular_sums(snapshot, bins, where, frame, walls)
        sums = part if sums is None else sums + part
    if sums is None:
        raise InputError("contact_directions: there is no snapshot")
    return angular_dataset(sums, frame)


class ContactNetwork(NamedTuple):
    """The directions and the size of a contact network, as the affine moduli need them."""

    a2: float  # second Fourier coefficient of the contact directions, along the axis of the fabric
    a4: float  # fourth Fourier coefficient
    scale: float  # (1/V) sum over contacts of the squared branch length, each contact once


def contact_network(snapshot, angle=None):
    """The ContactNetwork of a whole 2D sample; `angle` of the axis in radians, default the major axis of the branches.

    Contacts count with their squared branch length, as in the stiffness; a wall contact has the branch from the grain's centre to the
    wall. The coefficients are NaN without contacts. Raises InputError in three dimensions.
    """
    branch = contact_lines(snapshot, contact_ends(planar(snapshot, "contact_network"))).branch
    square = np.einsum("cd,cd->c", branch, branch)
    a2, a4, _ = fourier_coefficients(np.arctan2(branch[:, 1], branch[:, 0]), square, angle)
    return ContactNetwork(a2, a4, float(square.sum() / snapshot.volume))


def planar(snapshot, name):
    """The snapshot; raises InputError, by the name of the function asked, if it is three-dimensional."""
    if snapshot.position.shape[1] != 2:
        raise InputError(f"{name}: the snapshot is three-dimensional; the directions of contacts are taken in two dimensions only")
    return snapshot


def at_walls(snapshot, ends):
    """(E,) bool: the partner is a wall, or a grain of one."""
    return (ends.partner < 0) | snapshot.fixed[np.where(ends.partner < 0, 0, ends.partner)]


def complex_vectors(vectors):
    """Vectors (n, 2) as complex numbers (n,)."""
    return vectors[:, 0] + 1j * vectors[:, 1]


def chosen_grains(snapshot, where):
    """(N,) bool of the grains that `where` selects."""
    n = len(snapshot.radius)
    mask = np.asarray(np.ones(n, bool) if where is None else where(snapshot) if callable(where) else where)
    if mask.shape != (n,) or mask.dtype != bool:
        raise InputError(f"contact_directions: where has shape {mask.shape} of {mask.dtype}; it must be ({n},) of bool")
    return mask


def angular_sums(snapshot, bins, where, frame, walls):
    """The AngularSums of one snapshot."""
    ends = contact_ends(planar(snapshot, "contact_directions"))
    chosen, wall = chosen_grains(snapshot, where), at_walls(snapshot, ends)
    kept = chosen[ends.grain] if walls else chosen[ends.grain] & ~wall
    grain, z = ends.grain[kept], complex_vectors(ends.normal[kept])
    # of the force that the grain exerts, the part along the normal and that along the normal turned by a right angle
    force = -complex_vectors(ends.force[kept]) * z.conj()
    twice = ~wall[kept] & chosen[np.where(wall[kept], 0, ends.partner[kept])]
    if frame == "polar":
        outward = complex_vectors(snapshot.position[grain])
        lost = np.flatnonzero(outward == 0)
        if lost.size:
            raise InputError(f"contact_directions: grain {grain[lost[0]]} lies in the origin, where frame = 'polar' has no direction")
        z = z * outward.conj() / np.abs(outward)
    # a rounding below zero is brought to 2 pi itself, which is the first bin again
    index = np.floor(np.mod(np.angle(z), 2 * np.pi) * (bins / (2 * np.pi))).astype(int) % bins
    binned = (np.bincount(index, weights, bins) for weights in (np.ones(len(z)), force.real, force.imag))
    total = (harmonics(z, weights) for weights in (np.ones(len(z)), force.real, force.imag))
    return AngularSums(*binned, np.where(twice, 0.5, 1.0).sum(), *total)


def force_anisotropies(sums):
    """(a_n, axis, a_t, axis) of the least-squares harmonics of the forces; NaN if they are not to be told."""
    count = sums.harmonics[0].real
    nothing = (np.nan,) * 4
    if count == 0:
        return nothing
    second, fourth = sums.harmonics[1:] / count
    normal, tangential = sums.normal_harmonics / count, sums.tangential_harmonics / count
    # normal equations of 1, cos 2 theta, sin 2 theta; their products are harmonics again
    c, s = second.real, second.imag
    cc, cs, ss = 0.5 * (1 + fourth.real), 0.5 * fourth.imag, 0.5 * (1 - fourth.real)
    matrix = np.array([[1, c, s], [c, cc, cs], [s, cs, ss]])
    if np.linalg.eigvalsh(matrix)[0] < ROUNDING:
        return nothing
    f0, *along = np.linalg.solve(matrix, [normal[0].real, normal[1].real, normal[1].imag])
    if not f0 > 0:
        return nothing
    across = np.linalg.solve(matrix[1:, 1:], [tangential[1].real, tangential[1].imag])
    a_n, a_t = complex(*along) / f0, 1j * complex(*across) / f0
    return abs(a_n), axis_of(a_n), abs(a_t), axis_of(a_t)


def angular_dataset(sums, frame):
    """The Dataset of contact_directions."""
    bins, ends = len(sums.ends), sums.ends.sum()
    width = 2 * np.pi / bins
    full = sums.ends > 0
    unknown = np.full(bins, np.nan)
    mean_force = sums.normal.sum() / ends if ends else np.nan
    a2, a4, axis = coefficients(sums.harmonics)
    a_n, normal_axis, a_t, tangential_axis = force_anisotropies(sums)
    density = sums.ends / (ends * width) if ends else unknown

    def mean_in_bin(force):
        return np.divide(force, sums.ends * mean_force, out=unknown.copy(), where=full) if mean_force > 0 else unknown

    # the variance of 2 cos 2(theta - axis); when all contacts are aligned it vanishes, up to a rounding on either side
    variance = 2 + a4 - a2**2 if abs(2 + a4 - a2**2) > ROUNDING else 0.0
    over_angle = {
        "contact_density": density,
        "contact_density_error": np.divide(density, np.sqrt(sums.ends), out=unknown.copy(), where=full),
        "normal_force": mean_in_bin(sums.normal),
        "tangential_force": mean_in_bin(sums.tangential),
    }
    scalars = {
        "a2": a2, "a2_error": np.sqrt(variance / sums.contacts) if sums.contacts else np.nan, "a4": a4, "axis": axis,
        "a_n": a_n, "normal_axis": normal_axis, "a_t": a_t, "tangential_axis": tangential_axis,
        "mean_normal_force": mean_force, "contacts": sums.contacts, "contact_ends": ends,
    }  # fmt: skip
    variables = {name: ("angle", value, attributes(name)) for name, value in over_angle.items()}
    variables |= {name: ((), value, attributes(name)) for name, value in scalars.items()}
    angle = ("angle", (np.arange(bins) + 0.5) * width, attributes("angle"))
    frames = {"lab": "angles from the first axis", "polar": "angles from e_r of each grain"}
    return xr.Dataset(variables, {"angle": angle}, {"conventions": CONVENTIONS, "frame": frames[frame]})
