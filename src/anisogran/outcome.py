"""How a computation ends: bad input, failure and doubt are named here, and must be read.

A function either returns a result that it stands for, or raises one of the exceptions below, or returns a result that carries a
`Status`. Nothing is ever replaced by a plausible number.
"""

from dataclasses import dataclass
from difflib import get_close_matches
from math import isfinite


class InputError(ValueError):
    """The user gave something that cannot be used; the message is one line naming the key, the value and the bound."""


class RunFailed(RuntimeError):
    """A simulation had to stop: the message names step, grain and likely cause."""


class Interrupted(RuntimeError):
    """The user stopped it; the message says what was kept."""


class NotConverged(RuntimeError):
    """An iteration ended without a solution.

    Attributes: `history`, the residual norms so far (list of float); `best`, the best iterate (whatever the solver holds), which
    is no solution and is never returned as one.
    """

    def __init__(self, message, history=(), best=None):
        super().__init__(message)
        self.history = list(history)
        self.best = best


@dataclass(frozen=True)
class Status:
    """Whether a result can be used: `level` is "ok", "warned" or "failed"; `reasons` are sentences."""

    level: str = "ok"
    reasons: tuple[str, ...] = ()

    def __bool__(self):
        return self.level != "failed"

    def __str__(self):
        return self.level if not self.reasons else f"{self.level}: {'; '.join(self.reasons)}"

    def warn(self, reason):
        """This status, made at least "warned", with one more reason."""
        return Status("failed" if self.level == "failed" else "warned", (*self.reasons, reason))

    def fail(self, reason):
        """This status, made "failed", with one more reason."""
        return Status("failed", (*self.reasons, reason))

    def require(self):
        """Nothing, if the result can be used; else raises RunFailed with the reasons."""
        if self.level == "failed":
            raise RunFailed("; ".join(self.reasons))


def shown(value, most=60):
    """The value as one short line for a message."""
    text = repr(value)
    return text if len(text) <= most else f"{text[:most]}..."


def closest(word, known):
    """Of the known names the one that is spelt most like the word, in capitals or not, for a message that asks "did you mean ...?"."""
    names = {str(name).lower(): str(name) for name in known}
    return names[get_close_matches(str(word)[:100].lower(), names, n=1, cutoff=0.0)[0]]


def checked(where, key, value, *, above=None, at_least=None, below=None, at_most=None, unit=""):
    """`value` as a finite float inside its bounds; `where` and `key` name it in the message.

    Raises InputError naming where, key, value and the bound that it breaks.
    """
    try:
        number = float(value)
    except OverflowError:
        raise InputError(f"{where}: {key} is too large a number") from None
    except (TypeError, ValueError):
        raise InputError(f"{where}: {key} = {shown(value)} is not a number") from None
    bounds = (
        (above, "above", lambda bound: number > bound),
        (at_least, "at least", lambda bound: number >= bound),
        (below, "below", lambda bound: number < bound),
        (at_most, "at most", lambda bound: number <= bound),
    )
    if not isfinite(number):
        raise InputError(f"{where}: {key} = {number} must be a finite number")
    for bound, words, holds in bounds:
        if bound is not None and not holds(bound):
            raise InputError(f"{where}: {key} = {number:g} must be {words} {bound:g} {unit}".rstrip())
    return number
