"""The error budget of the main job, from some 250 runs in which one knob at a time is turned: what `anisogran demo --accuracy` chooses by.

    python data_generation/whole_way.py whole_way.json [--quick]

The runs go to a folder of the name of the file, a sweep each, so that it can be stopped and goes on; about 40 minutes on two cores. At the
end speeds are measured, on a quiet machine if the seconds are to be right. The file has the causes of error, the best answers, and the
rows of `anisogran cost whole`. That of the package is src/anisogran/cost/whole_way.json. --quick makes a rough one of small runs.
"""

import argparse
from pathlib import Path

from anisogran import sweep
from anisogran.cost import table_text
from anisogran.cost.cases import cases_of, done_cases
from anisogran.cost.main_job import MainJob
from anisogran.cost.tables import rounded
from anisogran.cost.whole_way import budget_of, measured_job, small_job, sweeps_of, whole_way_rows
from anisogran.files import check_writable, write_json


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("--workers", type=int)
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args(arguments)
    check_writable(options.file)
    job, folder = small_job() if options.quick else MainJob(), Path(options.file).with_suffix("")
    sweeps = sweeps_of(measured_job(job), options.quick)
    cases = {}
    for name, (scene, vary) in sweeps.items():
        if options.quick:
            cases[name] = done_cases(scene, vary)
        else:
            sweep(scene, vary, folder / name, workers=options.workers)
            cases[name] = cases_of(folder / name)
    budget, curves = budget_of(cases, measured_job(job))
    rows = whole_way_rows(budget, curves, job)
    print(table_text(rows))
    write_json(options.file, rounded(budget.as_dict() | {"rows": rows}))
    return budget


if __name__ == "__main__":
    main()
