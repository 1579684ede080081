"""Rows of a cost table as text: one block a knob, the default marked."""

from itertools import groupby


def row(knob, value, error, seconds, default=False):
    """One line of a cost table; `error` is relative to a stated reference, None where a thing has a price and no error."""
    return {"knob": knob, "value": value, "error": error, "seconds": seconds, "default": default}


def table_text(rows):
    """The rows as aligned text, neighbours with the same knob under one heading; the default has a star."""
    lines = []
    for knob, block in groupby(rows, key=lambda row: row["knob"]):
        lines += ["", knob]
        for entry in block:
            error = "" if entry["error"] is None else f"{entry['error']:9.2e}"
            value = entry["value"] if isinstance(entry["value"], str) else f"{entry['value']:g}"
            lines.append(f"  {value + (' *' if entry['default'] else ''):28} {error:>9}  {1e3 * entry['seconds']:10.2f} ms")
    return "\n".join(lines[1:])


def rounded(content):
    """The same with four digits in each number, more than is known."""
    if isinstance(content, dict):
        return {name: rounded(value) for name, value in content.items()}
    if isinstance(content, list):
        return [rounded(value) for value in content]
    return float(f"{content:.4g}") if isinstance(content, float) else content
