"""Any small sample on any place: no warning, no infinity, NaN where it is documented; units, frames and sums of every field at once.

The samples are the same in every run (derandomize); more are tried with larger max_examples.
"""

import re

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from anisogran import average
from anisogran.averaging import known_at, place_of
from anisogran.snapshot import Snapshot

NEVER_NAN = {
    "density", "number_density", "area_fraction", "volume_fraction", "momentum_density", "velocity_density", "spin_density", "stress",
    "stress_static", "stress_dynamic", "pressure", "fabric", "fabric_trace", "fabric_deviator", "couple_stress", "coordination_number",
    "wall_force_density", "stress_divergence", "density_gradient", "momentum_gradient",
}  # fmt: skip
NOT_BELOW_0 = {"density", "number_density", "area_fraction", "volume_fraction", "fabric_trace", "coordination_number"}
SUMMED = ["density", "number_density", "momentum_density", "stress_static", "fabric", "spin_density", "couple_stress"]


@st.composite
def samples(draw, borders=("none", "none", "cell", "sheared cell", "sector")):
    """Some grains, one beside the other or anywhere, on a lattice or not, with contacts, walls and wall grains."""
    d, border = draw(st.sampled_from([2, 3])), draw(st.sampled_from(borders))
    n, seed, regular = draw(st.integers(1, 7)), draw(st.integers(0, 10**6)), draw(st.booleans())
    rng = np.random.default_rng(seed)
    sites = np.stack(np.meshgrid(*[np.arange(-2.0, 3.0)] * d), axis=-1).reshape(-1, d)
    position = rng.permutation(sites)[:n] if regular else rng.normal(scale=2.0, size=(n, d))
    count = draw(st.integers(0, 8))
    first, second = rng.integers(0, n, count), rng.integers(-3, n, count)
    pairs = np.stack([first, np.where(first == second, -1, second)], axis=1)
    normal = rng.normal(size=(count, d))
    images = {"none": {}, "sector": {"sector": np.pi / 2}}.get(border)
    if images is None:
        cell = np.tril(rng.uniform(-1, 1, (d, d)), -1) + np.diag(rng.uniform(2, 4, d))
        images = {"cell": cell} if border == "cell" else {"cell": cell, "cell_velocity": np.tril(rng.normal(size=(d, d)))}
    return Snapshot(
        position, np.full(n, 0.5) if regular else rng.uniform(0.2, 0.9, n), rng.uniform(1, 2, n),
        rng.normal(size=(n, d)) * draw(st.sampled_from([0.0, 1.0])), rng.normal(size=n if d == 2 else (n, d)),
        pairs, rng.normal(size=(count, d)), position[first] + 0.4 * normal / np.linalg.norm(normal, axis=1)[:, None],
        rng.uniform(0, 0.1, count), fixed=rng.random(n) < draw(st.sampled_from([0.0, 0.5])), volume=rng.uniform(10, 20), **images,
    )  # fmt: skip


def places(snapshot):
    """Options of every place this sample can be averaged on."""
    rng = np.random.default_rng(len(snapshot.pairs))
    yield {}
    yield {"on": "points", "points": rng.normal(size=(3, snapshot.dimension)), "width": 0.8}
    yield {"on": "points", "points": rng.normal(size=(2, snapshot.dimension)), "width": 1.1, "kernel": "lucy"}
    edges = [np.arange(-2.0, 3.0)] * snapshot.dimension
    if snapshot.dimension == 2:
        yield {"on": "grid", "edges": edges}
    if snapshot.cell is None:
        yield {"on": "rings", "edges": np.arange(4.0) if snapshot.dimension == 2 else (np.arange(4.0), np.arange(-1.5, 2.0))}


def known_fields(snapshot, options):
    return known_at(place_of(snapshot, **{"on": "box", **options}))


@settings(max_examples=100, deadline=None, derandomize=True)
@given(samples())
def test_every_field_of_every_sample_is_a_number_or_says_why_not(snapshot):
    for options in places(snapshot):
        data = average(snapshot, fields=known_fields(snapshot, options), **options)
        for name, field in data.data_vars.items():
            values = field.values
            assert not np.isinf(values).any(), (name, options)
            assert ("reason" in field.attrs) == bool(np.isnan(values).any()), (name, options)
            assert name not in NEVER_NAN or np.isfinite(values).all(), (name, options)
            if name in NOT_BELOW_0:
                assert (values >= 0).all(), (name, options)
        empty = data.density.values == 0
        assert np.isnan(data.velocity.values[:, empty]).all()  # nobody is nowhere
        assert np.isfinite(data.velocity.values[:, ~empty]).all()
        agitation = np.moveaxis(data.stress_dynamic.values, (0, 1), (-2, -1))
        assert np.linalg.eigvalsh(agitation).min() > -1e-9 * (1 + np.abs(agitation).max())  # speeds below some 10, rounding


def exponents(unit):
    """Powers of kg, m and s in a unit such as "kg/(m2 s)" or "N m s"."""
    base = {"kg": (1, 0, 0), "m": (0, 1, 0), "s": (0, 0, 1), "N": (1, 1, -2), "rad": (0, 0, 0), "1": (0, 0, 0)}
    total = np.zeros(3)
    for sign, part in zip((1, -1), unit.split("/"), strict=False):
        for symbol, power in re.findall(r"([A-Za-z]+|^1)(\d*)", part):
            total += sign * np.array(base[symbol]) * int(power or 1)
    return total


def test_units_are_read_as_they_are_written():
    for unit, powers in {"kg/(m2 s)": (1, -2, -1), "N/m": (1, 0, -2), "1/m2": (0, -2, 0), "N m s": (1, 2, -1), "1": (0, 0, 0)}.items():
        assert tuple(exponents(unit)) == powers


@settings(max_examples=40, deadline=None, derandomize=True)
@given(samples(), st.sampled_from([(1e-6, 1e-3, 1e3), (1e6, 1e-6, 1.0), (1.0, 1e6, 1e-6), (1.0, 1.0, 1e6)]))
def test_every_field_changes_with_the_units_as_the_glossary_says(snapshot, scale):
    """The same sample in other kilograms, metres and seconds: each field scales with its own unit."""
    kg, m, s = scale
    more = {
        name: value * factor for name, factor in (("cell", m), ("cell_velocity", m / s)) if (value := getattr(snapshot, name)) is not None
    }
    other = Snapshot(
        snapshot.position * m, snapshot.radius * m, snapshot.mass * kg, snapshot.velocity * m / s, snapshot.spin / s, snapshot.pairs,
        snapshot.force * kg * m / s**2, snapshot.point * m, snapshot.overlap * m, volume=snapshot.volume * m**snapshot.dimension,
        fixed=snapshot.fixed, sector=snapshot.sector, **more,
    )  # fmt: skip
    for here in places(snapshot):
        there = dict(here)
        if "points" in here:
            there |= {"points": here["points"] * m, "width": here["width"] * m}
        elif "edges" in here:
            there["edges"] = [m * np.asarray(edges) for edges in here["edges"]] if np.ndim(here["edges"][0]) else here["edges"] * m
        names = with_errors(known_fields(snapshot, here))
        before, after = average(snapshot, fields=names, **here), average(other, fields=names, **there)
        for name in names:
            factor = np.prod(np.power(scale, exponents(before[name].attrs["units"])))
            compare(before, name, after[name].values / factor, before[name].values, here)


def with_errors(names):
    """Those that know how far rounding can move them: an angle near isotropy can be any."""
    return [name for name in names if not name.endswith("_angle")]


def compare(sample, name, found, expected, place):
    """Equal but for rounding, of sums of numbers of order 1, enlarged where a gradient is told by grains that are close together."""
    if name == "torque_stiffness":  # a quotient of rounding where the spin has no gradient
        told = (sample.curvature.values**2).sum(axis=0) > 1e-6
        found, expected = found[told], expected[told]
    elif name in ("bulk_modulus", "shear_modulus"):  # nor where contacts nearly along one line leave a strain that is rounding
        told = np.abs(expected) < 1e6
        found, expected = found[told], expected[told]
    elif name in ("s_D", "stress_ratio", "inertial_number"):  # and where as many grains as the fit has numbers leave no agitation
        told = np.abs(sample.pressure.values) > 1e-5
        found, expected = found[told], expected[told]
    np.testing.assert_allclose(found, expected, rtol=1e-5, atol=1e-7, err_msg=f"{name} on {place}")


@settings(max_examples=40, deadline=None, derandomize=True)
@given(samples(), st.integers(0, 10**6))
def test_cells_add_up_to_the_box(snapshot, seed):
    """Whatever the border and the edges, if the cells hold all grains: vectors and tensors on the grid, scalars and traces on rings."""
    if snapshot.dimension == 2 and snapshot.sector is None:
        box = average(snapshot, fields=SUMMED)
        cuts = np.sort(np.random.default_rng(seed).uniform(0.1, 1.9, 4))
        low, high = (np.zeros(2), np.diag(snapshot.cell)) if snapshot.cell is not None else (np.full(2, -20.0), np.full(2, 20.0))
        edges = [np.concatenate([[a], a + cuts / 2 * (b - a), [b]]) for a, b in zip(low, high, strict=True)]
        grid = average(snapshot, on="grid", edges=edges, fields=SUMMED)
        drift = snapshot.cell_velocity is not None  # images have another velocity, and the cell other momentum than its grains
        for name in SUMMED:
            if not (drift and name == "momentum_density"):
                total = (grid[name] * grid.volume).sum(["x", "y"])
                np.testing.assert_allclose(total, box[name] * box.volume, rtol=1e-11, atol=1e-11, err_msg=name)
    if snapshot.cell is None:
        edges = np.append(np.sort(np.random.default_rng(seed).uniform(0, 9, 5)), 30.0)
        edges[0] = 0.0
        names = ["density", "number_density", "stress_static", "fabric"]
        box = average(snapshot, fields=names)
        rings = average(snapshot, on="rings", edges=edges if snapshot.dimension == 2 else (edges, np.append(-20.0, edges)), fields=names)
        for name in names:
            total = (rings[name] * rings.volume).sum(rings.volume.dims).values
            whole = (box[name] * box.volume).values
            if whole.ndim == 2:
                total, whole = np.trace(total), np.trace(whole)
            np.testing.assert_allclose(total, whole, rtol=1e-10, atol=1e-10, err_msg=name)


@settings(max_examples=40, deadline=None, derandomize=True)
@given(samples(borders=("none",)), st.integers(0, 10**6))
def test_every_field_turns_and_moves_with_the_sample(snapshot, seed):
    """Any rotation and shift in the plane and in space, of the box and of points; about the axis and along it, rings see nothing."""
    rng, d = np.random.default_rng(seed), snapshot.dimension
    turn = np.linalg.qr(rng.normal(size=(d, d)))[0]
    turn[0] *= np.sign(np.linalg.det(turn))
    about_z = np.eye(d)
    about_z[:2, :2] = [[0.6, -0.8], [0.8, 0.6]]
    shift = rng.normal(size=d)
    for here in places(snapshot):
        on = here.get("on")
        if on == "grid" or (on == "rings" and not snapshot.position[:, :2].any(axis=1).all()):
            continue  # a grain on the axis takes x for its radius
        turning, moving = (about_z, 0.0) if on == "rings" else (turn, shift)
        there = here | {"points": here["points"] @ turning.T + moving} if on == "points" else here
        other = Snapshot(
            snapshot.position @ turning.T + moving, snapshot.radius, snapshot.mass, snapshot.velocity @ turning.T,
            snapshot.spin if d == 2 else snapshot.spin @ turning.T, snapshot.pairs, snapshot.force @ turning.T,
            snapshot.point @ turning.T + moving, snapshot.overlap, volume=snapshot.volume, fixed=snapshot.fixed,
        )  # fmt: skip
        names = with_errors(known_fields(snapshot, here))
        before, after = average(snapshot, fields=names, **here), average(other, fields=names, **there)
        for name in names:
            expected = before[name].values
            if on != "rings" and "j" in before[name].dims:
                expected = np.einsum("ik,kl...,jl->ij...", turning, expected, turning)
            elif on != "rings" and "i" in before[name].dims:
                expected = np.einsum("ik,k...->i...", turning, expected)
            compare(before, name, after[name].values, expected, here)
