"""Sweeps: the cases are the runs bit for bit, what is done is not done again, and nothing that happens to one case is lost or hides."""

import contextlib
import json
import shutil
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import anisogran as ag
from anisogran.experiments import SimpleShear
from anisogran.files import save_results
from anisogran.outcome import InputError, Interrupted, RunFailed
from anisogran.runs.lock import _take, locked
from anisogran.scenes import changed, scene_text
from anisogran.sweeps.cases import NAME, case_name, case_scenes, parsed_vary, text_of
from anisogran.sweeps.collecting import joined
from anisogran.sweeps.folder import taken_up
from anisogran.sweeps.running import GO, check_workers

SCENE = SimpleShear(n=60, strain=0.6, discard=0.05, inertial_number=0.2, frames=0)
VARY = {"contact.stiffness": [1000.0, 2000.0], "seed": [1, 2]}


@pytest.fixture(scope="module")
def threads():
    with ThreadPoolExecutor(1) as pool:
        yield pool


@pytest.fixture(scope="module")
def made(tmp_path_factory, threads):
    folder = tmp_path_factory.mktemp("sweep") / "s"
    ag.sweep(SCENE, VARY, folder, executor=threads)
    return folder


@pytest.fixture
def folder(made, tmp_path):
    """A copy of a finished sweep of four cases."""
    return Path(shutil.copytree(made, tmp_path / "s"))


def times_of(folder):
    return {path.relative_to(folder): path.stat().st_mtime_ns for path in folder.rglob("*") if path.is_file()}


def set_state(folder, **changes):
    state = json.loads((folder / "state.json").read_text())
    (folder / "state.json").write_text(json.dumps(state | changes))


def states(folder):
    return {one["case"]: one["state"] for one in ag.sweep_status(folder)}


def same(collected, place, run):
    """Whether the series at a place are those of a run, to the last bit."""
    there = collected["series"].to_dataset().sel(place)
    rows = run.series.sizes["time"]
    for name in run.series.variables:
        np.testing.assert_array_equal(there[name].values[:rows], run.series[name].values)
        assert np.isnan(there[name].values[rows:]).all()
        assert there[name].attrs == run.series[name].attrs
    return True


def test_collected_cases_are_the_runs_bit_for_bit(made, tmp_path):
    collected = ag.collect_sweep(made)
    assert dict(collected["series"].sizes) == {"contact_stiffness": 2, "seed": 2, "sample": 30}
    for stiffness in VARY["contact.stiffness"]:
        for seed in VARY["seed"]:
            run = changed(SCENE, {"contact.stiffness": stiffness, "seed": seed}).run()
            place = {"contact_stiffness": stiffness, "seed": seed}
            assert same(collected, place, run)
            case = collected["cases"].to_dataset().sel(place)
            assert case.state == "finished"
            assert case.message == str(run.status)
            assert case.grain_steps == run.provenance["grain_steps"]
            assert case.version == ag.__version__
            assert case.folder == f"contact.stiffness_{stiffness:g}-seed_{seed}"
    assert collected["series"].contact_stiffness.attrs == {
        "units": "N/m", "long_name": collected["series"].contact_stiffness.attrs["long_name"], "key": "contact.stiffness",
    }  # fmt: skip
    assert collected["series"].seed.dtype == int
    assert collected.attrs["scene"] == scene_text(SCENE)
    save_results(tmp_path / "c.h5", {name: node.to_dataset() for name, node in collected.children.items()}, collected.attrs)
    back = ag.open(tmp_path / "c.h5")
    for name, node in collected.children.items():
        xr.testing.assert_equal(back[name].to_dataset(), node.to_dataset())


def test_processes_leave_the_same_and_what_is_finished_is_left_alone(made, tmp_path):
    told = []
    ag.sweep(SCENE, {"seed": range(1, 3)}, tmp_path / "p", workers=2, listen=told.append)
    assert told[-1] == (2, 2, 0, 1.0)
    a, b = (ag.collect_sweep(one)["series"].to_dataset() for one in (made, tmp_path / "p"))
    xr.testing.assert_identical(a.sel(contact_stiffness=1000.0, drop=True).load(), b)
    before = times_of(tmp_path / "p")
    with ThreadPoolExecutor(1) as closed:
        pass
    again = ag.sweep(SCENE, {"seed": [1, 2]}, tmp_path / "p", executor=closed)  # takes no case, and is asked for none
    assert times_of(tmp_path / "p") == before
    assert [one["state"] for one in again] == ["finished"] * 2


def test_values_can_be_added(folder, threads):
    before = times_of(folder)
    ag.sweep(SCENE, {"seed": [3, 2, 1], "contact.stiffness": (2e3, 1e3)}, folder, executor=threads)
    after = times_of(folder)
    changed_files = {path for path in before if after[path] != before[path]}
    assert changed_files == {Path("sweep.json")}
    added = {path.parts[0] for path in after} - {path.parts[0] for path in before}
    assert added == {"contact.stiffness_1000-seed_3", "contact.stiffness_2000-seed_3"}
    collected = ag.collect_sweep(folder)
    assert dict(collected["series"].sizes) == {"contact_stiffness": 2, "seed": 3, "sample": 30}
    assert same(collected, {"contact_stiffness": 2000.0, "seed": 3}, changed(SCENE, {"contact.stiffness": 2e3, "seed": 3}).run())
    assert same(collected, {"contact_stiffness": 1000.0, "seed": 1}, changed(SCENE, {"contact.stiffness": 1e3, "seed": 1}).run())


def test_added_values_leave_the_cases_their_names(folder, threads):
    """Names that are counted stay with their cases; new ones take what is free."""
    told = json.loads((folder / "sweep.json").read_text())
    names = {name: f"case-{k:04d}" for k, name in enumerate(told["cases"], start=1)}
    for name, other in names.items():
        (folder / name).rename(folder / other)
    cases = {names[name]: values for name, values in told["cases"].items()}
    (folder / "sweep.json").write_text(json.dumps({**told, "cases": cases}))
    before = times_of(folder)
    ag.sweep(SCENE, VARY | {"seed": [0, 1, 2]}, folder, executor=threads)
    assert {path for path, time in times_of(folder).items() if before.get(path, time) != time} == {Path("sweep.json")}
    after = json.loads((folder / "sweep.json").read_text())["cases"]
    assert {name: after[name] for name in cases} == cases
    assert set(after) - set(cases) == {"contact.stiffness_1000-seed_0", "contact.stiffness_2000-seed_0"}


def test_cases_whose_names_would_be_too_long_are_counted(tmp_path):
    vary = {"contact.stiffness": [1000.00000001, 2000.00000001], "inertial_number": [0.10000000001], "pressure": [1.00000000001]}
    assert list(taken_up(tmp_path, SCENE, vary).cases) == ["case-0001", "case-0002"]


def test_only_what_is_not_finished_is_run_again(folder, threads):
    """Killed and interrupted ones go on from their checkpoints, which are at the end; one whose folder is gone begins anew."""
    names = list(states(folder))
    set_state(folder / names[0], state="running")
    set_state(folder / names[1], state="interrupted", fraction=0.9)
    (folder / names[1] / "results.h5").unlink()
    shutil.rmtree(folder / names[2])
    assert list(states(folder).values()) == ["killed", "interrupted", "new", "finished"]
    collected = ag.collect_sweep(folder)
    assert collected["cases"].state.values.tolist() == [["killed", "interrupted"], ["new", "finished"]]
    finite = np.isfinite(collected["series"].stress_ratio).all("sample")
    assert finite.values.tolist() == [[False, False], [False, True]]
    assert np.isnan(collected["series"].stress_ratio[0]).all()
    before = times_of(folder)
    ag.sweep(SCENE, VARY, folder, executor=threads)
    after = times_of(folder)
    assert {path.parts[0] for path in after if after[path] != before.get(path)} == set(names[:3])
    assert set(states(folder).values()) == {"finished"}
    assert np.isfinite(ag.collect_sweep(folder)["series"].stress_ratio).all()


def test_a_failed_case_stops_no_other_and_is_named(tmp_path, threads):
    vary = {"pressure": [1e4, 1.0, 2.0]}
    with pytest.raises(RunFailed, match=r"1 of 3 cases .* with retry\): pressure_10000: failed, stopped at step") as failed:
        ag.sweep(SCENE, vary, tmp_path / "s", executor=threads)
    assert "\n" not in str(failed.value)
    assert list(states(tmp_path / "s").values()) == ["failed", "finished", "finished"]
    collected = ag.collect_sweep(tmp_path / "s")
    assert collected["cases"].state.sel(pressure_asked=1e4) == "failed"
    assert "overlaps a neighbour" in str(collected["cases"].message.sel(pressure_asked=1e4).values)
    assert np.isnan(collected["series"].pressure.sel(pressure_asked=1e4)).all()  # the quantity keeps its name, the key does not
    assert same(collected, {"pressure_asked": 2.0}, changed(SCENE, {"pressure": 2.0}).run())
    before = times_of(tmp_path / "s")
    with pytest.raises(RunFailed, match="pressure_10000: failed, stopped at step"):
        ag.sweep(SCENE, vary, tmp_path / "s", executor=threads)
    assert times_of(tmp_path / "s") == before
    with pytest.raises(RunFailed, match="pressure_10000: failed, stopped at step"):
        ag.sweep(SCENE, vary, tmp_path / "s", executor=threads, retry=True)
    assert {path.parts[0] for path, time in times_of(tmp_path / "s").items() if time != before.get(path)} == {"pressure_10000"}


def test_an_interrupt_is_heard_on_any_executor_and_the_sweep_goes_on(tmp_path, threads):
    """Threads hear no signals. The first case is long; it is at work when the listener is interrupted."""
    scene, vary = changed(SCENE, {"strain": 4.0}), {"seed": [1, 2, 3]}
    folder = tmp_path / "s"

    def stop(progress):
        if progress.fraction > 0.1:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted, match="0 of 3 cases are finished"):
        ag.sweep(scene, vary, folder, executor=threads, listen=stop)
    assert list(states(folder).values()) == ["interrupted", "new", "new"]
    assert not (folder / GO).exists()
    assert not (folder / "lock").exists()
    with pytest.raises(InputError, match="none of its 3 cases is finished"):
        ag.collect_sweep(folder)
    ag.sweep(scene, vary, folder, executor=threads)
    assert same(ag.collect_sweep(folder), {"seed": 1}, changed(scene, {"seed": 1}).run())


def test_a_worker_that_fails_in_a_way_nobody_foresaw_is_a_failed_case(folder, threads, monkeypatch):
    def broken(name):
        raise MemoryError("no more")

    monkeypatch.setattr("anisogran.sweeps.running.run_case", broken)
    set_state(folder / "contact.stiffness_1000-seed_1", state="interrupted")
    with pytest.raises(RunFailed, match="seed_1: interrupted, MemoryError: no more"):
        ag.sweep(SCENE, VARY, folder, executor=threads)


def test_shorter_cases_end_in_nan_and_none_is_labelled(tmp_path, threads):
    vary = {"area_fraction": [None, 0.8], "strain": [0.6, 0.8]}
    ag.sweep(SCENE, vary, tmp_path / "s", executor=threads)
    collected = ag.collect_sweep(tmp_path / "s")
    series = collected["series"]
    assert series.area_fraction_asked.values.tolist() == ["none", "0.8"]
    assert series.sizes["sample"] == 40
    counts = np.isfinite(series.time).sum("sample")
    assert counts.sel(strain_asked=0.6).values.tolist() == [30, 30]
    assert counts.sel(strain_asked=0.8).values.tolist() == [40, 40]
    run = changed(SCENE, {"area_fraction": 0.8, "strain": 0.6}).run()
    assert same(collected, {"area_fraction_asked": "0.8", "strain_asked": 0.6}, run)


def test_fields_are_joined_over_their_places():
    """Equal coordinates stay, others become variables over an index; text and whole numbers too; what only one case has is kept."""
    r = ("r", [1.0, 2.0], {"units": "m"})
    one = xr.Dataset({"v": (("i", "r"), [[1.0, 2.0], [3.0, 4.0]]), "n": ("r", [5, 6])}, {"r": r, "depth": ("r", [0.0, 1.0])})
    two = xr.Dataset({"v": (("r", "i"), [[7.0, 8.0], [9.0, 0.0]]), "only": ((), "x")}, {"r": r, "depth": ("r", [0.0, 3.0])})
    axes = {"seed": ("seed", [1, 2, 3])}
    one.attrs, two.attrs = {"on": "rings", "edges": [1, 2]}, {"on": "rings", "edges": [1, 3]}
    data = joined({0: one, 2: two}, [(0,), (1,), (2,)], (3,), axes)
    assert data.attrs == {"on": "rings"}
    assert data.v.dims == ("seed", "i", "r")
    np.testing.assert_array_equal(data.v.values, [[[1, 2], [3, 4]], np.full((2, 2), np.nan), [[7, 9], [8, 0]]])
    np.testing.assert_array_equal(data.n.values, [[5, 6], [np.nan] * 2, [np.nan] * 2])
    assert data.only.values.tolist() == ["", "", "x"]
    assert data.r.attrs == {"units": "m"}
    np.testing.assert_array_equal(data.depth.values, [[0, 1], [np.nan] * 2, [0, 3]])
    places = [(0,), (1,), (2,)]
    assert joined({0: one, 1: two, 2: one}, places, (3,), axes).attrs == {"on": "rings"}  # what differs in one case differs
    assert joined({0: one}, places, (3,), axes).attrs == one.attrs
    other = one.assign_coords(r=("r", [1.0, 2.0], {"units": "mm"}))  # the same numbers, not the same places
    assert joined({0: one, 1: other}, places, (3,), axes).r.dims == ("seed", "r_index")
    longer = two.drop_dims("r").assign(w=("r", [1.0, 2.0, 3.0])).assign_coords(r=[1.0, 2.0, 4.0])
    data = joined({0: one, 1: longer}, [(0,), (1,), (2,)], (3,), axes)
    assert data.w.dims == ("seed", "r_index")
    np.testing.assert_array_equal(data.r.values, [[1, 2, np.nan], [1, 2, 4], [np.nan] * 3])


def test_values_in_words():
    assert parsed_vary(["contact.kc=0, 5e4,1e5 N/m", "seed=1..3,7", "friction=none"]) == {
        "contact.kc": [0, 5e4, "1e5 N/m"], "seed": [1, 2, 3, 7], "friction": ["none"],
    }  # fmt: skip
    plain, scenes = case_scenes(SCENE, {"contact.stiffness": ["1e3 N/m", 2000], "friction": ["none"]})
    assert plain == {"contact.stiffness": [1000.0, 2000.0], "friction": [None]}
    assert scenes[2000.0, None] == changed(SCENE, {"contact.stiffness": 2e3, "friction": None})
    for seeds in (np.arange(2), [0.0, 1.0], [0, 1.0]):
        plain = case_scenes(SCENE, {"seed": seeds})[0]["seed"]
        assert plain == [0, 1]
        assert [type(seed) for seed in plain] == [int, int]  # as they are labelled


@pytest.mark.parametrize(("value", "text"), [(5e4, "50000"), (1e9, "1e9"), (1e-7, "1e-7"), (0.1 + 0.2, "0.30000000000000004"), (3, "3")])
def test_values_are_told_without_loss(value, text):
    assert text_of(value) == text
    assert float(text) == value


@pytest.mark.hard_case("S6")
def test_names_of_cases_are_safe_and_each_has_its_own():
    assert case_name({"contact.kc": 1e5, "seed": -1}, ()) == "contact.kc_100000-seed_-1"
    long = {f"contact.key{k}": 0.1 for k in range(9)}
    assert case_name(long, {"case-0001"}) == "case-0002"
    assert case_name({"a": 1}, {"a_1"}) == "case-0001"
    for name in ("../x", "a/b", "", ".x", "a b", "x" * 65, "a\n"):
        assert not NAME.fullmatch(name)


@pytest.mark.parametrize(
    ("texts", "message"),
    [
        (["seed"], "--vary seed: must be KEY=VALUES, such as"),
        (["=3"], "--vary =3: must be KEY=VALUES"),
        (["seed="], "--vary seed=: must be KEY=VALUES"),
        (["seed=1,,2"], "--vary seed=1,,2: a value is missing between two commas"),
        (["seed=6..1"], "--vary seed=6..1: 6..1 must rise, by less than 10000"),
        (["seed=1..99999999999"], "must rise, by less than 10000"),
        (["seed=1", "seed=2"], "--vary seed=2: seed is varied already"),
        (["seed=1,2,1"], "--vary seed: 1 is there twice"),
        (["contact.stiffness=1e3,1000 N/m"], "--vary contact.stiffness: 1000 is there twice"),
        (["contact.stifness=1"], "--vary contact.stifness: [contact] unknown key 'stifness', did you mean 'stiffness'?"),
        (["sed=1"], "--vary sed: unknown key 'sed', did you mean 'seed'?"),
        (["seed=1.5"], "--vary seed: seed = 1.5 is not a whole number"),
        (["pressure=1,-1"], "--vary pressure: pressure = -1 must be above 0 N/m"),
        (["pressure=1 Pa"], "--vary pressure: pressure = '1 Pa' must have the unit N/m"),
        (["pressure=none"], "--vary pressure: pressure = 'none' is not a number"),
        (["friction=0.5"], "--vary friction: friction = 0.5 must be a table"),
        (["contact={stiffness=3}"], "--vary contact: is a table; vary one of its keys, contact.law, contact.stiffness, contact.damping"),
        (["friction=none", "friction.mu=0.1"], "--vary friction: friction.mu lies in it; vary one of them"),
        (["strain=0.6,2", "discard=0.05,1"], "--vary strain=0.6 --vary discard=1: strain = 0.6 must be at least discard + 0.5 = 1.5"),
        (["seed=1..200", "pressure=1..200"], "--vary seed pressure: 40000 cases, at most 10000 are taken"),
        (["kind=biaxial"], "--vary kind: kind cannot be changed, it is simple_shear"),
        (["contact.law=luding"], "--vary contact.law=luding: [contact] k1 is missing"),
    ],
)
def test_what_cannot_be_varied_is_one_line(texts, message, tmp_path):
    with pytest.raises(InputError) as refused:
        ag.sweep(SCENE, parsed_vary(texts), tmp_path / "s")
    assert message in str(refused.value)
    assert "\n" not in str(refused.value)
    assert not (tmp_path / "s").exists()


@pytest.mark.parametrize("vary", [{}, None, "seed=1", {"seed": "12"}, {"seed": 3}, {"seed": []}, {"seed": [{}]}, {1: [2]}])
def test_what_is_no_dict_of_values_is_refused(vary, tmp_path):
    with pytest.raises(InputError):
        ag.sweep(SCENE, vary, tmp_path / "s")


@pytest.mark.parametrize("scene", ["s.toml", SimpleShear, None])
def test_what_is_no_experiment_is_refused(scene, tmp_path):
    with pytest.raises(InputError, match=r"scene = .* must be an experiment, such as Biaxial\(pressure=100.0\) or read_scene\(file\)"):
        ag.sweep(scene, VARY, tmp_path / "s")


@pytest.mark.parametrize(
    ("scene", "vary", "message"),
    [
        (SCENE, {"seed": [1, 2]}, "is a sweep of contact.stiffness, seed, not of seed"),
        (SCENE, VARY | {"pressure": [1.0]}, "is a sweep of contact.stiffness, seed, not of contact.stiffness, seed, pressure"),
        (SCENE, VARY | {"seed": [2, 3]}, "has seed = 1; values can be added to a sweep, not left out"),
        (changed(SCENE, {"pressure": 2.0}), VARY, "is a sweep of another scene: pressure = 2.0, in the file 1.0"),
        (changed(SCENE, {"friction": None}), VARY, "is a sweep of another scene: friction = None"),
    ],
)
def test_another_sweep_in_the_folder_is_refused_by_key(scene, vary, message, folder):
    before = times_of(folder)
    with pytest.raises(InputError) as refused:
        ag.sweep(scene, vary, folder)
    assert message in str(refused.value)
    assert times_of(folder) == before
    other = changed(SCENE, {"seed": 5, "contact.stiffness": 7.0})  # what is varied may be anything in the scene itself
    assert len(ag.sweep(other, VARY, folder)) == 4


def test_folders_that_cannot_be_used_are_one_line(folder, tmp_path):
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "notes.txt").write_text("mine")
    with pytest.raises(InputError, match="is neither empty nor a sweep"):
        ag.sweep(SCENE, VARY, tmp_path / "full")
    for use in (ag.sweep_status, ag.collect_sweep):
        with pytest.raises(InputError, match=r"full: is no sweep, it has no sweep\.json"):
            use(tmp_path / "full")
    with locked(folder), pytest.raises(InputError, match=r"process .* is at work there"):
        ag.sweep(SCENE, VARY, folder)
    case = folder / "contact.stiffness_1000-seed_1"
    scene = (case / "scene.toml").read_text()
    (case / "scene.toml").write_text(scene.replace("pressure = 1.0", "pressure = 3.0"))
    with pytest.raises(InputError, match=r"seed_1/scene.toml: is not the scene of this case: pressure = 1.0, in the file 3.0"):
        ag.sweep(SCENE, VARY, folder)
    (case / "scene.toml").write_text(scene)
    (case / "results.h5").write_bytes(b"nonsense")
    with pytest.raises(InputError, match=r"seed_1/results.h5: "):
        ag.collect_sweep(folder)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda told: "[]", "damaged"),
        (lambda told: "nonsense", "damaged"),
        (lambda told: json.dumps({**told, "scene": "kind = 1"}), "kind"),
        (lambda told: json.dumps({**told, "scene": 3}), "damaged"),
        (lambda told: json.dumps({**told, "cases": {"../../x": [1000.0, 1]}}), "'../../x' is no name of a case"),
        (lambda told: json.dumps({**told, "cases": {"a": [1000.0, 1]}}), "its cases are not those of what is varied"),
        (lambda told: json.dumps({**told, "vary": {"seed": [1, -1]}}), "seed = -1 must be at least 0"),
        (lambda told: json.dumps({**told, "vary": [1]}), "damaged"),
        (lambda told: "[" * 100_000, "damaged"),
    ],
)
def test_a_damaged_list_of_cases_is_one_line(change, message, folder):
    path = folder / "sweep.json"
    path.write_text(change(json.loads(path.read_text())))
    with pytest.raises(InputError) as refused:
        ag.sweep_status(folder)
    assert message in str(refused.value)
    assert str(refused.value).startswith(f"{path}: ")
    assert "\n" not in str(refused.value)


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8) | st.sampled_from(["seed", "none", "contact.law"]),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from(["seed", "scene", "vary", "cases", "a", ""]), inner),
    max_leaves=8,
)


@pytest.mark.hard_case("S10")
@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(place=st.sampled_from(["scene", "vary", "cases", "all"]), value=JSON, cut=st.integers(0, 600))
def test_whatever_a_list_of_cases_holds_only_an_input_error_comes_out(place, value, cut, folder):
    path = folder / "sweep.json"
    good = folder.parent / "good.json"
    if not good.exists():
        shutil.copy(path, good)
    told = json.loads(good.read_text())
    path.write_text(json.dumps(value if place == "all" else {**told, place: value})[: cut if place == "cases" else None])
    with contextlib.suppress(InputError):
        ag.sweep_status(folder)


def test_a_sweep_that_was_killed_at_once_can_be_begun_again(tmp_path, threads):
    for name in ("lock", "sweep.json.tmp"):
        (tmp_path / name).touch()
    assert len(ag.sweep(SCENE, {"seed": [1]}, tmp_path, executor=threads)) == 1


def test_a_look_at_a_folder_turns_no_run_away(tmp_path):
    """Whoever asks whether a folder is locked has its lock for a moment."""
    file = (tmp_path / "lock").open("a+")
    _take(file)
    looked = threading.Timer(0.03, file.close)
    looked.start()
    with locked(tmp_path):
        looked.join()


def test_workers_must_be_possible(monkeypatch):
    for workers in (0, 1.5, "two", 10**6):
        with pytest.raises(InputError, match="workers"):
            check_workers(workers, [])
    monkeypatch.setattr("anisogran.sweeps.running.free_memory", lambda: 1e9)
    check_workers(2, [SCENE] * 5)
    with pytest.raises(InputError, match=r"workers = 3 take about 0.9 GB of memory, more than 80% of the 1.0 GB that are free"):
        check_workers(3, [SCENE] * 5)
