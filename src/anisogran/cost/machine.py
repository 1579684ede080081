"""On which machine, when and with which versions something was measured."""

import os
import platform
import re
from datetime import date
from pathlib import Path

from anisogran.files.provenance import software


def measured_on():
    """{date, machine, versions...} of now and here, plain words."""
    return {"date": str(date.today()), "machine": f"{processor()}, {os.cpu_count()} cores", **software()}


def processor():
    """The name of the processor, as the system tells it."""
    try:
        found = re.search(r"model name\s*:\s*(.+)", Path("/proc/cpuinfo").read_text(encoding="ascii", errors="replace"))
    except OSError:
        found = None
    return found.group(1) if found else platform.processor() or platform.machine()
