"""What every experiment of the list owes: a new one is asked all of it."""

import math
import re

import pytest

from anisogran.experiments import KINDS
from anisogran.outcome import InputError, Interrupted, RunFailed
from anisogran.runs.folder import run_in_folder
from anisogran.scenes import changed, doubts_of
from anisogran.scenes.keys import keys_of
from hard_case_page import NOT_ASKED

every_kind = pytest.mark.parametrize("kind", KINDS)


def quick(kind, **more):
    return KINDS[kind](**KINDS[kind].quick | more)


def numbers(kind):
    """The keys of the experiment itself that hold numbers."""
    return {name: one for name, one in keys_of(KINDS[kind]).items() if not one.records and not one.words}


@pytest.mark.hard_case("D11")
@every_kind
def test_no_grain_is_refused(kind, answer):
    with pytest.raises(InputError, match="n = 0 must be at least") as caught:
        quick(kind, n=0)
    answer.refused(caught)


@pytest.mark.hard_case("D5")
@every_kind
def test_a_number_below_its_bound_is_refused(kind, answer):
    for name, one in numbers(kind).items():
        below = one.above if one.above is not None else one.at_least - 1
        with pytest.raises(InputError, match=rf"^{KINDS[kind].__name__}: {name} = \S+ must be (above|at least) ") as caught:
            quick(kind, **{name: below})
    answer.refused(caught)
    answer.named(f"so are all {len(numbers(kind))} numbers")


@pytest.mark.hard_case("D7")
@every_kind
def test_what_is_not_finite_is_refused(kind, answer):
    for name in numbers(kind):
        for value in (math.nan, math.inf, -math.inf):
            with pytest.raises(InputError, match=f"^{KINDS[kind].__name__}: {name} = {value} must be a finite number") as caught:
                quick(kind, **{name: value})
    answer.refused(caught)
    answer.named(f"so are all {len(numbers(kind))} numbers")


@pytest.mark.hard_case("D16")
@pytest.mark.parametrize("kind", [kind for kind in KINDS if ("D16", kind) not in NOT_ASKED])
def test_nothing_is_measured_before_equilibrium(kind, answer, rng):
    """The stage before the first that records has a gate, and grains that fly about do not pass it."""
    stages = quick(kind).stages()
    first = next(k for k, stage in enumerate(stages) if stage.look is not None)
    relax = stages[first - 1]
    assert relax.gate is not None
    loose = stages[0].begin(None)
    flying = loose.next_stage(loose.boundary, velocity=rng.normal(0.0, 1.0, loose.velocity.shape))
    with pytest.raises(RunFailed, match=f"stage {relax.name}: no equilibrium after {relax.marks[-1]} steps: ") as caught:
        relax.is_over(flying, len(relax.marks))
    answer.named(caught)


@pytest.mark.hard_case("D24")
@every_kind
def test_effects_are_told_whether_active_or_absent(kind, answer):
    """Every effect is in one of the lists, and what is absent holds no memory."""
    simulation = quick(kind).stages()[0].begin(None)
    active, absent = simulation.active_effects()
    active = [text.split(":")[0] for text in active]
    assert {"normal", "friction", "rolling", "gravity", "wall_friction", "drag"} == {*active, *absent}
    assert ("friction" in absent) == (simulation._state.memory.spring is None)
    answer.named(f"first stage: {', '.join(active)}; absent: {', '.join(absent)}")


@pytest.mark.hard_case("F5")
@every_kind
def test_an_edited_scene_is_not_resumed(kind, answer, tmp_path):
    def leave(session):
        raise KeyboardInterrupt

    scene = quick(kind, seed=3)
    with pytest.raises(Interrupted):
        run_in_folder(scene, tmp_path, listen=leave)
    with pytest.raises(InputError, match=re.escape("checkpoint.npz: is of another scene: seed = 4, in the file 3") + "$") as caught:
        run_in_folder(changed(scene, {"seed": 4}), tmp_path, resume=True)
    answer.refused(caught)


@pytest.mark.hard_case("F11")
@every_kind
def test_a_mistaken_unit_is_doubted(kind, answer):
    """Lengths in mm, densities in g/mm3 or t/m3: each alone is told of, and the default scene is not."""
    scene = KINDS[kind]()
    assert doubts_of(scene) == []
    lengths = [name for name, one in numbers(kind).items() if one.unit == "m" and getattr(scene, name) is not None]
    for mistake in ({name: 1e3 * getattr(scene, name) for name in lengths}, {"density": 1e-3 * scene.density}):
        doubts = doubts_of(changed(scene, mistake))
        assert doubts
        answer.named(f"warned: {doubts[-1]}")
