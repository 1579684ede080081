"""Scene files: what they may say, what takes precedence, and the one line for each mistake."""

import math
import time
import tomllib

import pytest
from jsonschema import Draft202012Validator

from anisogran import Biaxial, Friction, Linear, Luding, RingShear, SimpleShear, Tablet
from anisogran.experiments import KINDS, read_scene
from anisogran.keys import REQUIRED
from anisogran.outcome import InputError
from anisogran.scenes import changed, scene_schema, scene_text
from anisogran.scenes.keys import keys_of, name_of

LUDING = '[contact]\nlaw = "luding"\nk1 = 1e4\nk2 = 5e4\n'
SCENE = f'kind = "biaxial"\npressure = 50\n{LUDING}'
SIZES = "[quick]\nn = 50\n[quick.contact]\nk2 = 2e4\n"


@pytest.fixture
def scene(tmp_path):
    """Reads a text as a scene file of the name scene.toml."""
    path = tmp_path / "scene.toml"

    def read(text, *overrides, **options):
        path.write_text(text)
        return read_scene(path, overrides, **options)

    return read


@pytest.fixture
def complaint(scene, tmp_path):
    """The one line that a text is refused with, the folder left out."""

    def refuse(text, *overrides, **options):
        with pytest.raises(InputError) as caught:
            scene(text, *overrides, **options)
        line = str(caught.value)
        assert "\n" not in line
        return line.replace(f"{tmp_path}/", "")

    return refuse


def test_what_a_file_leaves_out_is_the_default(scene):
    assert scene('kind = "biaxial"') == Biaxial()
    assert scene('kind = "ring_shear"\nn = 700') == RingShear(n=700)
    assert scene(SCENE) == Biaxial(pressure=50.0, contact=Luding(k1=1e4, k2=5e4))


def test_a_table_stands_for_itself(scene):
    """It takes nothing from the default of the experiment, whose damping is 4 and whose mu is 0.44."""
    linear = 'kind = "ring_shear"\n[contact]\nlaw = "linear"\nstiffness = 500\n[friction]\nstiffness = 100\nmu = 0.3\n'
    assert scene(linear) == RingShear(contact=Linear(500.0), friction=Friction(100.0, 0.3))


def test_none_switches_off(scene):
    assert scene('kind = "ring_shear"\nfriction = "none"').friction is None
    assert scene('kind = "simple_shear"\ninertial_number = "none"\nrate = 0.2') == SimpleShear(rate=0.2)
    assert scene(SCENE + 'plastic_depth = "none"\n') == scene(SCENE)
    for override in ("friction=none", " friction = none "):
        assert scene('kind = "ring_shear"', override).friction is None


def test_numbers_may_bring_their_unit(scene):
    said = scene('kind = "biaxial"\npressure = "50 N/m"\n[contact]\nlaw = "luding"\nk1 = "1e4N/m"\nk2 = " 5.e+4  N/m "')
    assert said == scene(SCENE)


@pytest.mark.hard_case("F11")
@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('k1 = "1e5 N/mm"', "k1 = '1e5 N/mm' must have the unit N/m, or none and no quotes"),
        ('k1 = "1e5 n/m"', "k1 = '1e5 n/m' must have the unit N/m, or none and no quotes"),
        ('k1 = "5 % N/m"', "k1 = '5 % N/m' must have the unit N/m, or none and no quotes"),
        ('k1 = "1 µN/m"', "k1 = '1 µN/m' must have the unit N/m, or none and no quotes"),
        ('k1 = "1e5"', "k1 = '1e5' must have the unit N/m, or none and no quotes"),
        ('k1 = "nan N/m"', "k1 = 'nan N/m' is not a number"),
        ('k1 = "-1 N/m"', "k1 = -1 must be above 0 N/m"),
        ('k1 = "1e400 N/m"', "k1 = inf must be a finite number"),
        ('k1 = "١ N/m"', "k1 = '١ N/m' is not a number"),
        ('plastic_depth = "0.1"', "plastic_depth = '0.1' must be a number without quotes or unit"),
        ('plastic_depth = "0.1 m"', "plastic_depth = '0.1 m' must be a number without quotes or unit"),
    ],
)
def test_no_other_unit_is_taken(text, words, complaint):
    assert complaint(f'kind = "biaxial"\n[contact]\nlaw = "luding"\n{text}') == f"scene.toml: [contact] {words}"


def test_quick_replaces_keys(scene):
    assert scene(SCENE + SIZES) == scene(SCENE)
    assert scene(SCENE + SIZES, quick=True) == Biaxial(pressure=50.0, n=50, contact=Luding(k1=1e4, k2=2e4))
    # another law begins anew; a table that the file lacks starts from the default
    other = '[quick.contact]\nlaw = "linear"\nstiffness = 3e4\n'
    assert scene(SCENE + other, quick=True).contact == Linear(3e4)
    assert scene('kind = "ring_shear"\n[quick.friction]\nmu = 0.1\n', quick=True).friction == Friction(500.0, 0.1)


def test_overrides_come_last(scene):
    assert scene(SCENE + SIZES, "n=60", "contact.kc=1e5", quick=True) == Biaxial(
        pressure=50.0, n=60, contact=Luding(k1=1e4, k2=2e4, kc=1e5)
    )
    assert scene(SCENE, "contact.k1=1e3 N/m", " contact.k1 = 2e3 ").contact.k1 == 2e3
    assert scene(SCENE, "contact.law=linear", "contact.stiffness=1e5").contact == Linear(1e5)
    assert scene(SCENE, 'contact={law = "linear", stiffness = 1e5}').contact == Linear(1e5)
    assert scene(SCENE, "friction.mu=0.5", "friction.stiffness=1e3").friction == Friction(1e3, 0.5)
    # what the file lacks starts from the default, 5e4 and 1e5 N/m; what it has does not
    assert scene('kind = "biaxial"', "contact.kc=1e5").contact == Luding(5e4, 1e5, 1e5, 0.1)
    assert scene(SCENE, "contact.kc=1e5").contact == Luding(1e4, 5e4, 1e5)


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("seed", "--set seed: must be KEY=VALUE, such as contact.kc=1e5"),
        ("\n", "--set: must be KEY=VALUE, such as contact.kc=1e5"),
        ("=3", "--set =3: must be KEY=VALUE, such as contact.kc=1e5"),
        ("sed=3", "--set sed=3: unknown key 'sed', did you mean 'seed'? biaxial has pressure"),
        ("seed=-3", "--set seed=-3: seed = -3 must be at least 0"),
        ("seed=3.5", "--set seed=3.5: seed = 3.5 is not a whole number"),
        ("seed=1\nkind=2", "--set seed=1 kind=2: seed = '1\\nkind=2' must be a number without quotes or unit"),
        ("seed.x=1", "--set seed.x=1: seed must be a number, not a table"),
        ("contact.k1.x=1", "--set contact.k1.x=1: [contact] k1 must be a number, not a table"),
        ("contact.kk=1", "--set contact.kk=1: [contact] unknown key 'kk', did you mean 'kc'? luding has k1, k2, kc"),
        ("contact=none", "--set contact=none: contact = 'none' must be a table, [contact]"),
        ("contact.k2=5", "scene.toml with --set contact.k2=5: [contact] k2 = 5 must be at least 10000 N/m (= k1)"),
        ("friction.mu=0.5", "scene.toml with --set friction.mu=0.5: [friction] stiffness is missing; friction has stiffness, mu"),
        ("kind=ring_shear", "--set kind=ring_shear: kind cannot be changed, it is biaxial"),
        ("quick.n=50", "--set quick.n=50: quick is a table of scene files, which the option --quick takes"),
        ("n=", "--set n=: must be KEY=VALUE"),
        ("k1=3", "--set k1=3: unknown key 'k1', did you mean contact.k1? biaxial has pressure"),
        ("damping=3", "--set damping=3: unknown key 'damping', did you mean contact.damping or friction.damping? biaxial has"),
        ("contact.seed=3", "--set contact.seed=3: [contact] unknown key 'seed', did you mean seed above all tables? luding has k1"),
        ("contact.mu=3", "--set contact.mu=3: [contact] unknown key 'mu', did you mean friction.mu? luding has k1"),
        ("contact.KC=3", "--set contact.KC=3: [contact] unknown key 'KC', did you mean 'kc'? luding has k1"),
        ("pressure=1,5", "--set pressure=1,5: pressure = '1,5' is not a number"),
        ("seed=1..6", "--set seed=1..6: seed = '1..6' is not a number"),
        ("strain=5%", "--set strain=5%: strain = '5%' must be a number without quotes or unit"),
    ],
)
def test_a_bad_override_is_one_line(override, words, complaint):
    assert complaint(SCENE, override).startswith(words)


def test_a_bad_quick_table_is_told_of_even_if_it_is_not_wanted(complaint):
    for quick in (False, True):
        assert complaint(SCENE + "[quick]\nsead = 50", quick=quick).startswith(
            "scene.toml: [quick] unknown key 'sead', did you mean 'seed'?"
        )
        assert complaint(SCENE + "[quick]\nn = 5", quick=quick) == "scene.toml: [quick] n = 5 must be at least 20"
        assert complaint(SCENE + "[quick.contact]\nk1 = -1", quick=quick) == "scene.toml: [quick.contact] k1 = -1 must be above 0 N/m"
        assert complaint(SCENE + "[quick.contact]\nk2 = 1.0", quick=quick) == (
            "scene.toml with [quick]: [contact] k2 = 1 must be at least 10000 N/m (= k1)"
        )
        assert complaint("quick = 3\n" + SCENE, quick=quick) == "scene.toml: quick = 3 must be a table, [quick]"
        assert complaint(SCENE + "[quick.quick]\nn = 5", quick=quick).startswith("scene.toml: [quick] quick is a table of scene files")
    assert complaint(SCENE, quick=True) == "scene.toml: has no table [quick]"


def test_tables_in_python():
    """A dict is the law that has all its keys; a record replaces another, and None what is optional."""
    assert Biaxial(contact={"k1": 1e4, "k2": 5e4, "damping": 0.1}).contact == Luding(1e4, 5e4, damping=0.1)
    assert Biaxial(contact={"stiffness": 1e4, "damping": 0.1}).contact == Linear(1e4, 0.1)
    for contact in (Linear(1e5), Luding(1e4, 5e4)):
        assert changed(RingShear(), {"contact": contact, "friction": None}) == RingShear(contact=contact, friction=None)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Friction(1e4, None), "Friction: mu = None is not a number"),
        (lambda: Biaxial(pressure=None), "Biaxial: pressure = None is not a number"),
        (lambda: Biaxial(contact=None), "Biaxial: contact = None must be Linear or Luding"),
    ],
)
def test_nothing_is_no_value_of_what_must_be_there(make, words):
    with pytest.raises(InputError) as caught:
        make()
    assert str(caught.value) == words


ALL = ", ".join(KINDS)
MISTAKES = [
    ("", f"kind is missing; it must be one of {ALL}"),
    ('kind = "biaxal"', f"kind = 'biaxal' must be one of {ALL}; did you mean 'biaxial'?"),
    ("kind = 3", f"kind = 3 must be one of {ALL}"),
    ('kind = "biaxial"\npresure = 1', "unknown key 'presure', did you mean 'pressure'? biaxial has pressure, contact, friction"),
    ('kind = "biaxial"\nquik = 1', "unknown key 'quik', did you mean 'quick'?"),
    ('kind = "biaxial"\n"pres\\nsure" = 1', "unknown key 'pres\\nsure', did you mean 'pressure'?"),
    ('kind = "biaxial"\ncontact = 3', "contact = 3 must be a table, [contact]"),
    ('kind = "biaxial"\nfriction = false', 'friction = False must be a table, [friction], or "none"'),
    ('kind = "biaxial"\n[[friction]]\nmu = 1', "friction = [{'mu': 1}] must be a table, [friction], or \"none\""),
    ('kind = "biaxial"\n[pressure]\nmu = 1', "pressure must be a number, not a table"),
    ('kind = "biaxial"\n[contact]\nk1 = 1', "[contact] law is missing; it must be one of linear, luding"),
    ('kind = "biaxial"\n[contact]\nlaw = "ludin"', "[contact] law = 'ludin' must be one of linear, luding; did you mean 'luding'?"),
    ('kind = "biaxial"\n[contact]\nlaw = ["luding"]', "[contact] law = ['luding'] must be one of linear, luding"),
    ('kind = "biaxial"\n[contact]\nlaw = "luding"\nk1 = 1', "[contact] k2 is missing; luding has k1, k2, kc, damping, plastic_depth"),
    (f'kind = "biaxial"\n{LUDING}kk = 1', "[contact] unknown key 'kk', did you mean 'kc'? luding has k1, k2, kc, damping, plastic_depth"),
    (f'kind = "biaxial"\n{LUDING}[contact.kc]', "[contact] kc must be a number, not a table"),
    ('kind = "biaxial"\n[friction]\nlaw = "friction"', "[friction] unknown key 'law', did you mean"),
    ('kind = "biaxial"\npressure = "none"', "pressure = 'none' is not a number"),
    (f'kind = "biaxial"\npressure = "{"x" * 900_000}"', f"pressure = '{'x' * 59}... is not a number"),
]


@pytest.mark.parametrize(("text", "words"), MISTAKES, ids=range(len(MISTAKES)))
def test_a_mistake_is_one_line_and_the_schema_knows_it(text, words, complaint):
    assert complaint(text).startswith(f"scene.toml: {words}")
    assert not Draft202012Validator(scene_schema(KINDS["biaxial"])).is_valid(tomllib.loads(text))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('kind = "biaxial"\n[contact]\nlaw = "luding"\nk1 = 2\nk2 = 1', "[contact] k2 = 1 must be at least 2 N/m (= k1)"),
        (
            'kind = "biaxial"\n[friction]\nstiffness = 1\nmu = 0.1\nmu_dynamic = 0.2',
            "[friction] mu_dynamic = 0.2 must be at most 0.1",
        ),
        ('kind = "simple_shear"\nrate = 1\ninertial_number = 0.1', "inertial_number = 0.1 and rate = 1 1/s: give one of them"),
        ('kind = "ring_shear"\ntravel = 10', "travel = 10 must be at least discard + block = 20 + 20, or there is nothing to average"),
        ('kind = "ring_shear"\ninner_radius = 1e9\nmean_diameter = 1e9', "inner_radius = 1e+09 m must be at least two mean diameters"),
    ],
)
def test_keys_that_do_not_fit_each_other(text, words, complaint):
    assert complaint(text).startswith(f"scene.toml: {words}")


def plain_table(record):
    """{key: value} of a contact law, from examples where there is no default."""
    values = {name: one.example if one.default is REQUIRED else one.default for name, one in keys_of(record).items()}
    return {name: value for name, value in values.items() if value is not None}


def places():
    """(kind, table or None, law or None, key, Key) of every number that any scene file may hold."""
    for kind, experiment in KINDS.items():
        for name, one in keys_of(experiment).items():
            if not one.records and not one.words:
                yield kind, None, None, name, one
            for record in one.records:
                law = name_of(record) if len(one.records) > 1 else None
                for key, inner in keys_of(record).items():
                    yield kind, name, (law, record), key, inner


PLACES = [pytest.param(*place, id=".".join(str(part) for part in (place[0], place[1], place[3]))) for place in places()]


def with_value(kind, table, law, key, value):
    """The text of a file that says this value (as TOML) of the key, and the beginning of a complaint."""
    if table is None:
        return f'kind = "{kind}"\n{key} = {value}\n', f"scene.toml: {key}"
    name, record = law
    lines = [f"law = {name!r}"] * (name is not None)
    lines += [f"{other} = {number}" for other, number in plain_table(record).items() if other != key]
    return "\n".join([f'kind = "{kind}"', f"[{table}]", *lines, f"{key} = {value}"]), f"scene.toml: [{table}] {key}"


def test_a_key_may_be_one_of_some_words(scene, complaint):
    """In a file, as an option, in Python and in the schema; nothing else is."""
    validator = Draft202012Validator(scene_schema(KINDS["tablet"]))
    wanted = "must be one of compression, tension, vibration"
    wrong = {
        '"tensoin"': f" = 'tensoin' {wanted}; did you mean 'tension'?",
        '"none"': f" = 'none' {wanted}; did you mean 'tension'?",
        "3": f" = 3 {wanted}",
        "true": f" = True {wanted}",
        "[1.0]": f" {wanted}, not a list",
        "{ a = 1.0 }": f" {wanted}, not a table",
    }
    for value, words in wrong.items():
        text = f'kind = "tablet"\ntest = {value}\n'
        assert complaint(text) == f"scene.toml: test{words}"
        assert not validator.is_valid(tomllib.loads(text))
    assert scene('kind = "tablet"\ntest = "tension"') == scene('kind = "tablet"', "test=tension") == Tablet(test="tension")
    with pytest.raises(InputError, match=rf"^Tablet: test = 'shear' {wanted}; did you mean"):
        Tablet(test="shear")


def beyond(bound, words, whole):
    """A number just beyond a bound."""
    if words in ("above", "below"):
        return bound
    step = max(1, bound // 2) if whole else 0.1 * abs(bound) or 1.0
    return bound - step if words == "at_least" else bound + step


@pytest.mark.parametrize(("kind", "table", "law", "key", "one"), PLACES)
def test_every_key_names_its_bound(kind, table, law, key, one, complaint):
    assert one.unit
    assert len(one.meaning) > 5
    bounds = {words: bound for words, bound in one.bounds.items() if bound is not None}
    assert bounds
    validator = Draft202012Validator(scene_schema(KINDS[kind]))
    for words, bound in bounds.items():
        value = beyond(bound, words, one.whole)
        text, begin = with_value(kind, table, law, key, value)
        assert complaint(text) == f"{begin} = {value:g} must be {words.replace('_', ' ')} {bound:g} {one.suffix}".rstrip()
        assert not validator.is_valid(tomllib.loads(text))


@pytest.mark.parametrize(("kind", "table", "law", "key", "one"), PLACES)
def test_every_key_names_what_it_cannot_use(kind, table, law, key, one, complaint):
    wrong = {
        "true": " = True is not a number",
        '"fast"': " = 'fast' is not a number",
        "nan": " = nan must be a finite number",
        "-inf": " = -inf must be a finite number",
        "[1.0]": " must be a number, not a list",
        "{ a = 1.0 }": " must be a number, not a table",
        "1979-05-27": " = datetime.date(1979, 5, 27) is not a number",
    }
    for value, words in wrong.items():
        text, begin = with_value(kind, table, law, key, value)
        assert complaint(text) == begin + words
    if one.whole:
        number = (one.at_least or 0) + 0.5
        text, begin = with_value(kind, table, law, key, number)
        assert complaint(text) == f"{begin} = {number:g} is not a whole number"


def test_changed_scenes():
    scene = RingShear(seed=1)
    assert changed(scene, {}) == scene
    assert changed(scene, {"friction.mu": 0.2, "seed": 2}) == RingShear(seed=2, friction=Friction(500.0, 0.2))
    assert changed(scene, {"friction": None, "contact": Linear(200.0)}) == RingShear(seed=1, friction=None, contact=Linear(200.0))
    assert changed(scene, {"friction": "none"}).friction is None
    assert changed(RingShear(friction=None), {"friction": Friction(1.0, 0.3, 0.2)}).friction == Friction(1.0, 0.3, 0.2)
    assert changed(SimpleShear(), {"inertial_number": None, "rate": 0.2}) == SimpleShear(rate=0.2)
    assert changed(scene, {"contact.law": "luding", "contact.k1": 1.0, "contact.k2": "2 N/m"}).contact == Luding(1.0, 2.0)
    for changes, words in (
        ({"contact.k1": 2.0}, r"^RingShear: \[contact\] unknown key 'k1', did you mean .*\? linear has stiffness, damping$"),
        ({"friction.mu": -1.0}, r"^RingShear: \[friction\] mu = -1 must be at least 0$"),
        ({"travel": 35.0}, r"^RingShear: travel = 35 must be at least discard \+ block = 20 \+ 20"),
        ({"seeds": 50.0}, "^RingShear: unknown key 'seeds', did you mean 'seed'"),
    ):
        with pytest.raises(InputError, match=words):
            changed(scene, changes)
    assert scene == RingShear(seed=1)


def test_a_scene_file_knows_every_contact_law():
    """Whoever writes a law declares its keys."""
    from anisogran.dem import NORMAL_LAWS

    for experiment in KINDS.values():
        assert set(keys_of(experiment)["contact"].records) <= set(NORMAL_LAWS)
    for law in NORMAL_LAWS:
        assert all(one.meaning for one in keys_of(law).values())
        law(**plain_table(law))


def test_numbers_are_kept_to_the_last_bit(scene):
    odd = Biaxial(pressure=math.nextafter(100.0, 200.0), strain=1e-300, seed=2**53, density=2e22)
    assert scene(scene_text(odd)) == odd


def test_reading_is_quick(scene):
    scene(SCENE)
    clock = time.perf_counter()
    scene(SCENE, "contact.kc=1")
    assert time.perf_counter() - clock < 0.5  # measured 2 ms
