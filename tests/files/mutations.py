"""Damaged copies of a valid text file, for the readers to survive."""

from hypothesis import strategies as st

from anisogran import InputError
from anisogran.snapshot import Snapshot

NASTY = [b"nan", b"inf", b"-1", b"0", b"1e29", b"1e-300", b"1e400", b"-7.5", b"x", b"999999999999", b"#", b"ITEM:", b"1_0", b"\xff\x00"]


def _damage(text, kind, where, other, word):
    """One kind of damage at the relative places `where` and `other`."""
    lines = text.split(b"\n")
    i, j = int(where * len(lines)), int(other * len(lines))
    tokens = lines[i].split(b" ")
    k = int(other * len(tokens))
    if kind == "byte":
        at = int(where * len(text))
        return text[:at] + word[:1] + text[at + 1 :]
    if kind == "cut":
        return text[: int(where * len(text))]
    if kind == "drop":
        lines.pop(i)
    elif kind == "repeat":
        lines.insert(j, lines[i])
    elif kind == "swap lines":
        lines[i], lines[j] = lines[j], lines[i]
    elif kind == "swap tokens":
        tokens[0], tokens[k] = tokens[k], tokens[0]
        lines[i] = b" ".join(tokens)
    elif kind == "word":
        tokens[k] = word
        lines[i] = b" ".join(tokens)
    return b"\n".join(lines)


def damaged(text):
    """Strategy: `text` (bytes) after one to three damages, or bytes of no sense at all."""
    kinds = st.sampled_from(["byte", "cut", "drop", "repeat", "swap lines", "swap tokens", "word"])
    place = st.floats(0, 1, exclude_max=True)
    words = st.one_of(st.sampled_from(NASTY), st.binary(min_size=1, max_size=4))
    steps = st.lists(st.tuples(kinds, place, place, words), min_size=1, max_size=3)

    def apply(steps):
        result = text
        for step in steps:
            result = _damage(result or b"\n", *step)
        return result

    return st.one_of(steps.map(apply), steps.map(apply), steps.map(apply), st.binary(max_size=200))


def complaint(stream):
    """The one line with which a stream of snapshots ended; empty if it came to its end."""
    try:
        for snapshot in stream:
            assert isinstance(snapshot, Snapshot)
    except InputError as error:
        return str(error)
    return ""
