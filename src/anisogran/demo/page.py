"""A page of HTML in one file: text, tables and pictures, the pictures embedded, no script and no link to anywhere."""

import base64
import io
from html import escape

STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #222; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.7rem; } h2 { font-size: 1.3rem; margin-top: 2.4rem; border-bottom: 1px solid #ccc; }
table { border-collapse: collapse; margin: 1rem 0; } td, th { padding: .25rem .8rem; border-bottom: 1px solid #e3e3e3; text-align: left; }
th { background: #f5f3ee; }
td.number { text-align: right; white-space: nowrap; font-variant-numeric: tabular-nums; } td.long { overflow-wrap: anywhere; }
figure { margin: 1.2rem 0; } img { max-width: 100%; } figcaption { color: #555; font-size: .9rem; }
.warning { background: #fff4e0; border-left: 4px solid #d98e04; padding: .5rem 1rem; }
"""


LONG = 60  # characters; a longer cell may be broken anywhere, a shorter one only between words


def number(value, error=None):
    """A number to four digits, or with its error to two digits of the error; "not determined" for NaN."""
    if value is None or value != value:
        return "not determined"
    if error is None:
        return f"{value:.4g}"
    if error != error:
        return f"{value:.4g} (no error bar)"
    return f"{value:.4g} ± {error:.2g}"


def heading(text, level=2):
    return f"<h{level}>{escape(text)}</h{level}>"


def paragraph(text, kind=None):
    return f"<p{f' class={kind}' if kind else ''}>{escape(text)}</p>"


def table(header, rows):
    """A table; cells are text, numbers or (value, error) pairs."""

    def cell(value):
        if isinstance(value, str):
            return f"<td{' class=long' if len(value) > LONG else ''}>{escape(value)}</td>"
        return f"<td class=number>{escape(number(*value) if isinstance(value, tuple) else number(value))}</td>"

    head = "".join(f"<th>{escape(name)}</th>" for name in header)
    body = "".join(f"<tr>{''.join(cell(value) for value in row)}</tr>\n" for row in rows)
    return f"<table><tr>{head}</tr>\n{body}</table>"


def picture(figure, caption):
    """A matplotlib Figure as an embedded PNG."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=130)
    data = base64.b64encode(buffer.getvalue()).decode()
    text = escape(caption)
    return f'<figure><img alt="{escape(caption, quote=True)}" src="data:image/png;base64,{data}"><figcaption>{text}</figcaption></figure>'


def page(title, parts):
    """The whole document."""
    body = "\n".join(parts)
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>'
        f"<style>{STYLE}</style></head>\n<body>\n{heading(title, 1)}\n{body}\n</body></html>\n"
    )
