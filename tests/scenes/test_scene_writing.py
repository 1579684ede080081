"""Scenes as text: what is written is read back, templates say everything, and the schema agrees with the reader."""

import tomllib

import numpy as np
import pytest
from hypothesis import HealthCheck, given, reject, settings
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

from anisogran import Biaxial, Friction, Linear, Luding, RingShear, SimpleShear
from anisogran.experiments import KINDS, experiment_of, read_scene
from anisogran.outcome import InputError
from anisogran.scenes import doubts_of, scene_schema, scene_template, scene_text
from anisogran.scenes.keys import keys_of


def numbers(one):
    """Strategy for the values of a Key that is no table."""
    if one.words:
        return st.sampled_from(one.words)
    if one.whole:
        values = st.integers(one.at_least, one.at_most)
    else:
        low = one.above if one.at_least is None else one.at_least
        high = one.below if one.at_most is None else one.at_most
        values = st.floats(
            low, high, exclude_min=one.above is not None, exclude_max=one.below is not None, allow_nan=False, allow_infinity=False
        )
    return st.one_of(st.none(), values) if one.optional else values


def records(record):
    """Strategy for records of a class; those whose keys do not fit each other are passed over."""

    def build(values):
        try:
            return record(**values)
        except InputError:
            reject()

    keys = {name: values_of(one) for name, one in keys_of(record).items()}
    if record in KINDS.values():  # all at random would rarely fit: what is not drawn is the default
        return st.fixed_dictionaries({}, optional=keys).map(build)
    return st.fixed_dictionaries(keys).map(build)


def values_of(one):
    """Strategy for the values of a Key."""
    if not one.records:
        return numbers(one)
    return st.one_of(*[st.none()] * one.optional, *map(records, one.records))


@pytest.mark.parametrize("kind", KINDS)
def test_a_scene_is_read_back_from_its_text(kind, tmp_path):
    path = tmp_path / "scene.toml"
    validator = Draft202012Validator(scene_schema(KINDS[kind]))

    @settings(max_examples=60, deadline=None, database=None, suppress_health_check=list(HealthCheck))
    @given(records(KINDS[kind]))
    def check(scene):
        text = scene_text(scene)
        path.write_text(text)
        assert read_scene(path) == scene
        assert validator.is_valid(tomllib.loads(text))

    check()


def test_the_text_of_a_scene():
    scene = RingShear(friction=None, contact=Luding(1.0, 2.0), seed=3)
    lines = scene_text(scene).splitlines()
    assert lines[:2] == ['kind = "ring_shear"', 'friction = "none"']
    assert {"pressure = 1.0              # N/m", "seed = 3"} < set(lines)
    assert lines[lines.index("[contact]") + 1 :] == [
        'law = "luding"',
        "k1 = 1.0                    # N/m",
        "k2 = 2.0                    # N/m",
        "kc = 0.0                    # N/m",
        "damping = 0.0               # kg/s",
    ]
    assert "none" not in scene_text(Biaxial())  # what is off by default is left out


@pytest.mark.parametrize("kind", KINDS)
def test_a_template_is_the_default_scene_with_every_key_explained(kind, tmp_path):
    path, text = tmp_path / "scene.toml", scene_template(KINDS[kind])
    path.write_text(text)
    assert read_scene(path) == KINDS[kind]()
    small = read_scene(path, quick=True)
    assert small.n < KINDS[kind]().n
    assert KINDS[kind](**(vars(KINDS[kind]()) | KINDS[kind].quick)) == small
    assert Draft202012Validator(scene_schema(KINDS[kind])).is_valid(tomllib.loads(text))
    for name, one in keys_of(KINDS[kind]).items():
        inner = [part for record in one.records for part in keys_of(record).items()]
        for key, part in inner or [(name, one)]:
            about = "; ".join(words for words in (part.suffix, part.range) if words)
            assert any(
                line.lstrip("# ").startswith(f"{key} = ") and line.endswith(f"# {part.meaning} [{about}]") for line in text.splitlines()
            )
    path.write_text(scene_template(KINDS[kind], quick=False))
    assert read_scene(path) == KINDS[kind]()
    assert "quick" not in tomllib.loads(path.read_text())


@pytest.mark.parametrize("kind", KINDS)
def test_what_a_template_shows_as_a_comment_is_right_too(kind, tmp_path):
    """With the mark of the comment taken away, and "rate" and "inertial_number", "linear" and "luding", not both."""
    path = tmp_path / "scene.toml"
    text = scene_template(KINDS[kind], quick=False)
    for name in ("rate", "area_fraction", "plastic_depth", "mu_dynamic"):
        text = text.replace(f"\n# {name} =", f"\n{name} =")
    if "\nrate =" in text:
        text = text.replace("\ninertial_number =", "\n# inertial_number =")
    blocks = text.split("\n\n")
    uncommented = [
        block.replace("# [friction]", "[friction]").replace("\n# ", "\n") if block.startswith("# [friction]") else block for block in blocks
    ]
    path.write_text("\n\n".join(uncommented))
    scene = read_scene(path)
    assert scene.friction is not None
    assert type(scene.contact) is type(KINDS[kind]().contact)
    (contact,) = (block for block in uncommented if block.startswith("[contact]"))
    other = "[contact]\n" + contact.split("\n# or\n")[1].replace("# # ", "#").replace("# law", "law").replace("\n# ", "\n")
    path.write_text(path.read_text().replace(contact, other))
    assert {type(read_scene(path).contact), type(scene.contact)} == {Linear, Luding}


def test_an_unknown_kind_is_refused():
    with pytest.raises(InputError, match=f"kind = 'ring' must be one of {', '.join(KINDS)}; did you mean 'ring_shear'"):
        experiment_of("ring")


@pytest.mark.parametrize("kind", KINDS)
def test_a_schema_explains_every_key(kind):
    schema = scene_schema(KINDS[kind])
    Draft202012Validator.check_schema(schema)
    assert schema["properties"]["kind"] == {"const": kind}
    assert schema["properties"]["density"]["unit"] == "kg/m3"
    assert schema["properties"]["density"]["anyOf"][0] == {"type": "number", "exclusiveMinimum": 0}
    for name in keys_of(KINDS[kind]):
        assert schema["properties"][name]["description"]
        assert name in schema["properties"]["quick"]["properties"]
    laws = {form["properties"]["law"]["const"]: form for form in schema["properties"]["contact"]["anyOf"]}
    assert laws["luding"]["required"] == ["law", "k1", "k2"]
    assert laws["luding"]["additionalProperties"] is False


def test_a_schema_takes_units_and_none_where_the_reader_does():
    check = Draft202012Validator(scene_schema(KINDS["simple_shear"])).is_valid
    scene = {"kind": "simple_shear", "inertial_number": "none", "rate": "0.1 1/s", "friction": "none", "quick": {"friction": {"mu": 0.1}}}
    assert check(scene)
    for key, value in (
        ("rate", "0.1 s"),
        ("pressure", "none"),
        ("contact", "none"),
        ("quick", {"grain": 3}),
        ("n", 50.5),
        ("seed", True),
    ):
        assert not check(scene | {key: value})


def test_whatever_numbers_a_record_was_made_of_are_plain_in_its_text(tmp_path):
    path = tmp_path / "scene.toml"
    for number in (np.float64(1e5), np.int64(100_000), 100_000):
        path.write_text(scene_text(Biaxial(contact=Linear(number), n=np.int64(50), pressure=np.float64(2.0))))
        assert "stiffness = 100000.0 " in path.read_text()
        assert read_scene(path) == Biaxial(contact=Linear(1e5), n=50, pressure=2.0)


@pytest.mark.hard_case("F11")
def test_doubts():
    assert doubts_of(Biaxial()) == doubts_of(RingShear()) == doubts_of(SimpleShear()) == []
    assert doubts_of(Biaxial(pressure=0.005)) == [  # 5e4/0.005 = 1e7 is just usual, 2e7 is not
        "contact.k2 = 100000 N/m is 2e+07 times the pressure of 0.005 N/m, not 100 to 1e+07 times: mm for m, or g for kg, in one of them?"
    ]
    soft = doubts_of(Biaxial(pressure=1e3, friction=Friction(10.0, 0.5)))  # k2 = 1e5 N/m is just stiff enough
    assert [doubt.split(" is ")[0] for doubt in soft] == ["contact.k1 = 50000 N/m", "friction.stiffness = 10 N/m"]
    assert doubts_of(Biaxial(density=2.0)) == ["density = 2 kg/m3 is not in 100 to 20000 kg/m3: given in g/cm3 or g/mm3?"]
    assert doubts_of(Biaxial(mean_radius=0.2)) == []
    assert doubts_of(Biaxial(mean_radius=0.5)) == ["mean_radius = 0.5 m: a radius not in 1e-06 to 0.2 m: given in mm or um?"]
    assert doubts_of(SimpleShear(mean_diameter=1.5e-6, density=100.0)) == [
        "mean_diameter = 1.5e-06 m: a radius not in 1e-06 to 0.2 m: given in mm or um?"
    ]
    # kc may be anything: it is no stiffness that must be there
    assert doubts_of(Biaxial(contact=Luding(5e4, 1e5, 1e-3))) == []
    # density 1 alone is not reduced units
    assert len(doubts_of(Biaxial(density=1.0))) == 1
    assert len(doubts_of(SimpleShear(density=2.0))) == 2  # nor is a mean diameter of 1 m
