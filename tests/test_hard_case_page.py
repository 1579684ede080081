"""The page of hard cases: its list, the committed page, and how a page is made of what tests found."""

import ast
from pathlib import Path

import pytest

from anisogran.outcome import InputError, Status
from hard_case_page import COMMAND, LIST, NOT_ASKED, Answer, cell, every_member, in_short, marked, members, page

TESTS = Path(__file__).parent
CASES = {case for table in LIST["table"] for case in table["cases"]}


def marks():
    """(file, case) of every `hard_case` in the tests."""
    for path in sorted(TESTS.rglob("test_*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Call) and ast.unparse(node.func) == "pytest.mark.hard_case":
                yield from ((path.name, argument.value) for argument in node.args)


def test_every_marked_case_is_in_the_list():
    assert not [one for one in marks() if one[1] not in CASES]


def test_every_exception_is_of_a_case_and_a_member():
    for case, member in NOT_ASKED:
        assert member in every_member(case)


def test_the_committed_page_has_a_row_for_every_case():
    """Its figures change with the machine; made anew by the command at its head."""
    text = (TESTS / "HARD_CASES.md").read_text()
    assert COMMAND in text
    for table in LIST["table"]:
        _, found, rows = text.partition(f"## {table['letter']}: {table['heading']}\n")
        assert found
        rows = rows.partition("\n## ")[0].splitlines()
        assert [line.split(" | ")[:2] for line in rows if line.startswith("| ")][2:] == [[f"| {c}", w] for c, w in table["cases"].items()]
        assert [name.strip(" |") for name in rows[1].split(" | ")[2:]] == members(table.get("over"))


def test_a_page_shows_answers_holes_and_failures():
    tables = [
        {"letter": "D", "heading": "Grains", "over": "contact laws", "cases": {"D1": "a step", "D3": "a ratio"}},
        {"letter": "S", "heading": "Files", "cases": {"S1": "a file"}},
    ]
    cells = {
        ("D1", "linear"): [("restitution", 2e-5), ("restitution", 3e-4), ("time", 0.0), ("refused: too | coarse", None)],
        ("D1", "luding"): [("**FAILED**: the step", None), ("holds: another", None)],
        ("S1", "outcome"): [("holds: it", None)],
    }
    text, summary = page(tables, cells)
    assert "| case |  | linear | luding |\n| --- | --- | --- | --- |\n" in text
    assert "| D1 | a step | restitution to 0.0003; time: exact; refused: too \\| coarse | **FAILED**: the step |" in text
    assert "| D3 | a ratio | does not apply: it has one stiffness | **hole** |" in text
    assert "| S1 | a file | holds: it |" in text
    assert summary == "hard cases: 2 of 4 answered, holes: D3 (luding)"


def test_many_answers_are_counted():
    assert cell([(f"refused: {word}", None) for word in "abcde"]) == "refused: a; refused: b; and 3 more"
    assert cell([("overlap of 5.1%", None), ("overlap of 1e-3%", None)]) == "overlap of 5.1%"  # the same with other numbers


def test_a_message_is_told_in_short():
    assert in_short("/home/me/runs/a b.toml: k = -1 must be\n positive, 1/2 of it") == "a b.toml: k = -1 must be positive, 1/2 of it"
    assert in_short("word " * 100).endswith("word ...")


class Item:
    nodeid = "test_it[luding]"

    def __init__(self, *marks, **params):
        self.user_properties, self.callspec, self.marks = [], type("Callspec", (), {"params": params}), marks

    def iter_markers(self, name):
        return (mark.mark for mark in self.marks if mark.mark.name == name)


def test_a_test_names_the_member_by_a_parameter_or_by_its_mark():
    mark = pytest.mark.hard_case
    assert list(marked(Item(mark("D1", "D3"), name="growing luding", other=3))) == [("D1", "luding"), ("D3", "luding")]
    assert list(marked(Item(mark("D1", of=["linear", "luding"])))) == [("D1", "linear"), ("D1", "luding")]
    assert list(marked(Item(mark("D11")))) == [("D11", "outcome")]
    assert list(marked(Item(mark("D3", of="linear")))) == []
    for wrong, words in ((mark("D99"), "D99 is not in hard_cases.toml"), (mark("D1", of="quadratic"), "D1 names none of linear, luding")):
        with pytest.raises(ValueError, match=words):
            list(marked(Item(wrong)))


def test_an_answer_goes_with_the_report():
    item = Item()
    answer = Answer(item)
    answer.computed(-1e-4, "restitution")
    with pytest.raises(ValueError, match="restitution: an error of nan is none"):
        answer.computed(float("nan"), "restitution")
    answer.refused(InputError("k1 = -1 must be above 0"))
    answer.named(Status().fail("tension"))
    assert [value for _, value in item.user_properties] == [
        ["restitution", 1e-4], ["refused: k1 = -1 must be above 0", None], ["failed: tension", None]
    ]  # fmt: skip
