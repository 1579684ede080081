"""`anisogran new` and `anisogran schema`: what they print can be used, and a wrong kind is one line."""

import json

import pytest
from jsonschema import Draft202012Validator

from anisogran import cli
from anisogran.experiments import KINDS, read_scene
from anisogran.scenes import scene_schema


def run(capsys, *arguments):
    with pytest.raises(SystemExit) as end:
        cli.main(list(arguments))
    captured = capsys.readouterr()
    return end.value.code, captured.out, captured.err


@pytest.mark.parametrize("kind", KINDS)
def test_what_new_prints_is_a_scene(kind, tmp_path, capsys):
    code, text, error = run(capsys, "new", kind)
    assert (code, error) == (0, "")
    (tmp_path / "scene.toml").write_text(text)
    assert read_scene(tmp_path / "scene.toml") == KINDS[kind]()


@pytest.mark.parametrize("kind", KINDS)
def test_what_schema_prints_is_a_schema(kind, capsys):
    code, text, error = run(capsys, "schema", kind)
    assert (code, error) == (0, "")
    Draft202012Validator.check_schema(json.loads(text))
    assert json.loads(text) == scene_schema(KINDS[kind])


@pytest.mark.parametrize("command", ["new", "schema"])
def test_an_unknown_kind_is_one_line(command, capsys):
    code, printed, error = run(capsys, command, "biaxal")
    assert (code, printed) == (2, "")
    assert error == f"anisogran: kind = 'biaxal' must be one of {', '.join(KINDS)}; did you mean 'biaxial'?\n"
    assert run(capsys, command) == (
        2,
        "",
        f"anisogran: kind is missing; it must be one of {', '.join(KINDS)}\n",
    )
