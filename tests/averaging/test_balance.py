"""Coarse graining keeps the books: mass is conserved, and in a packing at rest the stress balances walls and gravity at every point."""

from dataclasses import replace

import numpy as np
import pytest
from clusters import make

from anisogran import average
from anisogran.dem import Box, Friction, Grains, Linear, Pressure, Simulation
from anisogran.dem.packing import uniform_radii

GRAVITY = np.array([0.0, -9.81])


def grid(low, high, spacing):
    axis = np.arange(low, high, spacing)
    return np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)


@pytest.fixture(scope="module")
def resting():
    """80 discs with friction, at rest between walls, pressed from the right and from above, under gravity."""
    rng = np.random.default_rng(5)
    radius = uniform_radii(80, 1e-3, 2.0, rng)
    place = np.stack(np.meshgrid(np.arange(10), np.arange(10)), -1).reshape(-1, 2)[:80]
    grains = Grains(1.34e-3 * 1.5 + place * 2.7e-3, radius, velocity=rng.normal(0, 0.1, (80, 2)))
    push, side = {"mass": 1e-4, "damping": 5.0}, 2.7e-3 * 10 + 1e-3
    box = Box(side, side, right=Pressure(100.0, **push), top=Pressure(150.0, **push))
    law = {"friction": Friction(2e4, 0.3), "wall_friction": Friction(2e4, 0.2)}
    simulation = Simulation(grains, Linear(1e5, 0.1), boundary=box, drag=0.02, gravity=tuple(GRAVITY), **law)
    simulation.run(300_000)
    snapshot = simulation.snapshot()
    return snapshot


def unbalanced(snapshot):
    """The force on each grain, contacts and weight, (N, 2)."""
    force = snapshot.mass[:, None] * GRAVITY
    first, second = snapshot.pairs.T
    np.add.at(force, first, snapshot.force)
    np.add.at(force, second[second >= 0], -snapshot.force[second >= 0])
    return force


@pytest.mark.parametrize("kernel", ["gaussian", "lucy"])
def test_the_integral_of_the_density_is_the_mass(rng, kernel):
    snapshot = make(rng.uniform(0, 4, (30, 2)), rng.uniform(0.4, 0.6, 30), [], [], mass=rng.uniform(1, 2, 30))
    spacing = 0.25 if kernel == "gaussian" else 0.05
    data = average(snapshot, on="points", points=grid(-7, 11, spacing), width=1.0, kernel=kernel, fields=["density", "area_fraction"])
    # the sum over a grid is exact for the Gaussian but for its cut edge (7e-10 of its top); Lucy has a third power of |r| in its middle
    tolerance = 1e-10 if kernel == "gaussian" else 1e-8
    assert float(data.density.sum()) * spacing**2 == pytest.approx(snapshot.mass.sum(), rel=tolerance)
    assert float(data.area_fraction.sum()) * spacing**2 == pytest.approx(np.pi * (snapshot.radius**2).sum(), rel=tolerance)


@pytest.mark.parametrize("kernel", ["gaussian", "lucy", "heaviside"])
@pytest.mark.parametrize("width", ["0.5d", "1.0d", "3.0d"])
def test_a_packing_at_rest_is_in_balance_up_to_the_wall(resting, kernel, width):
    """-div sigma + wall force density + rho g = 0 at every point, inside, at the walls and beyond, for every kernel and width."""
    points = grid(-2e-3, 30e-3, 1.6e-3)
    options = {"on": "points", "points": points, "width": width, "kernel": kernel}
    data = average(resting, fields=["stress_divergence", "wall_force_density", "density"], **options)
    weight = data.density.values * GRAVITY[:, None]
    lost = -data.stress_divergence.values + data.wall_force_density.values + weight
    scale = np.abs(data.stress_divergence.values).max()
    assert np.abs(lost).max() < 1e-3 * scale
    # what is left is what the grains, one swinging rattler above all, are out of balance themselves: force per area like momentum
    moving = replace(resting, velocity=unbalanced(resting) / resting.mass[:, None])
    rest = average(moving, fields="momentum_density", **options).momentum_density.values
    np.testing.assert_allclose(lost, rest, atol=1e-12 * scale)
    assert np.abs(weight).max() > 300 * np.abs(rest).mean()  # gravity is not lost in the tolerance


def test_the_divergence_is_that_of_the_stress(resting):
    """Differences of the stress between neighbouring points go to stress_divergence at second order."""
    centre = np.array([[12e-3, 9e-3], [1e-3, 15e-3], [20e-3, 0.5e-3]])  # the second and third see a wall
    exact = average(resting, on="points", points=centre, width="1.0d", fields="stress_divergence").stress_divergence.values
    errors = []
    for step in (4e-4, 2e-4, 1e-4):
        difference = 0
        for axis in np.eye(2):
            before, after = (
                average(resting, on="points", points=centre + s * step * axis, width="1.0d", fields="stress_static") for s in (-1, 1)
            )
            difference = difference + np.einsum("ijp,j->ip", (after - before).stress_static.values, axis) / (2 * step)
        errors.append(np.abs(difference - exact).max() / np.abs(exact).max())
    order = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    np.testing.assert_allclose(order, 2.0, atol=0.05)
    assert errors[-1] < 1e-3


def test_wall_forces_add_up_to_those_of_the_walls(resting):
    """The integral of the wall force density is the whole force of the walls: minus the weight."""
    points = grid(-20e-3, 50e-3, 0.8e-3)
    data = average(resting, on="points", points=points, width=2e-3, fields=["wall_force_density", "density"])
    total = data.wall_force_density.sum("point").values * 0.8e-3**2
    wall = resting.pairs[:, 1] < 0
    np.testing.assert_allclose(total, resting.force[wall].sum(axis=0), atol=1e-9 * np.abs(resting.force).sum())
    weight = resting.mass.sum() * 9.81
    np.testing.assert_allclose(total - unbalanced(resting).sum(axis=0), [0.0, weight], atol=1e-9 * np.abs(resting.force).sum())


def test_stress_of_the_box_grid_and_points_agree(resting):
    """Spread over points or shared between cells, the integral of the contact stress is the same, and that of the walls' forces."""
    spacing = 0.8e-3
    points = average(resting, on="points", points=grid(-20e-3, 50e-3, spacing), width=2e-3, fields="stress_static")
    whole = average(resting, fields="stress_static").stress_static.values * resting.volume
    np.testing.assert_allclose(points.stress_static.sum("point") * spacing**2, whole, rtol=1e-9, atol=1e-9 * np.abs(whole).max())


def test_density_follows_the_momentum(rng):
    """d rho/dt = -div (rho v): the density a little later and earlier, against momentum_gradient, at second order in time."""
    position, velocity = rng.uniform(0, 4, (40, 2)), rng.normal(size=(40, 2))
    points = rng.uniform(0, 4, (6, 2))

    def density(time):
        moved = make(position + time * velocity, np.full(40, 0.3), [], [], velocity=velocity)
        return average(moved, on="points", points=points, width=0.8, fields=["density", "momentum_gradient"])

    loss = np.einsum("iip->p", density(0.0).momentum_gradient.values)
    errors = [np.abs((density(t).density - density(-t).density).values / (2 * t) + loss).max() for t in (0.08, 0.04, 0.02)]
    np.testing.assert_allclose(np.log2(np.array(errors[:-1]) / np.array(errors[1:])), 2.0, atol=0.1)


def test_frictionless_stress_at_rest_is_symmetric():
    """Central forces give a symmetric stress whatever the state; at rest, also friction does, since no grain may turn."""
    rng = np.random.default_rng(2)
    place = np.stack(np.meshgrid(np.arange(6), np.arange(6)), -1).reshape(-1, 2)
    snapshot = make(place * 0.95 + rng.uniform(-0.01, 0.01, (36, 2)), np.full(36, 0.5), [], [])
    distance = np.hypot(*np.moveaxis(snapshot.position[:, None] - snapshot.position[None], -1, 0))
    first, second = np.nonzero(np.triu(distance < 1, 1))
    branch = snapshot.position[second] - snapshot.position[first]
    pressed = make(snapshot.position, snapshot.radius, np.stack([first, second], 1), -branch * rng.uniform(1, 2, (len(first), 1)))
    for options in ({}, {"on": "points", "points": grid(0, 5, 0.7), "width": 0.7}, {"on": "grid", "width": 1.0}):
        stress = average(pressed, fields="stress_static", **options).stress_static.values
        np.testing.assert_allclose(stress[0, 1], stress[1, 0], atol=1e-12 * np.abs(stress).max())


def test_stress_at_rest_is_symmetric_with_friction(resting):
    stress = average(resting, fields="stress_static").stress_static.values
    assert abs(stress[0, 1] - stress[1, 0]) < 1e-4 * stress[1, 1]  # one rattler still swings


def test_width_and_number_of_grains_narrow_the_error(rng):
    """A wave of velocity: a wider kernel flattens it by its second moment (order 2), and more grains make a stress steadier (order 1/2)."""
    from anisogran.dem import dense_packing

    packed = dense_packing(np.full(900, 0.5), area_fraction=0.8, seed=3)
    wave = 2 * np.pi / packed.width
    cell = [packed.width, packed.width]
    velocity = np.stack([np.sin(wave * packed.position[:, 1]), np.zeros(900)], axis=1)
    snapshot = make(packed.position, np.full(900, 0.5), [], [], velocity=velocity, cell=cell)
    crest = np.stack([np.linspace(0, packed.width, 12, endpoint=False), np.full(12, 0.25 * packed.width)], axis=1)
    loss = []
    for width in (1.5, 3.0):
        data = average(snapshot, on="points", points=crest, width=width, fields="velocity")
        loss.append(1 - float(data.velocity[0].mean()))
    assert loss[1] == pytest.approx(1 - np.exp(-0.5 * (wave * 3.0) ** 2), rel=0.15)  # a crest of 30 d holds 12 rows of grains a width
    assert np.log2(loss[1] / loss[0]) == pytest.approx(2.0, abs=0.3)
