"""The fixed piece of work that is timed: the right physics, the numbers it promises, and one line for what cannot be used."""

import json
import math

import numpy as np
import pytest

from anisogran import cli
from anisogran.benchmark import AREA_FRACTION, EFFECTS, made_packing, read_packing, sheared_packing
from anisogran.dem import Linear, Luding
from anisogran.models import INTEGRATORS, LAWS

KEYS = {"particle_steps_per_s", "pairs_per_grain", "contacts_per_grain", "rebuilds", "late_builds", "bytes_per_grain"}


def run(capsys, *arguments):
    with pytest.raises(SystemExit) as end:
        cli.main(["bench", "dem", *map(str, arguments)])
    captured = capsys.readouterr()
    return end.value.code, captured.out, captured.err


@pytest.fixture(scope="module")
def packing():
    return made_packing(200)


@pytest.fixture
def file(packing, tmp_path):
    position, radius, side = packing
    np.savez(tmp_path / "p.npz", x=np.column_stack([position, np.full(200, 0.1)]), r=radius, L=side)
    return tmp_path / "p.npz"


def test_the_made_packing_is_the_common_one(packing):
    position, radius, side = packing
    assert position.shape == (200, 2)
    assert 0.5e-3 < radius.min() < radius.max() < 1.5e-3
    assert np.pi * np.sum(radius**2) / side**2 == pytest.approx(AREA_FRACTION, rel=1e-12)  # rounding


def test_large_packings_are_laid_with_tiles(monkeypatch):
    """Twice as wide and high as the tile, and every contact of the tile four times: across the borders as well."""
    monkeypatch.setattr("anisogran.benchmark.shear.LARGEST_TILE", 200)
    contacts = []
    for grains in (200, 800):
        position, radius, side = made_packing(grains)
        assert len(radius) == grains
        contacts.append(len(sheared_packing(position, radius, side, "frictionless", 5.0).snapshot().pairs))
    assert contacts[1] == 4 * contacts[0]


@pytest.mark.parametrize("effects", EFFECTS)
def test_the_work_is_pure_shear_with_the_effects_asked_for(effects, packing):
    """After a strain of rate times time the cell is as much narrower as it is higher; no effect is there that was not asked for."""
    position, radius, side = packing
    sim = sheared_packing(position, radius, side, effects, 5.0)
    normal, friction = sim.effects["normal"], sim.effects["friction"]
    assert isinstance(normal, Luding if effects == "luding" else Linear)
    assert (friction is None) == (effects == "frictionless")
    assert normal.damping == pytest.approx(3.5e4 * 0.5 * 2000.0 * 4 / 3 * math.pi * np.mean(radius**3))
    assert sim.active_effects()[1][-4:] == ["rolling", "gravity", "wall_friction", "drag"]
    assert (sim._state.spin is None, sim._state.memory.spring is None) == (effects == "frictionless",) * 2
    assert (sim._state.memory.largest is None) == (effects != "luding")
    sim.run(200)
    width, height = sim.walls.lattice[:2]
    assert math.log(height / side) == pytest.approx(5.0 * 200 * 1.44e-7, rel=1e-9)  # 200 roundings of 1 + 7e-7
    assert width * height == pytest.approx(side**2, rel=1e-12)
    assert sim.counters["late_builds"] == 0


def test_the_command_writes_what_it_promises(file, tmp_path, capsys):
    code, out, _ = run(capsys, "--packing", file, "--steps", 40, "--warmup", 20, "--ledger", "--json", tmp_path / "n.json")
    numbers = json.loads((tmp_path / "n.json").read_text())
    assert code == 0
    assert set(numbers) > KEYS
    assert "particle_steps_per_s" in out
    assert numbers["particle_steps_per_s"] * numbers["seconds"] == pytest.approx(200 * 40)
    assert 1.7 < numbers["contacts_per_grain"] < 2.5  # 4.27/2 in large packings of this density; 200 grains scatter by 0.1
    assert numbers["contacts_per_grain"] < numbers["pairs_per_grain"] < 3.5
    assert numbers["late_builds"] == 0
    assert numbers["ledger"] is True
    assert numbers["bytes_per_grain"] < 600


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"x": np.zeros((3, 2))}, "x (3, 2), r (200,) and L () are not (N, 3), (N,) and one number"),
        ({"x": np.arange(600.0).reshape(200, 3)}, "spheres in three dimensions are not there yet"),
        ({"r": None}, "not a readable packing with x, r and L"),
        ({"L": [1.0, 2.0]}, "L (2,) are not"),
        ({"r": np.array(["a"] * 200)}, "not a readable packing"),
        ({"L": 1e-6}, "is too large for the periodic cell"),
    ],
)
def test_a_packing_that_cannot_be_used_is_one_line(change, message, file, tmp_path, capsys):
    with np.load(file) as good:
        arrays = {**good, **change}
    np.savez(tmp_path / "bad.npz", **{name: value for name, value in arrays.items() if value is not None})
    code, out, err = run(capsys, "--packing", tmp_path / "bad.npz")
    assert code == 2
    assert message in err
    assert err.count("\n") == 1
    assert not out


def test_bench_alone_tells_what_there_is(capsys):
    with pytest.raises(SystemExit) as end:
        cli.main(["bench"])
    assert end.value.code == 0
    assert "Pure shear of a dense periodic packing" in capsys.readouterr().out


def test_what_is_no_packing_is_one_line(file, tmp_path, capsys):
    (tmp_path / "text.npz").write_text("no packing")
    for arguments, message in [
        (["--packing", tmp_path / "text.npz"], "text.npz: not a readable packing"),
        (["--packing", tmp_path / "none.npz"], "none.npz: not a readable packing"),
        (["--packing", file, "--effects", "rolling"], "--effects rolling: must be one of frictionless, friction, luding"),
        (["--packing", file, "--steps", 0], "--steps"),
        (["--packing", file, "--rate", "nan"], "--rate = nan must be a finite number"),
    ]:
        code, _, err = run(capsys, *arguments)
        assert code == 2
        assert message in err
        assert err.count("\n") == 1
    assert read_packing(file)[0].shape == (200, 2)


def test_averages_are_timed_on_every_place(capsys, tmp_path):
    """Small: every field is found on rings, grid and points, and the share of the run is that of its two times."""
    with pytest.raises(SystemExit) as end:
        cli.main(["bench", "averaging", "--grains", "400", "--repeats", "1", "--json", str(tmp_path / "a.json")])
    assert end.value.code == 0
    numbers = json.loads((tmp_path / "a.json").read_text())
    assert numbers["grains"] == 400
    assert numbers["rings_fields"] > 40
    assert numbers["points_fields"] > numbers["rings_fields"]
    assert numbers["share_of_run"] == pytest.approx(numbers["run_average_s"] / numbers["run_interval_s"])
    assert all(value > 0 for value in numbers.values())
    assert "rings_all_s" in capsys.readouterr().out


@pytest.mark.parametrize("room", ["dem", "averaging"])
def test_a_file_that_cannot_be_made_is_refused_before_any_work(room, capsys, tmp_path, monkeypatch):
    def fail(*arguments):
        raise AssertionError("work was done")

    monkeypatch.setattr("anisogran.benchmark.made_packing", fail)
    monkeypatch.setattr("anisogran.benchmark.averages.made_packing", fail)
    with pytest.raises(SystemExit) as end:
        cli.main(["bench", room, "--json", str(tmp_path / "no" / "a.json")])
    assert end.value.code == 2
    assert "cannot be written" in capsys.readouterr().err


def test_laws_at_a_point_are_timed_beside_their_errors(capsys, tmp_path):
    """Small: every law with every integrator; each error is of the order of its integrator, the default far below the explicit one."""
    with pytest.raises(SystemExit) as end:
        cli.main(["bench", "models", "--points", "300", "--repeats", "1", "--json", str(tmp_path / "m.json")])
    assert end.value.code == 0
    numbers = json.loads((tmp_path / "m.json").read_text())
    assert len(numbers) == 2 + 5 * len(LAWS) * len(INTEGRATORS)
    for law in LAWS:
        for integrator in INTEGRATORS:
            one = {
                key.removeprefix(f"{law}_{integrator}_"): value for key, value in numbers.items() if key.startswith(f"{law}_{integrator}_")
            }
            assert one["million_per_s"] > 0.0
            assert one["with_tangent_million_per_s"] > 0.0
            assert one["curve_s"] > 0.0
            assert one["error"] < 1e-2
            assert one["curve_error"] < 1e-2
        if law in ("scalar", "tensorial"):
            assert numbers[f"{law}_rk45_error"] < 1e-3 * numbers[f"{law}_midpoint_error"] < 1e-4 * numbers[f"{law}_explicit_error"]
    assert "tensorial_midpoint_million_per_s" in capsys.readouterr().out


def test_ring_flows_are_timed_beside_their_errors(capsys, tmp_path):
    """Small in 2D: the errors are those of this mesh, a tenth of the default one, and of the rate floor of the local law."""
    arguments = ["--along", "16", "--around", "8", "--repeats", "1", "--json", str(tmp_path / "c.json")]
    with pytest.raises(SystemExit) as end:
        cli.main(["bench", "continuum", *arguments])
    assert end.value.code == 0
    numbers = json.loads((tmp_path / "c.json").read_text())
    assert numbers["nonlocal_2d_unknowns"] == 3 * 33 * 16 + 17 * 8  # three quadratic fields and a linear one
    assert 1e-5 < numbers["local_1d_error"] < 5e-4  # 3.7e-4
    assert 1e-6 < numbers["nonlocal_1d_error"] < 1e-5  # 4e-6
    assert 1e-5 < numbers["nonlocal_2d_error"] < 1e-3
    for flow in ("local_1d", "nonlocal_1d", "nonlocal_2d"):
        assert numbers[f"{flow}_stress_ratio_error"] < 1e-4
    for flow in ("local_1d", "nonlocal_1d", "nonlocal_2d", "eccentric_2d"):
        assert numbers[f"{flow}_s"] > 0.0
        assert numbers[f"{flow}_processor_s"] > 0.0
        assert numbers[f"{flow}_iterations"] > 2
