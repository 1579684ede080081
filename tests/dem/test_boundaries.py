"""Walls, rings and the periodic cell: their geometry and motion in exact cases, most of them without a compiled kernel."""

import math
from dataclasses import replace

import numba
import numpy as np
import pytest
from crowds import FRICTION, LAW, crowd, state

from anisogran.compiled import OPTIONS
from anisogran.dem import Box, Cosine, Friction, Grains, Linear, Luding, Open, Path, Periodic, Pressure, Ring, Simulation
from anisogran.dem.boundaries import advance, settle, touch
from anisogran.dem.boundaries.motion import move
from anisogran.dem.rows import INVERSE_MASS, grain_rows
from anisogran.dem.state import find_forces
from anisogran.dem.stepping import body_of, kick_and_drift
from anisogran.dem.walls import WallList, find_wall_contacts, wall_contact
from anisogran.outcome import InputError, RunFailed


def body(position, velocity=0.0, radius=0.5, mass=1.0):
    """The arrays of the kernel for a few grains."""
    position = np.array(position, float)
    n = len(position)
    grains = Grains(position, np.full(n, radius), mass=np.full(n, mass), velocity=np.broadcast_to(np.asarray(velocity, float), (n, 2)))
    return body_of(grain_rows(grains, np.arange(n)))


def test_every_wall_of_a_box_pushes_inwards():
    state = Box(4.0, 3.0, sliding=(5.0, 6.0, 7.0, 8.0)).state()
    state.velocity[:] = [1.0, 2.0, 3.0, 4.0]
    place = {0: (0.4, 1.5), 1: (3.6, 1.5), 2: (2.0, 0.4), 3: (2.0, 2.6)}
    normal = {0: (-1, 0), 1: (1, 0), 2: (0, -1), 3: (0, 1)}
    for wall in range(4):
        overlap, nx, ny, vx, vy = touch(state, wall, *place[wall], 0.5)
        assert overlap == pytest.approx(0.1)
        assert (nx, ny) == normal[wall]
        assert (vx, vy) == ((wall + 1.0, wall + 5.0) if wall < 2 else (wall + 5.0, wall + 1.0))


def test_every_pressed_wall_of_a_box_yields_outwards():
    """m dv = (F - p length - c v) dt with the dashpot implicit; p acts on the height at the sides, on the width at bottom and top."""
    wall, dt = Pressure(2.0, mass=4.0, damping=3.0), 0.1
    state = Box(5.0, 7.0, left=wall, right=wall, bottom=wall, top=wall).state()
    state.force[:] = [15.0, 16.0, 17.0, 18.0]  # outward; 14 and 10 would balance
    way = advance(state, body([[1.0, 1.0]]), None, 1, 1.0, dt, dt)
    speed = dt * (state.force - 2.0 * np.array([7.0, 7.0, 5.0, 5.0])) / 4.0 / (1 + dt * 3.0 / 4.0)
    sense = np.array([-1.0, 1.0, -1.0, 1.0])
    np.testing.assert_allclose(state.velocity, sense * speed, rtol=1e-14)
    np.testing.assert_allclose(state.position, [0.0, 5.0, 0.0, 7.0] + sense * speed * dt, rtol=1e-14)
    assert way == pytest.approx(speed.max() * dt)


def test_cosine_waits_for_its_beginning():
    motion = Cosine(4.0, 3.0, duration=2.0, begin=5.0).parameters()
    for time, position, speed in ((4.0, 4.0, 0.0), (5.0, 4.0, 0.0), (6.0, 3.5, -math.pi / 4), (7.0, 3.0, 0.0), (9.0, 3.0, 0.0)):
        found = move(motion, 4.0, 0.0, 0.0, 1.0, 1.0, time, 0.1)
        assert found == (pytest.approx(position), pytest.approx(speed, abs=1e-15))


def test_cosine_goes_back_and_forth():
    motion = Cosine(4.0, 3.0, duration=2.0, half_periods=3).parameters()
    turns = ((1.0, 3.5, -1), (2.0, 3.0, 0), (3.0, 3.5, 1), (4.0, 4.0, 0), (5.0, 3.5, -1), (6.0, 3.0, 0), (9.0, 3.0, 0))
    for time, position, sense in turns:
        found = move(motion, 4.0, 0.0, 0.0, 1.0, 1.0, time, 0.1)
        assert found == (pytest.approx(position), pytest.approx(sense * math.pi / 4, abs=1e-15))
    with pytest.raises(InputError, match=r"half_periods = 1\.5 must be a whole number"):
        Cosine(4.0, 3.0, 2.0, half_periods=1.5)


def followed(path, times):
    """Positions and speeds (n,) of a wall on that path."""
    motion = path.parameters()
    return np.array([move(motion, 0.0, 0.0, 0.0, 1.0, 1.0, time, 0.1) for time in times]).T


def test_a_path_of_cubics_is_followed_exactly():
    """Uneven points of z = t^3 - t with its speed; at rest outside."""
    points = np.array([-1.0, -0.2, 0.5, 2.0])
    path = Path(points, points**3 - points, 3 * points**2 - 1)
    t = np.linspace(-0.99, 1.99, 41)
    position, speed = followed(path, t)
    np.testing.assert_allclose(position, t**3 - t, atol=1e-14)
    np.testing.assert_allclose(speed, 3 * t**2 - 1, atol=1e-14)
    np.testing.assert_array_equal(followed(path, [-5.0, -1.0, 2.0, 9.0]), [[0.0, 0.0, 6.0, 6.0], np.zeros(4)])
    np.testing.assert_allclose(followed(Path([1.0, 3.0], [2.0, 8.0]), [1.5, 2.0]), [[3.5, 5.0], [3.0, 3.0]], rtol=1e-15)


@pytest.mark.parametrize(("given", "order"), [(False, 3), (True, 4)])
def test_a_sampled_path_converges(given, order):
    """The lecture's cosine from n points: position of the third order with differences, of the fourth with exact speeds, speed one less."""
    t = np.linspace(0.0, 2.0, 1001)
    exact = np.cos(0.5 * np.pi * t), -0.5 * np.pi * np.sin(0.5 * np.pi * t)
    errors = []
    for n in (40, 80, 160):
        points = np.linspace(0.0, 2.0, n + 1)
        speed = -0.5 * np.pi * np.sin(0.5 * np.pi * points) if given else None
        found = followed(Path(points, np.cos(0.5 * np.pi * points), speed), t)
        errors.append([np.abs(found[q] - exact[q]).max() for q in range(2)])
    found_order = np.log2(errors[1] / np.array(errors[2]))
    np.testing.assert_allclose(found_order, [order, order - 1], atol=0.1)  # 160 points: close to the limit of many


def test_the_compiled_path_is_the_plain_one():
    points = np.linspace(0.0, 2.0, 7)
    motion = Path(points, np.sin(points)).parameters()
    compiled = numba.njit(**OPTIONS)(lambda motion, time: move(motion, 0.0, 0.0, 0.0, 1.0, 1.0, time, 0.1))
    times = np.append(np.linspace(-0.5, 2.5, 31), points)
    # fused multiply-add differs in the last digits
    np.testing.assert_allclose([compiled(motion, time) for time in times], followed(Path(points, np.sin(points)), times).T, atol=1e-14)


def test_bad_paths_are_refused():
    for arguments, message in [
        (([0.0], [1.0]), "Path: time has 1 entries, at least 2 are needed"),
        (([0.0, 1.0, 1.0], [1.0, 2.0, 3.0]), r"Path: time\[2\] = 1 s must be above time\[1\] = 1 s"),
        (([0.0, 1.0], [1.0, np.nan]), r"Path: position\[1\] = nan is not finite"),
        (([0.0, np.inf], [1.0, 1.0]), r"Path: time\[1\] = inf is not finite"),
        (([0.0, 1.0], [1.0, 2.0, 3.0]), r"Path: position has shape \(3,\), it must be \(2,\)"),
        (([0.0, 1.0], [1.0, 2.0], [0.0]), r"Path: speed has shape \(1,\), it must be \(2,\)"),
        (([[0.0, 1.0]], [1.0, 2.0]), r"Path: time has shape \(1, 2\), it must be \(n,\)"),
        ((["a", "b"], [1.0, 2.0]), "Path: time is no array of numbers"),
    ]:
        with pytest.raises(InputError, match=message):
            Path(*arguments)


@pytest.mark.hard_case("D15")
def test_a_pressed_wall_without_contact_has_a_speed_limit(answer):
    """pressure * length / damping, however light the wall; with the force of the grains it goes the other way."""
    state = Box(5.0, 7.0, right=Pressure(2.0, mass=1e-6, damping=4e3)).state()
    for step in range(50):
        advance(state, body([[1.0, 1.0]]), None, 1, 1.0, 1e-3 * step, 1e-3)
    assert state.velocity[1] == pytest.approx(-2.0 * 7.0 / 4e3, rel=1e-9)
    answer.computed(abs(state.velocity[1] / (2.0 * 7.0 / 4e3) + 1.0), "speed limit of a wall without contact")


@pytest.mark.hard_case("D15")
def test_a_pressed_wall_has_a_mass(answer):
    with pytest.raises(InputError, match=r"Pressure: mass = 0 must be above 0 kg") as caught:
        Pressure(1.0, mass=0.0, damping=1.0)
    answer.refused(caught)


@pytest.mark.hard_case("D15")
def test_the_status_tells_how_far_a_wall_is_from_its_pressure(answer):
    grains = Grains([[0.5, 0.5]], [0.5], mass=[1.0])
    box = Box(1.0, 1.0, right=Pressure(10.0, mass=1.0, damping=80.0))
    sim = Simulation(grains, Linear(1e3, 20.0), boundary=box, drag=20.0, dt=1e-3)
    assert "the right wall bears 0 of its pressure 10 N/m at present" in sim.status.reasons
    answer.named(sim.status)
    sim.run(6000)
    assert not any("bears" in reason for reason in sim.status.reasons)
    sim.walls.force[1] = 10.11
    assert "the right wall bears 1.01 of its pressure 10 N/m at present" in sim.status.reasons


def test_outer_grains_press_on_their_ring():
    """Radial piston: m dv = (F on the ring + radial force of the driven grains - 2 pi R p - c v) dt, and the grains move along."""
    dt, p = 0.1, 1.0
    state = Ring(2.0, rim=Pressure(p, mass=4.0, damping=3.0), inner=1).state()
    state.force[0] = 5.0
    grains = body([[0.5, 0.0], [1.0, 0.0], [1.2, 1.6], [0.0, -2.0]])  # free, inner, outer, outer
    grains.fx[:], grains.fy[:] = [9.0, 9.0, 3.0, 1.0], [9.0, 9.0, 4.0, -20.0]
    way = advance(state, grains, None, 1, 1.0, dt, dt)
    speed = dt * (5.0 + 5.0 + 20.0 - 2 * math.pi * 2.0 * p) / 4.0 / (1 + dt * 3.0 / 4.0)
    assert state.velocity[0] == pytest.approx(speed, rel=1e-14)
    assert way == pytest.approx(speed * dt)
    np.testing.assert_allclose(grains.x[2:], [0.6 * (2 + way), 0.0], atol=1e-14)
    np.testing.assert_allclose(grains.vy, [0.0, 0.0, 0.8 * speed, -speed], atol=1e-14)


def test_a_grain_that_leaves_the_sheared_cell_changes_its_velocity():
    """Through the top it comes back at the bottom, shifted by the offset and slower by rate times height; through the side nothing."""
    state = Periodic(4.0, 3.0, shear_rate=0.5).state()
    state.lattice[2:6] = [1.0, 0.2, 1.1, 0.9]
    grains = body([[2.5, 3.1], [1.5, -0.1], [4.2, 1.0]], [0.0, 0.3])
    settle(state, grains)
    np.testing.assert_allclose(grains.x, [1.5, 2.5, 0.2], atol=1e-15)
    np.testing.assert_allclose(grains.y, [0.1, 2.9, 1.0], atol=1e-15)
    np.testing.assert_allclose(grains.vx, [-1.5, 1.5, 0.0], atol=1e-15)
    np.testing.assert_array_equal(grains.vy, 0.3)
    np.testing.assert_array_equal(state.lattice[:6], [4.0, 3.0, 1.0, 0.0, 1.0, 1.0])


def test_the_offset_of_the_sheared_cell_stays_within_its_width():
    """By how much the image above is shifted is known only up to a width; kept small, it keeps its digits in a long run."""
    state = Periodic(4.0, 3.0, shear_rate=0.5).state()
    for _ in range(30):
        advance(state, body([[1.0, 1.0]]), None, 1, 1.0, 0.0, 0.1)
    assert state.lattice[2] == pytest.approx(0.5)  # 30 * 0.1 * 0.5 * 3.0 = 4.5
    assert state.lattice[3] == pytest.approx(1.5)


def test_glued_grains_ride_on_their_walls():
    """One grain on the left, two on the right, none below, one above: position, velocity, no spin; what presses on them moves the wall."""
    dt, wall = 0.1, Pressure(2.0, mass=4.0, damping=3.0)
    sliding = (5.0, 6.0, 7.0, 8.0)
    box = Box(5.0, 7.0, left=wall, right=wall, bottom=wall, top=wall, sliding=sliding, glued=(1, 2, 0, 1))
    state, start = box.state(), [[1.0, 1.0], [0.0, 2.0], [5.0, 3.0], [5.0, 4.0], [2.0, 7.0]]
    grains, spin = body(start), np.full(5, 9.0)
    state.force[:] = [1.0, 2.0, 3.0, 4.0]
    grains.fx[:], grains.fy[:] = [99.0, -20.0, 15.0, 16.0, 98.0], [99.0, 98.0, 97.0, 96.0, 25.0]
    force = np.array([1.0 + 20.0, 2.0 + 31.0, 3.0, 4.0 + 25.0])
    held = [("left wall", 21 / 7, 2.0), ("right wall", 33 / 7, 2.0), ("bottom wall", 3 / 5, 2.0), ("top wall", 29 / 5, 2.0)]
    assert box.held(state, grains, 1) == [(name, pytest.approx(present), pressure) for name, present, pressure in held]
    advance(state, grains, spin, 1, 1.0, dt, dt)
    speed = [-1.0, 1.0, -1.0, 1.0] * (dt * (force - 2.0 * np.array([7.0, 7.0, 5.0, 5.0])) / 4.0 / (1 + dt * 3.0 / 4.0))
    np.testing.assert_allclose(state.velocity, speed, rtol=1e-14)
    velocity = np.array([[0.0, 0.0], [speed[0], 5.0], [speed[1], 6.0], [speed[1], 6.0], [8.0, speed[3]]])
    np.testing.assert_allclose(np.stack([grains.vx, grains.vy], axis=1), velocity, rtol=1e-14)
    np.testing.assert_allclose(np.stack([grains.x, grains.y], axis=1), start + dt * velocity, rtol=1e-14)
    assert spin.tolist() == [9.0, 0.0, 0.0, 0.0, 0.0]


def test_driven_grains_of_no_wall_keep_their_velocity():
    """In a box and in free space; nothing that presses on them counts, and their spin stays."""
    for boundary in (Box(5.0, 7.0), Open()):
        grains, spin = body([[1.0, 1.0], [2.0, 3.0]], [[9.0, 9.0], [0.5, -0.25]]), np.full(2, 9.0)
        grains.fx[:], grains.fy[:] = 77.0, 77.0
        for _ in range(8):
            assert advance(boundary.state(), grains, spin, 1, 1.0, 0.0, 0.25) == 0.0
        np.testing.assert_array_equal(np.stack([grains.x, grains.y], axis=1), [[1.0, 1.0], [3.0, 2.5]])
        assert (grains.vx[1], grains.vy[1], spin[1]) == (0.5, -0.25, 9.0)


def test_a_driven_grain_hits_like_an_infinite_mass():
    """Elastic impact of a driven grain on one at rest: that one flies off at twice the speed, the driven one goes on as before."""
    grains = Grains([[3.0, 0.0], [0.0, 0.0]], [0.5, 0.5], mass=[1.0, 1.0], velocity=[[0.0, 0.0], [0.5, 0.0]], driven=1)
    sim = Simulation(grains, Linear(1e3), dt=1e-3)
    sim.run(6000)
    # the error of a binary contact falls with the third power of the step; this step is t_c/140
    assert sim.velocity[0, 0] == pytest.approx(1.0, abs=1e-4)
    np.testing.assert_allclose(sim.position[1], [3.0, 0.0], atol=1e-12)
    assert sim.velocity[1].tolist() == [0.5, 0.0]


def test_a_run_with_rough_sliding_walls_can_be_split(rng):
    """Bit for bit, with glued grains on a pressed and on a sliding wall; the wall moves its grains exactly."""
    loose, side = crowd(rng)
    column = np.stack([np.full(7, side), np.linspace(0.1, 0.9, 7) * side], axis=1)
    row = np.stack([np.linspace(-0.5, 1.0, 12) * side, np.zeros(12)], axis=1)
    clear = loose.position[:, 1] > 1e-3 + loose.radius  # of the row
    clear &= loose.position[:, 0] < side - 1e-3 - loose.radius
    position, radius = loose.position[clear], loose.radius[clear]
    grains = Grains(
        np.concatenate([position, column, row]), np.append(radius, np.full(19, 1e-3)), driven=19,
        velocity=np.concatenate([loose.velocity[clear], np.zeros((19, 2))]),
    )  # fmt: skip
    box = Box(side, side, right=Pressure(50.0, 1e-4, 0.5), top=Cosine(side, 0.8 * side, 0.02), sliding=(0, 0, 0.3, 0), glued=(0, 7, 12, 0))
    runs = []
    for pieces in ([2000], [1, 336, 7, 10, 646, 1000]):
        sim = Simulation(grains, LAW, friction=FRICTION, boundary=box)
        for steps in pieces:
            sim.run(steps)
        runs.append(sim)
    assert runs[0].counters == runs[1].counters
    np.testing.assert_array_equal(state(runs[0]), state(runs[1]))
    n, right = len(position), float(sim.walls.position[1])
    assert abs(right - side) > 1e-4
    # 2000 additions, each rounded by up to 2e-18 m at places of 0.02 m
    np.testing.assert_allclose(sim.position[n : n + 7], np.stack([np.full(7, right), column[:, 1]], axis=1), rtol=0, atol=1e-14)
    np.testing.assert_allclose(sim.position[n + 7 :] - row, np.full((12, 2), [0.3 * sim.time, 0.0]), rtol=0, atol=1e-14)
    assert sim.velocity[:n, 0].max() > 0.0
    assert sim.counters["late_builds"] == 0


def test_boxes_whose_glued_grains_do_not_add_up_are_refused():
    grains = Grains([[1.0, 1.0], [0.0, 2.0]], [0.5, 0.5], driven=1)
    for make, message in [
        (
            lambda: Simulation(grains, Linear(1e3), boundary=Box(4.0, 4.0, glued=(1, 1, 0, 0))),
            "glued = 2 grains in all, but driven = 1 are",
        ),
        (lambda: Box(4.0, 4.0, glued=(1, 1)), r"Box: glued = \(1, 1\) must have four entries, for left, right, bottom, top"),
        (lambda: Box(4.0, 4.0, glued=(0, 1.5, 0, 0)), r"Box: glued \(right\) = 1.5 must be a whole number of grains"),
        (lambda: Box(4.0, 4.0, glued=(0, 0, -1, 0)), r"Box: glued \(bottom\) = -1 must be at least 0"),
        (lambda: Box(4.0, 4.0, sliding=(0, 0, 0, math.nan)), r"Box: sliding \(top\) = nan must be a finite number"),
        (lambda: Box(4.0, 4.0, sliding=1.0), "Box: sliding = 1.0 must have four entries"),
    ]:
        with pytest.raises(InputError, match=message):
            make()


def test_friction_at_a_wall():
    """A disc in a ring, at 30 degrees: normal force and tangential dashpot in closed form; the wall feels the opposite of the grain."""
    k, g, g_t, overlap, spin, outward, along, ring_speed = 1e3, 5.0, 2.0, 0.02, 3.0, 0.4, -0.7, 0.25
    n = np.array([math.cos(math.pi / 6), 0.5])
    t = np.array([-n[1], n[0]])
    grains = Grains([(1.5 + overlap) * n], [0.5], mass=[1.0], velocity=[outward * n + along * t], spin=[spin])
    boundary = Ring(2.0, rim=Pressure(1.0, mass=1.0, damping=0.0))
    friction = Friction(1e3, 10.0, damping=g_t)
    sim = Simulation(grains, Luding(k, k, damping=g), friction=friction, boundary=boundary, wall_friction=friction)
    sim.walls.velocity[0] = ring_speed
    find_forces(sim._state)
    arm = 0.5 - overlap / 2
    fn, ft = k * overlap + g * (outward - ring_speed), g_t * (along + arm * spin)  # on the wall
    np.testing.assert_allclose(sim.net_force[0], -fn * n - ft * t, rtol=1e-12)
    assert sim.torque[0] == pytest.approx(-arm * ft, rel=1e-12)
    assert sim.walls.force[0] == pytest.approx(fn, rel=1e-12)
    assert sim.walls.traction[0] == pytest.approx(ft, rel=1e-12)
    snapshot = sim.snapshot()
    assert snapshot.pairs.tolist() == [[0, -1]]
    np.testing.assert_allclose(snapshot.force[0], sim.net_force[0], rtol=1e-12)
    np.testing.assert_allclose(snapshot.point[0], 2.0 * n, rtol=1e-12)  # on the wall
    memory = sim._state.wall_memory
    memory.largest[:], memory.spring[:] = 0.01, 0.5  # a step would load the one and cut the other
    sim.snapshot()
    assert (memory.largest.item(), memory.spring.item()) == (0.01, 0.5)


def test_every_wall_has_its_own_memory():
    """A grain at the right wall unloads from what it remembers there, not elsewhere; away from the wall it forgets that alone."""
    state = Box(4.0, 3.0).state()
    law, friction = Luding(1.0, 2.0, 0.0).parameters(), Friction(1.0, 10.0).parameters()
    largest, spring = np.array([[0.3], [0.18], [0.3], [0.3]]), np.full((4, 1), 0.01)
    candidates = WallList(np.array([0]), np.array([1]), np.array([1]))
    contact = wall_contact.py_func(state, body([[3.6, 1.5]]), np.zeros(1), 0, candidates, law, friction, largest, spring, 0.0)
    assert contact[5:] == (pytest.approx(2.0 * 0.1 - 1.0 * 0.18), pytest.approx(-0.01))
    wall_contact.py_func(state, body([[3.4, 1.5]]), np.zeros(1), 0, candidates, law, friction, largest, spring, 0.0)
    np.testing.assert_array_equal(largest, [[0.3], [0.0], [0.3], [0.3]])
    np.testing.assert_array_equal(spring, [[0.01], [0.0], [0.01], [0.01]])


def test_a_wall_lists_what_is_within_the_skin():
    candidates = WallList(np.zeros(8, int), np.zeros(8, int), np.zeros(1, int))
    find_wall_contacts.py_func(Box(4.0, 3.0).state(), body([[3.41, 1.5], [3.39, 1.5]]), 2, 0.1, candidates)
    assert (candidates.size[0], candidates.grain[0], candidates.wall[0]) == (1, 0, 1)  # gaps 0.09 and 0.11


@pytest.mark.hard_case("D17")
@pytest.mark.parametrize("skin", [0.1, 1e-3])
def test_a_moving_wall_finds_a_grain_at_rest(skin):
    """The way of the walls counts when the list is judged, so the top meets the grain although that has not moved at all.

    With a skin thinner than the way of the wall in ten steps the list is built late, which has to be counted.
    """
    box = Box(2.0, 4.0, top=Cosine(4.0, 0.85, duration=10.0))
    sim = Simulation(Grains([[1.0, 0.5]], [0.4], mass=[1e6]), Linear(10.0), boundary=box, dt=1e-3, skin=skin)
    sim.run(10_000)
    assert sim.walls.force[3] == pytest.approx(10.0 * 0.05, rel=1e-4)  # the grain yields by F t^2/2m, some 1e-6
    assert (sim.counters["late_builds"] > 0) == (skin < 0.01)


def test_a_collapsing_cell_stops_at_its_pressure():
    """Four discs in a column, apart and at rest, carried together by the cell: in the end four contacts bear pressure times width."""
    k, pressure, width = 1e3, 2.5, 4.0
    grains = Grains([[1.0, 1.0], [1.0, 3.0], [1.0, 5.0], [1.0, 7.0]], np.full(4, 0.5), mass=np.ones(4))
    cell = Periodic(width, 8.0, pressure=(None, pressure), viscosity=25.0)
    sim = Simulation(grains, Linear(k, 20.0), boundary=cell)
    sim.run(10_000)
    # force balance of a column in series; the relaxation has long ended
    assert sim.walls.lattice[1] == pytest.approx(4 * (1 - pressure * width / k), rel=1e-9)
    assert sim.counters["late_builds"] == 0


def test_agitation_holds_a_cell_open():
    """Grains that never touch: the sides relax to sum m c^2 / (pressure * other side), whatever the mean velocity and the shear flow."""
    for axis, shear_rate in ((0, 0.5), (1, 0.0)):
        pressure, c = 0.045, np.array([0.6, -0.3])
        pressures = (pressure, None) if axis == 0 else (None, pressure)
        state = Periodic(4.0, 4.0, shear_rate=shear_rate, pressure=pressures, viscosity=pressure).state()
        grains = body([[1.0, 1.0], [3.0, 2.0]])
        grains.rows[:, INVERSE_MASS] = [1.0, 0.5]
        grains.vx[:], grains.vy[:] = 0.7 + shear_rate * grains.y, -0.2
        (grains.vx, grains.vy)[axis][:] += c  # its momentum is zero
        for _ in range(400):
            advance(state, grains, None, 2, 1.0, 0.0, 0.1)
        assert state.lattice[axis] == pytest.approx((0.36 + 2 * 0.09) / (pressure * 4.0), rel=1e-9)  # e^-40 of the way is left


def test_affine_motion_alone_hardly_wears_the_list():
    """Grains that flow with the sheared cell approach by strain times reach, however far up they are: a list per 0.086 of strain."""
    position = np.array([[1.0, 1.0], [1.0, 3.0], [1.0, 5.0], [1.0, 7.0]])
    grains = Grains(position, np.full(4, 0.5), mass=np.ones(4), velocity=np.outer(position[:, 1], [0.1, 0.0]))
    sim = Simulation(grains, Linear(1e3), boundary=Periodic(4.0, 8.0, shear_rate=0.1), skin=0.1)
    sim.run(int(0.2 / 0.1 / sim.dt))
    assert sim.counters["builds"] == 3  # 0.95 * 0.1 / 1.1 of strain each: two within 0.2, after the first
    assert sim.counters["late_builds"] == 0


def test_deep_overlap_is_seen_across_the_border():
    with pytest.raises(InputError, match="grains 0 and 1 overlap by 160% of the smaller radius at the start"):
        Simulation(Grains([[0.1, 1.0], [3.9, 1.0]], [0.5, 0.5]), Linear(1e3), boundary=Periodic(4.0, 3.0))


def test_a_cell_too_small_for_its_images_is_refused():
    """Narrower than twice the reach of the list, a pair would be listed with two images and feel its force twice."""
    pair = Grains([[0.5, 0.5], [1.45, 0.5]], [0.5, 0.5], mass=[1.0, 1.0])
    sim = Simulation(pair, Linear(1e3), boundary=Periodic(2.3, 4.0), skin=0.1)
    np.testing.assert_allclose(sim.net_force[:, 0], [-50.0, 50.0], rtol=1e-12)
    for size in ((2.1, 4.0), (4.0, 2.1)):
        with pytest.raises(InputError, match="is too large for the periodic cell"):
            Simulation(pair, Linear(1e3), boundary=Periodic(*size), skin=0.1)
    sim = Simulation(pair, Linear(1e3), boundary=Periodic(4.0, 4.0, pressure=1e3, viscosity=1e3), skin=0.1)
    with pytest.raises(RunFailed, match=r"stopped at step \d+ .* the periodic cell is narrower"):
        sim.run(5000)


def test_drag_acts_in_every_half_kick():
    """v <- v + h (f - drag v)/m, twice, in both directions; the driven grain takes no part."""
    grains = body(np.zeros((2, 2)), [3.0, -2.0], mass=2.0)
    b = grains
    kick_and_drift.py_func(b.rows, b.forces, None, None, 0.5, 1, 0.1, 0.2, 0.5)
    factor = (1 - 0.1 * 0.25) * (1 - 0.2 * 0.25)
    np.testing.assert_allclose([b.vx, b.vy], [[3.0 * factor, 3.0], [-2.0 * factor, -2.0]], rtol=1e-14)
    np.testing.assert_allclose([b.x, b.y], [[1.5 * factor, 0.0], [-factor, 0.0]], rtol=1e-14)


def test_the_next_stage_begins_with_the_forces_of_the_last():
    """Every contact memory is handed over: largest overlap and spring, of pairs and at the wall. Without dashpots no force changes."""
    boundary = Ring(2.0, rim=Pressure(1.0, mass=1e3, damping=0.0))
    friction, law = Friction(5e2, 0.5), Luding(5e2, 1e3, 100.0)
    grains = Grains([[1.49, 0.0], [0.47, 0.0]], [0.5, 0.5], mass=[1.0, 1.0], velocity=[[0.5, 0.3], [1.0, 0.0]], spin=[3.0, -2.0])
    sim = Simulation(grains, law, friction=friction, boundary=boundary, wall_friction=friction)
    sim.run(120)
    s = sim._state
    memory = [s.memory.largest[:1], s.memory.spring[:1], s.wall_memory.largest, s.wall_memory.spring]
    assert all(part.any() for part in memory)
    stage = sim.next_stage(boundary=replace(boundary, radius=float(sim.walls.position[0])))
    np.testing.assert_array_equal(stage.spin, sim.spin)
    np.testing.assert_allclose(stage.net_force, sim.net_force, rtol=1e-12)
    np.testing.assert_allclose(stage.torque, sim.torque, rtol=1e-12)
    fresh = Simulation(
        replace(grains, position=sim.position, velocity=sim.velocity), law, friction, boundary=stage.boundary, wall_friction=friction
    )
    assert np.all(np.abs(fresh.net_force - sim.net_force).max(axis=1) > 0.1)  # the memory matters for both grains
    s.memory.largest[0], s.memory.spring[0] = 1e-6, 0.5  # a step would load the one and cut the other; a snapshot must not
    sim.snapshot()
    assert (s.memory.largest[0], s.memory.spring[0]) == (1e-6, 0.5)


def test_grains_can_be_glued_to_walls_later():
    """Renumbered, those of each wall last; every contact keeps its memory, and so its force; from then on they ride."""
    law, friction = Luding(5e2, 1e3, 400.0), Friction(5e2, 0.5)
    position = [[2.0, 2.49], [2.0, 0.55], [0.9, 1.6], [2.0, 1.52], [3.3, 0.45]]
    velocity = [[0.3, -1.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]]
    sim = Simulation(Grains(position, 0.5, mass=np.arange(1.0, 6.0), velocity=velocity), law, friction=friction, boundary=Box(4.0, 3.0))
    sim.run(300)
    top, bottom = (np.arange(5) == k for k in (0, 1))
    none = np.zeros(5, bool)
    box = Box(4.0, 3.0, top=Cosine(3.0, 3.1, 1e-2), glued=(0, 0, 1, 1))
    stage = sim.next_stage(boundary=box, driven=[none, none, bottom, top])
    order = [2, 3, 4, 1, 0]
    np.testing.assert_array_equal(stage.grains.mass, sim.grains.mass[order])
    np.testing.assert_array_equal(stage.position, sim.position[order])
    assert sim.snapshot().pairs.tolist() == [[1, 3], [3, 0], [1, -3]]
    held = 3  # it touches both glued ones, and nothing else
    np.testing.assert_allclose(stage.net_force[1], sim.net_force[held], rtol=1e-12)
    assert np.abs(stage.net_force[1]).max() > 1.0
    fresh = Simulation(replace(sim.grains, position=sim.position, velocity=sim.velocity), law, friction=friction, boundary=Box(4.0, 3.0))
    assert np.abs(fresh.net_force[held] - sim.net_force[held]).max() > 0.1  # the memory matters
    stage.run(int(2e-2 / stage.dt))
    np.testing.assert_allclose(stage.position[4], sim.position[0] + [0.0, 0.1], rtol=1e-9)
    np.testing.assert_array_equal(stage.position[3], sim.position[1])
    with pytest.raises(InputError, match=r"^next_stage: driven has grain 1 twice"):
        sim.next_stage(boundary=box, driven=[none, none, bottom, bottom])
    with pytest.raises(InputError, match=r"^next_stage: driven has the shape \(1, 3\) of bool; it must be \(5,\) bool"):
        sim.next_stage(boundary=box, driven=none[:3])
    with pytest.raises(InputError, match=r"^next_stage: driven has masks of different lengths; each must be \(5,\) bool"):
        sim.next_stage(boundary=box, driven=[none, none[:3]])


def test_a_periodic_cell_tells_how_its_images_move():
    """Lattice vectors as rows, and their rates: the image above moves with the shear, those at the sides with the stretch."""
    sheared = Periodic(4.0, 3.0, shear_rate=0.5)
    told = sheared.extent(sheared.state())
    np.testing.assert_allclose(told["cell"], [[4.0, 0.0], [0.0, 3.0]])
    np.testing.assert_allclose(told["cell_velocity"], [[0.0, 0.0], [1.5, 0.0]])
    stretched = Periodic(4.0, 3.0, stretch_rate=(-0.1, 0.2))
    np.testing.assert_allclose(stretched.extent(stretched.state())["cell_velocity"], [[-0.4, 0.0], [0.0, 0.6]])
