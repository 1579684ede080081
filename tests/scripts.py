"""The scripts of data_generation/ and fits/ as modules."""

import importlib.util
from pathlib import Path

ROOT = Path(__file__).parent.parent


def script(path):
    """A script, such as ROOT / "fits" / "cohesion.py"."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def fits_script(name):
    """One of fits/, by its name."""
    return script(ROOT / "fits" / f"{name}.py")
