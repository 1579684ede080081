"""The page of hard cases: what the tests marked `hard_case` find is collected from every worker and written as tables.

    @pytest.mark.hard_case("D3")
    def test_...(name, answer):
        ...
        answer.computed(error, "restitution")

The cases are those of `hard_cases.toml`; the members that a case is asked of come from the package's own lists. A test tells its member by
one of its parameters, or by `hard_case("D3", of="luding")`. What nobody answered is a hole.
"""

import math
import re
import tomllib
from collections import defaultdict
from datetime import date
from functools import cache
from pathlib import Path

import pytest

LIST = tomllib.loads((Path(__file__).parent / "hard_cases.toml").read_text())
NOT_ASKED = {(case, member): reason for case, reasons in LIST["not_asked"].items() for member, reason in reasons.items()}
COMMAND = "pytest -m hard_case --hard-cases=tests/HARD_CASES.md"
MOST, LONGEST = 2, 110  # messages in a cell, and their characters
NUMBER = re.compile(r"\d[\d.e+-]*")
HOLE, FAILED = "**hole**", "**FAILED**"
ONCE = "outcome"  # the one column of a table without members


@cache
def members(over):
    """The names of the members of a list of the package; ["outcome"] for None."""
    from anisogran import continuum, dem, experiments, models

    lists = {
        None: [ONCE],
        "contact laws": dem.NORMAL_LAWS,
        "experiments": experiments.KINDS,
        "laws at a point": models.LAWS,
        "flow laws": continuum.LAWS,
    }
    return [name_of(member) for member in lists[over]]


def name_of(member):
    """The name of a law or an experiment, of its class, or a name itself."""
    kind = getattr(member, "kind", None) or getattr(member, "__name__", type(member).__name__)
    return member if isinstance(member, str) else str(kind).lower()


def every_member(case):
    """The members of all tables that have the case."""
    return [member for table in LIST["table"] if case in table["cases"] for member in members(table.get("over"))]


class Answer:
    """What a test found: each call is one outcome in the cell of its case."""

    def __init__(self, item):
        self._found = item.user_properties

    def computed(self, error, quantity="computed"):
        """To this error, relative unless the name of the quantity says otherwise; of several tests the page shows the largest.

        Its sign is left away, which would look exact. ValueError if it is not a finite number: then nothing was computed.
        """
        if not math.isfinite(error):
            raise ValueError(f"{quantity}: an error of {error} is none")
        self._found.append(("found", [quantity, abs(float(error))]))

    def refused(self, message):
        """By an exception, or what pytest.raises caught."""
        self._found.append(("found", [f"refused: {in_short(message)}", None]))

    def named(self, outcome):
        """A failure or a doubt by its name: an exception, what pytest.raises caught, a Status."""
        self._found.append(("found", [in_short(outcome), None]))


def in_short(message):
    """A message on one line, without folders of this machine, cut to the length of a cell."""
    text = re.sub(r"(?<![\w.])/[^\s:,]*/", "", " ".join(str(getattr(message, "value", message)).split()))
    return text if len(text) <= LONGEST else text[:LONGEST].rsplit(" ", 1)[0] + " ..."


@pytest.fixture
def answer(request):
    """Where a test marked `hard_case` says what it found. Without a word of it the page says that the test holds."""
    return Answer(request.node)


def marked(item):
    """The (case, member) that a test answers. Raises ValueError for an unknown case, and where no member is named."""
    values = item.callspec.params.values() if hasattr(item, "callspec") else ()
    for mark in item.iter_markers("hard_case"):
        of = mark.kwargs.get("of", ())
        words = {word for value in ([of] if isinstance(of, str) else [*of, *values]) for word in name_of(value).split()}
        for case in mark.args:
            possible = every_member(case)
            found = [member for member in possible if member in words] or [ONCE] * (ONCE in possible)
            if not found:
                known = f"names none of {', '.join(possible)}" if possible else "is not in hard_cases.toml"
                raise ValueError(f"{item.nodeid}: the case {case} {known}")
            yield from ((case, member) for member in found if (case, member) not in NOT_ASKED)


def pytest_addoption(parser):
    parser.addoption("--hard-cases", metavar="FILE", type=Path, help="write the page of hard cases to FILE")


def pytest_configure(config):
    config.addinivalue_line("markers", "hard_case(*cases, of=member): the test answers these cases of hard_cases.toml")
    config.pluginmanager.register(Collected(config))


@pytest.hookimpl(tryfirst=True)  # also if a fixture fails, it is told whose cell that is
def pytest_runtest_setup(item):
    item.user_properties += [("hard_case", list(one)) for one in marked(item)]


class Collected:
    """The outcomes of every case so far, {(case, member): [(words, error or None)]}."""

    def __init__(self, config):
        self.config, self.cells = config, defaultdict(list)

    def pytest_runtest_logreport(self, report):
        told = defaultdict(list)
        for key, value in report.user_properties:
            told[key].append(value)
        name = report.nodeid.split("::")[-1].split("[")[0].removeprefix("test_").replace("_", " ")
        if report.failed:
            told["found"] = [[f"{FAILED}: {name}", None]]
        elif report.when != "call" or report.skipped:
            return
        for case, member in told["hard_case"]:
            self.cells[case, member] += told["found"] or [[f"holds: {name}", None]]

    def pytest_terminal_summary(self, terminalreporter):
        path, whole = self.config.getoption("--hard-cases"), self.config.args_source is not pytest.Config.ArgsSource.ARGS
        option = self.config.option
        if path is None and (not whole or option.keyword or option.markexpr or option.collectonly):
            return  # a part of the tests says nothing about holes
        text, summary = page(LIST["table"], self.cells)
        terminalreporter.write_line(summary)
        if path is not None:
            path.write_text(text)


def page(tables, cells):
    """(text of the page, one line of summary)."""
    parts, holes, asked, answered = [], [], 0, 0
    for table in tables:
        columns = members(table.get("over"))
        lines = [["case", "", *columns], ["---"] * (2 + len(columns))]
        for case, words in table["cases"].items():
            row = {member: cell(cells.get((case, member), []), NOT_ASKED.get((case, member))) for member in columns}
            lines.append([case, words, *row.values()])
            unanswered = [member for member, outcome in row.items() if outcome == HOLE]
            holes += [case if unanswered == [ONCE] else f"{case} ({', '.join(unanswered)})"] * bool(unanswered)
            wanted = [outcome for member, outcome in row.items() if (case, member) not in NOT_ASKED]
            asked += len(wanted)
            answered += sum(outcome != HOLE and FAILED not in outcome for outcome in wanted)
        parts += [f"## {table['letter']}: {table['heading']}", "\n".join(f"| {' | '.join(line)} |" for line in lines)]
    summary = f"hard cases: {answered} of {asked} answered, holes: {', '.join(holes) or 'none'}"
    return "\n\n".join([HEAD, *parts, f"{date.today()}, {versions()}. H{summary[1:]}."]) + "\n", summary


HEAD = f"""# The page of hard cases

Made by the tests: `{COMMAND}`.
Each case is computed, to the error that is told, or refused by its name; "holds" names a test that asks for more than a number.
Errors are relative unless the quantity says otherwise, the largest of all tests of the cell; exact is to the last bit. What nobody answers
is a **hole**."""


def cell(found, not_asked=None):
    """The outcomes in few words: of each quantity the largest error, of messages that differ by more than numbers the first two."""
    if not_asked:
        return f"does not apply: {not_asked}"
    largest, messages = {}, {}
    for words, error in found:
        if error is None:
            messages.setdefault(NUMBER.sub("#", words), words)
        else:
            largest[words] = max(error, largest.get(words, 0.0))
    computed = [f"{words} to {error:.1g}" if error else f"{words}: exact" for words, error in sorted(largest.items())]
    failed = [words for words in messages.values() if FAILED in words]
    told = sorted(messages.values())  # in whatever order the tests ran
    more = [f"and {len(told) - MOST} more"] if len(told) > MOST else []
    return "; ".join(failed or [*computed, *told[:MOST], *more]).replace("|", "\\|") or HOLE


def versions():
    from anisogran.files.provenance import software

    made_with = ("anisogran", "python", "numpy", "numba", "scipy")
    return ", ".join(f"{name} {software()[name]}" for name in made_with)
