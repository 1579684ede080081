"""What accuracy costs in time: `python fits/accuracy_cost.py [accuracy_cost.json [FIGURE.png]] [--readme README.md]`.

Prints small tables in markdown: the error budget of the whole way, as it comes with the package, and of each room the knobs that a user
turns, the default bold. With --readme they replace what stands between the two marks in that file. data_generation/accuracy_cost.py makes
the data of the rooms; those of the full run are in fits/data/accuracy_cost.json.
"""

import argparse
import json
from itertools import groupby
from pathlib import Path

from anisogran import plots
from anisogran.cost import budget_tables, choice_rows, measured_budget
from anisogran.files import write_text
from anisogran.outcome import InputError

DATA = Path(__file__).parent / "data" / "accuracy_cost.json"
BEGIN, END = "<!-- made by fits/accuracy_cost.py -->", "<!-- end of what it made -->"
COLUMNS = 5  # values of a knob in a table
SHOWN = {  # the beginnings of the knobs that are shown, and their names in the figure
    "dem": {
        "steps in a contact time: restitution, dashpot": "time step: restitution",
        "grains: mu": "grains: mu",
        "inertial number: mu": "inertial number: mu",
        "p/k: phi": "p/k: area fraction",
    },
    "averaging": {
        "width in d: scatter": "width: scatter of the pressure",
        "width in d: error of a velocity wave": "width: a velocity wave",
        "grains in a cell": "grains in a cell",
        "snapshots of a run": "snapshots: s_D",
    },
    "models": {
        "steps to a turn, midpoint, order {}: tensorial": "steps, midpoint",
        "integrator at 200 steps to a turn: tensorial": "integrator at 200 steps",
        "tolerance of rk45": "tolerance, Runge-Kutta",
    },
    "fitting": {
        "points, white noise: error of beta": "points, white noise: beta",
        "points, noise with a memory of {} of the path: error of beta": "points, correlated noise: beta",
        "largest eps_D, 400 points: error of beta": "largest strain: beta",
        "kind of error bar": "kind of error bar",
    },
    "continuum": {
        "elements along the radius: error of v_phi, nonlocal law": "elements, nonlocal",
        "elements along the radius: error of v_phi, local law": "elements, local",
        "rate_floor: error of v_phi, local law": "rate floor, local",
        "elements_around: error of v_phi": "elements around, off centre",
    },
}


def shown(room, rows):
    """{name in the figure: rows} of the knobs of a room; of a room without a list all that have an error."""
    blocks = [(knob, list(block)) for knob, block in groupby(rows, key=lambda row: row["knob"])]
    if room not in SHOWN:
        return {knob: block for knob, block in blocks if block[0]["error"] is not None}
    found = {}
    for beginning, name in SHOWN[room].items():
        before, _, after = beginning.partition("{}")
        matching = [block for knob, block in blocks if knob.startswith(before) and after in knob]
        if len(matching) != 1:
            raise InputError(f"{room}: {len(matching)} knobs begin with {beginning!r}")
        found[name] = matching[0]
    return found


def around_default(block):
    """COLUMNS rows of a block, the default in their middle where that is possible; evenly spread if there is none."""
    if len(block) <= COLUMNS:
        return block
    [*at] = (k for k, row in enumerate(block) if row["default"])
    if not at:
        return [block[round(k * (len(block) - 1) / (COLUMNS - 1))] for k in range(COLUMNS)]
    begin = min(max(at[0] - COLUMNS // 2, 0), len(block) - COLUMNS)
    return block[begin : begin + COLUMNS]


def cell(row):
    """Value: error, seconds; bold if it is the default."""
    value = row["value"] if isinstance(row["value"], str) else f"{row['value']:g}"
    seconds = row["seconds"]
    time = f"{seconds:.2g} s" if seconds >= 0.0995 else f"{1e3 * seconds:.2g} ms"
    text = f"{value}: {short(row['error'])}, {time}"
    return f"**{text}**" if row["default"] else text


def short(error):
    """Two digits, without zeros in the exponent."""
    mantissa, _, exponent = f"{error:.1e}".partition("e")
    return f"{error:.2g}" if 0.01 <= error < 100 else f"{mantissa}e{int(exponent)}"


def table(room, rows):
    """The table of a room in markdown, a knob a line."""
    lines = [f"| {room} | error of | value: error, seconds |" + " |" * (COLUMNS - 1), "| --- " * (2 + COLUMNS) + "|"]
    for block in shown(room, rows).values():
        name, _, meaning = block[0]["knob"].partition(": ")
        cells = [cell(row) for row in around_default(block)]
        lines.append("| " + " | ".join([name, meaning.removeprefix("error of "), *cells, *[""] * (COLUMNS - len(cells))]) + " |")
    return "\n".join(lines)


def prices(rows):
    """{effect: time with it over time without}, of the rows of the grains."""
    pairs = [list(block) for knob, block in groupby(rows, key=lambda row: row["knob"]) if knob.startswith("price of ")]
    return {
        pair[0]["knob"].removeprefix("price of ").partition(",")[0]: pair[1]["seconds"] / pair[0]["seconds"]
        for pair in pairs
        if [row["value"] for row in pair] == ["without", "with"]
    }


def text_of(data):
    """The tables of the whole way, and those of all rooms, with date and machine."""
    about, rooms = data["about"], {room: rows for room, rows in data.items() if room != "about"}
    parts = [budget_tables(measured_budget())]
    parts.append(f"{about['date']}, seconds of one core of {about['processor']} ({about['cores']} cores), the default bold:")
    for room, rows in rooms.items():
        parts.append(table(room, rows))
        told = ", ".join(f"{effect} {ratio:.2f}" for effect, ratio in prices(rows).items())
        if told:
            parts.append(f"Time with an effect over that without it: {told}.")
    return "\n\n".join(parts)


def put_into(path, text):
    """Replace what stands between the marks of a file; InputError if they are not there."""
    before, begin, rest = Path(path).read_text().partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise InputError(f"{path}: has no lines {BEGIN} and {END}")
    write_text(path, f"{before}{BEGIN}\n{text}\n{END}{after}")


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file", nargs="?", default=str(DATA))
    parser.add_argument("figure", nargs="?")
    parser.add_argument("--readme", help="file whose tables are replaced")
    options = parser.parse_args(arguments)
    data = json.loads(Path(options.file).read_text())
    text = text_of(data)
    print(text)
    if options.readme:
        put_into(options.readme, text)
    if options.figure:
        curves = {room: shown(room, rows) for room, rows in data.items() if room != "about"}
        curves["the whole way, as chosen for an accuracy"] = choice_rows(measured_budget())
        plots.rooms_figure(curves).savefig(options.figure, dpi=100)
    return text


if __name__ == "__main__":
    main()
