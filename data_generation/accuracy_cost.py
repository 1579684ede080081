"""What accuracy costs in time, room by room: error against seconds of the processor for each knob, with the machine and the date.

    python data_generation/accuracy_cost.py accuracy_cost.json [ROOM ...] [--quick]

Without names all rooms but the whole way are gone through one after the other, some 25 minutes of one core; the file is whole after each.
Rooms that are named are put into a file that is there, in place of their old rows, if it was made on the same kind of processor.
"""

import argparse
import json
import os
from datetime import UTC, datetime
from pathlib import Path

from anisogran import cost
from anisogran.cost.machine import processor
from anisogran.cost.tables import rounded
from anisogran.files import check_writable, software, write_json
from anisogran.outcome import InputError

ROOMS = [room for room in cost.ROOMS if room != "whole"]  # that one takes an hour and has a script of its own, whole_way.py


def kept(path, about):
    """{room: rows} of a file that is there; InputError if another processor made it, since seconds would not compare."""
    if not Path(path).exists():
        return {}
    old = json.loads(Path(path).read_text())
    if old["about"]["processor"] != about["processor"]:
        raise InputError(f"{path}: was made on {old['about']['processor']}, this is {about['processor']}: make all rooms anew")
    return {room: rows for room, rows in old.items() if room != "about"}


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("rooms", nargs="*", metavar="ROOM", help=f"{', '.join(ROOMS)}; all if none is named")
    parser.add_argument("--quick", action="store_true", help="small samples, rough numbers")
    options = parser.parse_args(arguments)
    for room in options.rooms:
        if room not in ROOMS:
            raise InputError(f"room = {room}: must be one of {', '.join(ROOMS)}")
    check_writable(options.file)
    about = {"date": f"{datetime.now(UTC):%Y-%m-%d}", "processor": processor(), "cores": os.cpu_count(), "quick": options.quick}
    about |= {"versions": software()}
    found = kept(options.file, about) if options.rooms else {}
    for room in options.rooms or ROOMS:
        rows = cost.rows_of(room, options.quick)
        print(f"\n== {room} ==\n{cost.table_text(rows)}", flush=True)
        found[room] = [row | {name: rounded(row[name]) for name in ("error", "seconds")} for row in rows]
        in_order = {name: found[name] for name in ROOMS if name in found}
        write_json(options.file, {"about": about} | in_order)
    return found


if __name__ == "__main__":
    main()
