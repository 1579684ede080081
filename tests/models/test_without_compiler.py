"""The laws are plain Python: with the compiler switched off they give the same numbers."""

import json
import os
import subprocess
import sys

import numpy as np
from law_cases import PARAMETERS, START, record, shearing, state, strain

from anisogran.models import INTEGRATORS, LAWS, element_test, updated

SCRIPT = """
import json, sys
sys.path[:0] = sys.argv[1:]
from test_without_compiler import numbers
print(json.dumps(numbers()))
"""


def numbers():
    """Stresses and tangents of a step with rotation, and the ends of a short path, for every law and integrator."""
    found = {}
    for law in LAWS:
        turn = 0.0 if law == "scalar" else 1.0
        for integrator in INTEGRATORS:
            new = updated(
                state(law, 100.0, -45.0, 5.0 * turn),
                strain(1e-5, -1e-4, 1e-4 * turn),
                record(law),
                d_spin=1e-3 * turn,
                integrator=integrator,
                tangent=True,
            )
            test = element_test(law, PARAMETERS[law], shearing(law, 3e-5), START[law], steps=3, integrator=integrator)
            found[f"{law} {integrator}"] = [*new.stress.ravel(), *new.tangent.ravel(), *test.stress.ravel(), *test.eps_V, str(test.status)]
    return found


def test_the_laws_run_without_the_compiler():
    folder = os.path.dirname(__file__)
    run = subprocess.run(
        [sys.executable, "-W", "error", "-c", SCRIPT, folder, os.path.dirname(folder)],
        env=os.environ | {"NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    plain, compiled = json.loads(run.stdout), numbers()
    assert plain.keys() == compiled.keys()
    for name, values in compiled.items():
        assert plain[name][-1] == values[-1]
        # fused multiply-add against single operations, amplified by Newton's tolerance of 1e-11
        np.testing.assert_allclose(plain[name][:-1], values[:-1], rtol=1e-8, atol=1e-9)
