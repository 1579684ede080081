"""Probes of lattices, whose moduli are known, and the protocol that probes a sample along its path."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from anisogran import Friction, InputError, Linear, Luding, RunFailed, Stiffness
from anisogran import open as open_results
from anisogran.averaging.directions import contact_network
from anisogran.dem import Grains, Periodic, Simulation
from anisogran.dem.checkpoint import inventory
from anisogran.experiments.probing import DIRECTIONS, contact_stress, in_cell, probes, strained
from anisogran.fitting import probed_moduli
from anisogran.models import network_moduli
from anisogran.outcome import Interrupted
from anisogran.runs.session import Session
from anisogran.tensors import plane_parts, rotate

K, KT, RADIUS = 1e5, 2e4, 1e-3
SPRINGS = Linear(K, damping=0.1)
ROUGH = Friction(KT, 10.0, damping=0.05)
SIZES = {"steps": 100, "rest": 1e-9, "drag": 0.3}


def lattice(contact=SPRINGS, friction=None, overlap=1e-4, columns=6, rows=6, taller=1.0):
    """Equal discs on a triangular lattice with this overlap over the diameter along the rows; the rows lie `taller` apart than there."""
    a = 2 * RADIUS * (1 - overlap)
    height = 0.5 * np.sqrt(3) * a * taller
    x, y = np.meshgrid(np.arange(columns), np.arange(rows))
    position = np.stack([(x + 0.5 * (y % 2)) * a, y * height], axis=2).reshape(-1, 2)
    grains = Grains(position, np.full(len(position), RADIUS))
    return Simulation(grains, contact, friction, boundary=Periodic(columns * a, rows * height))


def moduli(ways, way, phi_C=None):
    some = [one for one in ways if one.way == way]
    return probed_moduli(np.stack([one.d_eps for one in some], 2), np.stack([one.d_sigma for one in some], 2), phi_C=phi_C)


def lattice_stress(simulation, gradient, k_t=0.0):
    """Exact stress of the triangular lattice after x -> (1 + gradient) x: it moves affinely. Tangential springs to first order."""
    width, height = simulation.walls.lattice[:2]
    bonds = np.array([[width / 6, 0.0], [width / 12, height / 6], [-width / 12, height / 6]])
    turn = 0.5 * (gradient[1, 0] - gradient[0, 1])
    area, stress = width * height / 36 * np.linalg.det(np.eye(2) + gradient), np.zeros((2, 2))
    for bond in bonds:
        new = bond + gradient @ bond
        length = np.linalg.norm(new)
        n, t = new / length, np.array([-new[1], new[0]]) / length
        slip = (gradient @ bond) @ t - turn * length
        stress += np.outer(max(0.0, K * (2 * RADIUS - length)) * n - k_t * slip * t, new) / area
    return rotate(0.5 * (stress + stress.T), -turn)


@pytest.mark.parametrize(("friction", "k_t"), [(None, 0.0), (ROUGH, KT)], ids=["smooth", "rough"])
def test_a_triangular_lattice_has_its_moduli(friction, k_t):
    """E = sqrt(3) k_n, B = 2G = sqrt(3)/2 (k_n + k_t), A = 0, from the response and from the fabric; they differ by the prestress."""
    simulation = lattice(friction=friction)
    ways = probes(simulation, 1e-7, **SIZES)
    exact = {"E": np.sqrt(3) * K, "A": 0.0, "B": 0.5 * np.sqrt(3) * (K + k_t), "G": 0.25 * np.sqrt(3) * (K + k_t)}
    prestress = plane_parts(contact_stress(simulation))[0]
    assert prestress == pytest.approx(np.sqrt(3) * K * 1e-4, rel=1e-3)
    for way in ("forth", "back"):
        found = moduli(ways, way, phi_C=0.5 * np.pi).values
        # known first-order effect of the stress: pressure times 1, 0, -3/2, -3/4; the rest is of second order in overlap and strain
        for name, part in {"E": 1.0, "A": 0.0, "B": -1.5, "G": -0.75}.items():
            assert found[name] == pytest.approx(exact[name] + part * prestress, abs=0.01 * prestress), name
    network = contact_network(simulation.snapshot(), 0.5 * np.pi)
    affine = network_moduli(network.a2, network.a4, K, k_t, network.scale)
    for name, value in exact.items():
        assert getattr(affine, name) == pytest.approx(value, rel=1e-12, abs=1e-9 * K), name


@pytest.mark.parametrize("name", DIRECTIONS)
def test_the_stress_of_a_strained_lattice_is_exact(name):
    """Finite probes, against the closed form, area and rotation included; the sample bears a deviator, so that a turn would show."""
    simulation = lattice(overlap=2e-3, taller=0.999)
    before = lattice_stress(simulation, np.zeros((2, 2)))
    np.testing.assert_allclose(contact_stress(simulation), before, rtol=1e-9, atol=1e-9)
    assert before[1, 1] > 1.2 * before[0, 0]
    for way in probes(simulation, 1e-4, directions=(name,), **SIZES):
        if way.way == "forth":
            eps = way.d_eps
            gradient = np.array([[np.expm1(-eps[0, 0]), -2 * eps[0, 1]], [0.0, np.expm1(-eps[1, 1])]])  # true strains
            expected = lattice_stress(simulation, gradient) - before
            np.testing.assert_allclose(way.d_sigma, expected, rtol=1e-6, atol=1e-6 * np.abs(expected).max())
            last = expected
        else:
            np.testing.assert_allclose(way.d_sigma, -last, atol=1e-6 * np.abs(last).max())  # springs give all of it back


def test_an_open_direction_makes_it_anisotropic():
    """A stretched lattice whose rows no longer touch each other sideways: only the inclined bonds bear, and it is stiffer along y."""
    simulation = lattice(overlap=-1e-5, taller=1 - 2e-5)
    assert len(simulation.snapshot().pairs) == 2 * len(simulation.grains)
    found = moduli(probes(simulation, 1e-7, **SIZES), "forth")
    assert abs(found.values["phi_C"]) == pytest.approx(0.5 * np.pi, abs=1e-6)  # the axis is found, not given
    network = contact_network(simulation.snapshot())
    affine = network_moduli(network.a2, network.a4, K, 0.0, network.scale)
    # bonds at 30 degrees from the vertical: a2 = 2 cos 60 degrees = 1
    assert network.a2 == pytest.approx(1.0, abs=1e-4)
    for name in ("E", "A", "B", "G"):
        assert found.values[name] == pytest.approx(getattr(affine, name), rel=1e-4), name  # but for the overlap, some 1e-5


def test_a_probe_leaves_the_state_as_it_is():
    """Bit for bit, contact memory, list and counters included."""
    simulation = lattice(Luding(5e4, 1e5, 1e5, damping=0.1), ROUGH)
    simulation.run(7)
    kept = {name: array.copy() for name, array in inventory(simulation._state)[0].items()}
    probes(simulation, 1e-5, **SIZES)
    after = inventory(simulation._state)[0]
    assert kept.keys() == after.keys()
    for name, array in kept.items():
        np.testing.assert_array_equal(after[name], array, err_msg=name)


def test_half_the_probe_is_half_the_response():
    simulation = lattice()
    whole, half = (moduli(probes(simulation, size, **SIZES), "forth", phi_C=0.0).values for size in (2e-6, 1e-6))
    for name in ("E", "B", "G"):
        assert half[name] == pytest.approx(whole[name], rel=1e-6)  # the overlap is fifty probes: nothing opens; strain^2 remains


def test_first_loading_is_plastic_and_the_way_back_elastic():
    """Luding's law on a lattice in first loading: k1 forth in compression, k2 in expansion, and k2 on every way back."""
    simulation = lattice(Luding(0.5 * K, K, 0.0, damping=0.1))
    ways = probes(simulation, 1e-7, directions=("isotropic",), **SIZES)
    bulk = {(way.sign, way.way): way.d_sigma[0, 0] / way.d_eps[0, 0] for way in ways}
    full = np.sqrt(3) * K
    assert bulk[1.0, "forth"] == pytest.approx(0.5 * full, rel=1e-3)
    for key in ((1.0, "back"), (-1.0, "forth"), (-1.0, "back")):
        assert bulk[key] == pytest.approx(full, rel=1e-3)


def test_a_sliding_contact_slides_forth_and_sticks_back():
    """Springs at Coulomb's limit: forth only the normal springs bear more, in the sense in which they slide."""
    simulation = lattice(friction=Friction(KT, 1e-3), overlap=1e-3)
    slid = strained(simulation, 1e-4 * DIRECTIONS["pure_shear"], **SIZES)  # many times the limit
    ways = {(way.sign, way.way): way for way in probes(slid, 1e-8, directions=("pure_shear",), **SIZES)}
    shear = {key: plane_parts(way.d_sigma)[1] / plane_parts(way.d_eps)[1] for key, way in ways.items()}
    smooth, rough = 0.5 * np.sqrt(3) * K, 0.5 * np.sqrt(3) * (K + KT)
    assert shear[1.0, "forth"] == pytest.approx(smooth, rel=0.01)  # the limit itself changes with the normal force, by mu
    for key in ((1.0, "back"), (-1.0, "forth"), (-1.0, "back")):
        assert shear[key] == pytest.approx(rough, rel=0.01)


def test_contacts_that_open_are_counted():
    simulation = lattice(overlap=1e-6)
    for way in probes(simulation, 1e-5, directions=("isotropic",), **SIZES):
        opens = way.sign * (1 if way.way == "forth" else -1) < 0
        assert (way.opened, way.closed) == ((0, 0) if way.sign > 0 else (108, 0) if opens else (0, 108))


def test_a_sheared_cell_goes_on_where_it_was_left():
    """Shear in two stages ends in the same places as in one: the offset of the images is handed on."""
    simulation = lattice(overlap=1e-3)
    once = in_cell(simulation, {"shear_rate": 10.0})
    half = in_cell(simulation, {"shear_rate": 10.0})
    once.run(2000)
    half.run(1000)
    twice = in_cell(half, {"shear_rate": 10.0})
    twice.run(1000)
    assert once.walls.lattice[2] == pytest.approx(2000 * once.dt * 10.0 * once.walls.lattice[1])
    assert twice.walls.lattice[2] == pytest.approx(once.walls.lattice[2], rel=1e-12)
    np.testing.assert_allclose(contact_stress(twice), contact_stress(once), rtol=1e-9, atol=1e-9 * K)
    cell = Periodic(0.012, 0.012, offset=-0.001)
    assert cell.state().lattice[2] == pytest.approx(0.011)
    with pytest.raises(InputError, match="offset"):
        replace(cell, offset=np.inf)


@pytest.fixture(scope="module")
def run():
    return Stiffness(n=150, strain=0.03, states=3, inertial_number=5e-3, samples=20, seed=2).run()


def test_states_lie_where_they_are_asked_for(run):
    assert run.status
    m = run.tables["moduli"]
    np.testing.assert_allclose(m.eps_zz, 0.03 * np.array([0.0, 0.25, 1.0]), atol=1e-12)
    np.testing.assert_allclose(run.series.sigma_xx, 100.0, rtol=0.1)
    assert abs(float(m.s_D[0])) < 0.02
    assert (run.tables["probes"].imbalance < run.scene.rest).all()
    assert list(run.snapshots) == ["frame-00000000", "frame-00000001", "frame-00000002"]
    assert run.series.eps_zz[-1] == m.eps_zz[-1]


def test_moduli_are_those_of_the_probes_and_of_the_snapshots(run):
    m, p = run.tables["moduli"], run.tables["probes"].to_dataframe()
    for k, snapshot in enumerate(run.snapshots.values()):
        network = contact_network(snapshot.bearing(1e-3), 0.5 * np.pi)
        affine = network_moduli(network.a2, network.a4, K, 0.0, network.scale)
        assert float(m.E.sel(source="fabric")[k]) == affine.E
        back = p[(p.probed_state == k) & (p.way == -1)]
        bulk = back[back.d_eps_V != 0]
        assert float(m.E.sel(source="back")[k]) == pytest.approx(float((bulk.d_sigma_V / bulk.d_eps_V).mean()), rel=1e-9)
        shear = back[back.d_eps_xz != 0]
        assert 2 * float(m.G.sel(source="back")[k]) == pytest.approx(float((shear.d_sigma_xz / shear.d_eps_xz).mean()), rel=1e-9)
    assert (m.E.sel(source="back") < m.E.sel(source="fabric")).all()  # Voigt's bound
    assert (m.G.sel(source="back") < 0.5 * m.G.sel(source="fabric")).all()  # frictionless: far from affine in shear


@pytest.mark.hard_case("D23", "F1", of="stiffness")
def test_a_run_is_kept_and_taken_up(run, tmp_path):
    """The tables of moduli survive the file, and a run in a folder that is stopped and resumed gives the same bits."""
    run.save(tmp_path / "run.h5")
    stored = open_results(tmp_path / "run.h5")
    np.testing.assert_array_equal(stored["moduli"].G, run.tables["moduli"].G)

    def stop(fraction):
        if fraction > 0.9:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted):
        run.scene.run(progress=stop, folder=tmp_path / "run")
    again = run.scene.run(folder=tmp_path / "run", resume=True)
    for name in ("E", "A", "B", "G", "a2"):
        np.testing.assert_array_equal(again.tables["moduli"][name], run.tables["moduli"][name])
    np.testing.assert_array_equal(again.snapshots["frame-00000002"].force, run.snapshots["frame-00000002"].force)


def test_a_probe_that_does_not_come_to_rest_is_told_of(run):
    """The way is measured as it is, and the status of the run says so."""
    assert run.scene.doubts(run.tables) == []
    probes = run.tables["probes"].copy(deep=True)
    probes["imbalance"][[0, 1, 30]] = 2 * run.scene.rest
    told = run.scene.doubts({"probes": probes})
    assert told == [f"state {k}: ways of its probes that did not come to rest: {count}" for k, count in ((0, 2), (2, 1))]
    coarse = Stiffness(n=60, states=1, inertial_number=0.01, probe=1e-2).run()
    moving = int((coarse.tables["probes"].imbalance >= coarse.scene.rest).sum())
    assert moving > 0
    assert str(coarse.status).endswith(f"state 0: ways of its probes that did not come to rest: {moving}")


@pytest.mark.hard_case("D22", of="stiffness")
def test_a_loading_that_is_too_fast_is_warned_of(run, answer):
    simulation = SimpleNamespace(counters={"late_builds": 0}, snapshot=lambda: run.snapshots["frame-00000000"])
    fast = Stiffness(inertial_number=0.05).judge(run.series, None, simulation)
    assert "inertial number of the loading 0.05: not quasi-static" in fast.reasons
    assert "quasi-static" not in str(run.scene.judge(run.series, None, simulation))
    answer.named(fast)


def test_the_estimate_counts_the_steps_of_probes(monkeypatch):
    """They are some half of all, on copies of the simulation; a guess to a factor of two."""
    taken, run = [], Simulation.run
    monkeypatch.setattr(Simulation, "run", lambda self, steps, **more: taken.append(steps) or run(self, steps, **more))
    scene = Stiffness(n=60, states=1, inertial_number=0.01)
    session = Session(scene)
    session.go()
    probes = session.stages[-1]
    assert probes.name == "probe-0"
    assert 0.5 < probes.steps / (sum(taken) - session.grain_steps / scene.n) < 2.0


def test_what_cannot_be_probed_is_refused():
    with pytest.raises(InputError, match="plastic_depth"):
        Stiffness(contact=Luding(5e4, 1e5, plastic_depth=0.05))
    with pytest.raises(InputError, match=r"probe = 0\.5"):
        Stiffness(probe=0.5)
    apart = lattice(overlap=-0.01)
    assert Stiffness().calm(apart) == "no grains touch"


def test_a_state_that_finds_no_rest_is_not_probed(monkeypatch):
    monkeypatch.setattr("anisogran.experiments.stiffness.CALM", 1e-30)
    monkeypatch.setattr("anisogran.experiments.stiffness.ATTEMPTS", 2)
    monkeypatch.setattr(
        Stiffness, "stages", lambda self: [stage for stage in STAGES(self) if stage.name in ("press", "settle-0", "probe-0")]
    )
    with pytest.raises(RunFailed, match=r"stage settle-0: no equilibrium.*mean net force"):
        Stiffness(n=60, states=2, inertial_number=0.01).run()


STAGES = Stiffness.stages
