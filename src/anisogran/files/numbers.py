"""Numbers as JSON."""

import json
import math
import os
from pathlib import Path


def json_text(numbers):
    """A flat dict as JSON; NaN and infinity, which JSON does not know, become null."""
    plain = {key: None if isinstance(value, float) and not math.isfinite(value) else value for key, value in numbers.items()}
    return json.dumps(plain, indent=2, allow_nan=False)


def write_json(path, numbers):
    """Writes a flat dict as a JSON file; an older file is replaced only when all is written."""
    temporary = Path(f"{path}.tmp")
    temporary.write_text(json_text(numbers) + "\n", encoding="utf-8")
    os.replace(temporary, path)
