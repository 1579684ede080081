"""One contact along a path of overlaps, against the formulas of the lecture and against the grains of a simulation."""

from itertools import pairwise

import numpy as np
import pytest
from crowds import EVERY_LAW, K

import anisogran as ag
from anisogran.dem import Grains, Linear, Luding, Simulation
from anisogran.outcome import InputError


def straight(*turns, steps=100):
    """Overlaps that go straight from one turn to the next."""
    return np.concatenate([np.linspace(a, b, steps + 1) for a, b in pairwise(turns)])


def runs(branch):
    """The branches one after the other, each once."""
    return [str(name) for k, name in enumerate(branch) if k == 0 or branch[k - 1] != name]


@pytest.mark.parametrize("adhesion", [0.0, 0.5, 1.0, 2.0, 4.0])
def test_marks_are_those_of_the_lecture(adhesion):
    """delta_0 = (1 - k1/k2) delta_max, delta_min = (k2 - k1)/(k2 + kc) delta_max, f_min = -kc delta_min; and the path passes there."""
    k1, k2, kc = 0.5 * K, K, adhesion * K
    path = ag.contact_path(Luding(k1, k2, kc), straight(0.0, 0.6, -0.06, steps=6600))
    low = (k2 - k1) / (k2 + kc) * 0.6
    assert (path.delta_max, path.delta_0, path.delta_min) == (0.6, pytest.approx(0.3), pytest.approx(low))
    assert path.f_min == pytest.approx(-kc * low, abs=1e-9)
    assert path.stiffness == k2
    assert path.force.min() == pytest.approx(path.f_min, abs=K * 1e-4)  # a step of the path
    assert runs(path.branch) == ["open", "loading", "elastic", "limit", "open"]
    on = {name: path.branch == name for name in ("loading", "elastic", "limit", "open")}
    np.testing.assert_allclose(path.force[on["loading"]], k1 * path.overlap[on["loading"]], rtol=1e-12)
    np.testing.assert_allclose(path.force[on["elastic"]], k2 * (path.overlap[on["elastic"]] - 0.3), atol=1e-12 * K)
    np.testing.assert_allclose(path.force[on["limit"]], -kc * path.overlap[on["limit"]], atol=1e-12 * K)
    np.testing.assert_array_equal(path.force[on["open"]], 0.0)
    assert path.overlap[on["limit"]].max() == pytest.approx(low, abs=2e-4)
    np.testing.assert_array_equal(path.largest[on["open"]], 0.0)


def test_an_open_contact_forgets_its_past():
    path = ag.contact_path(Luding(1.0, 2.0, 1.0), [0.5, -0.1, 0.3, 0.2])
    assert path.branch.tolist() == ["loading", "open", "loading", "elastic"]
    np.testing.assert_allclose(path.force, [0.5, 0.0, 0.3, 2.0 * (0.2 - 0.15)])
    assert path.delta_max == 0.5  # of the whole path


def test_marks_follow_the_growing_stiffness():
    """At half the plastic limit half the growth, at and beyond the limit all of it; beyond it the first loading is elastic."""
    law = Luding(1.0, 5.0, 0.7, plastic_depth=0.1)  # d_p = 1/8 of the size
    path = ag.contact_path(law, straight(0.0, 0.125, 0.0), size=2.0)
    grown = 3.0
    assert path.stiffness == pytest.approx(grown)
    assert (path.delta_0, path.delta_min) == (pytest.approx(0.125 * 2 / 3), pytest.approx(0.125 * 2 / 3.7))
    path = ag.contact_path(law, straight(0.0, 0.5, 0.3), size=2.0)
    assert path.stiffness == pytest.approx(5.0)
    assert path.delta_max == 0.5
    assert (path.delta_0, path.delta_min) == (pytest.approx(0.2), pytest.approx(0.25 * 4 / 5.7))
    assert runs(path.branch) == ["open", "loading", "elastic"]
    assert path.largest.max() == pytest.approx(0.25)


def test_linear_contact_has_one_branch():
    path = ag.contact_path(Linear(K, 3.0), straight(-0.1, 0.2, -0.1), rate=0.5)
    assert runs(path.branch) == ["open", "elastic", "open"]
    closed = path.overlap > 0
    np.testing.assert_allclose(path.force[closed], K * path.overlap[closed] - 3.0 * 0.5, rtol=1e-12)
    np.testing.assert_allclose(path.stored, np.where(closed, 0.5 * K * path.overlap**2, 0.0))
    assert (path.delta_max, path.delta_0, path.delta_min, path.f_min, path.stiffness) == (0.2, 0.0, 0.0, 0.0, K)
    apart = ag.contact_path(Linear(K), [-1.0, -0.5])
    assert (apart.delta_max, runs(apart.branch)) == (0.0, ["open"])


@pytest.mark.parametrize("name", EVERY_LAW)
def test_the_path_is_what_grains_feel(name):
    """The overlaps and rates of two colliding grains, step by step, give the forces that the compiled simulation has found."""
    law = EVERY_LAW[name]
    grains = Grains([[0.0, 0.0], [0.9999, 0.0]], [0.5, 0.5], mass=[1.0, 1.0], velocity=[[0.5, 0.0], [-0.5, 0.0]])
    sim = Simulation(grains, law)
    overlap, rate, force = [1.0 - 0.9999], [-1.0], [float(sim.net_force[1, 0])]
    for _ in range(150):
        half = sim.velocity + 0.5 * sim.dt * sim.net_force  # of unit masses; the dashpot takes the velocities of the half step
        sim.run(1)
        overlap.append(1.0 - float(sim.position[1, 0] - sim.position[0, 0]))
        rate.append(float(half[1, 0] - half[0, 0]))
        force.append(float(sim.net_force[1, 0]))
    path = ag.contact_path(law, overlap, rate, size=0.5)
    assert path.branch[-1] == "open"
    # an overlap is known to 1e-16 of the diameter
    np.testing.assert_allclose(path.force, force, rtol=0, atol=1e-11 * K)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((None, [0.1]), "law = None must be a contact law"),
        ((Linear(1.0), []), r"overlaps has shape \(0,\); it must be \(n,\)"),
        ((Linear(1.0), [[0.1]]), r"overlaps has shape \(1, 1\)"),
        ((Linear(1.0), [0.1, np.nan]), r"overlaps\[1\] = nan is not finite"),
        ((Linear(1.0), [0.1, 0.2], [1.0, 2.0, 3.0]), r"rate of shape \(3,\) does not fit \(2,\)"),
        ((Linear(1.0), [0.1, 0.2], np.inf), r"rate\[0\] = inf is not finite"),
        ((Linear(1.0), [0.1], 0.0, 0.0), "size = 0 must be above 0 m"),
        ((Luding(1.0, 2.0, plastic_depth=0.05), [0.1]), "size = None, but plastic_depth = 0.05 is a share of"),
    ],
)
def test_what_cannot_be_a_path_is_refused(arguments, message):
    with pytest.raises(InputError, match=message):
        ag.contact_path(*arguments)
